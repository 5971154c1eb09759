import numpy as np
import pytest
from scipy.spatial import ConvexHull, Delaunay

from cardiosurf.analysis.eikonal import distance_from as distance_of
from cardiosurf.analysis.sources import Sources


def distance_from(points, triangles, sources):
    return distance_of(points, triangles, Sources.at(np.flatnonzero(sources)))


def jittered_square(half, step, seed=0):
    line = np.arange(-half, half + step / 2, step)
    x, y = np.meshgrid(line, line, indexing="ij")
    points = np.c_[x.ravel(), y.ravel(), np.zeros(x.size)]
    inner = (np.abs(points[:, :2]) < half - step / 2).all(axis=1)
    points[inner, :2] += np.random.default_rng(seed).uniform(-0.3, 0.3, (inner.sum(), 2)) * step
    return points, Delaunay(points[:, :2]).simplices.astype(np.int64)


def test_a_straight_front_is_exact_on_any_triangulation():
    # first-order updates reproduce a linear solution exactly
    points, triangles = jittered_square(50.0, 2.5)
    distance = distance_from(points, triangles, points[:, 0] > 49.9)
    np.testing.assert_allclose(distance, 50.0 - points[:, 0], atol=1e-6)


def test_circles_on_the_plane_converge_at_first_order():
    errors = []
    for step in (4.0, 2.0, 1.0):
        points, triangles = jittered_square(40.0, step)
        radius = np.hypot(points[:, 0], points[:, 1])
        # start from a disc and measure from its rim, to keep the source's own error out
        sources = radius <= 10.0
        start = distance_from(points, triangles, sources) + radius[sources].max()
        errors.append(np.abs(start - radius)[radius > 20.0].mean())
    slope = np.log2(errors[0] / errors[2]) / 2
    # the update is first order (with a logarithm for point sources), hence at least 0.7
    assert slope > 0.7
    # the rim of the source disc is ragged by up to one step, and that offset stays
    assert errors[2] < 0.6


def test_great_circles_on_the_sphere():
    index = np.arange(4000) + 0.5
    polar = np.arccos(1 - 2 * index / 4000)
    azimuth = np.pi * (1 + 5**0.5) * index
    points = (
        50.0
        * np.c_[np.cos(azimuth) * np.sin(polar), np.sin(azimuth) * np.sin(polar), np.cos(polar)]
    )
    triangles = ConvexHull(points).simplices.astype(np.int64)
    north = polar < 0.2
    distance = distance_from(points, triangles, north) + 50.0 * polar[north].max()
    # edges are about 3 su and the rim of the source is ragged by one of them
    assert np.abs(distance - 50.0 * polar)[polar > 0.4].max() < 3.0


def test_what_no_source_reaches_is_infinitely_far():
    points, triangles = jittered_square(10.0, 2.5)
    count = len(points)
    two = np.concatenate((points, points + np.array([100.0, 0.0, 0.0])))
    both = np.r_[triangles, triangles + count]
    sources = np.zeros(2 * count, dtype=bool)
    sources[0] = True
    distance = distance_from(two, both, sources)
    assert np.isfinite(distance[:count]).all()
    assert np.isinf(distance[count:]).all()


@pytest.mark.parametrize("scale", [0.1, 10.0])
def test_distance_scales_with_the_surface(scale):
    points, triangles = jittered_square(20.0, 2.5)
    sources = np.hypot(points[:, 0] + 20, points[:, 1] + 20) < 1.0
    np.testing.assert_allclose(
        distance_from(scale * points, triangles, sources),
        scale * distance_from(points, triangles, sources),
        rtol=1e-6,
    )
