"""Geodesics of a net, from their own differential equation, and how far circles are from them.

    d²x^k/ds² + Gamma^k_ij dx^i/ds dx^j/ds = 0

Metric and symbols are those of ``nets``, so nothing here is meshed.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from cardiosurf.arrays import Floats
from cardiosurf.errors import InputError, NumericalError
from cardiosurf.geometry.jets import Jet
from cardiosurf.geometry.nets import Net, RevolvedNet, christoffel

TOLERANCE = 1e-12
"""Relative tolerance of the integration."""


@dataclass(frozen=True)
class StretchedNet:
    """A net measured by a wave: g_kk / s_k, with the same anisotropy s_k everywhere.

    A wave runs sqrt(s_k) faster along x^k, and takes the geodesics of this metric.

    Attributes
    ----------
    net : Net
        The net of the surface.
    factors : pair of float
        s_1 and s_2.
    """

    net: Net
    factors: tuple[float, float]

    def metric(self, net: Floats) -> tuple[Jet, Jet]:
        """Return g_11 / s_1 and g_22 / s_2."""
        first, second = self.net.metric(net)
        return first / self.factors[0], second / self.factors[1]

    def curvatures(self, net: Floats) -> tuple[Floats, Floats]:
        """Return the curvatures of the surface itself."""
        return self.net.curvatures(net)


@dataclass(frozen=True)
class Geodesic:
    """A geodesic, from its start on.

    Attributes
    ----------
    arclength : (n,) float
        Distance along it, in su.
    places : (n, 2) float
        Net coordinates.
    velocity : (n, 2) float
        dx^k/ds.
    """

    arclength: Floats
    places: Floats
    velocity: Floats


def geodesic(
    net: Net,
    start: tuple[float, float],
    angle: float,
    length: float,
    *,
    within: tuple[float, float] = (-np.inf, np.inf),
    count: int = 401,
) -> Geodesic:
    """Return the geodesic that starts at a place, in a direction.

    Parameters
    ----------
    net : Net
        The net.
    start : (2,) float
        Net coordinates.
    angle : float
        From e1 towards e2, in radians, as the net measures it.
    length : float
        How long it is, in su.
    within : pair of float
        It ends where x^1 leaves this range.
    count : int
        Number of places returned.

    Raises
    ------
    InputError
        If the start is not within the range.
    NumericalError
        If the integration breaks down, as at a pole.
    """
    if not within[0] <= start[0] <= within[1]:
        raise InputError("start", f"{start[0]:g} is not within the range", f"{within}")
    roots = [float(np.sqrt(one.value[0])) for one in net.metric(np.array([start]))]
    state = [*start, np.cos(angle) / roots[0], np.sin(angle) / roots[1]]
    leaving = [_Leaving(within[0], -1.0), _Leaving(within[1], 1.0)]
    found = scipy.integrate.solve_ivp(
        lambda _, now: _change(net, now),
        (0.0, length),
        state,
        method="DOP853",
        rtol=TOLERANCE,
        atol=TOLERANCE,
        events=leaving if np.isfinite(within).all() else None,
        dense_output=True,
    )
    if not found.success:
        raise NumericalError(f"a geodesic breaks down: {found.message}", "a start off the pole")
    s = np.linspace(0.0, found.t[-1], count)
    solution: Any = found.sol
    values = solution(s).T
    return Geodesic(s, values[:, :2], values[:, 2:])


def circle_curvature(net: RevolvedNet | StretchedNet, x1: Floats) -> Floats:
    """Return the geodesic curvature of the circles x^1 = const, (n,), in 1/su.

        kappa = -Gamma^1_22 sqrt(g_11) / g_22 = d_1 g_22 / (2 g_22 sqrt(g_11))

    Above 0 where the circle bends towards smaller x^1; 0 where it is a geodesic. On the vein
    -cos theta / rho.

    Parameters
    ----------
    net : RevolvedNet or StretchedNet
        A net in which nothing depends on x^2.
    x1 : (n,) float
        Places.
    """
    places = np.stack([np.asarray(x1, np.float64), np.zeros(len(x1))], axis=1)
    first, second = net.metric(places)
    symbol = christoffel(net, places)[:, 0, 1, 1]
    return np.asarray(-symbol * np.sqrt(first.value) / second.value)


def clairaut(net: Net, line: Geodesic) -> Floats:
    """Return g_22 dx^2/ds along a line, (n,): constant on a geodesic where nothing depends on x^2.

    On a surface of revolution it is rho sin(angle from the profile), in su.

    Parameters
    ----------
    net : Net
        The net.
    line : Geodesic
        The line.
    """
    return np.asarray(net.metric(line.places)[1].value * line.velocity[:, 1])


def _change(net: Net, now: Floats) -> Floats:
    velocity = now[2:]
    symbols = christoffel(net, now[None, :2])[0]
    return np.concatenate([velocity, -np.einsum("kij,i,j->k", symbols, velocity, velocity)])


class _Leaving:
    """An event of the integration: x^1 crosses a limit from inside, which ends it."""

    terminal = True

    def __init__(self, limit: float, direction: float) -> None:
        self.limit, self.direction = limit, direction

    def __call__(self, _: float, now: Floats) -> float:
        return float(now[0] - self.limit)
