"""Moving the free vertices of a mesh along the surface until its triangles are well shaped."""

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.sheet import Sheet
from cardiosurf.geometry.topology import area_vectors, incidence, sharpness

_SWEEPS = 3
_STIFF = 50.0
_POOR = 36.0
_ENOUGH = 30.0
_TRIES = 6


def relaxed(points: Floats, triangles: Ints, free: Mask, sheet: Sheet) -> Floats:
    """Return the points with free vertices moved to the middle of their triangles.

    The middle is the mean of the triangles' centroids weighted by their areas. Vertices between
    near-equilateral triangles stay; a move that makes an angle around the vertex smaller than
    30 degrees and smaller than before is not made.

    Parameters
    ----------
    points : (n, 3) float
        Vertices.
    triangles : (m, 3) int
        Triangles.
    free : (n,) bool
        Which vertices may move.
    sheet : Sheet
        The exact surface.
    """
    for _ in range(_SWEEPS):
        points = _swept(points, triangles, free, sheet, (_STIFF, _ENOUGH))
    return points


def improved(points: Floats, triangles: Ints, free: Mask, sheet: Sheet, *, sweeps: int) -> Floats:
    """Return the points with free vertices moved only where the smallest angle around grows."""
    for _ in range(sweeps):
        before = points
        points = _swept(points, triangles, free, sheet, (_POOR, 90.0))
        if np.array_equal(before, points):
            break
    return points


def _swept(
    points: Floats, triangles: Ints, free: Mask, sheet: Sheet, limits: tuple[float, float]
) -> Floats:
    """Return the points after one sweep over the free vertices with an angle below limits[0].

    No angle below limits[1] gets smaller.
    """
    least = np.full(len(points), 90.0)
    _spread_least(least, sharpness(points, triangles), triangles)
    chosen = free & (least < limits[0])
    if not chosen.any():
        return points
    near = np.flatnonzero(chosen[triangles].any(axis=1))
    names, local = np.unique(triangles[near], return_inverse=True)
    patch = points[names]
    patch = _moved(patch, local.reshape(-1, 3), chosen[names], sheet, limits[1])
    points = points.copy()
    points[names] = patch
    return points


def _moved(points: Floats, triangles: Ints, free: Mask, sheet: Sheet, enough: float) -> Floats:
    around = incidence(triangles, len(points))
    area = np.linalg.norm(area_vectors(points, triangles), axis=1)
    total = np.maximum(around @ area, 1e-300)
    middle = (around @ (area[:, None] * points[triangles].mean(axis=1))) / total[:, None]
    before = np.minimum(_worst(points, triangles, sheet), enough)
    target = points.copy()
    target[free] = sheet.project(middle[free])
    accepted = free.copy()
    for _ in range(_TRIES):
        trial = np.where(accepted[:, None], target, points)
        worse = accepted & (_worst(trial, triangles, sheet) < before)
        if not worse.any():
            return trial
        # the move of a neighbour may be to blame, so all corners of a spoiled triangle stay
        accepted[triangles[worse[triangles].any(axis=1)]] = False
    return points


def _worst(points: Floats, triangles: Ints, sheet: Sheet) -> Floats:
    """Return the smallest angle around each vertex, negative where a triangle is turned over."""
    upright = np.einsum(
        "mk,mk->m", area_vectors(points, triangles), sheet.normal(points[triangles[:, 0]])
    )
    least = np.full(len(points), 90.0)
    _spread_least(least, np.where(upright > 0, sharpness(points, triangles), -1.0), triangles)
    return least


def _spread_least(least: Floats, values: Floats, triangles: Ints) -> None:
    np.minimum.at(least, triangles.ravel(), np.repeat(values, 3))
