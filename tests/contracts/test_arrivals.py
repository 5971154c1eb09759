"""Arrival times on every shape of the registry, against an independent first-order solver."""

import numpy as np
import pytest
import scipy

from cardiosurf.analysis.conductor import Conductor
from cardiosurf.analysis.distance import distance_from
from cardiosurf.analysis.eikonal import arrival
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


def test_first_order_is_what_the_undisturbed_wave_of_verdicts_is(waves):
    conductor, source, first, _ = waves
    sources = np.arange(len(conductor.points)) == source
    expected = distance_from(conductor.points, conductor.triangles, sources)
    # the same discrete equation, solved in another order; that one stops at 1e-9 edges a change
    np.testing.assert_allclose(first.times, expected, atol=1e-5)


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
