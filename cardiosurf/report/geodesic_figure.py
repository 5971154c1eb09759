"""Geodesics of the vein: section 5.1's G-iii as a figure (``make figures``)."""

from functools import cache

import numpy as np
import scipy
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cardiosurf.arrays import Floats
from cardiosurf.geometry.geodesics import Geodesic, circle_curvature, geodesic
from cardiosurf.geometry.nets import vein_net
from cardiosurf.report.canvas import INK, NEVER, STIMULUS, new_figure

ROOT, TIP = 70.0, 35.0
RIM = 0.5 * np.pi
AWAY = "#0072b2"
STARTS = (0.25, 0.6, 0.95, 1.25, 1.45)
"""Where geodesics are started along a circle."""
SPANS = (0.25, 0.5, 0.75, 1.0)
"""How far apart in phi two points of the root are, over pi."""
RATIOS = {0.5: AWAY, 1.0: INK, 2.0: STIMULUS}


def tangential(theta: float, length: float = 600.0) -> Geodesic:
    """Return the geodesic that starts along the circle of ``theta``, down to the vein's root."""
    return geodesic(vein_net(ROOT, TIP), (theta, 0.0), RIM, length, within=(0.0, RIM))


@cache
def summit(span: float) -> float:
    """Return how high the shortest way between two points of the root climbs, as theta.

    By symmetry it is highest half way, where it runs along a circle.

    Parameters
    ----------
    span : float
        How far apart the points are in phi, in radians.
    """

    def missing(theta: float) -> float:
        return float(tangential(theta).places[-1, 1] - 0.5 * span)

    return float(scipy.optimize.brentq(missing, 1e-3, RIM - 1e-6, xtol=1e-9))


def geodesics() -> Figure:
    """Return geodesics from circles, geodesics between points of the root, circles' curvature."""
    figure = new_figure(
        10.5,
        4.0,
        f"Geodesics of the vein (root {ROOT:g}, tip {TIP:g}), seen along its axis",
        "only the circle at the tip is a geodesic; all others bend towards the tip",
    )
    left, middle, right = figure.subplots(1, 3)
    _leaving(left)
    _climbing(middle)
    _curvatures(right)
    return figure


def _leaving(axes: Axes) -> None:
    """Draw geodesics that start along circles, and go straight on where they reach the plane."""
    _circles(axes, STARTS)
    for k, theta in enumerate(STARTS):
        line = tangential(theta)
        points = _seen(line.places + np.array([0.0, 2.0 * np.pi * k / len(STARTS)]))
        last = points[-1] - points[-2]
        out = points[-1] + 30.0 * last / np.linalg.norm(last)
        axes.plot(*np.vstack([points, out]).T, color=AWAY, linewidth=1.4)
        axes.plot(*points[0], "o", color=STIMULUS, markersize=4)
    axes.set(title="started along a circle", xlim=(-100, 100), ylim=(-100, 100), xlabel="y [su]")
    axes.set_ylabel("z [su]")


def _climbing(axes: Axes) -> None:
    """Draw the shortest ways over the vein between points of its root."""
    _circles(axes, ())
    for part in SPANS:
        line = tangential(summit(part * np.pi))
        half = line.places[:, 1]
        theta = np.concatenate([line.places[::-1, 0], line.places[1:, 0]])
        phi = np.concatenate([half[-1] - half[::-1], half[-1] + half[1:]])
        axes.plot(*_seen(np.stack([theta, phi], axis=1)).T, color=AWAY, linewidth=1.4)
    axes.plot(0.0, ROOT, "o", color=STIMULUS, markersize=4)
    axes.set(title="between points of the root", xlim=(-80, 80), ylim=(-80, 80), xlabel="y [su]")


def _curvatures(axes: Axes) -> None:
    theta = np.linspace(0.0, RIM, 181)
    for ratio, colour in RATIOS.items():
        tip = ROOT * ratio / (1.0 + ratio)
        bent = ROOT * circle_curvature(vein_net(ROOT, tip), theta)
        axes.plot(theta, bent, color=colour, label=f"r/R = {ratio:g}")
    axes.axhline(0.0, color=INK, linewidth=0.5)
    axes.set(title="geodesic curvature of circles", xlabel="theta", ylabel="times root radius [1]")
    axes.set_xticks([0.0, 0.5 * RIM, RIM])
    axes.set_xticklabels(["0, root", "pi/4", "pi/2, tip"])
    axes.legend(fontsize=8)


def _circles(axes: Axes, between: tuple[float, ...]) -> None:
    turn = np.linspace(-np.pi, np.pi, 181)
    for theta in (0.0, *between, RIM):
        places = np.stack([np.full_like(turn, theta), turn], axis=1)
        end = theta in (0.0, RIM)
        colour, width = (INK, 1.0) if end else (NEVER, 0.8)
        axes.plot(*_seen(places).T, color=colour, linewidth=width)
    axes.set_aspect("equal")


def _seen(places: Floats) -> Floats:
    """Return y and z, (n, 2), of places on the vein."""
    theta, phi = places.T
    rho = ROOT - (ROOT - TIP) * np.sin(theta)
    return np.stack([rho * np.sin(phi), rho * np.cos(phi)], axis=1)
