"""The phase of excitable tissue, and how often it turns along a line of vertices.

The phase of a place is the direction, in the plane of u and v, in which its state lies as seen from
a centre that the pulse runs round:

    theta = atan2(v - v*, u - u*)

It grows through front, plateau and tail by one turn. Tissue at rest is as far from the centre as
the rest of the pulse, so all of it has one and the same phase, and no turn is counted in it.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardiosurf.arrays import Floats, Ints
from cardiosurf.recording.recording import THRESHOLD, FrameSeries

CHUNK = 2**22
"""Frames are looked at so many numbers at a time: they may be in a file larger than memory."""


@dataclass(frozen=True)
class Centre:
    """The point in the plane of u and v about which the phase turns.

    Attributes
    ----------
    u, v : float
        Its coordinates: fronts pass below it, tails above it.
    """

    u: float
    v: float


def chunks(frames: FrameSeries) -> list[slice]:
    """Return the frames in slices of at most ``CHUNK`` numbers."""
    count, nodes = frames.u.shape
    rows = max(1, CHUNK // max(1, nodes))
    return [slice(first, min(first + rows, count)) for first in range(0, count, rows)]


def phase_centre(frames: FrameSeries) -> Centre | None:
    """Return u* = 0.5 and v* = half of the largest v in the frames; None if v never left rest.

    A front crosses u = 0.5 at a small v, a tail near the largest, so v* lies between the two.

    Parameters
    ----------
    frames : FrameSeries
        u and v of all vertices at some times.
    """
    most = max((float(np.max(frames.v[rows], initial=0.0)) for rows in chunks(frames)), default=0.0)
    return Centre(THRESHOLD, 0.5 * most) if most > 0.0 else None


def phase(u: Floats, v: Floats, centre: Centre) -> Floats:
    """Return the phase, in radians between -pi and pi, of any shape.

    Parameters
    ----------
    u, v : float arrays of one shape
        Potential and recovery.
    centre : Centre
        The point about which it turns.
    """
    return np.asarray(np.arctan2(v - centre.v, u - centre.u))


def turns(a0: NDArray[Any], b0: NDArray[Any], a1: NDArray[Any], b1: NDArray[Any]) -> Ints:
    """Count how often straight lines in the plane of u and v pass the half line from the centre.

    Summed along a closed line of vertices this is how often the phase turns along it: the straight
    line between two states is seen from the centre under less than half a turn, which is the change
    of phase between neighbours wrapped into (-pi, pi). Counting, unlike a sum of angles, is exact,
    and a line walked the other way gives the opposite number, bit for bit.

    Parameters
    ----------
    a0, b0, a1, b1 : arrays of one shape
        u - u* and v - v* at the beginning and at the end.

    Returns
    -------
    int array of that shape
        1: the phase passes 0 upward; -1: downward.
    """
    upward, downward = (b0 < 0.0) & (b1 >= 0.0), (b0 >= 0.0) & (b1 < 0.0)
    side = a0 * b1 - a1 * b0
    # lines through the centre itself: it is taken to lie a trifle lower, and by a smaller trifle
    # more to the left, the same for all, so that a vertex there is on one side for all of them
    side = np.where(side != 0.0, side, np.where(a0 != a1, a0 - a1, b1 - b0))
    up, down = upward & (side > 0.0), downward & (side < 0.0)
    return np.asarray(up.astype(np.int64) - down)
