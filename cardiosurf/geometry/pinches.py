"""Points where a level's curve crosses itself: saddles of the level that lie on its zero set."""

import numpy as np

from cardiosurf.arrays import Floats, Ints
from cardiosurf.geometry.levels import Level
from cardiosurf.geometry.locate import limited, tangential
from cardiosurf.geometry.sheet import Sheet

_ROUNDS = 20
_SHALLOW = 0.5
_STEP = 1e-4
_FLAT = 1e-10
# curvatures that differ more than this from each other's negative do not make a saddle
_LOPSIDED = 1e-3
# as near to the zero set as the tracing of curves can tell
ON_LEVEL = 1e-9


def saddles(level: Level, points: Floats, edges: Ints, sheet: Sheet, spacing: float) -> Floats:
    """Return the saddles (k, 3) of a level on the surface that lie near its zero set.

    A plane that touches the inside of a bend, x = ring_radius - tube_radius on a torus for one, is
    zero on curves that cross where it touches.

    Parameters
    ----------
    level : Level
        The level.
    points, edges : (n, 3), (e, 2)
        Points spread over the surface, and neighbours among them.
    sheet : Sheet
        The exact surface.
    spacing : float
        How far the points are apart, in su.
    """
    slope = np.linalg.norm(_slopes(level, points, sheet), axis=1)
    least = (slope < _SHALLOW) & (np.abs(level.value(points)) < spacing)
    for here, there in (edges.T, edges[:, ::-1].T):
        least[here[slope[here] > slope[there]]] = False
    start: Floats = points[least]
    if not len(start):
        return start
    found, bending = _stationary(level, start, sheet, spacing)
    good = np.linalg.norm(_slopes(level, found, sheet), axis=1) < 1e3 * _FLAT
    good &= np.linalg.norm(found - start, axis=1) < 2.0 * spacing
    good &= np.abs(level.value(found)) < 0.02 * spacing
    return np.asarray(
        found[good & (np.linalg.det(bending) < -_LOPSIDED * (bending**2).sum(axis=(1, 2)))]
    )


def _slopes(level: Level, points: Floats, sheet: Sheet) -> Floats:
    return tangential(level.gradient(points), sheet.normal(points))


def _stationary(level: Level, start: Floats, sheet: Sheet, spacing: float) -> tuple[Floats, Floats]:
    """Return where the slope vanishes (Newton), and the level's second derivatives (n, 2, 2)."""
    found, bending = start, np.zeros((len(start), 2, 2))
    step = _STEP * spacing
    for _ in range(_ROUNDS):
        normal = sheet.normal(found)
        along = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal), axis=1)])
        along /= np.linalg.norm(along, axis=1)[:, None]
        basis = np.stack([along, np.cross(normal, along)], axis=1)
        change = np.empty((len(found), 2, 3))
        for k in range(2):
            ends = (sheet.project(found + side * step * basis[:, k]) for side in (1.0, -1.0))
            after, before = (_slopes(level, one, sheet) for one in ends)
            change[:, k] = (after - before) / (2.0 * step)
        bending = np.einsum("nkd,njd->nkj", change, basis)
        slope = np.einsum("nd,njd->nj", _slopes(level, found, sheet), basis)
        if np.abs(slope).max() < _FLAT:
            break
        move = np.linalg.pinv(bending, rcond=1e-6) @ slope[:, :, None]
        moved = np.einsum("nk,nkd->nd", move[:, :, 0], basis)
        found = sheet.project(found - limited(moved, 0.5 * spacing))
    return found, bending
