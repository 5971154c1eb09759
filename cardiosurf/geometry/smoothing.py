"""Moving the free vertices of a mesh along the surface until its triangles are well shaped."""

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.sheet import Sheet
from cardiosurf.geometry.topology import angles, area_vectors, incidence, smallest_around

_SWEEPS = 3
_FINAL_SWEEPS = 30
_GOOD = 38.0
_ENOUGH = 30.0


def relaxed(points: Floats, triangles: Ints, fixed: int, sheet: Sheet) -> Floats:
    """Return the points with each free vertex moved to the middle of its triangles.

    The middle is the mean of the triangles' centroids weighted by their areas. A move that makes
    an angle around the vertex smaller than 30 degrees and smaller than before is not made.

    Parameters
    ----------
    points : (n, 3) float
        Vertices, the first ``fixed`` of which do not move.
    triangles : (m, 3) int
        Triangles.
    fixed : int
        Number of fixed vertices.
    sheet : Sheet
        The exact surface.
    """
    free = np.arange(len(points)) >= fixed
    for _ in range(_SWEEPS):
        points = _moved(points, triangles, free, sheet, _ENOUGH)
    return points


def improved(points: Floats, triangles: Ints, fixed: int, sheet: Sheet) -> Floats:
    """Return the points with free vertices moved only where the smallest angle around grows."""
    free = np.arange(len(points)) >= fixed
    for _ in range(_FINAL_SWEEPS):
        least = smallest_around(angles(points, triangles).min(axis=1), triangles, len(points))
        poor = free & (least < _GOOD)
        near = poor[triangles].any(axis=1)
        if not poor.any():
            break
        before = points
        points = _moved(points, triangles[near], poor, sheet, 180.0)
        if np.array_equal(before, points):
            break
    return points


def _moved(points: Floats, triangles: Ints, free: Mask, sheet: Sheet, enough: float) -> Floats:
    """Return the points after one sweep in which no angle below ``enough`` gets smaller."""
    count = len(points)
    around = incidence(triangles, count)
    area = np.linalg.norm(area_vectors(points, triangles), axis=1)
    total = np.maximum(around @ area, 1e-300)
    middle = (around @ (area[:, None] * points[triangles].mean(axis=1))) / total[:, None]
    before = np.minimum(_quality(points, triangles, count, sheet), enough)
    accepted = free.copy()
    target = points.copy()
    target[free] = sheet.project(middle[free])
    for _ in range(6):
        trial = np.where(accepted[:, None], target, points)
        worse = accepted & (_quality(trial, triangles, count, sheet) < before)
        if not worse.any():
            return trial
        # the move of a neighbour may be to blame, so all corners of a spoiled triangle stay
        accepted[triangles[worse[triangles].any(axis=1)]] = False
    return points


def _quality(points: Floats, triangles: Ints, count: int, sheet: Sheet) -> Floats:
    """Return the smallest angle around each vertex, negative where a triangle is turned over."""
    upright = np.einsum(
        "mk,mk->m",
        area_vectors(points, triangles),
        sheet.normal(sheet.project(points[triangles].mean(axis=1))),
    )
    least = angles(points, triangles).min(axis=1)
    return smallest_around(np.where(upright > 0, least, -1.0), triangles, count)
