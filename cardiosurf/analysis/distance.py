"""Arrival times of an undisturbed wave: the eikonal equation |grad T| = 1 on a triangulation."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask


@dataclass(frozen=True)
class _Updates:
    """Every way to update a corner from its triangle's opposite edge, sorted by corner.

    Attributes
    ----------
    corner, first, second : (3m,) int
        The corner that is updated and the two ends of the opposite edge.
    squared_edge, foot, squared_height : (3m,) float
        Squared length of that edge; where along it (0 at ``first``) the corner's perpendicular
        falls; and the squared height of the corner above it.
    """

    corner: Ints
    first: Ints
    second: Ints
    squared_edge: Floats
    foot: Floats
    squared_height: Floats


def _updates(points: Floats, triangles: Ints) -> _Updates:
    corner = triangles.ravel()
    first = triangles[:, [1, 2, 0]].ravel()
    second = triangles[:, [2, 0, 1]].ravel()
    order = np.argsort(corner, kind="stable")
    corner, first, second = corner[order], first[order], second[order]
    edge = points[second] - points[first]
    to_corner = points[corner] - points[first]
    squared_edge = np.einsum("ij,ij->i", edge, edge)
    foot = np.einsum("ij,ij->i", edge, to_corner) / squared_edge
    squared_height = np.einsum("ij,ij->i", to_corner, to_corner) - foot**2 * squared_edge
    return _Updates(corner, first, second, squared_edge, foot, np.maximum(squared_height, 0.0))


def _arrival_through_edge(updates: _Updates, rows: Ints, times: Floats) -> Floats:
    """Return the least time at which a straight front over the edge reaches each corner."""
    start = times[updates.first[rows]]
    end = times[updates.second[rows]]
    squared_edge = updates.squared_edge[rows]
    foot = updates.foot[rows]
    squared_height = updates.squared_height[rows]
    with np.errstate(invalid="ignore"):
        rise = end - start
        slack = squared_edge - rise**2
    smooth = np.isfinite(slack) & (slack > 0.0)
    rise = np.where(smooth, rise, 0.0)
    offset = rise * np.sqrt(squared_height / (squared_edge * np.where(smooth, slack, 1.0)))
    # where one end of the edge is still unknown, the wave can only come from the other
    s = np.where(smooth, np.clip(foot - offset, 0.0, 1.0), np.where(start <= end, 0.0, 1.0))
    base = np.where(smooth, start + s * rise, np.minimum(start, end))
    along: Floats = base + np.sqrt(squared_height + squared_edge * (s - foot) ** 2)
    return along


def distance_from(points: Floats, triangles: Ints, sources: Mask) -> Floats:
    """Return the geodesic distance of every vertex from the source vertices.

    It solves |grad T| = 1 with T = 0 on the sources by first-order updates over the triangles,
    repeated for the neighbourhood of whatever changed until nothing does. Divided by the speed of
    the wave it is the arrival time of a wave that nothing disturbs.

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
    updates = _updates(points, triangles)
    times = np.where(sources, 0.0, np.inf)
    changed = sources.copy()
    tolerance = 1e-9 * float(np.sqrt(updates.squared_edge.mean()))
    while changed.any():
        rows = np.flatnonzero(
            (changed[updates.first] | changed[updates.second]) & ~sources[updates.corner]
        )
        if rows.size == 0:
            break
        corner = updates.corner[rows]
        starts = np.flatnonzero(np.r_[True, corner[1:] != corner[:-1]])
        best = np.minimum.reduceat(_arrival_through_edge(updates, rows, times), starts)
        vertices = corner[starts]
        better = best < times[vertices] - tolerance
        changed = np.zeros(len(points), dtype=bool)
        changed[vertices[better]] = True
        times[vertices[better]] = best[better]
    return times
