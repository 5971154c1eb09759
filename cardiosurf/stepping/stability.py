"""How long a step may be before the explicit reaction runs away."""

import numpy as np

from cardiosurf.stepping.schemes import Scheme


def largest_stable(scheme: Scheme) -> float:
    """Return the largest rate * dt at which the explicit part of a scheme damps w' = -rate w.

    The scheme then is sum_j a_j w_(k+1-j) + rate dt sum_j c_j w_(k-j) = 0, stable while no root of
    its polynomial leaves the unit disc: 2 for imex_euler, 1 for cnab2, 4/3 for sbdf2.

    Parameters
    ----------
    scheme : Scheme
        The time integration.
    """
    stable, unstable = 0.0, 4.0
    while unstable - stable > 1e-6:
        middle = 0.5 * (stable + unstable)
        if _growth(scheme, middle) <= 1.0 + 1e-9:
            stable = middle
        else:
            unstable = middle
    return stable


def _growth(scheme: Scheme, rate_step: float) -> float:
    """Return the modulus of the largest root at one rate * dt."""
    length = max(len(scheme.state), len(scheme.explicit) + 1)
    polynomial = np.zeros(length)
    polynomial[: len(scheme.state)] += scheme.state
    polynomial[1 : 1 + len(scheme.explicit)] += rate_step * np.array(scheme.explicit)
    return float(np.abs(np.roots(polynomial)).max())
