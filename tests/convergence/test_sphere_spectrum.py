"""Eigenvalues of the Laplace-Beltrami operator on the sphere: l(l + 1) / R^2, 2l + 1 of each."""

import numpy as np
import pytest
from scipy.sparse.linalg import eigsh
from waves import icosphere, operators

RADIUS = 50.0
LEVELS = (3, 4, 5)
EXACT = np.repeat([0.0, 2.0, 6.0, 12.0], [1, 3, 5, 7]) / RADIUS**2


def spectrum(level, mass):
    points, triangles = icosphere(level)
    op = operators(RADIUS * points, triangles, mass=mass)
    # shifted below the spectrum so that the matrix to factorise is positive definite
    shift = -1.0 / RADIUS**2
    values = eigsh(
        op.stiffness.tocsc(),
        17,
        M=op.mass.tocsc(),
        sigma=shift,
        v0=points[:, 0],
        return_eigenvectors=False,
    )
    return np.sort(values)


@pytest.fixture(scope="module", params=["blended", "consistent"])
def errors(request):
    """Worst relative error of the multiplets l = 1, 2, 3 on each level, (levels, 3)."""

    def worst(values):
        relative = np.abs(values[1:16] / EXACT[1:] - 1.0)
        return [relative[:3].max(), relative[3:8].max(), relative[8:].max()]

    return np.array([worst(spectrum(level, request.param)) for level in LEVELS])


def test_eigenvalues_converge_at_second_order(errors):
    # linear elements on a polyhedron inscribed in the surface: both errors are O(h^2)
    slopes = np.log2(errors[:-1] / errors[1:])
    assert slopes == pytest.approx(2.0, abs=0.1)


def test_eigenvalues_are_close_on_the_finest_sphere(errors):
    # h = 0.035 R there; (l h / R)^2 / 12 is 0.0009 at l = 3, twice that is the cap
    assert (errors[-1] < 0.0018).all()


def test_the_sphere_has_one_constant_and_no_mode_between_the_multiplets():
    values = spectrum(3, "blended") * RADIUS**2
    assert values[0] == pytest.approx(0.0, abs=1e-8)
    # l = 4 begins at 20; a seventeenth value far below it would be a spurious mode
    assert values[16] == pytest.approx(20.0, rel=0.01)


def test_lumped_mass_meets_the_spectrum_too():
    # its error at l = 3 on level 4 is 0.43 %, opposite in sign to that of the consistent mass
    values = spectrum(4, "lumped")
    assert values[1:16] == pytest.approx(EXACT[1:], rel=0.005)
    assert values[15] < EXACT[15] < spectrum(4, "consistent")[15]
