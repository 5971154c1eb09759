"""Arrival times on every shape of the registry, against an independent first-order solver."""

import numpy as np
import pytest
import scipy

from cardiosurf.analysis.conductor import Conductor
from cardiosurf.analysis.eikonal import arrival, distance_from
from cardiosurf.analysis.sources import Sources
from cardiosurf.analysis.trajectories import Places, trajectories
from cardiosurf.geometry import SHAPES, build_surface
from cardiosurf.geometry.topology import numbered_edges, open_edges

EDGE = 6.0


@pytest.fixture(scope="module", params=sorted(SHAPES))
def waves(request):
    """A shape, and arrivals of both orders from a vertex off its open edges, at speed 1."""
    surface = build_surface(SHAPES[request.param](), EDGE, {})
    isotropic = np.broadcast_to(np.eye(3), (len(surface.triangles), 3, 3))
    conductor = Conductor(surface.points, surface.triangles, isotropic)
    inner = np.setdiff1d(np.arange(len(surface.points)), open_edges(surface.triangles))
    source = inner[len(inner) // 2]
    first, second = (arrival(conductor, Sources.at([source]), 1.0, order=n) for n in (1, 2))
    return conductor, source, first, second


def relaxed(points, triangles, source):
    """The first-order equation in NumPy: all triangles at once until no vertex gets earlier."""
    turns = [triangles[:, np.roll([0, 1, 2], -k)].T for k in range(3)]
    times = np.where(np.arange(len(points)) == source, 0.0, np.inf)
    before = None
    while not np.array_equal(times, before):
        before = times.copy()
        for goal, one, two in turns:
            new = through_edge(points[goal], points[one], points[two], before[one], before[two])
            np.minimum.at(times, goal, new)
    return times


def through_edge(goal, one, two, first, second):
    """Least time at the goal over the edge between two points, its times being linear."""
    side, away = two - one, goal - one
    squared = np.einsum("ij,ij->i", side, side)
    foot = np.einsum("ij,ij->i", away, side) / squared
    height = np.einsum("ij,ij->i", away, away) - foot**2 * squared
    with np.errstate(invalid="ignore", divide="ignore"):
        rise = second - first
        crossing = foot - rise * np.sqrt(height / (squared * (squared - rise**2)))
        s = np.where(np.isfinite(crossing), np.clip(crossing, 0.0, 1.0), 0.0)
        inner = first + s * rise + np.sqrt(height + squared * (s - foot) ** 2)
    ends = (
        first + np.linalg.norm(goal - one, axis=1),
        second + np.linalg.norm(goal - two, axis=1),
    )
    return np.fmin(inner, np.minimum(*ends))


def test_first_order_solves_its_discrete_equation(waves):
    conductor, source, first, _ = waves
    expected = relaxed(conductor.points, conductor.triangles, source)
    # one solution, found in another order: times differ by rounding and by what a change must be
    np.testing.assert_allclose(first.times, expected, atol=1e-9)


def test_the_undisturbed_wave_of_verdicts_is_an_arrival_of_first_order(waves):
    conductor, source, first, _ = waves
    found = distance_from(conductor.points, conductor.triangles, Sources.at([source]))
    # the metric of d = 1, which an arrival computes, is exact to rounding
    np.testing.assert_allclose(found, first.times, atol=1e-9)


def test_arrivals_lie_between_the_chord_and_the_way_along_edges(waves):
    conductor, source, _, second = waves
    points = conductor.points
    edges = numbered_edges(conductor.triangles)[0]
    length = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
    graph = scipy.sparse.coo_array((length, tuple(edges.T)), shape=(len(points),) * 2).tocsr()
    along = scipy.sparse.csgraph.dijkstra(graph, directed=False, indices=source)
    assert (second.times <= along + 1e-9).all()
    assert (second.times >= np.linalg.norm(points - points[source], axis=1) - 0.01 * EDGE).all()


def test_both_orders_agree_to_first_order(waves):
    _, _, first, second = waves
    # about a vertex of the mesh the first order is late by up to half an edge, and keeps it
    difference = first.times - second.times
    assert np.abs(difference).max() < EDGE
    assert difference.mean() > 0.0


def test_trajectories_go_back_to_the_source(waves):
    conductor, source, _, second = waves
    every = np.arange(0, len(conductor.triangles), 37)
    starts = Places(every, np.full((len(every), 3), 1.0 / 3.0))
    paths = trajectories(conductor, second.times, starts, forward=False)
    for path in paths:
        assert np.diff(path.times).max(initial=0.0) < 1e-9
    # rays along an open edge may leave through it, and no other ends but at the source
    ended = np.array([np.linalg.norm(path.points[-1] - conductor.points[source]) for path in paths])
    inner = np.array([path.end != "edge" for path in paths])
    assert inner.mean() > 0.5
    assert ended[inner].max() < EDGE
