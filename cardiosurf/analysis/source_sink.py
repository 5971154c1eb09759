"""Source and sink at a patch's edge: the flux that a front needs beyond it, and what it brings.

A front that arrives at T has u = U(t - T), so the flux across the edge is n . d grad u = -U' n . d
grad T. Along the edge both sides have the same slowness s = sin A/(c0 sqrt(d0)), A the angle of
incidence in tissue of diffusivity d0, and c0^2 grad T . d grad T = 1 leaves (det d in the surface)

    n . d grad T = sqrt(d_nn - det(d) c0^2 s^2)/c0,

sqrt(d0) cos A where d = d0. The ratio of both sides, with what the front's curvature K takes from
its speed, is that of the flux needed to the flux available:

    ratio = sqrt|d_nn - det(d) c0^2 s^2|, within / (the same, before) / (1 - g sqrt(d0) K/c0)

Head on it is sqrt(d2/d1), and a straight front of the kinetics passes up to sqrt(critical_jump).
Beyond the critical angle the root is imaginary: no front of the eikonal equation goes on with the
one outside, the field ahead of it runs off along the patch. Its modulus then stands for the load;
that is a guess. Fibres along the normal have d_nn - det(d) c0^2 s^2 = d_nn cos^2 A if their
transverse diffusivity is d0: the ratio does not depend on the angle.
"""

from dataclasses import dataclass

import numpy as np

from cardiosurf.arrays import Floats, Mask


@dataclass(frozen=True)
class Edge:
    """Diffusivities at places of an edge.

    Attributes
    ----------
    normal, tangential, mixed : (k,) float
        d_nn, d_tt and d_nt of the tensor, n across the edge, t along it, in su^2/tu.
    """

    normal: Floats
    tangential: Floats
    mixed: Floats

    @classmethod
    def of(cls, tensor: Floats, across: Floats, along: Floats) -> "Edge":
        """Return the parts of tensors (k, 3, 3) for unit vectors (k, 3) across and along."""

        def part(left: Floats, right: Floats) -> Floats:
            return np.asarray(np.einsum("ki,kij,kj->k", left, tensor, right))

        return cls(part(across, across), part(along, along), part(across, along))

    def only(self, chosen: Mask) -> "Edge":
        """Return the same at some of the places (k,)."""
        return Edge(self.normal[chosen], self.tangential[chosen], self.mixed[chosen])

    def flux_squared(self, trace: Floats) -> Floats:
        """Return d_nn - det(d) c0^2 s^2 for the slowness c0 s along the edge, in su^2/tu."""
        determinant = self.normal * self.tangential - self.mixed**2
        return self.normal - determinant * trace**2


def flux_ratio(before: Edge, within: Edge, trace: Floats) -> Floats:
    """Return the flux needed beyond an edge in units of that of the straight front before it.

    Parameters
    ----------
    before, within : Edge
        The diffusivities on both sides.
    trace : (k,) float
        c0 s = sin A/sqrt(d0), the slowness along the edge, in sqrt(tu)/su.
    """
    available = np.maximum(before.flux_squared(trace), 0.0)
    with np.errstate(divide="ignore"):
        return np.asarray(np.sqrt(np.abs(within.flux_squared(trace)) / available))


def curvature_number(
    ambient: Floats | float, curvature: Floats, factor: float, speed: float
) -> Floats:
    """Return g sqrt(d) K/c0, what curvature takes from a front's speed; it stands still at 1.

    Parameters
    ----------
    ambient : float or (k,) float
        d in the front's direction, in su^2/tu.
    curvature : (k,) float
        K, positive where the front diverges, in 1/su.
    factor, speed : float
        g (``curvature_factor``), and c0 in su/tu (``planar_speed``).
    """
    return np.asarray(factor * np.sqrt(ambient) * curvature / speed)


def with_curvature(ratio: Floats, number: Floats) -> Floats:
    """Return ratio/(1 - number), infinite where the front stands still before it arrives.

    Parameters
    ----------
    ratio : (k,) float
        That of the fluxes of straight fronts.
    number : (k,) float
        The curvature number before the edge.
    """
    left = 1.0 - number
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(left > 0.0, ratio / left, np.inf))
