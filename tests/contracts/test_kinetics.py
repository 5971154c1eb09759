"""What every kinetics model of the registry must satisfy."""

from dataclasses import fields, replace

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from cardiosurf.kinetics import KINETICS

every_model = pytest.mark.parametrize("model", KINETICS.values(), ids=KINETICS)


def constants(model):
    return [field.name for field in fields(model) if field.name != "model"]


@every_model
def test_rest_is_an_equilibrium(model):
    f, g = model().rates(np.zeros(3), np.zeros(3))
    assert (f == 0.0).all()
    assert (g == 0.0).all()


@every_model
def test_rest_is_stable(model):
    # eigenvalues of the Jacobian at rest, by central differences (exact to 1e-6 for a cubic)
    shift = 1e-4
    columns = []
    for direction in np.eye(2) * shift:
        ahead = np.array(model().rates(direction[:1], direction[1:]))
        behind = np.array(model().rates(-direction[:1], -direction[1:]))
        columns.append((ahead - behind)[:, 0] / (2.0 * shift))
    assert (np.linalg.eigvals(np.column_stack(columns)).real < -1e-3).all()


@every_model
def test_small_disturbances_decay_and_large_ones_excite(model):
    quiet, _ = model().rates(np.array([0.05]), np.array([0.0]))
    excited, recovering = model().rates(np.array([0.5]), np.array([0.0]))
    assert quiet[0] < 0.0 < excited[0]
    assert recovering[0] > 0.0


@every_model
def test_rates_are_vectorised_and_leave_their_arguments_alone(model):
    rng = np.random.default_rng(3)
    u, v = rng.random(50), rng.random(50)
    kept = u.copy(), v.copy()
    f, g = model().rates(u, v)
    assert f.shape == g.shape == (50,)
    single = [model().rates(u[k : k + 1], v[k : k + 1]) for k in range(50)]
    assert f == pytest.approx(np.array([pair[0][0] for pair in single]), rel=1e-14)
    assert g == pytest.approx(np.array([pair[1][0] for pair in single]), rel=1e-14)
    assert (u == kept[0]).all()
    assert (v == kept[1]).all()


@every_model
def test_every_constant_is_used(model):
    u, v = np.array([0.4]), np.array([0.3])
    standard = model().rates(u, v)
    for name in constants(model):
        changed = replace(model(), **{name: 1.1 * getattr(model(), name)}).rates(u, v)
        assert changed != standard, f"{name} changes nothing"


@every_model
def test_constants_are_yaml_keys(model):
    adapter = TypeAdapter(model)
    name = constants(model)[0]
    assert getattr(adapter.validate_json(f'{{"{name}": 0.2}}'), name) == 0.2
    for wrong in (f'{{"{name}": -0.2}}', f'{{"{name}": NaN}}', '{"alpha_of_nothing": 0.2}'):
        with pytest.raises(ValidationError):
            adapter.validate_json(wrong)


@pytest.mark.parametrize("name", KINETICS)
def test_registered_under_its_own_name(name):
    assert KINETICS[name]().model == name
