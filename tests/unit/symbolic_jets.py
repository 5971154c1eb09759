"""Sympy expressions in two coordinates as jets: derivatives taken symbolically."""

from dataclasses import dataclass

import numpy as np
import sympy as sp

from cardiosurf.geometry.jets import Jet

X, Y = sp.symbols("x y", real=True)


def evaluated(expression, places):
    """Return the expression's values (n,) at places (n, 2)."""
    value = sp.lambdify((X, Y), sp.sympify(expression), "numpy")(places[:, 0], places[:, 1])
    return np.broadcast_to(np.asarray(value, dtype=float), (len(places),)).copy()


def jet_of(expression, places) -> Jet:
    """Return the expression and its derivatives at places (n, 2)."""
    first = [sp.diff(expression, one) for one in (X, Y)]
    second = [sp.diff(expression, *pair) for pair in ((X, X), (X, Y), (Y, Y))]
    return Jet(
        evaluated(expression, places),
        np.stack([evaluated(one, places) for one in first]),
        np.stack([evaluated(one, places) for one in second]),
    )


@dataclass(frozen=True)
class SymbolicNet:
    """An orthogonal net of which only the metric is given, in x and y."""

    first: sp.Expr
    second: sp.Expr

    def metric(self, net):
        return jet_of(self.first, net), jet_of(self.second, net)

    def curvatures(self, net):
        raise NotImplementedError
