"""Fields on a net together with their first and second derivatives, exact to rounding.

A jet is the Taylor polynomial of order two of a field at each of n places. Arithmetic on jets is
the product and chain rule, so a formula written once gives its own derivatives.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from cardiosurf.arrays import Floats


@dataclass(frozen=True, eq=False)
class Jet:
    """A field and its derivatives by the net coordinates x^1, x^2.

    Attributes
    ----------
    value : (n,) float
        The field f.
    first : (2, n) float
        d_1 f, d_2 f.
    second : (3, n) float
        d_1 d_1 f, d_1 d_2 f, d_2 d_2 f; NaN where they are not known.
    """

    value: Floats
    first: Floats
    second: Floats

    def __add__(self, other: Jet | float) -> Jet:
        """Return the sum."""
        if not isinstance(other, Jet):
            return Jet(self.value + other, self.first, self.second)
        return Jet(self.value + other.value, self.first + other.first, self.second + other.second)

    __radd__ = __add__

    def __neg__(self) -> Jet:
        """Return the negative."""
        return Jet(-self.value, -self.first, -self.second)

    def __sub__(self, other: Jet | float) -> Jet:
        """Return the difference."""
        return self + (-other)

    def __rsub__(self, other: float) -> Jet:
        """Return a number minus the field."""
        return -self + other

    def __mul__(self, other: Jet | float) -> Jet:
        """Return the product."""
        if not isinstance(other, Jet):
            return Jet(self.value * other, self.first * other, self.second * other)
        crossed = _outer(self.first, other.first) + _outer(other.first, self.first)
        return Jet(
            self.value * other.value,
            self.first * other.value + self.value * other.first,
            self.second * other.value + self.value * other.second + crossed,
        )

    __rmul__ = __mul__

    def __truediv__(self, other: Jet | float) -> Jet:
        """Return the quotient."""
        return self * (other.power(-1.0) if isinstance(other, Jet) else 1.0 / other)

    def __rtruediv__(self, other: float) -> Jet:
        """Return a number divided by the field."""
        return self.power(-1.0) * other

    def power(self, exponent: float) -> Jet:
        """Return the field to a power."""
        f, p = self.value, exponent
        return self.chained(f**p, p * f ** (p - 1.0), p * (p - 1.0) * f ** (p - 2.0))

    def chained(self, outer: Floats, slope: Floats, bend: Floats) -> Jet:
        """Return h(f), given h, h' and h'' at the values of the field."""
        return Jet(
            outer,
            slope * self.first,
            slope * self.second + bend * _outer(self.first, self.first),
        )

    def along(self, axis: int) -> Jet:
        """Return the derivative by a net coordinate, 0 or 1; its second derivatives are NaN."""
        second = self.second[[0, 1]] if axis == 0 else self.second[[1, 2]]
        return Jet(self.first[axis], second, np.full_like(self.second, np.nan))

    def towards(self, direction: tuple[Floats, Floats]) -> Floats:
        """Return the derivative N^k d_k f in the direction N^k, (n,)."""
        return np.asarray(direction[0] * self.first[0] + direction[1] * self.first[1])


Scalar: TypeAlias = Jet | float


def coordinates(net: Floats) -> tuple[Jet, Jet]:
    """Return the net coordinates x^1, x^2 themselves as jets.

    Parameters
    ----------
    net : (n, 2) float
        The places.
    """
    x = np.asarray(net, dtype=np.float64)
    none, one = np.zeros(len(x)), np.ones(len(x))
    flat = np.zeros((3, len(x)))
    return Jet(x[:, 0], np.stack([one, none]), flat), Jet(x[:, 1], np.stack([none, one]), flat)


def constant(value: float | Floats, count: int) -> Jet:
    """Return a field of ``count`` places whose derivatives are zero.

    Parameters
    ----------
    value : float or (n,) float
        Its value, at each place if it is an array: then it is frozen, not constant.
    count : int
        How many places.
    """
    held = np.broadcast_to(np.asarray(value, dtype=np.float64), (count,)).copy()
    return Jet(held, np.zeros((2, count)), np.zeros((3, count)))


def sin(f: Jet) -> Jet:
    """Return the sine."""
    s, c = np.sin(f.value), np.cos(f.value)
    return f.chained(s, c, -s)


def cos(f: Jet) -> Jet:
    """Return the cosine."""
    s, c = np.sin(f.value), np.cos(f.value)
    return f.chained(c, -s, -c)


def exp(f: Jet) -> Jet:
    """Return the exponential."""
    e = np.exp(f.value)
    return f.chained(e, e, e)


def log(f: Jet) -> Jet:
    """Return the natural logarithm."""
    inverse = 1.0 / f.value
    return f.chained(np.log(f.value), inverse, -(inverse**2))


def sqrt(f: Jet) -> Jet:
    """Return the square root."""
    return f.power(0.5)


def logistic(f: Jet) -> Jet:
    """Return 1 / (1 + exp(-f))."""
    share = 0.5 * (1.0 + np.tanh(0.5 * f.value))
    slope = share * (1.0 - share)
    return f.chained(share, slope, slope * (1.0 - 2.0 * share))


def _outer(a: Floats, b: Floats) -> Floats:
    """Return half of a_i b_j + a_j b_i for ij = 11, 12, 22: twice that is the product rule."""
    return np.stack([a[0] * b[0], 0.5 * (a[0] * b[1] + a[1] * b[0]), a[1] * b[1]])
