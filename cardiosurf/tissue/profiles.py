"""Profiles of stimuli on a mesh: means over the hat functions of what the formulas say.

A profile has steep edges: the author's disc jumps by 0.6, his plane wave falls within 0.1 su.
Values at the vertices would make it larger or smaller by up to half a mesh edge, by chance, and
shift every activation by the time that a wave takes for it (docs/numerics.md).
"""

import numpy as np
import scipy

from cardiosurf.arrays import Floats, Mask
from cardiosurf.errors import InputError
from cardiosurf.geometry.nearest import nearest_point
from cardiosurf.geometry.regions import Vector
from cardiosurf.geometry.surface import Surface
from cardiosurf.geometry.topology import corners_in
from cardiosurf.spelling import did_you_mean
from cardiosurf.tissue.averaging import hat_means
from cardiosurf.tissue.distance import distance_to_segments

_FADED = 40.0
"""This many widths beyond its position a plane wave's profile is 0 to double precision."""


def disc_profile(surface: Surface, centre: Vector, radius: float, key: str) -> Floats:
    """Return exp(-r^2 / (2 radius^2)) within a disc and 0 outside, (n,).

    Parameters
    ----------
    surface : Surface
        The mesh.
    centre : (3,) float
        The disc's centre is the surface point nearest to it; r is the distance from there.
    radius : float
        Of the disc, in su.
    key : str
        Key path of the stimulus, for messages.

    Raises
    ------
    InputError
        If the centre is farther from the surface than the radius, or no vertex is in the disc.
    """
    near = nearest_point(surface, np.asarray(centre))
    if near.distance > radius:
        # rounded, and plus 0 to turn -0 into 0
        closest = ", ".join(f"{coordinate:g}" for coordinate in near.point.round(3) + 0.0)
        raise InputError(
            f"{key}.centre",
            f"{list(centre)} is {near.distance:.4g} su away from the surface",
            f"a point within radius ({radius:g} su) of the surface",
            f"the nearest surface point, [{closest}]",
        )
    r = np.linalg.norm(surface.points - near.point, axis=1)
    if r.min() >= radius:
        raise InputError(
            f"{key}.radius",
            f"no vertex of the mesh lies within {radius:g} su of the centre",
            f"a radius above {r.min():.4g} on this mesh",
            "a larger radius, or a smaller mesh.edge_length",
        )

    def disc(places: Floats) -> Floats:
        away = np.linalg.norm(places - near.point, axis=1)
        return np.where(away < radius, np.exp(-0.5 * (away / radius) ** 2), 0.0)

    return hat_means(surface, disc, surface.points, _around(surface, r < radius))


def edge_profile(surface: Surface, edge: str, position: float, width: float, key: str) -> Floats:
    """Return 1/(1 + exp((s - position)/width)), s the distance from an open edge, (n,).

    Parameters
    ----------
    surface : Surface
        The mesh.
    edge : str
        Name of the open edge.
    position, width : float
        Where the profile is one half, and how fast it falls, in su.
    key : str
        Key path of the stimulus, for messages.

    Raises
    ------
    InputError
        If the surface has no such edge.
    """
    if edge not in surface.edges:
        names = sorted(surface.edges)
        raise InputError(
            f"{key}.edge",
            f"the surface has no open edge {edge!r}",
            ", ".join(names) if names else "none: this surface is closed",
            did_you_mean(edge, names) or ("" if names else "shape: point, or region"),
        )
    segments = surface.points[surface.edges[edge]]
    # farther from the edge the profile is 0, and the distance of no use
    reach = position + _FADED * width
    half = 0.5 * float(np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).max())
    middles = scipy.spatial.cKDTree(segments.mean(axis=1))
    found = middles.query(surface.points, distance_upper_bound=reach + half)[0]
    near = _around(surface, np.isfinite(found))
    asked = np.unique(surface.triangles[near])
    s = np.full(len(surface.points), np.inf)
    s[asked] = distance_to_segments(surface.points[asked], segments[:, 0], segments[:, 1])
    return hat_means(surface, lambda s: _fading((s - position) / width), s, near)


def _fading(x: Floats) -> Floats:
    """Return 1/(1 + exp(x))."""
    values: Floats = scipy.special.expit(-x)
    return values


def region_profile(surface: Surface, key: str) -> Floats:
    """Return 1 on a region and 0 elsewhere, (n,).

    Parameters
    ----------
    surface : Surface
        The mesh, which has lines along the region's edge.
    key : str
        The region's name, and the key path of the stimulus.

    Raises
    ------
    InputError
        If the region is empty.
    """
    mask = surface.regions[key]
    if not mask.any():
        raise InputError(
            f"{key}.region",
            "the region is empty: it holds no triangle of the surface",
            "a region that lies on the surface",
            "cardiosurf mesh prints the extent of the surface",
        )
    shares, corners = np.repeat(surface.areas(), 3), surface.triangles.ravel()
    inside = np.bincount(corners, shares * np.repeat(mask, 3), len(surface.points))
    profile: Floats = inside / np.bincount(corners, shares, len(surface.points))
    return profile


def _around(surface: Surface, felt: Mask) -> Mask:
    """Return the triangles within one ring of a vertex where a profile is felt, (m,)."""
    ring = felt.copy()
    ring[surface.triangles[corners_in(felt, surface.triangles) > 0]] = True
    return corners_in(ring, surface.triangles) > 0
