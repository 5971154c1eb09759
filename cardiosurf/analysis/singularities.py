"""Phase singularities: points of the surface around which all phases meet.

With u and v linear in each triangle the phase turns once around a triangle exactly if the centre
(u*, v*) lies in the triangle that its corners' states make in the plane of u and v. There, where
u = u* and v = v*, is the singularity: the end of a wave front, about which the wave rotates.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cardiosurf.analysis.phase import Centre, chunks, turns
from cardiosurf.arrays import Floats, Ints
from cardiosurf.recording.recording import FrameSeries

_RIGHT, _ABOVE = 0b0011, 0b0101
"""Bits of the quadrants with u >= u*, and of those with v >= v*."""


@dataclass(frozen=True)
class Singularities:
    """Phase singularities of all frames, in the order of time.

    Attributes
    ----------
    times : (k,) float
        Time of each frame, in tu.
    frames : (s,) int
        The frame that each was found in.
    triangles : (s,) int
        The triangle it lies in.
    points : (s, 3) float
        Where, in su.
    chiralities : (s,) int
        1: the wave rotates counterclockwise about it, seen from the side from which the triangles'
        vertices run counterclockwise (the phase winds by -2 pi); -1: clockwise.
    """

    times: Floats
    frames: Ints
    triangles: Ints
    points: Floats
    chiralities: Ints

    @property
    def counts(self) -> Ints:
        """How many there are in each frame, (k,)."""
        return np.bincount(self.frames, minlength=len(self.times)).astype(np.int64)


def find_singularities(
    frames: FrameSeries, points: Floats, triangles: Ints, centre: Centre
) -> Singularities:
    """Return the phase singularities of every frame.

    Parameters
    ----------
    frames : FrameSeries
        u and v of all vertices at some times.
    points : (n, 3) float
        Vertices, in su.
    triangles : (m, 3) int
        The triangles to look at, consistently oriented: the excitable ones, as a rule.
    centre : Centre
        The point in the plane of u and v about which the phase turns.
    """
    found: list[tuple[Ints, Ints, Floats, Ints]] = []
    for rows in chunks(frames):
        a, b = frames.u[rows] - np.float32(centre.u), frames.v[rows] - np.float32(centre.v)
        row, triangle = _candidates(a, b, triangles)
        corner = triangles[triangle]
        states = a[row[:, None], corner].astype(float), b[row[:, None], corner].astype(float)
        winding, weights = _winding(*states)
        (hit,) = np.nonzero(winding)
        places = np.einsum("si,sid->sd", weights[hit], points[corner[hit]])
        found.append((row[hit] + rows.start, triangle[hit], places, -winding[hit]))
    if not found:
        nothing = np.empty(0, dtype=np.int64)
        return Singularities(frames.times, nothing, nothing, np.empty((0, 3)), nothing)
    frame, triangle, places, chirality = (
        np.concatenate(parts) for parts in zip(*found, strict=True)
    )
    return Singularities(frames.times, frame, triangle, places, chirality)


def _candidates(
    a: NDArray[np.float32], b: NDArray[np.float32], triangles: Ints
) -> tuple[Ints, Ints]:
    """Return frames and triangles whose corners lie on both sides of u* and on both sides of v*."""
    quadrant = (1 << (2 * (a < 0.0) + (b < 0.0)).astype(np.uint8)).astype(np.uint8)
    # a vertex's quadrants at all times lie side by side, and are taken together
    by_vertex = np.ascontiguousarray(quadrant.T)
    every = by_vertex[triangles[:, 0]]
    every |= by_vertex[triangles[:, 1]]
    every |= by_vertex[triangles[:, 2]]
    both = np.zeros(16, dtype=np.bool_)
    for bits in range(16):
        sides = (bits & _ABOVE, bits & ~_ABOVE, bits & _RIGHT, bits & ~_RIGHT)
        both[bits] = all(sides)
    triangle, frame = np.nonzero(both[every])
    order = np.lexsort((triangle, frame))
    return frame[order], triangle[order]


def _winding(a: Floats, b: Floats) -> tuple[Ints, Floats]:
    """Return how often the phase winds around triangles, and the weights of their singularities.

    Parameters
    ----------
    a, b : (s, 3) float
        u - u* and v - v* at the corners.
    """
    after, before = [1, 2, 0], [2, 0, 1]
    winding = turns(a, b, a[:, after], b[:, after]).sum(axis=1)
    # barycentric weights of the point where a and b vanish
    weights = a[:, after] * b[:, before] - a[:, before] * b[:, after]
    total = weights.sum(axis=1, keepdims=True)
    return winding, np.where(total == 0.0, 1.0 / 3.0, weights / np.where(total == 0.0, 1.0, total))
