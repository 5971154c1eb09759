"""By which way a wave came into a target: through the entrance, or round it.

The entrance is the part of the target's edge that the unperturbed wave (isotropic tissue, same
stimulus) would meet first: where its direction makes less than 60 degrees with the inward normal.
Each activated point of the target is led back along its trajectory to where that trajectory came
into the target. Where most of the activated area (at least half) came in through the entrance, the
route is ``direct``, otherwise ``indirect``.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardiosurf.analysis.origins import carry_labels, triangle_gradients
from cardiosurf.arrays import Floats, Ints, Mask

Route = Literal["direct", "indirect"]

ENTRANCE_COSINE = 0.5


@dataclass(frozen=True)
class RouteFinding:
    """The route of a target and the share of its activated area that came by the entrance."""

    route: Route | None
    direct_fraction: float | None


def edges_of(triangles: Ints, inside: Mask) -> tuple[Ints, Ints]:
    """Return the edges between a set of triangles and the others.

    Parameters
    ----------
    triangles : (m, 3) int
        Vertex numbers.
    inside : (m,) bool
        The set.

    Returns
    -------
    edges : (k, 2) int
        Vertex numbers of the edges that have the set on one side and other tissue on the other.
    owner : (k,) int
        The triangle of the set at each.
    """
    sides = np.sort(triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(len(triangles)), 3)
    order = np.lexsort((sides[:, 1], sides[:, 0]))
    sides, owner = sides[order], owner[order]
    shared = np.flatnonzero((sides[1:] == sides[:-1]).all(axis=1))
    left, right = owner[shared], owner[shared + 1]
    between = inside[left] != inside[right]
    own = np.where(inside[left], left, right)[between]
    return sides[shared[between]], own


def entrance_vertices(
    points: Floats, triangles: Ints, inside: Mask, unperturbed: Floats
) -> tuple[Mask, Mask]:
    """Return which vertices lie on the set's edge, and which of them on its entrance.

    Parameters
    ----------
    points : (n, 3) float
        Vertices, in su.
    triangles : (m, 3) int
        Vertex numbers.
    inside : (m,) bool
        The target's triangles.
    unperturbed : (n,) float
        Arrival times (or distances) of the unperturbed wave.
    """
    edges, owner = edges_of(triangles, inside)
    on_edge = np.zeros(len(points), dtype=bool)
    on_edge[edges.ravel()] = True
    entrance = np.zeros(len(points), dtype=bool)
    if len(edges) == 0:
        return on_edge, entrance
    along = points[edges[:, 1]] - points[edges[:, 0]]
    inward = points[triangles[owner]].mean(axis=1) - points[edges[:, 0]]
    inward -= (
        along
        * (np.einsum("ij,ij->i", inward, along) / np.einsum("ij,ij->i", along, along))[:, None]
    )
    inward /= np.linalg.norm(inward, axis=1)[:, None]
    gradient = triangle_gradients(points, triangles[owner], unperturbed)
    with np.errstate(invalid="ignore"):
        cosine = np.einsum("ij,ij->i", gradient, inward) / np.linalg.norm(gradient, axis=1)
    entrance[edges[cosine > ENTRANCE_COSINE].ravel()] = True
    return on_edge, entrance


@dataclass(frozen=True)
class Map:
    """An activation map on a surface: what the route is read from.

    Attributes
    ----------
    points : (n, 3) float
    triangles : (m, 3) int
    tensor : (m, 3, 3) float
        Diffusivity, in su^2/tu.
    lat : (n,) float
        First activation, NaN where never, in tu.
    unperturbed : (n,) float
        Distance of the unperturbed wave from the stimulus, in su; 0 where stimulated.
    """

    points: Floats
    triangles: Ints
    tensor: Floats
    lat: Floats
    unperturbed: Floats


def route_into(activation: Map, inside: Mask, areas: Floats) -> RouteFinding:
    """Return the route by which the wave came into a target.

    Parameters
    ----------
    activation : Map
        The activation map.
    inside : (m,) bool
        The target's triangles.
    areas : (m,) float
        Areas of all triangles, in su^2.
    """
    chosen = inside & np.isfinite(activation.lat)[activation.triangles].all(axis=1)
    if not chosen.any():
        return RouteFinding(None, None)
    on_edge, entrance = entrance_vertices(
        activation.points, activation.triangles, inside, activation.unperturbed
    )
    # a trajectory that starts inside the target began at a stimulus there: nothing was bypassed
    labels = np.where(on_edge & ~entrance, 0.0, 1.0)
    carried = carry_labels(
        activation.points,
        activation.triangles[chosen],
        activation.tensor[chosen],
        activation.lat,
        labels,
    )
    share = carried[activation.triangles[chosen]].mean(axis=1)
    fraction = float(np.average(share, weights=areas[chosen]))
    return RouteFinding("direct" if fraction >= 0.5 else "indirect", fraction)
