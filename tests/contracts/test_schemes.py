"""What every scheme of the registry must satisfy, from its coefficients alone."""

import numpy as np
import pytest

from cardiosurf.stepping.schemes import SCHEMES

every_scheme = pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)


@every_scheme
def test_declared_order_follows_from_the_coefficients(scheme):
    # exact for w = t^q, q = 0 ... order, at dt = 1: new time 1, present 0, before -1 ...
    new = 1.0 - np.arange(6)
    for q in range(scheme.order + 1):
        derivative = sum(a * t**q for a, t in zip(scheme.state, new, strict=False))
        power = max(q - 1, 0)
        implicit = q * sum(b * t**power for b, t in zip(scheme.implicit, new, strict=False))
        explicit = q * sum(c * t**power for c, t in zip(scheme.explicit, new[1:], strict=False))
        assert derivative == pytest.approx(implicit, abs=1e-12)
        assert derivative == pytest.approx(explicit, abs=1e-12)


@every_scheme
def test_order_is_not_declared_too_low(scheme):
    q, new = scheme.order + 1, 1.0 - np.arange(6)
    derivative = sum(a * t**q for a, t in zip(scheme.state, new, strict=False))
    implicit = q * sum(b * t ** (q - 1) for b, t in zip(scheme.implicit, new, strict=False))
    assert abs(derivative - implicit) > 1e-6


@every_scheme
@pytest.mark.parametrize("stiffness", [0.0, 0.1, 1.0, 10.0, 1e3, 1e6])
def test_diffusion_is_damped_at_any_step(scheme, stiffness):
    # roots of sum_j (a_j + z b_j) r^(k-j): within the unit circle for all z = dt * eigenvalue >= 0
    k = max(len(scheme.state), len(scheme.implicit))
    a, b = np.zeros(k), np.zeros(k)
    a[: len(scheme.state)] = scheme.state
    b[: len(scheme.implicit)] = scheme.implicit
    roots = np.abs(np.roots(a + stiffness * b))
    assert (roots <= 1.0 + 1e-12).all()


@every_scheme
def test_matrix_is_positive(scheme):
    assert scheme.state[0] > 0.0
    assert scheme.implicit[0] > 0.0


@every_scheme
def test_depth_covers_all_coefficients(scheme):
    assert scheme.depth >= len(scheme.state) - 1
    assert scheme.depth >= len(scheme.explicit)


def test_names_and_sources():
    for name, scheme in SCHEMES.items():
        assert scheme.name == name
        assert "19" in scheme.citation or "20" in scheme.citation, "a source has a year"
