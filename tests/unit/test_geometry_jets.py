"""Jets against derivatives that sympy takes."""

import numpy as np
import sympy as sp
from symbolic_jets import X, Y, jet_of

from cardiosurf.geometry import jets

PLACES = np.array([[0.3, -1.2], [2.0, 0.4], [-0.7, 0.9]])


def same(found, expression):
    wanted = jet_of(expression, PLACES)
    # a few dozen operations, each exact to rounding
    for name in ("value", "first", "second"):
        np.testing.assert_allclose(getattr(found, name), getattr(wanted, name), rtol=1e-13)


def test_arithmetic_and_functions():
    x, y = jets.coordinates(PLACES)
    f = jets.exp(x * y - 0.5) * jets.sin(2.0 * x + y) / (1.0 + x * x) - y
    same(f, sp.exp(X * Y - sp.Rational(1, 2)) * sp.sin(2 * X + Y) / (1 + X**2) - Y)
    g = jets.log(3.0 + jets.cos(x - y)) + jets.sqrt(5.0 - x) * 2.0 / y
    same(g, sp.log(3 + sp.cos(X - Y)) + 2 * sp.sqrt(5 - X) / Y)
    same(jets.logistic(x * y * 3.0), 1 / (1 + sp.exp(-3 * X * Y)))
    same((2.0 - x).power(3.0), (2 - X) ** 3)


def test_derivatives():
    x, y = jets.coordinates(PLACES)
    f = jets.sin(x * y) * x
    g = f.along(1)
    wanted = jet_of(sp.diff(sp.sin(X * Y) * X, Y), PLACES)
    np.testing.assert_allclose(g.value, wanted.value, rtol=1e-14)
    np.testing.assert_allclose(g.first, wanted.first, rtol=1e-14)
    # what a polynomial of order two does not know it does not invent
    assert np.isnan(g.second).all()
    direction = np.array([0.6, 0.8, -1.0]), np.array([2.0, 0.0, 1.0])
    np.testing.assert_allclose(f.towards(direction), (np.array(direction) * f.first).sum(axis=0))


def test_frozen_values_have_no_slope():
    held = jets.constant(np.array([1.0, 2.0, 3.0]), 3)
    np.testing.assert_array_equal(held.value, [1.0, 2.0, 3.0])
    assert not held.first.any()
    assert not held.second.any()
