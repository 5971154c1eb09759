"""The modified FitzHugh-Nagumo model of Rogers and McCulloch."""

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from cardiosurf.arrays import Floats
from cardiosurf.sections import NonNegative, Positive, Section


class RogersMcCullochConstants(NamedTuple):
    """The constants, for the compiled march."""

    a: float
    b1: float
    b2: float
    c1: float
    c2: float


def law(c: Any, u: Any, v: Any) -> Any:
    """Return f and g at u and v, numbers or arrays, with the constants c."""
    return c.c1 * u * (u - c.a) * (1.0 - u) - c.c2 * u * v, c.b1 * (u - c.b2 * v)


@dataclass(frozen=True)
class RogersMcCulloch(Section):
    """Kinetics f = c1 u (u - a)(1 - u) - c2 u v, g = b1 (u - b2 v).

    Source: Rogers and McCulloch, IEEE Trans Biomed Eng 41:743 (1994), with the constants of
    Chun's paper; 1 time unit is 0.63 ms, 1 space unit 0.99 mm.
    """

    model: Literal["rogers_mcculloch"] = "rogers_mcculloch"
    a: NonNegative = 0.13
    b1: NonNegative = 0.013
    b2: NonNegative = 1.0
    c1: Positive = 0.26
    c2: NonNegative = 0.1

    def rates(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Return the reaction terms (f, g) of u and v, each (n,), in 1/tu."""
        f, g = law(self, u, v)
        return f, g
