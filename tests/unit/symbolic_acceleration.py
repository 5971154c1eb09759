"""The relative acceleration equation written out in sympy from the paper's definitions.

- E^k n'' = d_n((1/sqrt g) d_k U^k v) + d_n E^k v', summed over k and divided by the sum of E^k,
U^k = Lambda^k sqrt(g) d^kk, E^k = Lambda^k U^k / sqrt(g), d^kk = s^kk g^kk (eq. relacceqn without
the terms of eq. relcomp1 and of the static force), Lambda held fixed.
"""

from dataclasses import dataclass

import sympy as sp
from symbolic_jets import X, Y


@dataclass(frozen=True)
class Terms:
    """What v, dv/dlambda and dv/dn are multiplied by in - d^2 n / d lambda^2."""

    velocity: sp.Expr
    change: sp.Expr
    spread: sp.Expr


def derived(scales, factors, covector, along) -> Terms:
    """Return the terms; ``scales`` are sqrt(g_11), sqrt(g_22) and ``along`` is N^1, N^2."""
    root = scales[0] * scales[1]
    axes = (X, Y)

    def by_n(field):
        return sum(along[j] * sp.diff(field, axes[j]) for j in range(2))

    flows = [covector[k] * root * factors[k] / scales[k] ** 2 for k in range(2)]
    divergence = sum(sp.diff(flows[k], axes[k]) for k in range(2)) / root
    energy = sum(covector[k] * flows[k] for k in range(2)) / root
    return Terms(by_n(divergence) / energy, by_n(energy) / energy, divergence / energy)


def zero(expression) -> bool:
    """Tell whether an expression is identically zero."""
    return sp.simplify(sp.expand(sp.numer(sp.together(expression.doit())))) == 0
