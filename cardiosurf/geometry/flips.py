"""Delaunay triangles kept as such while vertices move and go, by flips (Lawson, 1977)."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.periodic import wrapped
from cardiosurf.geometry.sheet import Periods
from cardiosurf.geometry.topology import corners_in, twins

_ROUNDS = 200
# a fourth vertex on the circle itself, up to rounding, asks for no flip
_TIE = 1e-12


@dataclass(frozen=True)
class _Chart:
    """Places in a chart, and after how much it repeats itself."""

    flat: Floats
    periods: Periods | None

    def steps(self, start: Ints, end: Ints) -> Floats:
        """Return the ways from vertices to others."""
        return wrapped(self.flat[end] - self.flat[start], self.periods)

    def turn(self, a: Ints, b: Ints, c: Ints) -> Floats:
        """Return a number above 0 where a, b, c run counter-clockwise (seen from outside)."""
        one, other = self.steps(a, b), self.steps(a, c)
        if self.flat.shape[1] == 3:
            return _volume(self.flat[a], one, other)
        return _cross(one, other)


def updated(
    flat: Floats, triangles: Ints, moved: Mask, gone: Mask, *, periods: Periods | None = None
) -> Ints | None:
    """Return the Delaunay triangles after vertices have moved and gone; None if it takes more.

    Parameters
    ----------
    flat : (n, 2) or (n, 3) float
        All vertices in a chart, or on a sphere about the origin, in their new places.
    triangles : (m, 3) int
        Their Delaunay triangles before, counter-clockwise (outward on a sphere).
    moved, gone : (n,) bool
        Vertices that have moved, and those that no triangle is to have any more.
    periods : pair of float or None, optional
        After how much the chart repeats itself; triangles are far smaller than that.
    """
    chart = _Chart(flat, periods)
    triangles, beside = _collapsed(chart, triangles, gone)
    touched = moved | beside
    near = triangles[corners_in(touched, triangles) > 0]
    if corners_in(gone, triangles).any() or not (chart.turn(*near.T) > 0.0).all():
        return None
    return _flipped(chart, triangles, touched)


def _collapsed(chart: _Chart, triangles: Ints, gone: Mask) -> tuple[Ints, Mask]:
    """Return the triangles, vertices that are gone drawn into a neighbour, and what is beside.

    A vertex that cannot be drawn into any of its neighbours without turning a triangle over stays.
    """
    beside = np.zeros(len(chart.flat), dtype=bool)
    left = gone.copy()
    while corners_in(left, triangles).any():
        rows = np.flatnonzero(corners_in(left, triangles))
        vertex, into = _drawn_into(chart, triangles[rows], left)
        if not len(vertex):
            break
        left[vertex] = False
        target = np.arange(len(chart.flat))
        target[vertex] = into
        beside[triangles[rows]] = True
        new = target[triangles[rows]]
        flat_ones = (new == new[:, [1, 2, 0]]).any(axis=1)
        triangles = triangles.copy()
        triangles[rows] = new
        triangles = np.delete(triangles, rows[flat_ones], axis=0)
    return triangles, beside


def _drawn_into(chart: _Chart, triangles: Ints, gone: Mask) -> tuple[Ints, Ints]:
    """Return vertices that may go at the same time, and the neighbour that each is drawn into."""
    first = np.where(gone[triangles], triangles, len(gone)).min(axis=1)
    waits = np.zeros(len(gone) + 1, dtype=bool)
    waits[triangles[gone[triangles] & (triangles != first[:, None])]] = True
    rows = np.flatnonzero(~waits[first])
    rows = rows[np.argsort(first[rows], kind="stable")]
    at = (triangles[rows] == first[rows, None]).argmax(axis=1)
    vertex, a, b = (triangles[rows, (at + turn) % 3] for turn in range(3))
    names, start, count = np.unique(vertex, return_index=True, return_counts=True)
    # each neighbour of a vertex against each triangle around it
    of = np.repeat(np.arange(len(names)), count**2)
    place = np.arange(len(of)) - np.repeat(np.cumsum(count**2) - count**2, count**2)
    into, beyond = start[of] + place // count[of], start[of] + place % count[of]
    turn = chart.turn(a[into], a[beyond], b[beyond])
    turn[(a[into] == a[beyond]) | (a[into] == b[beyond])] = np.inf
    worst = np.minimum.reduceat(turn, np.flatnonzero(place % count[of] == 0))
    best = np.array([s + int(worst[s : s + c].argmax()) for s, c in zip(start, count, strict=True)])
    good = worst[best] > 0.0 if len(best) else np.zeros(0, dtype=bool)
    return names[good], a[best[good]]


def _flipped(chart: _Chart, triangles: Ints, touched: Mask) -> Ints | None:
    """Return the triangles with all edges around touched vertices flipped that are not Delaunay.

    In each round those edges are flipped whose quadrilaterals have no triangle in common, nor are
    neighbours; half edge 3 t + i is the one opposite vertex i of triangle t.
    """
    corners, twin = triangles.ravel().copy(), twins(triangles)
    near = corners_in(touched, triangles) > 0
    half = np.arange(len(twin))
    # each edge once; an edge of which only the other triangle is near counts as well
    edges = half[(twin > half) & (np.repeat(near, 3) | near[twin // 3])]
    for _ in range(_ROUNDS):
        edges = edges[_wrong(chart, corners, edges, twin[edges])]
        if not len(edges):
            return corners.reshape(-1, 3)
        rim = _rim(edges, twin)
        outer = twin[rim]
        around = np.concatenate([[edges, twin[edges]], np.where(outer < 0, edges, outer)]) // 3
        claim = np.full(len(triangles), len(edges))
        np.minimum.at(claim, around, np.broadcast_to(np.arange(len(edges)), around.shape))
        free = (claim[around] == np.arange(len(edges))).all(axis=0)
        done = _flip(corners, twin, edges[free], rim[:, free])
        stale = np.zeros(len(triangles), dtype=bool)
        stale[done // 3] = True
        rest = edges[~free]
        rest = rest[~stale[rest // 3] & ~stale[twin[rest] // 3]]
        done = done[twin[done] >= 0]
        edges = np.concatenate([rest, done])
        edges = np.unique(np.minimum(edges, twin[edges]))
    return None


def _rim(edges: Ints, twin: Ints) -> Ints:
    """Return the half edges (4, k) around the two triangles at each of the half edges (k,)."""
    other = twin[edges]
    return np.stack([_next(edges), _next(_next(edges)), _next(other), _next(_next(other))])


def _next(half: Ints) -> Ints:
    return half - half % 3 + (half + 1) % 3


def _flip(corners: Ints, twin: Ints, edges: Ints, rim: Ints) -> Ints:
    """Flip the edges in place; return the half edges around the new pairs of triangles, (4 k,)."""
    one, other = edges // 3, twin[edges] // 3
    p, q = corners[edges], corners[twin[edges]]
    a, b = corners[rim[0]], corners[rim[1]]
    outer = twin[rim]
    for triangle, vertices in ((one, (p, a, q)), (other, (q, b, p))):
        for place, vertex in enumerate(vertices):
            corners[3 * triangle + place] = vertex
    twin[3 * one + 1], twin[3 * other + 1] = 3 * other + 1, 3 * one + 1
    new = np.stack([3 * other, 3 * one + 2, 3 * one, 3 * other + 2])
    twin[new] = outer
    there = outer >= 0
    twin[outer[there]] = new[there]
    return new.ravel()


def _wrong(chart: _Chart, corners: Ints, edges: Ints, others: Ints) -> Mask:
    """Return at which half edges the vertex beyond lies in the circle of the triangle."""
    beyond, around = corners[others], (edges, _next(edges), _next(_next(edges)))
    a, b, c = (chart.steps(beyond, corners[half]) for half in around)
    squares = [np.einsum("kd,kd->k", one, one) for one in (a, b, c)]
    if chart.flat.shape[1] == 3:
        # on a sphere: beyond the plane of the triangle
        scale = float(np.abs(chart.flat).max(initial=0.0)) * np.maximum.reduce(squares)
        return np.asarray(_volume(a, b, c) < -_TIE * scale)
    inside = squares[0] * _cross(b, c) + squares[1] * _cross(c, a) + squares[2] * _cross(a, b)
    return np.asarray(inside > _TIE * np.maximum.reduce(squares) ** 2)


def _cross(one: Floats, other: Floats) -> Floats:
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


def _volume(one: Floats, two: Floats, three: Floats) -> Floats:
    return np.asarray(np.einsum("kd,kd->k", one, np.cross(two, three)))
