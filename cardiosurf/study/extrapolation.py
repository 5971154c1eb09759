"""From values on several meshes to the value on none: Richardson's extrapolation, with its error.

The value on edges of length h is taken to be x(h) = x0 + c h^p.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy

LOWEST_ORDER, HIGHEST_ORDER = 1.0, 4.0
"""The orders of convergence that are plausible: the blended mass has 4, region edges cost some."""
FORMAL_ORDER = 2.0
"""That of the steps, and of waves across fibres with any mass: what is left in the end. Coarse
meshes may seem to converge faster; extrapolated so, the T-domain's value fell short (findings)."""
SCATTER = 4.0
"""Values within this many half widths are as close as meshes, each of its own making, allow."""
LEVELS = 3
"""How many of the finest levels are extrapolated from."""
OrderIs = Literal["fitted", "assumed", "none"]
_ORDERS = np.linspace(LOWEST_ORDER, HIGHEST_ORDER, 301)


@dataclass(frozen=True)
class Sample:
    """The value on one mesh.

    Attributes
    ----------
    size : float
        Edge length h, in su.
    value : float
        The value x.
    half_width : float
        How far the true value on this mesh may be from it.
    """

    size: float
    value: float
    half_width: float


@dataclass(frozen=True)
class Estimate:
    """The value on infinitely fine meshes.

    Attributes
    ----------
    value : float
        x0, extrapolated.
    error : float
        How far from it the converged value is at most (``extrapolate`` has the rule).
    bracket_error : float
        What the brackets alone contribute: the half width on the finest mesh.
    order : float or None
        The order p that was extrapolated with; None: there is no trend to extrapolate.
    order_is : str
        ``fitted`` to three levels; ``assumed`` to be 2, where no order from 1 to 2 fits them;
        ``none``: the values turn round, or stay.
    converged : bool
        Whether one order from 1 to 4 explains the three finest levels within their brackets and
        they draw closer, or they are within 4 half widths of each other.
    """

    value: float
    error: float
    bracket_error: float
    order: float | None
    order_is: OrderIs
    converged: bool


def extrapolate(samples: Sequence[Sample]) -> Estimate:
    """Return the extrapolated value and its error, from the three finest levels.

        x0 = x3 + (x3 - x2) / ((h2 / h3)^p - 1)

    with p fitted to the three where that gives 1 to 2, else 2. Where the values turn round, what is
    left is the meshes' scatter, which extrapolation would enlarge, and x0 = x3. The error is the
    largest of

    - the whole extrapolation, |x0 - x3| + w3 (w: half widths of the brackets);
    - what the extrapolation from h1 and h3 differs by, + w3; without a trend the spread of the
      three, + w3;
    - the distance to the furthest x0 that any order from 1 to 4 allows: to all x0 for which some c
      and p put x0 + c h^p within each bracket. If there are none, the values do not converge as
      they should, and the spread of the three, + w3, takes its place.

    Parameters
    ----------
    samples : sequence of Sample
        At least three, the coarsest first.

    References
    ----------
    Roache, J Fluids Eng 116:405 (1994), for the order from three meshes.
    """
    if len(samples) < LEVELS:
        msg = f"{len(samples)} levels; an error takes {LEVELS}"
        raise ValueError(msg)
    finest = samples[-LEVELS:]
    coarse, middle, fine = finest
    order, order_is = _order(coarse, middle, fine)
    value = fine.value if order is None else _limit(middle, fine, order)
    values = [sample.value for sample in finest]
    spread = max(values) - min(values)
    allowed = enclosure(finest, order or FORMAL_ORDER)
    if allowed is None:
        furthest = spread + fine.half_width
    else:
        furthest = max(allowed[1] - value, value - allowed[0])
    other = spread if order is None else abs(value - _limit(coarse, fine, order))
    widest = max(sample.half_width for sample in finest)
    return Estimate(
        value=value,
        error=max(max(abs(value - fine.value), other) + fine.half_width, furthest),
        bracket_error=fine.half_width,
        order=order,
        order_is=order_is,
        converged=(allowed is not None and _draw_closer(coarse, middle, fine))
        or spread <= SCATTER * widest,
    )


def _order(coarse: Sample, middle: Sample, fine: Sample) -> tuple[float | None, OrderIs]:
    """Return the order to extrapolate with, and where it comes from."""
    if (coarse.value - middle.value) * (middle.value - fine.value) <= 0.0:
        return None, "none"
    fitted = fit_order(coarse, middle, fine)
    if fitted is None or fitted > FORMAL_ORDER:
        return FORMAL_ORDER, "assumed"
    return fitted, "fitted"


def _limit(coarser: Sample, finer: Sample, order: float) -> float:
    """Return the value without a mesh, from two meshes and the order."""
    ratio = float((coarser.size / finer.size) ** order)
    return finer.value + (finer.value - coarser.value) / (ratio - 1.0)


def _draw_closer(coarse: Sample, middle: Sample, fine: Sample) -> bool:
    last, before = abs(fine.value - middle.value), abs(middle.value - coarse.value)
    return last <= max(before, fine.half_width + middle.half_width)


def fit_order(coarse: Sample, middle: Sample, fine: Sample) -> float | None:
    """Return the order p of x0 + c h^p through three values, None if it is not from 1 to 4.

    Parameters
    ----------
    coarse, middle, fine : Sample
        The values, h falling.
    """
    before, last = coarse.value - middle.value, middle.value - fine.value
    if last == 0.0:
        return None

    def excess(order: float) -> float:
        one, two, three = (sample.size**order for sample in (coarse, middle, fine))
        return float((one - two) / (two - three) - before / last)

    # the ratio of the steps grows with the order
    if not excess(LOWEST_ORDER) <= 0.0 <= excess(HIGHEST_ORDER):
        return None
    return float(scipy.optimize.brentq(excess, LOWEST_ORDER, HIGHEST_ORDER))


def enclosure(samples: Sequence[Sample], order: float) -> tuple[float, float] | None:
    """Return the least and the largest x0 of any x0 + c h^p, 1 <= p <= 4, within all brackets.

    For a given p the conditions x_i - w_i <= x0 + c h_i^p <= x_i + w_i bound x0, once c is
    eliminated, by the lines through the ends of each pair of brackets, i coarser than j:

        x0 <= (U_j g_i - L_i g_j) / (g_i - g_j)
        x0 >= (L_j g_i - U_i g_j) / (g_i - g_j),   g = h^p, L = x - w, U = x + w

    Parameters
    ----------
    samples : sequence of Sample
        The values, h falling.
    order : float
        An order that is tried besides 1, 1.01, ... 4.

    Returns
    -------
    tuple of float or None
        None if no order explains the values.
    """
    orders = np.append(_ORDERS, order)
    lowest, highest = np.full(len(orders), -np.inf), np.full(len(orders), np.inf)
    for i, coarser in enumerate(samples):
        for finer in samples[i + 1 :]:
            g, f = coarser.size**orders, finer.size**orders
            most, least = finer.value + finer.half_width, coarser.value - coarser.half_width
            highest = np.minimum(highest, (most * g - least * f) / (g - f))
            most, least = coarser.value + coarser.half_width, finer.value - finer.half_width
            lowest = np.maximum(lowest, (least * g - most * f) / (g - f))
    possible = lowest <= highest
    if not possible.any():
        return None
    return float(lowest[possible].min()), float(highest[possible].max())
