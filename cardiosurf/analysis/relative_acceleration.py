"""The paper's relative acceleration of neighbouring trajectories, on a net, from its definition.

With the trajectory's covector Lambda_k = d y^1 / d x^k, the wavefront's direction
N^k = d x^k / d n, the diffusivity d^kl on the net and

    U^k = sqrt(g) d^kl Lambda_l,  B = (1/sqrt g) d_k U^k,  E = d^kl Lambda_k Lambda_l

eq. relacceqn, summed over k and divided by E, without the terms that the paper drops there, is

    - d^2 n / d lambda^2 = (d_n B / E) v + (B / E) dv/dn + (d_n E / E) dv/dlambda,  d_n = N^k d_k.

The three brackets are what is computed here (``Acceleration``). B is the divergence of d Lambda.
The paper keeps Lambda fixed while it differentiates (its supposition that fronts are only
slightly curved); what that means depends on how Lambda is written, see ``front``.

Source: Chun's paper, sections 3 to 5.4; where it slips: docs/theory.md.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardiosurf.arrays import Floats
from cardiosurf.geometry.jets import Jet, constant, cos, log, sin
from cardiosurf.geometry.nets import Net

Reading = Literal["coordinate", "unit"]


@dataclass(frozen=True)
class Front:
    """How a wave runs through each place.

    Attributes
    ----------
    covector : pair of Jet
        Lambda_1, Lambda_2.
    along : pair of (n,) float
        N^1, N^2: the direction of the wavefront in net coordinates.
    """

    covector: tuple[Jet, Jet]
    along: tuple[Floats, Floats]


@dataclass(frozen=True)
class Tensor:
    """The contravariant diffusivity on a net: d^11, d^12 = d^21, d^22."""

    first: Jet
    mixed: Jet
    second: Jet

    def times(self, covector: tuple[Jet, Jet]) -> tuple[Jet, Jet]:
        """Return d^kl Lambda_l."""
        a, b = covector
        return self.first * a + self.mixed * b, self.mixed * a + self.second * b


@dataclass(frozen=True)
class Acceleration:
    """The right-hand side of the relative acceleration equation, at each place.

    Attributes
    ----------
    of_velocity : (n,) float
        d_n B / E, what v is multiplied by.
    of_change : (n,) float
        d_n E / E, what dv/dlambda is multiplied by.
    of_spread : (n,) float
        B / E, what dv/dn is multiplied by.
    """

    of_velocity: Floats
    of_change: Floats
    of_spread: Floats

    def total(self, velocity: float = 1.0, change: float = 1.0, *, spread: float = 0.0) -> Floats:
        """Return - d^2 n / d lambda^2, (n,), for v, dv/dlambda and dv/dn.

        Parameters
        ----------
        velocity, change, spread : float
            v, dv/dlambda and dv/dn; the paper's figures take 1, 1 and 0.
        """
        return np.asarray(
            self.of_velocity * velocity + self.of_change * change + self.of_spread * spread
        )


def front(net: Net, places: Floats, angle: Floats | float, *, reading: Reading = "unit") -> Front:
    """Return a wave that runs at an angle to the first net axis, the angle held fixed.

    Parameters
    ----------
    net : Net
        The net.
    places : (n, 2) float
        Net coordinates.
    angle : float or (n,) float
        Angle A from the first net axis towards the second, in radians. It is held fixed under
        differentiation, whatever it is at other places.
    reading : {"unit", "coordinate"}
        "unit": A is measured on the surface, Lambda_k = h_k (cos A, sin A), h_k = sqrt(g_kk),
        N^k = (-sin A, cos A) / h_k, and what is held fixed are the components in the net's unit
        frame. Terms come out in 1/su^2 (of_velocity) and 1/su.
        "coordinate": the paper's, Lambda = (cos A, sin A), N = (-sin A, cos A) as they stand, in
        coordinates whose units differ. On a plane the two are the same.
    """
    held = np.broadcast_to(np.asarray(angle, dtype=np.float64), (len(places),))
    cosine, sine = np.cos(held), np.sin(held)
    if reading == "coordinate":
        return Front((constant(cosine, len(places)), constant(sine, len(places))), (-sine, cosine))
    first, second = (g.power(0.5) for g in net.metric(places))
    return Front(
        (first * constant(cosine, len(places)), second * constant(sine, len(places))),
        (-sine / first.value, cosine / second.value),
    )


def diffusivity(
    net: Net, places: Floats, factors: tuple[Jet, Jet], turn: Jet | None = None
) -> Tensor:
    """Return the diffusivity d^kk = s_k g^kk of factors along the net's axes.

    Parameters
    ----------
    net : Net
        The net.
    places : (n, 2) float
        Net coordinates.
    factors : pair of Jet
        Diffusivity s_1, s_2 along the two axes, in su^2/tu.
    turn : Jet, optional
        Angle from the first net axis towards the second by which the axes of the two factors are
        turned, in radians: fibres that are oblique to the net. Then d^12 is not zero.
    """
    first, second = net.metric(places)
    s, t = factors
    if turn is None:
        return Tensor(s / first, constant(0.0, len(places)), t / second)
    c, n = cos(turn), sin(turn)
    mixed = (s - t) * c * n / (first * second).power(0.5)
    return Tensor((s * c * c + t * n * n) / first, mixed, (s * n * n + t * c * c) / second)


def relative_acceleration(net: Net, places: Floats, tensor: Tensor, wave: Front) -> Acceleration:
    """Return the terms of the relative acceleration equation.

    Parameters
    ----------
    net : Net
        The net.
    places : (n, 2) float
        Net coordinates, off the poles.
    tensor : Tensor
        The diffusivity there.
    wave : Front
        The wave's direction there.
    """
    first, second = net.metric(places)
    root = (first * second).power(0.5)
    flow = tensor.times(wave.covector)
    spread = ((root * flow[0]).along(0) + (root * flow[1]).along(1)) / root
    energy = wave.covector[0] * flow[0] + wave.covector[1] * flow[1]
    return Acceleration(
        of_velocity=spread.towards(wave.along) / energy.value,
        of_change=energy.towards(wave.along) / energy.value,
        of_spread=spread.value / energy.value,
    )


def ricci_type(net: Net, places: Floats, k: int) -> Floats:
    """Return S_kk = g_kk d_m [(1/sqrt g) d_k (g_mm / sqrt g)], m != k, (n,) (eq. tensordef1).

    It is zero on every surface of revolution along its net: nothing there depends on phi.

    Parameters
    ----------
    net : Net
        The net.
    places : (n, 2) float
        Net coordinates, off the poles.
    k : int
        0 or 1.
    """
    metric, m = net.metric(places), 1 - k
    root = (metric[0] * metric[1]).power(0.5)
    bracket = (metric[m] / root).along(k) / root
    return np.asarray(metric[k].value * bracket.first[m])


def gravitational(net: Net, places: Floats, factor: Jet, k: int) -> Floats:
    """Return G_kk, (n,), as it follows from eq. curvatureflow3.

    G_kk = (d_k d_m s)/s + d_m log g^kk d_k log s + (d_k log g^kk + d_k log g / 2) d_m log s

    Parameters
    ----------
    net : Net
        The net.
    places : (n, 2) float
        Net coordinates, off the poles.
    factor : Jet
        s = s^kk, the factor along the axis k.
    k : int
        0 or 1; m is the other one.

    Notes
    -----
    The printed eq. tensordef2 (``gravitational_as_printed``) has slips: the paper's own eq.
    relaccsphere comes out with this one, not with that.
    """
    metric, m = net.metric(places), 1 - k
    inverse, whole, s = -log(metric[k]), log(metric[0] * metric[1]), log(factor)
    return np.asarray(
        factor.second[1] / factor.value
        + inverse.first[m] * s.first[k]
        + (inverse.first[k] + 0.5 * whole.first[k]) * s.first[m]
    )


def gravitational_as_printed(net: Net, places: Floats, factor: Jet, k: int) -> Floats:
    """Return G_kk, (n,), as eq. tensordef2 prints it, to show what the slips do.

    G_kk = (d_k d_m s)/s + (d_m log g^kk + d_k log g^mm + d_k g / 2) d_k log s

    Parameters
    ----------
    net : Net
        The net.
    places : (n, 2) float
        Net coordinates, off the poles.
    factor : Jet
        s = s^kk, the factor along the axis k.
    k : int
        0 or 1; m is the other one.
    """
    metric, m = net.metric(places), 1 - k
    bracket = (
        -log(metric[k]).first[m] - log(metric[m]).first[k] + 0.5 * (metric[0] * metric[1]).first[k]
    )
    return np.asarray(factor.second[1] / factor.value + bracket * log(factor).first[k])
