"""Moving the free vertices of a mesh along the surface until its triangles are well shaped."""

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.sheet import Sheet
from cardiosurf.geometry.topology import (
    area_columns,
    corner_columns,
    corners_in,
    sharpness,
    sharpness_of,
)

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
    patch, sharp[near] = _moved(points[names], local, chosen[names], sheet, limits[1], sharp[near])
    points = points.copy()
    points[names] = patch
    return points


def _moved(
    points: Floats, triangles: Ints, free: Mask, sheet: Sheet, enough: float, sharp: Floats
) -> tuple[Floats, Floats]:
    """Return the points with free ones moved, and the smallest angle of each triangle then."""
    corners = corner_columns(points, triangles)
    area, normal = area_columns(corners), sheet.normal(points)
    upright = np.where(_faces(normal, area, triangles) > 0, sharp, -1.0)
    before = np.minimum(_least(len(points), upright, triangles), enough)
    target, turned = points.copy(), normal.copy()
    target[free] = sheet.project(_middles(corners, area, triangles, len(points))[free])
    turned[free] = sheet.normal(target[free])
    after = np.empty(len(triangles))
    value = _upright(target, triangles, turned, after)
    accepted = free.copy()
    for _ in range(_TRIES):
        worse = accepted & (_least(len(points), value, triangles) < before)
        if not worse.any():
            return target, after
        # the move of a neighbour may be to blame, so all corners of a spoiled triangle stay
        back = np.zeros(len(points), dtype=bool)
        back[triangles[corners_in(worse, triangles) > 0]] = True
        back &= accepted
        accepted &= ~back
        target[back], turned[back] = points[back], normal[back]
        again = np.flatnonzero(corners_in(back, triangles))
        anew = np.empty(len(again))
        value[again] = _upright(target, triangles[again], turned, anew)
        after[again] = anew
    return points, sharp


def _middles(
    corners: list[list[Floats]], area: tuple[Floats, ...], triangles: Ints, count: int
) -> Floats:
    """Return the mean of the centroids around each vertex, weighted by the areas, (count, 3)."""
    x, y, z = area
    size, names = np.sqrt(x * x + y * y + z * z), triangles.ravel()
    total = np.maximum(np.bincount(names, np.repeat(size, 3), count), 1e-300)
    sums = [
        np.bincount(names, np.repeat(size * ((a + b + c) / 3.0), 3), count)
        for a, b, c in zip(*corners, strict=True)
    ]
    return np.stack(sums, axis=1) / total[:, None]


def _upright(points: Floats, triangles: Ints, normal: Floats, angles: Floats) -> Floats:
    """Return the smallest angle of each triangle, -1 where it is turned over, (m,).

    ``angles`` (m,) is filled with the smallest angles themselves.
    """
    corners = corner_columns(points, triangles)
    area = area_columns(corners)
    angles[:] = sharpness_of(corners, area)
    return np.where(_faces(normal, area, triangles) > 0, angles, -1.0)


def _faces(normal: Floats, area: tuple[Floats, ...], triangles: Ints) -> Floats:
    """Return the areas (m,), negative where a triangle does not face the way of its normal."""
    first = triangles[:, 0]
    return np.asarray(sum(normal[first, k] * area[k] for k in range(3)))


def _least(count: int, values: Floats, triangles: Ints) -> Floats:
    """Return the smallest value around each of count vertices, 90 if there is none."""
    least = np.full(count, 90.0)
    np.minimum.at(least, triangles.ravel(), np.repeat(values, 3))
    return least
