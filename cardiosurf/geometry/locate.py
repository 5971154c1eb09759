"""Newton steps along the surface, onto a level and onto the crossing of two levels."""

from collections.abc import Sequence

import numpy as np

from cardiosurf.arrays import Floats, Ints
from cardiosurf.geometry.levels import Level
from cardiosurf.geometry.sheet import Sheet

_ROUNDS = 30
_EXACT = 1e-11
_PARALLEL = 1e-8


def tangential(vectors: Floats, normals: Floats) -> Floats:
    """Return the vectors (n, 3) without their components along the unit normals (n, 3)."""
    return np.asarray(vectors - np.einsum("nk,nk->n", vectors, normals)[:, None] * normals)


def onto_level(points: Floats, level: Level, sheet: Sheet, reach: float) -> Floats:
    """Return the points (n, 3) moved along the surface to where the level is zero.

    Parameters
    ----------
    points : (n, 3) float
        Points of the surface near the level's zero set, in su.
    level : Level
        The level.
    sheet : Sheet
        The exact surface.
    reach : float
        Longest single step, in su.
    """
    moved = points.copy()
    for _ in range(_ROUNDS):
        value = level.value(moved)
        left = np.abs(value) > _EXACT
        if not left.any():
            break
        here = moved[left]
        slope = tangential(level.gradient(here), sheet.normal(here))
        square = np.maximum(np.einsum("nk,nk->n", slope, slope), _PARALLEL)
        moved[left] = sheet.project(here - limited(slope * (value[left] / square)[:, None], reach))
    return moved


def onto_crossing(
    points: Floats, pairs: Ints, levels: Sequence[Level], sheet: Sheet, reach: float
) -> tuple[Floats, Floats, Floats]:
    """Return the points moved along the surface to where two levels are zero.

    Parameters
    ----------
    points : (n, 3) float
        Starting points on the surface, in su.
    pairs : (n, 2) int
        The two levels of each point.
    levels : sequence of Level
        The levels.
    sheet : Sheet
        The exact surface.
    reach : float
        Longest single step, in su.

    Returns
    -------
    moved : (n, 3) float
        Where each point ended.
    residual : (n,) float
        Distance from the two levels that is left.
    sine : (n,) float
        Sine of the angle between the two levels there.
    """
    moved = points.copy()
    value, slope = _both(moved, pairs, levels, sheet)
    left = np.arange(len(points))
    for _ in range(_ROUNDS):
        left = left[np.abs(value[left]).max(axis=1) > _EXACT]
        if not len(left):
            break
        step = np.linalg.pinv(slope[left], rcond=1e-7) @ value[left][:, :, None]
        moved[left] = sheet.project(moved[left] - limited(step[:, :, 0], reach))
        value[left], slope[left] = _both(moved[left], pairs[left], levels, sheet)
    length = np.maximum(np.linalg.norm(slope, axis=2), 1e-300)
    cross = np.linalg.norm(np.cross(slope[:, 0], slope[:, 1]), axis=1)
    return moved, np.abs(value).max(axis=1), cross / (length[:, 0] * length[:, 1])


def limited(steps: Floats, reach: float) -> Floats:
    """Return the steps (n, 3), none longer than reach."""
    length = np.sqrt(np.einsum("nk,nk->n", steps, steps))
    return np.asarray(steps * np.minimum(1.0, reach / np.maximum(length, 1e-300))[:, None])


def _both(
    points: Floats, pairs: Ints, levels: Sequence[Level], sheet: Sheet
) -> tuple[Floats, Floats]:
    value, slope = np.empty(pairs.shape), np.empty((*pairs.shape, 3))
    for number in np.unique(pairs).tolist():
        at, which = np.nonzero(pairs == number)
        value[at, which] = levels[number].value(points[at])
        slope[at, which] = levels[number].gradient(points[at])
    normal = sheet.normal(points)
    for side in range(2):
        slope[:, side] = tangential(slope[:, side], normal)
    return value, slope
