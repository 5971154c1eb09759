"""Where a front starts: vertices with times, and directions where they are known."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from cardiosurf.analysis.conductor import Conductor
from cardiosurf.arrays import Floats, Ints
from cardiosurf.errors import InputError
from cardiosurf.tissue.stimuli import Pulse

UNIFORM = 0.1
"""Spread of the metric up to which tissue about a source counts as uniform, relative to its trace.

On a curved surface it is seen from the source's plane: at distance r it differs by (r/R)^2.
"""


@dataclass(frozen=True)
class Sources:
    """Where a wave starts.

    Attributes
    ----------
    vertices : (k,) int
        Vertices whose arrival is given.
    times : (k,) float
        Their times, in tu.
    gradients : (k, 3) float
        Gradients of the time at them, in tu/su; NaN where unknown.
    """

    vertices: Ints
    times: Floats
    gradients: Floats

    @classmethod
    def at(cls, vertices: Ints, times: Floats | float = 0.0) -> "Sources":
        """Return sources at vertices with given times, whose gradients are unknown."""
        unknown = np.full((len(vertices), 3), np.nan)
        every = np.broadcast_to(np.asarray(times, dtype=np.float64), len(vertices)).copy()
        return cls(np.asarray(vertices), every, unknown)


def point_source(
    conductor: Conductor, centre: Floats, speed: float, *, radius: float, time: float = 0.0
) -> Sources:
    """Return a point source with the exact times about it: sqrt(x . d^-1 x)/c0.

    Close to a point a front is a circle (an ellipse, where tissue is anisotropic) too small for
    the mesh to follow: times that are linear on edges are wrong by a part of an edge there, and
    stay so. So the times near the source are given, as long as the tissue there is uniform: within
    ``radius`` or up to the nearest triangle with another diffusivity. On a curved surface the
    distance is that along the chord, short of the arc by r^3/(24 R^2) at distance r.

    Parameters
    ----------
    conductor : Conductor
        The triangles and their diffusivity.
    centre : (3,) float
        The source, on the surface, in su.
    speed : float
        c0, in su/tu.
    radius : float
        How far times are given, in su; at least the nearest vertex gets one.
    time : float
        When it starts, in tu.
    """
    used = np.unique(conductor.triangles)
    away = conductor.points[used] - centre
    distance = np.linalg.norm(away, axis=1)
    nearest = used[np.argmin(distance)]
    plane, within, reach = _uniform(conductor, nearest, centre)
    chosen = (distance <= min(radius, reach)) | (used == nearest)
    # what leaves the plane of the source is laid into it, along the chord
    flat = away[chosen] @ plane.T
    flat *= (distance[chosen] / np.maximum(np.linalg.norm(flat, axis=1), 1e-300))[:, None]
    pull = flat @ within / speed**2
    times = np.sqrt(np.einsum("ij,ij->i", flat, pull))
    with np.errstate(invalid="ignore"):
        gradients = (pull @ plane) / times[:, None]
    return Sources(used[chosen], time + times, gradients)


def stimulus_sources(conductor: Conductor, pulses: Iterable[Pulse], speed: float) -> Sources:
    """Return the fronts that stimuli start from: time 0 on the level u = 0.5 of each.

    Inside the level the stimulus itself is the activation. A vertex next to it, in a triangle that
    the level crosses, gets the time of a straight front, (0.5 - u)/(c0 sqrt(grad u . d grad u)).
    For a current the level is half its greatest strength.

    Parameters
    ----------
    conductor : Conductor
        The triangles and their diffusivity.
    pulses : iterable of Pulse
        The stimuli; of several beats of a place the first counts.
    speed : float
        c0, in su/tu.

    Raises
    ------
    InputError
        No stimulus reaches its level on excitable tissue.
    """
    hats, _ = conductor.hat_gradients()
    tensor, triangles = conductor.tangential(), conductor.triangles
    times = np.full(len(conductor.points), np.inf)
    excitable = np.zeros(len(times), dtype=np.bool_)
    excitable[triangles] = True
    for pulse in pulses:
        u = pulse.profile
        level = 0.5 if pulse.duration == 0.0 else 0.5 * float(u.max())
        inside = excitable & (u >= level)
        times[inside] = np.minimum(times[inside], pulse.time)
        corners = inside[triangles]
        crossed = np.flatnonzero(corners.any(axis=1) & ~corners.all(axis=1))
        gradient = np.einsum("mai,ma->mi", hats[crossed], u[triangles[crossed]])
        steepness = np.sqrt(np.einsum("mi,mij,mj->m", gradient, tensor[crossed], gradient))
        later = (level - u[triangles[crossed]]) / (speed * steepness[:, None])
        outside = ~corners[crossed]
        np.minimum.at(times, triangles[crossed][outside], pulse.time + later[outside])
    started = np.flatnonzero(np.isfinite(times))
    if not started.size:
        raise InputError(
            "stimulus",
            "no stimulus raises u above 0.5 on excitable tissue, so no front starts",
            "an amplitude above 0.5, or a current",
        )
    return Sources.at(started, times[started])


def _uniform(conductor: Conductor, vertex: int, centre: Floats) -> tuple[Floats, Floats, float]:
    """Return the plane at a vertex (2, 3), the metric in it (2, 2), and how far that one holds."""
    metric = conductor.metric()
    touching = (conductor.triangles == vertex).any(axis=1)
    plane = conductor.planes()[np.argmax(touching)]
    within = np.einsum("ai,mij,bj->mab", plane, metric, plane)
    mean = within[touching].mean(axis=0)
    other = np.abs(within - mean).max(axis=(1, 2)) > UNIFORM * np.trace(mean)
    corners = conductor.points[conductor.triangles[other]]
    reach = np.linalg.norm(corners - centre, axis=2).min(initial=np.inf)
    return plane, mean, float(reach)
