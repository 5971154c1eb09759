"""Flat and round meshes for arrivals and trajectories, and the exact times on them."""

import numpy as np
from scipy.spatial import ConvexHull, Delaunay

from cardiosurf.analysis.conductor import Conductor

RADIUS = 50.0


def square(step, half=50.0, seed=0):
    """A jittered square [-half, half]^2 with a mesh line along x = 0, in the plane z = 0."""
    line = np.linspace(-half, half, 2 * round(half / step) + 1)
    x, y = np.meshgrid(line, line, indexing="ij")
    points = np.c_[x.ravel(), y.ravel(), np.zeros(x.size)]
    inner = (np.abs(points[:, :2]) < half - step / 2).all(axis=1) & (points[:, 0] != 0.0)
    points[inner, :2] += np.random.default_rng(seed).uniform(-0.2, 0.2, (inner.sum(), 2)) * step
    return points, Delaunay(points[:, :2]).simplices.astype(np.int64)


def conductor(points, triangles, tensor=None):
    """The mesh with one tensor (3, 3), or one a triangle; isotropic without."""
    tensor = np.eye(3) if tensor is None else tensor
    return Conductor(points, triangles, np.broadcast_to(tensor, (len(triangles), 3, 3)))


def halves(points, triangles, left, right):
    """The mesh with isotropic diffusivities left and right of x = 0."""
    on_right = points[triangles, 0].mean(axis=1) > 0.0
    return conductor(points, triangles, np.where(on_right, right, left)[:, None, None] * np.eye(3))


def through_halves(points, source, slow, fast):
    """Exact times from a source at x < 0 where the speed is ``slow``; ``fast`` where x > 0.

    Fermat: the least over where a ray crosses x = 0, and for points at x < 0 over rays that run
    along x = 0 for a while (head wave), which leave it at the critical angle.
    """
    away = points - source
    direct = np.hypot(away[:, 0], away[:, 1]) / slow
    critical = np.arcsin(slow / fast)
    depth, behind = -source[0], np.abs(points[:, 0])
    along = np.abs(away[:, 1]) - (depth + behind) * np.tan(critical)
    head = (depth + behind) / (slow * np.cos(critical)) + along / fast
    times = np.where(along > 0.0, np.minimum(direct, head), direct)
    for i in np.flatnonzero(points[:, 0] > 0.0):
        times[i] = _refracted(depth, behind[i], abs(away[i, 1]), slow, fast)
    return times


def _refracted(depth, behind, height, slow, fast):
    """Least time over the crossing point, by bisection of its derivative."""
    low, high = 0.0, height
    for _ in range(60):
        y = 0.5 * (low + high)
        slope = y / (slow * np.hypot(depth, y)) - (height - y) / (
            fast * np.hypot(behind, height - y)
        )
        low, high = (low, y) if slope > 0.0 else (y, high)
    return np.hypot(depth, y) / slow + np.hypot(behind, height - y) / fast


def fibonacci_sphere(count):
    """A sphere of even, irregular triangles."""
    index = np.arange(count) + 0.5
    polar = np.arccos(1 - 2 * index / count)
    azimuth = np.pi * (1 + 5**0.5) * index
    unit = np.c_[np.cos(azimuth) * np.sin(polar), np.sin(azimuth) * np.sin(polar), np.cos(polar)]
    hull = ConvexHull(unit).simplices.astype(np.int64)
    a, b, c = (unit[hull[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0
    hull[inward] = hull[inward][:, [0, 2, 1]]
    return RADIUS * unit, hull


def rings(step, inner, outer, radius=np.inf):
    """Triangles between two circles about a point, on the plane or on a sphere; the distance (n,).

    The first circle has the first vertices, and every circle as many; the second circle is turned
    by half a triangle against the first, and so on. So the circles are mesh lines.
    """
    distance = np.linspace(inner, outer, round((outer - inner) / step) + 1)
    count = round(np.pi * (inner + outer) / step)
    turn = np.arange(count) + 0.5 * np.arange(len(distance))[:, None]
    angle = 2.0 * np.pi / count * turn.ravel()
    r = np.repeat(distance, count)
    across, height = r, np.zeros_like(r)
    if np.isfinite(radius):
        across, height = radius * np.sin(r / radius), radius * np.cos(r / radius)
    here = (np.arange(len(distance) - 1)[:, None] * count + np.arange(count)).ravel()
    beside = here // count * count + (here + 1) % count
    lower = np.c_[here, here + count, beside]
    upper = np.c_[beside, here + count, beside + count]
    points = np.c_[across * np.cos(angle), across * np.sin(angle), height]
    return points, np.concatenate((lower, upper)), r
