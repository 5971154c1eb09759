"""The orthogonal nets of the shapes: metric, Christoffel symbols and curvatures, exactly.

A net (x^1, x^2) has the metric g_11, g_22 (g_12 = 0). All nets here are of two kinds: a flat part
with Cartesian coordinates, or a surface of revolution with x^1 even in the arclength of its
profile and x^2 = phi the angle about the axis, so that g_11 is constant and g_22 = rho^2.

Curvatures count along the normal e1 x e2: a normal curvature is above 0 where the surface bends
towards it. The mean curvature is (k_1 + k_2) / 2; a sphere of radius R with the outward normal has
-1/R. The Gaussian curvature k_1 k_2 does not depend on the normal.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Protocol

import numpy as np

from cardiosurf.arrays import Floats
from cardiosurf.geometry import AnyShape
from cardiosurf.geometry.atrium import Atrium
from cardiosurf.geometry.jets import Jet, constant
from cardiosurf.geometry.plane import Plane
from cardiosurf.geometry.profile import Profile
from cardiosurf.geometry.sphere import Sphere
from cardiosurf.geometry.t_domain import TDomain
from cardiosurf.geometry.torus import Torus
from cardiosurf.geometry.vein import Vein


class Net(Protocol):
    """An orthogonal net on one part of a shape."""

    def metric(self, net: Floats) -> tuple[Jet, Jet]:
        """Return g_11 and g_22 at net coordinates (n, 2), in su^2 (a unit of x^k)^-2."""
        ...

    def curvatures(self, net: Floats) -> tuple[Floats, Floats]:
        """Return the normal curvatures k_1, k_2 (n,) along the net's lines, in 1/su."""
        ...


@dataclass(frozen=True)
class FlatNet:
    """Cartesian coordinates on a flat part: g_11 = g_22 = 1."""

    def metric(self, net: Floats) -> tuple[Jet, Jet]:
        """Return 1 and 1."""
        return constant(1.0, len(net)), constant(1.0, len(net))

    def curvatures(self, net: Floats) -> tuple[Floats, Floats]:
        """Return 0 and 0."""
        return np.zeros(len(net)), np.zeros(len(net))


@dataclass(frozen=True)
class RevolvedNet:
    """The net (theta, phi) that a profile makes when it is turned about its axis.

    With s = start + rate theta, the radius rho(s), the heading alpha(s) and the curvature kappa(s)
    of the profile: g_11 = rate^2, g_22 = rho^2, d rho / ds = cos alpha, k_1 = kappa,
    k_2 = sin alpha / rho.

    Parameters
    ----------
    profile : Profile
        (rho, z)(s), with the z axis to which rho, phi and z are right-handed.
    start : float
        Arclength where theta is 0, in su.
    rate : float
        Arclength per radian of theta, in su.
    """

    profile: Profile
    start: float
    rate: float

    def _stations(self, net: Floats) -> Floats:
        return np.asarray(self.start + self.rate * np.asarray(net)[:, 0])

    def radius(self, net: Floats) -> Jet:
        """Return rho, the distance from the axis, in su."""
        s = self._stations(net)
        (rho, _), (outward, upward) = self.profile.at(s), self.profile.tangent(s)
        none = np.zeros_like(rho)
        bend = -(self.rate**2) * self.profile.curvature(s) * upward
        return Jet(rho, np.stack([self.rate * outward, none]), np.stack([bend, none, none]))

    def metric(self, net: Floats) -> tuple[Jet, Jet]:
        """Return rate^2 and rho^2."""
        rho = self.radius(net)
        return constant(self.rate**2, len(net)), rho * rho

    def curvatures(self, net: Floats) -> tuple[Floats, Floats]:
        """Return kappa and sin alpha / rho; kappa jumps where the profile's bows meet."""
        s = self._stations(net)
        (rho, _), (_, upward) = self.profile.at(s), self.profile.tangent(s)
        return self.profile.curvature(s), upward / rho


def christoffel(net: Net, places: Floats) -> Floats:
    """Return the Christoffel symbols of the second kind.

        Gamma^k_kk = d_k g_kk / 2 g_kk,  Gamma^k_km = d_m g_kk / 2 g_kk,
        Gamma^k_mm = -d_k g_mm / 2 g_kk,  m != k

    Parameters
    ----------
    net : Net
        The net.
    places : (n, 2) float
        Net coordinates. At a pole (g_22 = 0) the symbols with phi are not defined.

    Returns
    -------
    (n, 2, 2, 2) float
        Gamma^i_jk at [:, i, j, k].
    """
    metric = net.metric(places)
    found = np.zeros((len(places), 2, 2, 2))
    for k in range(2):
        m, half = 1 - k, 0.5 / metric[k].value
        found[:, k, k, k] = half * metric[k].first[k]
        found[:, k, k, m] = found[:, k, m, k] = half * metric[k].first[m]
        found[:, k, m, m] = -half * metric[m].first[k]
    return found


def gaussian_curvature(net: Net, places: Floats) -> Floats:
    """Return the Gaussian curvature k_1 k_2, (n,), in 1/su^2.

    Parameters
    ----------
    net : Net
        The net.
    places : (n, 2) float
        Net coordinates.
    """
    first, second = net.curvatures(places)
    return np.asarray(first * second)


def mean_curvature(net: Net, places: Floats) -> Floats:
    """Return the mean curvature (k_1 + k_2) / 2 along e1 x e2, (n,), in 1/su.

    Parameters
    ----------
    net : Net
        The net.
    places : (n, 2) float
        Net coordinates.
    """
    first, second = net.curvatures(places)
    return np.asarray(0.5 * (first + second))


def lemma_d_sides(net: Net, places: Floats, k: int) -> tuple[Floats, Floats, Floats]:
    """Return both sides of the paper's Lemma D, and what is missing between them, each (n,).

        (1/sqrt g) d_k (sqrt g g^kk) = g^kk Gamma^m_mk - g^kk Gamma^k_kk

    holds on every orthogonal net (eq. AD3final). The Lemma leaves the last term out, so it holds
    exactly where d_k g_kk = 0: x^k runs evenly along its own lines. That x^m is a Killing
    direction, the condition of the Lemma, does not give this.

    Parameters
    ----------
    net : Net
        The net.
    places : (n, 2) float
        Net coordinates.
    k : int
        0 or 1; m is the other one.

    Returns
    -------
    left, right, missing : (n,) float
        The left side, g^kk Gamma^m_mk, and -g^kk Gamma^k_kk.

    Notes
    -----
    Source: Chun's paper, Appendix D.
    """
    metric, m = net.metric(places), 1 - k
    root = (metric[0] * metric[1]).power(0.5)
    left = (root / metric[k]).first[k] / root.value
    symbols = christoffel(net, places)
    inverse = 1.0 / metric[k].value
    return left, inverse * symbols[:, m, m, k], -inverse * symbols[:, k, k, k]


def _plane_nets(shape: Plane) -> dict[str, Net]:
    return {"plane": FlatNet()}


def vein_net(root_radius: float, tip_radius: float) -> RevolvedNet:
    """Return the net (theta, phi) of a vein: g_11 = A^2, g_22 = (root - A sin theta)^2.

    Parameters
    ----------
    root_radius, tip_radius : float
        Radii of the root circle (theta = 0) and of the tip (theta = pi/2), in su; A is their
        difference.

    Notes
    -----
    Source: Chun's paper, section 5.2 and Appendix E (R = A, r = tip_radius).
    """
    arc = root_radius - tip_radius
    # seen from +x, phi turns clockwise: rho, phi and -x are right-handed
    bows = ((1.0 / arc, 0.5 * np.pi * arc),)
    return RevolvedNet(Profile((root_radius, 0.0), np.pi, bows), 0.0, arc)


def _square_nets(shape: Vein) -> dict[str, Net]:
    return {"square": FlatNet(), "vein": vein_net(shape.root_radius, shape.tip_radius)}


def _t_domain_nets(shape: TDomain) -> dict[str, Net]:
    vein = vein_net(shape.root_radius, shape.tip_radius)
    return {"vein": vein, "right_rectangle": FlatNet(), "left_rectangle": FlatNet()}


def _sphere_nets(shape: Sphere) -> dict[str, Net]:
    radius = shape.radius
    bows = ((-1.0 / radius, np.pi * radius),)
    return {"sphere": RevolvedNet(Profile((0.0, radius), 0.0, bows), 0.0, radius)}


def _revolved_nets(shape: Torus | Atrium) -> dict[str, Net]:
    sheet = shape.sheet(1.0)
    s, theta = np.array(sheet.stations), np.array(sheet.angles)
    rates = np.diff(s) / np.diff(theta)
    starts = s[:-1] - rates * theta[:-1]
    return {
        part: RevolvedNet(sheet.profile, float(start), float(rate))
        for part, start, rate in zip(sheet.parts, starts, rates, strict=True)
    }


NETS: Mapping[str, Callable[[Any], dict[str, Net]]] = MappingProxyType(
    {
        "plane": _plane_nets,
        "vein": _square_nets,
        "t_domain": _t_domain_nets,
        "sphere": _sphere_nets,
        "torus": _revolved_nets,
        "atrium": _revolved_nets,
    }
)
"""For each kind of shape, what gives the nets of its parts."""


def nets_of(shape: AnyShape) -> dict[str, Net]:
    """Return the net of each part of a shape, by the part's name.

    Parameters
    ----------
    shape : shape section
        One of ``SHAPES``.
    """
    return NETS[shape.kind](shape)
