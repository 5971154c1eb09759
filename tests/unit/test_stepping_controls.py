import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from cardiosurf.errors import InputError, NumericalError
from cardiosurf.fem.operators import assemble
from cardiosurf.kinetics import KINETICS, RogersMcCulloch
from cardiosurf.stepping.controls import Execution, TimeSection, decide
from cardiosurf.stepping.schemes import SCHEMES, Scheme
from cardiosurf.stepping.solvers import LOOSEST_TOLERANCE
from cardiosurf.stepping.stability import largest_stable
from cardiosurf.stepping.step_rule import ERROR_COEFFICIENTS, auto_step, reaction_rate


@pytest.fixture
def operators():
    points = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [2.0, 2.0, 0.0]])
    triangles = np.array([[0, 1, 2], [1, 3, 2]])
    return assemble(points, triangles, np.tile(np.eye(3), (2, 1, 1)), np.ones(2, bool))


@pytest.mark.parametrize(
    "wrong",
    [
        '{"step": 1}',
        '{"end": 0}',
        '{"end": 100, "step": -1}',
        '{"end": 100, "step": "large"}',
        '{"end": 100, "scheme": "rk4"}',
        '{"end": 100, "tolerance": 1e-3}',
        '{"end": NaN}',
        '{"end": 100, "stop": 3}',
    ],
)
def test_section_refuses(wrong):
    with pytest.raises(ValidationError):
        TypeAdapter(TimeSection).validate_json(wrong)


def test_section_defaults():
    section = TypeAdapter(TimeSection).validate_json('{"end": 2500}')
    assert section == TimeSection(2500.0, "auto", "sbdf2", "auto", 1e-7, True)
    assert section.tolerance < LOOSEST_TOLERANCE


def test_every_scheme_of_the_section_is_registered():
    choices = TypeAdapter(TimeSection).json_schema()["properties"]["scheme"]["enum"]
    assert set(choices) == set(SCHEMES) == set(ERROR_COEFFICIENTS)


def test_decisions_carry_their_reasons(operators):
    controls = decide(TimeSection(end=100.0), RogersMcCulloch(), operators)
    assert controls.scheme is SCHEMES["sbdf2"]
    # 0.0285 (0.2262 dt)^2 <= 0.25 %
    assert controls.step.step == 1.2
    assert "0.226" in controls.step.reason
    assert controls.solver.name == "cg"
    assert "4 nodes" in controls.solver.reason
    plain = decide(
        TimeSection(end=100.0), RogersMcCulloch(), operators, execution=Execution(jit=False)
    )
    assert plain.solver.name == "direct"
    wanted = decide(TimeSection(end=100.0, step=0.7, solver="cg"), RogersMcCulloch(), operators)
    assert wanted.step.step == 0.7
    # C (rate dt)^2 = 0.0285 (0.2262 * 0.7)^2
    assert wanted.step.lat_error == pytest.approx(0.000715, rel=0.01)
    assert wanted.step.reason == "asked for: LAT error 0.07%"
    assert wanted.solver.name == "cg"


@pytest.mark.parametrize(
    ("name", "limit"), [("imex_euler", 2.0), ("cnab2", 1.0), ("sbdf2", 4.0 / 3.0)]
)
def test_explicit_stability_limits(name, limit):
    # by hand: forward Euler |1 - z| <= 1; AB2 and the extrapolated BDF2 leave the disc at -1:
    # 2 = z (3 + 1)/2 and 1.5 + 2 + 0.5 = z (2 + 1)
    assert largest_stable(SCHEMES[name]) == pytest.approx(limit, abs=1e-4)


@pytest.mark.parametrize("step", [6.0, 60.0, 5000.0])
def test_an_unstable_step_is_refused_where_it_would_begin(operators, step):
    # 4/3 / 0.2262 = 5.89 tu; a run with 60 tu does not blow up but dies, and would look like a
    # stimulus that does not capture
    with pytest.raises(NumericalError, match=f"at step 1, t = {step:g} tu.*5.89 tu"):
        decide(TimeSection(end=1e7, step=step), RogersMcCulloch(), operators)
    assert decide(TimeSection(end=1e7, step=5.8), RogersMcCulloch(), operators).step.step == 5.8


@pytest.mark.parametrize("name", KINETICS)
def test_reaction_rate_of_the_shipped_models(name):
    # |df/du| at u = 1, v = 0 is c1 (1 - a) = 0.2262, the largest on [0, 1]
    assert reaction_rate(KINETICS[name]()) == pytest.approx(0.26 * 0.87, rel=1e-6)


@pytest.mark.parametrize("name", SCHEMES)
def test_step_follows_the_rate(name):
    slow, fast = RogersMcCulloch(), RogersMcCulloch(c1=2.6)
    one, other = auto_step(SCHEMES[name], slow).step, auto_step(SCHEMES[name], fast).step
    assert other == pytest.approx(one / 10.0)


def test_a_slow_potential_with_a_fast_recovery_follows_the_recovery():
    assert reaction_rate(RogersMcCulloch(b1=2.0, b2=3.0)) == pytest.approx(6.0, rel=1e-6)


def test_auto_is_refused_for_a_scheme_without_a_measured_error():
    foreign = Scheme("mine", 1, (1.0, -1.0), (1.0,), (1.0,), "nowhere")
    with pytest.raises(InputError, match="auto is not known for the scheme mine"):
        auto_step(foreign, RogersMcCulloch())
