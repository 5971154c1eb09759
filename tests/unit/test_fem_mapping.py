import numpy as np
import pytest

from cardiosurf.errors import InputError
from cardiosurf.fem.mapping import SurfaceMapping, surface_mesh

POINTS = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 4.0], [0.0, 2.0, 0.0], [1.0, 5.0, -2.0]])
TRIANGLES = np.array([[0, 1, 2], [1, 3, 2]])
REFERENCE = np.array([[0.0, 1.0, 0.0, 0.25], [0.0, 0.0, 1.0, 0.5]])


@pytest.fixture
def mapping():
    return SurfaceMapping(surface_mesh(POINTS, TRIANGLES))


def test_corners_are_mapped_to_corners(mapping):
    images = mapping.F(REFERENCE)
    assert images.shape == (3, 2, 4)
    assert np.moveaxis(images[:, :, :3], 0, -1) == pytest.approx(POINTS[TRIANGLES], abs=1e-15)


def test_area_element_is_twice_the_area(mapping):
    # triangle 0: right-angled, legs 5 and 2
    assert mapping.detDF(REFERENCE)[0] == pytest.approx(10.0)
    corners = POINTS[TRIANGLES[1]]
    cross = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    assert mapping.detDF(REFERENCE)[1] == pytest.approx(np.linalg.norm(cross))


def test_inverse_is_the_pseudo_inverse(mapping):
    jacobian, inverse = mapping.DF(REFERENCE), mapping.invDF(REFERENCE)
    for k in range(2):
        assert inverse[:, :, k, 1] == pytest.approx(np.linalg.pinv(jacobian[:, :, k, 1]))


def test_some_triangles_only(mapping):
    some = np.array([1])
    assert mapping.F(REFERENCE, some) == pytest.approx(mapping.F(REFERENCE)[:, [1]])
    assert mapping.invDF(REFERENCE, some).shape == (2, 3, 1, 4)
    assert mapping.detDF(REFERENCE, some).shape == (1, 4)


def test_triangle_without_area_is_refused():
    flat = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0], [0.0, 1.0, 0.0]])
    with pytest.raises(InputError, match="1 triangles have no area, the first of them is number 1"):
        SurfaceMapping(surface_mesh(flat, np.array([[0, 1, 3], [0, 1, 2]])))
