"""Questions that have an answer in the hexagonal packing: face, disc and strand."""

import numpy as np

from cardiosurf.arrays import Floats, Mask
from cardiosurf.discrete.network import Packing, packed
from cardiosurf.discrete.play import Play, Rule, play

HALF = 20.0
"""Half side of the plane of units, in distances between them; the block has half of it."""
FACTORS = (1.0, 64.0)
"""Between which anisotropies that of a face is looked for."""
CLOSE = 1e-3
"""Half width of its bracket."""
MOST = 10
"""Rings of a disc and rows of a strand that are tried."""
ROW = np.sqrt(0.75)


def block_of_fibres(factor: float, rule: Rule, *, loads: bool = True) -> tuple[Packing, Play]:
    """Return problem 1 of Appendix C in a packing, and what a wave from above makes of it.

    Rows of the packing lie along the wave's front; the fibres run with the wave, along y.

    Parameters
    ----------
    factor : float
        Anisotropy of the block.
    rule : Rule
        What a unit can do.
    loads : bool
        As in ``link_factors``.
    """

    def inside(places: Floats) -> Mask:
        return np.asarray((np.abs(places) <= HALF).all(axis=1))

    def diffusivity(places: Floats) -> Floats:
        factors = np.ones_like(places)
        factors[(np.abs(places) <= 0.5 * HALF).all(axis=1), 1] = factor
        return factors

    packing = packed(inside, 1.5 * HALF, diffusivity, loads=loads)
    start = np.flatnonzero(packing.places[:, 1] > HALF - 2.0)
    return packing, play(packing.network, rule, start, most=3.0 * HALF)


def face_limit(rule: Rule) -> float:
    """Return the anisotropy from which on the block's face charges units in vain.

    A link across the face lies 30 degrees off its normal and has d = 3/4 s + 1/4, so that it is
    (4 N_max^2 - 1)/3.

    Parameters
    ----------
    rule : Rule
        What a unit can do.
    """
    low, high = FACTORS
    while high - low > 2.0 * CLOSE:
        middle = 0.5 * (low + high)
        _, played = block_of_fibres(middle, rule)
        low, high = (low, middle) if played.failures.any() else (middle, high)
    return 0.5 * (low + high)


def smallest_disc(rule: Rule) -> int:
    """Return how many units round one make a disc that spreads, the least of 1, 7, 19, ...

    Parameters
    ----------
    rule : Rule
        What a unit can do.
    """

    def everywhere(places: Floats) -> Mask:
        return np.ones(len(places), dtype=np.bool_)

    packing = packed(everywhere, HALF)
    away = np.hypot(*packing.places.T)
    for rings in range(MOST):
        disc = np.flatnonzero(_hexagon(packing.places) <= rings + 0.5 * CLOSE)
        if np.isfinite(play(packing.network, rule, disc).first[away > 0.8 * HALF]).any():
            return len(disc)
    return 0


def narrowest_strand(rule: Rule) -> int:
    """Return how many rows of units wide a strand is that excites a half plane; 0: none is.

    The rows run along x, and the half plane, x < 0, begins where they end.

    Parameters
    ----------
    rule : Rule
        What a unit can do.
    """
    for rows in range(1, MOST + 1):

        def inside(places: Floats, rows: int = rows) -> Mask:
            row = np.round(places[:, 1] / ROW)
            of_strand = (row >= -(rows // 2)) & (row < rows - rows // 2)
            return np.asarray((places[:, 0] < 0.0) | of_strand)

        packing = packed(inside, HALF)
        start = np.flatnonzero(packing.places[:, 0] > HALF - 3.0)
        first = play(packing.network, rule, start).first
        if np.isfinite(first[packing.places[:, 0] < -0.7 * HALF]).any():
            return rows
    return 0


def _hexagon(places: Floats) -> Floats:
    """Return how many steps from neighbour to neighbour a place is from the middle, (n,)."""
    row = places[:, 1] / ROW
    column = places[:, 0] - 0.5 * row
    return np.asarray(np.maximum.reduce([np.abs(column), np.abs(row), np.abs(column + row)]))
