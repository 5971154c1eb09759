"""Arrival times of an undisturbed wave: the eikonal equation |grad T| = 1 on a triangulation."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.analysis.neighbours import triangles_around
from cardiosurf.arrays import Floats, Ints, Mask

NEXT, AFTER = [1, 2, 0], [2, 0, 1]
"""From each corner of a triangle to the first and to the second end of the opposite edge."""

BAND = 2.0
"""How much of the front, in edge lengths, moves on at a time.

Less makes more rounds, more makes vertices move on before their own time is settled: between 1
and 3 the seconds do not change.
"""


@dataclass(frozen=True)
class _Corners:
    """What an update of a corner from the opposite edge needs, for each corner (m, 3).

    Attributes
    ----------
    squared_edge, foot, squared_height : (m, 3) float
        Squared length of that edge; where along it (0 at its first end) the corner's perpendicular
        falls; and the squared height of the corner above it.
    """

    squared_edge: Floats
    foot: Floats
    squared_height: Floats

    def of(self, triangles: Ints) -> tuple[Floats, Floats, Floats]:
        """Return the three for some of the triangles, each (k, 3)."""
        every = (self.squared_edge, self.foot, self.squared_height)
        edge, foot, height = (each.take(triangles, axis=0) for each in every)
        return edge, foot, height


def _corners(points: Floats, triangles: Ints) -> _Corners:
    a, b, c = (points.take(column, axis=0) for column in triangles.T)
    squared = np.stack([np.einsum("ij,ij->i", s, s) for s in (c - b, a - c, b - a)], axis=1)
    to_first, to_second = squared.take(AFTER, axis=1), squared.take(NEXT, axis=1)
    foot = (squared + to_first - to_second) / (2.0 * squared)
    return _Corners(squared, foot, np.maximum(to_first - foot * foot * squared, 0.0))


def _arrival_through_edge(start: Floats, end: Floats, corners: tuple[Floats, ...]) -> Floats:
    """Return the least time at which a straight front over the edge reaches each corner."""
    squared_edge, foot, squared_height = corners
    rise = end - start
    slack = squared_edge - rise * rise
    smooth = slack > 0.0
    s = foot - rise * np.sqrt(squared_height / (squared_edge * slack))
    # where one end of the edge is still unknown, the wave can only come from the other
    s = np.where(smooth, np.minimum(np.maximum(s, 0.0), 1.0), start > end)
    base = np.where(smooth, start + s * rise, np.minimum(start, end))
    s -= foot
    along: Floats = base + np.sqrt(squared_height + squared_edge * s * s)
    return along


def distance_from(points: Floats, triangles: Ints, sources: Mask) -> Floats:
    """Return the geodesic distance of every vertex from the source vertices.

    It solves |grad T| = 1 with T = 0 on the sources by first-order updates over the triangles,
    repeated for the neighbourhood of whatever changed until nothing does, the nearest to the
    sources first. Divided by the speed of the wave it is the arrival time of a wave that nothing
    disturbs.

    Parameters
    ----------
    points : (n, 3) float
        Vertices, in su.
    triangles : (m, 3) int
        Vertex numbers.
    sources : (n,) bool
        Where the distance is 0.

    Returns
    -------
    (n,) float
        Distances in su; infinite where no source can be reached.
    """
    corners, around = _corners(points, triangles), triangles_around(triangles, len(points))
    edge = float(np.sqrt(corners.squared_edge.mean()))
    band, tolerance = BAND * edge, 1e-9 * edge
    times = np.where(sources, 0.0, np.inf)
    touched = np.zeros(len(triangles), dtype=bool)
    waiting = sources.copy()
    # times that are not known yet are infinite, and what they make of an edge is not used
    with np.errstate(invalid="ignore", divide="ignore"):
        while True:
            (front,) = waiting.nonzero()
            if not front.size:
                return times
            since = times[front]
            front = front[since <= since.min() + band]
            waiting[front] = False
            touched[around.at(front)[0]] = True
            (near,) = touched.nonzero()
            touched[near] = False
            vertices = triangles.take(near, axis=0)
            before = times.take(vertices)
            after = _arrival_through_edge(
                before.take(NEXT, axis=1), before.take(AFTER, axis=1), corners.of(near)
            )
            better = after < before - tolerance
            np.minimum.at(times, vertices[better], after[better])
            waiting[vertices[better]] = True
