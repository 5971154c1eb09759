"""Net angles theta and phi at the corners of a surface's triangles, from those in their middles."""

import numpy as np

from cardiosurf.arrays import Floats, Ints
from cardiosurf.geometry.surface import Surface
from cardiosurf.geometry.topology import twins


def sphere_angles(surface: Surface) -> tuple[Floats, Floats]:
    """Return theta and phi of each triangle's corners on a sphere, each (m, 3), in radians.

    The pole follows from the angles in the middles; phi is not wrapped.
    """
    theta, phi = surface.net.T
    local = np.stack(
        [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=1
    )
    corners = surface.points[surface.triangles]
    middles = corners.mean(axis=1)
    middles /= np.linalg.norm(middles, axis=1)[:, None]
    basis = np.linalg.lstsq(middles, local, rcond=None)[0]
    x, y, z = np.moveaxis(corners @ basis, 2, 0)
    return np.arctan2(np.hypot(x, y), z), np.where(
        np.hypot(x, y) < 1e-9 * np.abs(corners).max(), phi[:, None], np.arctan2(y, x)
    )


def revolved_angles(surface: Surface) -> tuple[Floats, Floats]:
    """Return theta and phi of each corner on a surface of revolution, each (m, 3), in radians.

    The axis x = c, y = 0 follows from phi in the middles, (x - c) sin phi = y cos phi; theta grows
    evenly along the meridians of a part, e_theta . grad theta being constant there. Not wrapped.
    """
    corners = surface.points[surface.triangles]
    middles = corners.mean(axis=1)
    theta, phi = surface.net.T
    sine, cosine = np.sin(phi), np.cos(phi)
    axis = sine @ (sine * middles[:, 0] - cosine * middles[:, 1]) / (sine @ sine)
    azimuth = np.arctan2(corners[:, :, 1], corners[:, :, 0] - axis)
    rate = _rates(surface, middles, theta)[surface.part_of]
    along = np.einsum("mkd,md->mk", corners - middles[:, None], surface.frame[:, 0])
    guess = np.exp(1j * (theta[:, None] + along * rate[:, None]))
    # the triangles around a vertex all have a say
    names = surface.triangles.ravel()
    count = len(surface.points)
    mean = np.bincount(names, guess.real.ravel(), count) + 1j * np.bincount(
        names, guess.imag.ravel(), count
    )
    turned = np.angle(mean[surface.triangles] * np.exp(-1j * theta)[:, None])
    return theta[:, None] + turned, azimuth


def _rates(surface: Surface, middles: Floats, theta: Floats) -> Floats:
    """Return the growth of theta along the meridians of each part, in radians per su."""
    twin = twins(surface.triangles)
    one = np.flatnonzero(twin >= 0)
    here, there = one // 3, twin[one] // 3
    same: Ints = surface.part_of[here]
    way = np.einsum("kd,kd->k", middles[there] - middles[here], surface.frame[here, 0])
    grown = np.angle(np.exp(1j * (theta[there] - theta[here])))
    inner = same == surface.part_of[there]
    parts = len(surface.parts)
    total = np.bincount(same[inner], (way * grown)[inner], parts)
    return total / np.bincount(same[inner], (way * way)[inner], parts)
