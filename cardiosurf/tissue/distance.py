"""Distance in space from points to line segments."""

import numpy as np

from cardiosurf.arrays import Floats

_PAIRS_AT_ONCE = 400_000


def distance_to_segments(points: Floats, starts: Floats, ends: Floats) -> Floats:
    """Return the Euclidean distance of each point to the nearest of the segments, in su.

    Parameters
    ----------
    points : (n, 3) float
        The points.
    starts, ends : (k, 3) float
        End points of the segments; a segment of length 0 counts as a point.
    """
    along = ends - starts
    # a segment of length 0: any position on it is its start
    squared = np.maximum(np.einsum("ki,ki->k", along, along), np.finfo(float).tiny)
    chunk = max(1, _PAIRS_AT_ONCE // max(1, len(starts)))
    nearest = np.empty(len(points))
    for first in range(0, len(points), chunk):
        offset = points[first : first + chunk, None, :] - starts
        position = np.clip(np.einsum("nki,ki->nk", offset, along) / squared, 0.0, 1.0)
        across = offset - position[:, :, None] * along
        nearest[first : first + chunk] = np.sqrt(
            np.einsum("nki,nki->nk", across, across).min(axis=1)
        )
    return nearest
