"""Moving the free vertices of a mesh along the surface until its triangles are well shaped."""

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.sheet import Sheet
from cardiosurf.geometry.topology import area_vectors, areas, corners_in, sharpness

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
    sharp = sharpness(points, triangles)
    for _ in range(_SWEEPS):
        points = _swept(points, triangles, free, sheet, (_STIFF, _ENOUGH), sharp)
    return points


def improved(points: Floats, triangles: Ints, free: Mask, sheet: Sheet, *, sweeps: int) -> Floats:
    """Return the points with free vertices moved only where the smallest angle around grows."""
    sharp = sharpness(points, triangles)
    for _ in range(sweeps):
        before = points
        points = _swept(points, triangles, free, sheet, (_POOR, 90.0), sharp)
        if np.array_equal(before, points):
            break
    return points


def _swept(
    points: Floats,
    triangles: Ints,
    free: Mask,
    sheet: Sheet,
    limits: tuple[float, float],
    sharp: Floats,
) -> Floats:
    """Return the points after one sweep over the free vertices with an angle below limits[0].

    No angle below limits[1] gets smaller. ``sharp`` holds the smallest angle of each triangle,
    before and after.
    """
    chosen = free & (_least(len(points), sharp, triangles) < limits[0])
    if not chosen.any():
        return points
    near = np.flatnonzero(corners_in(chosen, triangles))
    used = np.zeros(len(points), dtype=bool)
    used[triangles[near]] = True
    names = np.flatnonzero(used)
    local = (np.cumsum(used) - 1)[triangles[near]]
    patch = _moved(points[names], local, chosen[names], sheet, limits[1])
    sharp[near] = sharpness(patch, local)
    points = points.copy()
    points[names] = patch
    return points


def _moved(points: Floats, triangles: Ints, free: Mask, sheet: Sheet, enough: float) -> Floats:
    before = np.minimum(_least(len(points), _upright(points, triangles, sheet), triangles), enough)
    middle = _middles(points, triangles)
    target = points.copy()
    target[free] = sheet.project(middle[free])
    value = _upright(target, triangles, sheet)
    accepted = free.copy()
    for _ in range(_TRIES):
        worse = accepted & (_least(len(points), value, triangles) < before)
        if not worse.any():
            return target
        # the move of a neighbour may be to blame, so all corners of a spoiled triangle stay
        back = np.zeros(len(points), dtype=bool)
        back[triangles[corners_in(worse, triangles) > 0]] = True
        back &= accepted
        accepted &= ~back
        target[back] = points[back]
        again = np.flatnonzero(corners_in(back, triangles))
        value[again] = _upright(target, triangles[again], sheet)
    return points


def _middles(points: Floats, triangles: Ints) -> Floats:
    """Return the mean of the centroids around each vertex, weighted by the areas, (n, 3)."""
    names, area = triangles.ravel(), areas(points, triangles)
    total = np.maximum(np.bincount(names, np.repeat(area, 3), len(points)), 1e-300)
    a, b, c = triangles.T
    # columns: sums over rows of three are slow
    sums = [
        np.bincount(names, np.repeat(area * ((x[a] + x[b] + x[c]) / 3.0), 3), len(points))
        for x in np.ascontiguousarray(points.T)
    ]
    return np.stack(sums, axis=1) / total[:, None]


def _upright(points: Floats, triangles: Ints, sheet: Sheet) -> Floats:
    """Return the smallest angle of each triangle, -1 where it is turned over, (m,)."""
    normal, vector = sheet.normal(points), area_vectors(points, triangles)
    first = triangles[:, 0]
    upright = sum(normal[first, k] * vector[:, k] for k in range(3))
    return np.where(upright > 0, sharpness(points, triangles), -1.0)


def _least(count: int, values: Floats, triangles: Ints) -> Floats:
    """Return the smallest value around each of count vertices, 90 if there is none."""
    least = np.full(count, 90.0)
    np.minimum.at(least, triangles.ravel(), np.repeat(values, 3))
    return least
