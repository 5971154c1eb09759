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
USUAL_ORDER = 2.0
LEVELS = 3
"""How many of the finest levels are extrapolated from."""
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
    order : float
        The order p that was extrapolated with.
    order_is : str
        ``fitted`` to three levels, or ``assumed``: no plausible order fits them.
    converged : bool
        Whether one plausible order explains the finest levels within their brackets, and the last
        step from level to level is no longer than the one before, or within the brackets.
    """

    value: float
    error: float
    bracket_error: float
    order: float
    order_is: Literal["fitted", "assumed"]
    converged: bool


def extrapolate(samples: Sequence[Sample]) -> Estimate:
    """Return the extrapolated value and its error, from the three finest levels.

        x0 = x3 + (x3 - x2) / ((h2 / h3)^p - 1),
        error = max(|x0 - x3| + w3, the furthest x0 that any order from 1 to 4 allows)

    The second is found exactly: all x0 for which some c and some p put x0 + c h^p within the
    bracket (half width w) of each level. If there are none, the values do not converge as they
    should, and the spread of the three takes its place.

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
    coarse, middle, fine = samples[-LEVELS:]
    finest = [coarse, middle, fine]
    fitted = fit_order(coarse, middle, fine)
    order = USUAL_ORDER if fitted is None else fitted
    value = fine.value + (fine.value - middle.value) / ((middle.size / fine.size) ** order - 1.0)
    allowed = enclosure(finest, order)
    values = [sample.value for sample in finest]
    if allowed is None:
        beyond = max(values) - min(values) + fine.half_width
    else:
        beyond = max(allowed[1] - value, value - allowed[0])
    last, before = abs(fine.value - middle.value), abs(middle.value - coarse.value)
    settled = last <= max(before, fine.half_width + middle.half_width)
    return Estimate(
        value=value,
        error=max(abs(value - fine.value) + fine.half_width, beyond),
        bracket_error=fine.half_width,
        order=order,
        order_is="assumed" if fitted is None else "fitted",
        converged=allowed is not None and settled,
    )


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
