"""Areas of regions by integrals over the shapes' parametrisations, independent of any mesh."""

from collections.abc import Callable

import numpy as np
from scipy.integrate import quad

from cardiosurf.geometry import Surface

Turn = Callable[[float, float], float]


def meshed(surface: Surface, name: str) -> float:
    """Return a region's area on the mesh."""
    return float(surface.areas()[surface.regions[name]].sum())


def arc_above(level: float) -> float:
    """Return how much of a full turn has cos >= level."""
    return 2.0 * float(np.arccos(np.clip(level, -1.0, 1.0)))


def vein_area(root: float, tip: float, turn: Turn, theta=(0.0, np.pi / 2)) -> float:
    """Return the area of the part of a vein that takes turn(x, rho) radians of each ring."""
    arc = root - tip

    def ring(t: float) -> float:
        rho = root - arc * np.sin(t)
        return arc * rho * turn(arc * (1.0 - np.cos(t)), rho)

    return quad(ring, *theta, limit=400, epsabs=1e-6, epsrel=1e-9)[0]


def square_area(half: float, root: float, inside: Callable[[float], tuple[float, float]]) -> float:
    """Return the area in abs(y), abs(z) <= half outside the root circle, z in inside(y)."""

    def overlap(a: float, b: float, c: float, d: float) -> float:
        return max(0.0, min(b, d) - max(a, c))

    def row(y: float) -> float:
        low, high = inside(y)
        hole = np.sqrt(max(root**2 - y**2, 0.0))
        return overlap(low, high, -half, half) - overlap(low, high, -hole, hole)

    y = -half + 2.0 * half * (np.arange(400_000) + 0.5) / 400_000
    return float(np.mean([row(one) for one in y[::20]]) * 2.0 * half)


def vein_whole(root: float, tip: float) -> float:
    """Return a vein's area, 2 pi A (root pi / 2 - A)."""
    arc = root - tip
    return 2.0 * np.pi * arc * (root * np.pi / 2 - arc)
