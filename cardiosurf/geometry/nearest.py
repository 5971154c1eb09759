"""The point of a triangulated surface nearest to a given point."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.arrays import Floats
from cardiosurf.geometry.surface import Surface
from cardiosurf.geometry.topology import corners_in, edge_lengths


@dataclass(frozen=True)
class Nearest:
    """A point of the surface.

    Attributes
    ----------
    point : (3,) float
        Where it is, in su.
    distance : float
        How far the given point is from it, in su.
    triangle : int
        The triangle it lies in.
    weights : (3,) float
        Its barycentric weights: a field's value there is weights @ field[triangles[triangle]].
    """

    point: Floats
    distance: float
    triangle: int
    weights: Floats


def nearest_point(surface: Surface, point: Floats) -> Nearest:
    """Return the point of the surface's triangles nearest to a point (3,)."""
    target = np.asarray(point, dtype=np.float64)
    away = np.linalg.norm(surface.points - target, axis=1)
    # a triangle as near as the nearest vertex has a vertex not a longest edge farther away
    limit = away.min() + edge_lengths(surface.points, surface.triangles).max()
    rows = np.flatnonzero(corners_in(away <= limit, surface.triangles))
    corners = surface.points[surface.triangles[rows]]
    # of these, only triangles whose circle about their centroid may reach in need a closer look
    centre = corners.mean(axis=1)
    reach = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
    away = np.linalg.norm(centre - target, axis=1)
    close = np.flatnonzero(away - reach <= (away + reach).min())
    weights = _weights(corners[close], target)
    places = np.einsum("ki,kid->kd", weights, corners[close])
    distance = np.linalg.norm(places - target, axis=1)
    best = int(np.argmin(distance))
    return Nearest(places[best], float(distance[best]), int(rows[close[best]]), weights[best])


def _weights(corners: Floats, target: Floats) -> Floats:
    """Return the barycentric weights (k, 3) of the nearest point of each triangle."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    offset = target - corners[:, 0]
    a, b, c = (
        np.einsum("kd,kd->k", *pair) for pair in ((first, first), (first, second), (second, second))
    )
    d, e = np.einsum("kd,kd->k", first, offset), np.einsum("kd,kd->k", second, offset)
    scale = np.maximum(a * c - b * b, 1e-300)
    u, v = (c * d - b * e) / scale, (a * e - b * d) / scale
    inner = np.stack([1.0 - u - v, u, v], axis=1)
    candidates = [inner]
    for one in range(3):
        other = (one + 1) % 3
        side = corners[:, other] - corners[:, one]
        share = np.einsum("kd,kd->k", target - corners[:, one], side)
        share = np.clip(share / np.maximum(np.einsum("kd,kd->k", side, side), 1e-300), 0.0, 1.0)
        weights = np.zeros_like(inner)
        weights[:, one], weights[:, other] = 1.0 - share, share
        candidates.append(weights)
    stacked = np.stack(candidates)
    places = np.einsum("jki,kid->jkd", stacked, corners)
    distance = np.linalg.norm(places - target, axis=2)
    distance[0, (inner < 0).any(axis=1)] = np.inf
    return np.asarray(stacked[np.argmin(distance, axis=0), np.arange(len(corners))])
