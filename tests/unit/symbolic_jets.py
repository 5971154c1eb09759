"""Sympy expressions in two coordinates as jets: derivatives taken symbolically."""

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
