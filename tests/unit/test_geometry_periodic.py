"""Delaunay triangles on a flat torus against all copies of its points, and flips on it."""

import numpy as np
import pytest

from cardiosurf.arrays import Floats, Ints
from cardiosurf.geometry.flips import updated
from cardiosurf.geometry.periodic import periodic_delaunay, wrapped
from cardiosurf.geometry.sheet import Periods
from cardiosurf.geometry.topology import open_edges

BOTH = (3.0, 2.0 * np.pi)
AROUND = (None, 2.0 * np.pi)


def cloud(count: int) -> Floats:
    rng = np.random.default_rng(5)
    return rng.uniform(size=(count, 2)) * [3.0, 2.0 * np.pi] - [0.0, np.pi]


def circles(flat: Floats, triangles: Ints, periods: Periods) -> tuple[Floats, Floats]:
    """Centres and radii of the triangles' circles, by Cramer's rule."""
    a = flat[triangles[:, 0]]
    b = wrapped(flat[triangles[:, 1]] - a, periods)
    c = wrapped(flat[triangles[:, 2]] - a, periods)
    matrix, right = np.stack([b, c], axis=1), 0.5 * np.stack([(b * b).sum(1), (c * c).sum(1)], 1)
    offset = np.linalg.solve(matrix, right[:, :, None])[:, :, 0]
    return a + offset, np.linalg.norm(offset, axis=1)


def names(triangles: Ints) -> set[tuple[int, ...]]:
    return {tuple(sorted(one)) for one in triangles.tolist()}


def test_steps_are_the_shortest() -> None:
    steps = wrapped(np.array([[2.0, 4.0], [-1.0, -7.0]]), BOTH)
    np.testing.assert_allclose(steps, [[-1.0, 4.0 - 2 * np.pi], [-1.0, 2 * np.pi - 7.0]])
    np.testing.assert_allclose(wrapped(np.array([[2.0, 4.0]]), AROUND), [[2.0, 4.0 - 2 * np.pi]])
    np.testing.assert_array_equal(wrapped(np.array([[9.0, 9.0]]), None), [[9.0, 9.0]])


@pytest.mark.parametrize("count", [40, 60, 90, 150])
def test_few_points_leave_no_triangle_out(count: int) -> None:
    # edges as long as the first margin of copies: some triangles have their home copy outside it
    for seed in range(20):
        rng = np.random.default_rng(seed)
        flat = rng.uniform(size=(count, 2)) * [3.0, 2.0 * np.pi]
        triangles = periodic_delaunay(flat, BOTH)
        assert len(triangles) == 2 * count
        assert len(open_edges(triangles)) == 0


@pytest.mark.parametrize("count", [24, 40, 90, 150])
def test_few_points_leave_no_hole_in_a_ring(count: int) -> None:
    around = 2.0 * np.pi * np.arange(12) / 12
    rims = [np.stack([np.full(12, w), around], axis=1) for w in (0.0, 3.0)]
    for seed in range(20):
        rng = np.random.default_rng(seed)
        inner = [0.3, 0.0] + rng.uniform(size=(count, 2)) * [2.4, 2.0 * np.pi]
        triangles = periodic_delaunay(np.concatenate([*rims, inner]), AROUND)
        # the two rims, and V - E + F = 0, 2 E = 3 F + 24
        assert len(open_edges(triangles)) == 24
        assert len(triangles) == 2 * (count + 24) - 24


@pytest.mark.parametrize("count", [150, 600])
def test_circles_on_a_flat_torus_are_empty(count: int) -> None:
    flat = cloud(count)
    triangles = periodic_delaunay(flat, BOTH)
    # V - E + F = 0 and 2 E = 3 F
    assert len(triangles) == 2 * count
    assert len(open_edges(triangles)) == 0
    centres, radii = circles(flat, triangles, BOTH)
    for centre, radius in zip(centres, radii, strict=True):
        nearest = np.linalg.norm(wrapped(flat - centre, BOTH), axis=1).min()
        assert nearest > radius * (1.0 - 1e-6)


def test_even_grids_have_no_holes_and_no_doubles() -> None:
    # every four neighbours lie on a circle: each copy of a square must be cut the same way
    rows, columns = 24, 40
    grid = np.stack(np.meshgrid(np.arange(rows) / rows, np.arange(columns) / columns), axis=-1)
    flat = grid.reshape(-1, 2) * [3.0, 2.0 * np.pi]
    triangles = periodic_delaunay(flat, BOTH)
    assert len(names(triangles)) == len(triangles) == 2 * rows * columns
    assert len(open_edges(triangles)) == 0


def test_a_ring_has_two_open_edges() -> None:
    flat = cloud(300)
    triangles = periodic_delaunay(flat, AROUND)
    border = open_edges(triangles)
    # V - E + F = 0 on a ring, 2 E = 3 F + border
    assert len(triangles) == 2 * 300 - len(border)


def test_a_part_of_the_points_has_the_triangles_of_the_whole_inside_it() -> None:
    flat = cloud(2000)
    whole = periodic_delaunay(flat, BOTH)
    away = np.linalg.norm(wrapped(flat - [0.0, np.pi], BOTH), axis=1)
    near = np.flatnonzero(away < 1.0)
    part = near[periodic_delaunay(flat[near], BOTH)]
    # 2000 points are 0.1 apart: circles are at most 0.3 wide
    inner = away < 0.5
    expected = whole[inner[whole].all(axis=1)]
    assert names(part[inner[part].all(axis=1)]) == names(expected)


def test_flips_across_the_seams() -> None:
    rng = np.random.default_rng(1)
    grid = np.stack(np.meshgrid(np.arange(20) / 20, np.arange(20) / 20), axis=-1)
    flat = (grid.reshape(-1, 2) + 0.008 * rng.uniform(-1.0, 1.0, (400, 2))) * [3.0, 2.0 * np.pi]
    old = periodic_delaunay(flat, BOTH)
    # no triangle turns over: their heights are 0.13 and more
    moved = flat + 0.04 * rng.uniform(-1.0, 1.0, flat.shape)
    # the same places, some of them named by another copy
    moved[::7] += [3.0, -2.0 * np.pi]
    everywhere, nowhere = np.ones(400, bool), np.zeros(400, bool)
    new = updated(moved, old, everywhere, nowhere, periods=BOTH)
    assert new is not None
    assert names(new) != names(old)
    assert names(new) == names(periodic_delaunay(moved, BOTH))
