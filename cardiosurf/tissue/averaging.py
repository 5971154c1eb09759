"""Means of a function over the hat functions of a mesh."""

from collections.abc import Callable
from functools import cache

import numpy as np

from cardiosurf.arrays import Floats, Mask
from cardiosurf.geometry.surface import Surface

FINENESS = 0.15
"""Length of the pieces that edges are cut into, in su: resolves steps that are 0.1 su wide."""

MOST_PIECES = 24
_AT_ONCE = 400_000


def hat_means(
    surface: Surface, function: Callable[[Floats], Floats], argument: Floats, near: Mask
) -> Floats:
    """Return the mean of a function over each vertex's hat function, (n,).

    The mean is the integral of function times hat over the integral of the hat, so the function's
    integral is kept on every mesh: values at the vertices alone make a profile with a steep edge
    larger or smaller by up to half a mesh edge, by chance. Triangles are cut into pieces (of about
    0.15 su, at most 24 to an edge), the function is taken at their centres.

    Parameters
    ----------
    surface : Surface
        The mesh.
    function : callable
        Takes arguments (k, ...), returns values (k,).
    argument : (n, ...) float
        What it is a function of, at the vertices and linear in between: their coordinates, say.
    near : (m,) bool
        Triangles where the function is not zero all over; elsewhere it is not asked.
    """
    triangles, count = surface.triangles, len(surface.points)
    areas, chosen = surface.areas(), np.flatnonzero(near)
    longest = np.sqrt(areas[chosen].max(initial=0.0) * 4.0 / np.sqrt(3.0))
    weights = _barycentres(int(np.clip(np.ceil(longest / FINENESS), 1, MOST_PIECES)))
    total = np.zeros(count)
    chunk = max(1, _AT_ONCE // len(weights))
    for first in range(0, len(chosen), chunk):
        part = triangles[chosen[first : first + chunk]]
        places = np.einsum("qc,tc...->tq...", weights, argument[part])
        values = function(places.reshape(-1, *argument.shape[1:])).reshape(len(part), -1)
        shares = areas[chosen[first : first + chunk], None] * (values @ weights) / len(weights)
        total += np.bincount(part.ravel(), shares.ravel(), count)
    hats = np.bincount(triangles.ravel(), np.repeat(areas / 3.0, 3), count)
    means: Floats = total / hats
    return means


@cache
def _barycentres(pieces: int) -> Floats:
    """Return the centres of the equal pieces of a triangle whose edges are cut into some."""
    n = pieces
    upright = [(i + 1 / 3, j + 1 / 3) for i in range(n) for j in range(n - i)]
    turned = [(i + 2 / 3, j + 2 / 3) for i in range(n - 1) for j in range(n - 1 - i)]
    pairs = np.array(upright + turned) / n
    return np.column_stack((1.0 - pairs.sum(axis=1), pairs))
