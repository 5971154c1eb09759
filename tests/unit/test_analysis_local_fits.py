"""Gradients by parabolas: exact where the field is one, and on the sphere."""

import numpy as np
from arrival_samples import RADIUS, fibonacci_sphere, square

from cardiosurf.analysis.local_fits import LocalFits, tangent_planes, vertex_normals


def test_the_gradient_of_a_parabola_is_exact():
    points, triangles = square(4.0)
    x, y = points[:, 0], points[:, 1]
    fits = LocalFits(points, triangles, 2)
    # in a corner there may be fewer than nine vertices within two edges
    assert np.count_nonzero(~fits.known) <= 4
    found = fits.gradient(2.0 + 0.3 * x - y + 0.01 * x * x - 0.02 * x * y + 0.03 * y * y)
    exact = np.stack([0.3 + 0.02 * x - 0.02 * y, -1.0 - 0.02 * x + 0.06 * y, 0.0 * x], axis=1)
    np.testing.assert_allclose(found[fits.known], exact[fits.known], atol=1e-10)


def test_several_fields_at_once_are_each_by_itself():
    points, triangles = square(4.0)
    fields = np.stack([points[:, 0] ** 2, np.sin(points[:, 1] / 20.0)], axis=1)
    fits = LocalFits(points, triangles, 2)
    together = fits.gradient(fields)
    assert together.shape == (len(points), 3, 2)
    for part in range(2):
        np.testing.assert_array_equal(together[:, :, part], fits.gradient(fields[:, part]))


def test_on_a_sphere_the_gradient_is_that_in_the_tangent_plane():
    points, triangles = fibonacci_sphere(2000)
    normals = points / RADIUS
    # the normal of a triangle is off by h/R = 0.084 at the most at its corners; means cancel most
    np.testing.assert_allclose(vertex_normals(points, triangles), normals, atol=0.02)
    found = LocalFits(points, triangles, 2).gradient(points[:, 2])
    exact = np.array([0.0, 0.0, 1.0]) - normals[:, 2:] * normals
    # the third derivative 1/R^2 over 2 edges of 4.2 su: 0.03 at most
    np.testing.assert_allclose(found, exact, atol=0.03)
    assert np.sqrt(np.mean((found - exact) ** 2)) < 0.005


def test_too_few_vertices_give_no_gradient():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    fits = LocalFits(points, np.array([[0, 1, 2], [1, 3, 2]]), 3)
    assert not fits.known.any()
    assert np.isnan(fits.gradient(points[:, 0])).all()


def test_tangent_planes_are_orthonormal():
    normals = fibonacci_sphere(100)[0] / RADIUS
    planes = tangent_planes(normals)
    frames = np.concatenate([planes, normals[:, None]], axis=1)
    np.testing.assert_allclose(
        frames @ frames.transpose(0, 2, 1), np.eye(3)[None] + 0 * frames, atol=1e-12
    )
    # right-handed
    np.testing.assert_allclose(np.linalg.det(frames), 1.0, atol=1e-12)
