import numpy as np
import pytest
from scipy.spatial import ConvexHull, Delaunay

from cardiosurf.geometry import Plane, Sphere
from cardiosurf.geometry.flips import updated
from cardiosurf.geometry.topology import corners_in, edge_lengths, open_edges, twins

RNG = np.random.default_rng(7)
RIM, COUNT = 60, 460


def cloud():
    """Points in a circle, the first ones on it."""
    angle = 2.0 * np.pi * np.arange(RIM) / RIM
    inner = RNG.uniform(-0.9, 0.9, (4 * COUNT, 2))
    inner = inner[np.hypot(*inner.T) < 0.9][: COUNT - RIM]
    return np.concatenate([np.stack([np.cos(angle), np.sin(angle)], axis=1), inner])


def names(triangles):
    return {tuple(sorted(one)) for one in np.asarray(triangles).tolist()}


def plane_delaunay(points):
    return Plane(x=(0.0, 1.0), y=(0.0, 1.0)).sheet(1.0).triangulate(np.c_[points, 0 * points[:, 0]])


def test_after_small_moves_the_triangles_are_those_of_scipy():
    points = cloud()
    old = plane_delaunay(points)
    moved = points.copy()
    # every vertex by 0.3 times the smallest height around it: no triangle turns over
    sides = edge_lengths(np.c_[points, 0 * points[:, 0]], old)
    area = 0.5 * np.abs(np.linalg.det(points[old][:, 1:] - points[old][:, :1]))
    height = np.full(COUNT, np.inf)
    np.minimum.at(height, old.ravel(), np.repeat(2.0 * area / sides.max(axis=0), 3))
    step = RNG.uniform(-1.0, 1.0, (COUNT - RIM, 2)) / np.sqrt(2.0)
    moved[RIM:] += 0.3 * height[RIM:, None] * step
    free = np.arange(COUNT) >= RIM
    new = updated(moved, old, free, np.zeros(COUNT, bool))
    assert new is not None
    assert names(new) != names(old)
    assert names(new) == names(Delaunay(moved).simplices)


def test_triangles_that_turn_over_are_refused():
    points = cloud()
    old = plane_delaunay(points)
    moved = points.copy()
    moved[RIM:] = moved[RIM:][::-1]
    assert updated(moved, old, np.arange(COUNT) >= RIM, np.zeros(COUNT, bool)) is None


@pytest.mark.parametrize("share", [0.02, 0.2])
def test_without_some_points_the_triangles_are_those_of_the_rest(share):
    points = cloud()
    gone = RNG.uniform(size=COUNT) < share
    gone[:RIM] = False
    new = updated(points, plane_delaunay(points), np.zeros(COUNT, bool), gone)
    assert new is not None
    rest = np.flatnonzero(~gone)
    assert names(new) == names(rest[Delaunay(points[rest]).simplices])


def test_on_a_sphere_the_triangles_are_those_of_the_convex_hull():
    sheet = Sphere(radius=2.0).sheet(1.0)
    points = sheet.project(RNG.normal(size=(500, 3)))
    old = sheet.triangulate(points)
    gone = np.arange(500) % 25 == 3
    moved = sheet.project(points + RNG.normal(size=(500, 3)) * 5e-4)
    new = updated(sheet.flattened(moved), old, np.ones(500, bool), gone)
    assert new is not None
    rest = np.flatnonzero(~gone)
    assert names(new) == names(rest[ConvexHull(moved[rest]).simplices])
    normal = np.cross(
        moved[new[:, 1]] - moved[new[:, 0]],
        moved[new[:, 2]] - moved[new[:, 0]],
    )
    assert (np.einsum("md,md->m", normal, moved[new[:, 0]]) > 0).all()


def test_points_on_one_circle_ask_for_no_flip():
    # the square's two diagonals are equally good: the one that is there stays
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    for triangles in ([[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]):
        new = updated(square, np.array(triangles), np.ones(4, bool), np.zeros(4, bool))
        assert names(new) == names(triangles)


def test_twins_open_edges_and_corners_of_two_triangles():
    triangles = np.array([[0, 1, 2], [2, 1, 3]])
    # half edge 0 of the first is (1, 2), half edge 2 of the second is (2, 1)
    assert twins(triangles).tolist() == [5, -1, -1, -1, -1, 0]
    assert open_edges(triangles).tolist() == [[2, 0], [0, 1], [1, 3], [3, 2]]
    assert corners_in(np.array([True, False, True, True]), triangles).tolist() == [2, 2]
    points = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [3.0, 4.0, 0.0]])
    assert edge_lengths(points, triangles) == pytest.approx(
        np.array([[5.0, 4.0], [4.0, 3.0], [3.0, 5.0]])
    )


def test_open_edges_of_many_triangles_are_those_counted_one_by_one():
    points = cloud()
    triangles = plane_delaunay(points)
    triangles = triangles[RNG.permutation(len(triangles))[: len(triangles) * 2 // 3]]
    uses: dict = {}
    for a, b, c in triangles.tolist():
        for pair in ((b, c), (c, a), (a, b)):
            uses.setdefault(frozenset(pair), []).append(pair)
    single = [pairs[0] for pairs in uses.values() if len(pairs) == 1]
    assert sorted(map(tuple, open_edges(triangles).tolist())) == sorted(single)


def test_a_vertex_that_no_neighbour_can_stand_in_for_is_not_left_out():
    # a pinwheel about the origin: none of its corners sees all its edges
    angle = np.radians([0, 100, 120, 220, 240, 340])
    rim = np.array([1.0, 0.2] * 3)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = np.concatenate([rim, [[0.0, 0.0]]])
    fan = np.array([[6, one, (one + 1) % 6] for one in range(6)])
    gone = np.arange(7) == 6
    assert updated(points, fan, np.zeros(7, bool), gone) is None
