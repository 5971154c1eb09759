"""Delaunay triangles in a chart that repeats itself."""

import numpy as np

from cardiosurf.arrays import Floats, Ints
from cardiosurf.geometry.sheet import Periods, planar_delaunay

_MARGIN = 0.08
_WIDEN = 3.0
_GAP = 12.0
# far above rounding, far below what a mesh could notice
_JITTER = 1e-6


def wrapped(steps: Floats, periods: Periods | None) -> Floats:
    """Return steps (n, 2) in a chart, each the shortest of those that lead to the same place."""
    if periods is None:
        return steps
    shortest = steps.copy()
    for axis, period in enumerate(periods):
        if period is not None:
            shortest[:, axis] -= period * np.round(shortest[:, axis] / period)
    return shortest


def periodic_delaunay(flat: Floats, periods: Periods) -> Ints:
    """Return the Delaunay triangles (m, 3), counter-clockwise, of points in a periodic chart.

    Points near the cell's edges are copied to its other side, all are triangulated in the plane,
    and of all copies of a triangle the one is kept whose lowest vertex lies in the cell itself.
    Copies reach as far as the circle around any kept triangle, so that it is found; circles that
    are many times wider than usual belong to gaps, where the points are not all there are.

    Parameters
    ----------
    flat : (n, 2) float
        Points in the chart.
    periods : pair of float or None
        Periods of the two coordinates.
    """
    cell = np.array([np.inf if period is None else period for period in periods])
    flat = flat.copy()
    for axis, period in enumerate(periods):
        if period is not None:
            flat[:, axis] %= period
    extent = np.where(np.isfinite(cell), cell, np.ptp(flat, axis=0))
    spacing = float(np.sqrt(extent.prod() / max(len(flat), 1)))
    # four points on a circle have two triangulations: which one must be the same for all copies
    flat += _JITTER * spacing * np.random.default_rng(0).uniform(-1.0, 1.0, flat.shape)
    share = _MARGIN
    while True:
        names, places = _copies(flat, cell, share)
        found = planar_delaunay(places)
        triangles = names[found]
        lowest = np.take_along_axis(found, triangles.argmin(axis=1)[:, None], axis=1)[:, 0]
        kept = lowest < len(flat)
        kept &= (triangles != triangles[:, [1, 2, 0]]).all(axis=1)
        # a triangle that is seen from the cell, moved to where its lowest vertex is in the cell
        seen = (found < len(flat)).any(axis=1)
        home = places[lowest[seen]] - flat[names[lowest[seen]]]
        if share >= 1.0 or _within(places[found[seen]] - home[:, None], cell, share):
            return triangles[kept]
        share = min(1.0, _WIDEN * share)


def _copies(flat: Floats, cell: Floats, share: float) -> tuple[Ints, Floats]:
    """Return the points and their copies within the cell widened by a share of it, and of which."""
    names, places = np.arange(len(flat)), flat
    for axis in np.flatnonzero(np.isfinite(cell)):
        period, margin = cell[axis], share * cell[axis]
        low = np.flatnonzero(places[:, axis] <= margin)
        high = np.flatnonzero(places[:, axis] >= period - margin)
        beyond, before = places[low], places[high]
        beyond[:, axis] += period
        before[:, axis] -= period
        places = np.concatenate([places, beyond, before])
        names = np.concatenate([names, names[low], names[high]])
    return names, places


def _within(corners: Floats, cell: Floats, share: float) -> bool:
    """Return whether the circles around triangles (k, 3, 2) lie where all copies are."""
    a = corners[:, 0]
    b, c = corners[:, 1] - a, corners[:, 2] - a
    twice = 2.0 * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    bb, cc = (b * b).sum(axis=1), (c * c).sum(axis=1)
    offset = np.stack([c[:, 1] * bb - b[:, 1] * cc, b[:, 0] * cc - c[:, 0] * bb], axis=1)
    offset /= np.maximum(twice, 1e-300)[:, None]
    radius = np.linalg.norm(offset, axis=1)
    usual = radius < _GAP * np.median(radius)
    centre, radius = (a + offset)[usual], radius[usual]
    inside = True
    for axis in np.flatnonzero(np.isfinite(cell)):
        margin = share * cell[axis]
        inside &= bool((centre[:, axis] - radius >= -margin).all())
        inside &= bool((centre[:, axis] + radius <= cell[axis] + margin).all())
    return inside
