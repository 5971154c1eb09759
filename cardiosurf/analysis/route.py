"""By which way a wave came into a target: through the entrance, or round it.

The entrance is the part of the target's edge that the unperturbed wave (isotropic tissue, same
stimulus) would meet first: where its direction makes less than 60 degrees with the inward normal.
A place on the entrance was *crossed* when the tissue one front width behind it was excited along
trajectories that came in there. Where at least half of the entrance's length was crossed, the route
is ``direct``, otherwise ``indirect``.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
import scipy

from cardiosurf.analysis.eikonal import distance_from
from cardiosurf.analysis.origins import carry_labels, triangle_gradients
from cardiosurf.analysis.sources import Sources
from cardiosurf.arrays import Floats, Ints, Mask

Route = Literal["direct", "indirect"]

ENTRANCE_COSINE = 0.5
FRONT_WIDTH = 12.0
"""10-90 % width of a front in su: so far a front that is blocked still reaches."""
SIDEWAYS = 1.5
"""How far along the entrance a trajectory may drift, in units of its depth (about 56 degrees)."""


@dataclass(frozen=True)
class RouteFinding:
    """The route of a target and the share of its entrance's length that the wave crossed."""

    route: Route | None
    direct_fraction: float | None


@dataclass(frozen=True)
class Map:
    """An activation map on a surface: what the route is read from.

    Attributes
    ----------
    points : (n, 3) float
    triangles : (m, 3) int
    tensor : (m, 3, 3) float
        Diffusivity, in su^2/tu.
    excitable : (m,) bool
    lat : (n,) float
        First activation, NaN where never, in tu.
    wave : callable
        Returns ``unperturbed``. It is called where a wave came into a target with an entrance, and
        not before: an eikonal equation is to be solved for it.
    """

    points: Floats
    triangles: Ints
    tensor: Floats
    excitable: Mask
    lat: Floats
    wave: Callable[[], Floats]

    @cached_property
    def unperturbed(self) -> Floats:
        """When a wave that nothing disturbs would arrive from the stimuli that captured, (n,).

        Times its speed, in su; or in tu: only its direction counts.
        """
        return self.wave()


def edges_of(triangles: Ints, inside: Mask, outside: Mask) -> tuple[Ints, Ints]:
    """Return the edges between two sets of triangles.

    Parameters
    ----------
    triangles : (m, 3) int
        Vertex numbers.
    inside, outside : (m,) bool
        The sets; nothing is in both.

    Returns
    -------
    edges : (k, 2) int
        Vertex numbers of the edges that have one set on one side and one on the other.
    owner : (k,) int
        The triangle inside at each.
    """
    of_inside, of_outside = np.zeros((2, int(triangles.max(initial=0)) + 1), dtype=np.bool_)
    of_inside[triangles[inside]] = True
    of_outside[triangles[outside]] = True
    near = np.flatnonzero((of_inside & of_outside)[triangles].sum(axis=1) > 1)
    sides = np.sort(triangles[near][:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
    owner = np.repeat(near, 3)
    order = np.lexsort((sides[:, 1], sides[:, 0]))
    sides, owner = sides[order], owner[order]
    shared = np.flatnonzero((sides[1:] == sides[:-1]).all(axis=1))
    left, right = owner[shared], owner[shared + 1]
    between = (inside[left] & outside[right]) | (inside[right] & outside[left])
    own = np.where(inside[left], left, right)[between]
    return sides[shared[between]], own


def entrance_weights(activation: Map, inside: Mask) -> Floats:
    """Return the length of entrance that belongs to each vertex.

    The edge between the target and tissue that is not excitable is no entrance.

    Parameters
    ----------
    activation : Map
        The surface and the unperturbed wave.
    inside : (m,) bool
        The target's triangles.

    Returns
    -------
    (n,) float
        Half the length of the adjoining entrance edges, in su; 0 off the entrance.
    """
    edges = entrance_edges(activation, inside)
    sides = activation.points[edges[:, 1]] - activation.points[edges[:, 0]]
    halves = np.repeat(0.5 * np.linalg.norm(sides, axis=1), 2)
    weights = np.bincount(edges.ravel(), weights=halves, minlength=len(activation.points))
    return weights.astype(np.float64)


def entrance_edges(activation: Map, inside: Mask, cosine: float = ENTRANCE_COSINE) -> Ints:
    """Return the edges at which the unperturbed wave enters a set of triangles.

    Parameters
    ----------
    activation : Map
        The surface and the unperturbed wave.
    inside : (m,) bool
        The set.
    cosine : float
        Of the largest angle between the wave's direction and the inward normal.

    Returns
    -------
    (k, 2) int
        Vertex numbers.
    """
    points, triangles = activation.points, activation.triangles
    edges, owner = edges_of(triangles, inside, activation.excitable & ~inside)
    if not len(edges):
        return edges
    along = points[edges[:, 1]] - points[edges[:, 0]]
    squared = np.einsum("ij,ij->i", along, along)
    inward = points[triangles[owner]].mean(axis=1) - points[edges[:, 0]]
    inward -= along * (np.einsum("ij,ij->i", inward, along) / squared)[:, None]
    inward /= np.linalg.norm(inward, axis=1)[:, None]
    gradient = triangle_gradients(points, triangles[owner], activation.unperturbed)
    steepness = np.linalg.norm(gradient, axis=1)
    enters = np.einsum("ij,ij->i", gradient, inward) > cosine * steepness
    return np.asarray(edges[enters])


def route_into(activation: Map, inside: Mask) -> RouteFinding:
    """Return the route by which the wave came into a target.

    Parameters
    ----------
    activation : Map
        The activation map.
    inside : (m,) bool
        The target's triangles.
    """
    active = inside & np.isfinite(activation.lat)[activation.triangles].all(axis=1)
    if not active.any():
        return RouteFinding(None, None)
    weights = entrance_weights(activation, inside)
    if not weights.any():
        # nothing to pass: the stimulus lies inside, or the target is all there is
        return RouteFinding("direct", 1.0)
    fraction = _crossed_fraction(activation, inside, active, weights)
    return RouteFinding("direct" if fraction >= 0.5 else "indirect", fraction)


def _crossed_fraction(activation: Map, inside: Mask, active: Mask, weights: Floats) -> float:
    """Return the share of the entrance's length behind which the wave came in by it."""
    points = activation.points
    entrance = np.flatnonzero(weights)
    depth = distance_from(points, activation.triangles[inside], Sources.at(entrance))
    edge = float(np.sqrt(np.median(_squared_edges(points, activation.triangles[inside]))))
    own = np.flatnonzero(np.isfinite(depth))
    nearest = np.asarray(scipy.spatial.cKDTree(points[entrance]).query(points[own])[1])
    # a thin target is no deeper than this behind most of its entrance
    thickness = np.zeros(len(entrance))
    np.maximum.at(thickness, nearest, depth[own])
    behind = min(FRONT_WIDTH, 0.5 * float(np.median(thickness)))
    near = (depth[own] >= behind) & (depth[own] <= behind + 1.5 * edge)
    layer, nearest = own[near], nearest[near]
    # what comes from the entrance carries the place where it came in
    labels = np.zeros((len(points), 4))
    labels[entrance, 0] = 1.0
    labels[entrance, 1:] = points[entrance]
    carried = carry_labels(
        points,
        activation.triangles[active],
        activation.tensor[active],
        activation.lat,
        labels,
    )[layer]
    with np.errstate(invalid="ignore", divide="ignore"):
        came_in = carried[:, 1:] / carried[:, :1]
        drift = np.linalg.norm(came_in - points[entrance[nearest]], axis=1)
        crossed = (carried[:, 0] >= 0.5) & (drift <= SIDEWAYS * behind + edge)
    seen = np.bincount(nearest, minlength=len(entrance))
    share = np.bincount(nearest, weights=crossed, minlength=len(entrance))
    known = seen > 0
    if not known.any():
        return 0.0
    return float(np.average(share[known] / seen[known], weights=weights[entrance[known]]))


def _squared_edges(points: Floats, triangles: Ints) -> Floats:
    sides = points[triangles] - points[np.roll(triangles, 1, axis=1)]
    squared: Floats = np.einsum("mij,mij->mi", sides, sides)
    return squared
