"""Trajectories of a wave: the paths along d grad T over the triangles (T the LAT, d the tensor).

They are the characteristics of c0 sqrt(grad T . d grad T) = 1: the gradient raised with the
metric that the diffusivity makes. Linear T on a triangle has one direction in it, so a trajectory
is straight in each triangle and is followed exactly, from edge to edge. Where the flows of both
triangles lead onto their common edge it runs along the edge, as long as they go the same way.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardiosurf.analysis.compiled.paths import LONG, MEETING, OPEN_EDGE, STILL, follow
from cardiosurf.analysis.conductor import Conductor
from cardiosurf.arrays import Floats, Ints
from cardiosurf.geometry.topology import twins

End = Literal["edge", "meeting", "still", "long"]
ENDS: dict[int, End] = {
    int(OPEN_EDGE): "edge",
    int(MEETING): "meeting",
    int(STILL): "still",
    int(LONG): "long",
}
"""An open edge (also that towards scar); two fronts, or no way on; no direction; no more room."""

ROUNDING = 1e-12
ROOM = 20_000
"""Triangles that a trajectory may cross."""


@dataclass(frozen=True)
class Places:
    """Places on a triangulation.

    Attributes
    ----------
    triangles : (k,) int
        Their triangles.
    shares : (k, 3) float
        Barycentric coordinates there.
    """

    triangles: Ints
    shares: Floats

    def points(self, conductor: Conductor) -> Floats:
        """Return where they are, (k, 3), in su."""
        corners = conductor.points[conductor.triangles[self.triangles]]
        return np.asarray(np.einsum("ki,kij->kj", self.shares, corners))


@dataclass(frozen=True)
class Trajectory:
    """The path of a point of a front.

    Attributes
    ----------
    points : (k, 3) float
        Where it crosses edges, in su; the first is where it starts.
    times : (k,) float
        LAT at these, in tu: growing if it was followed forward, falling if backward.
    triangles : (k,) int
        The triangle that it goes on in from each.
    end : {"edge", "meeting", "still", "long"}
        Why it ends.
    """

    points: Floats
    times: Floats
    triangles: Ints
    end: End

    def at(self, times: Floats) -> Floats:
        """Return where it is at given times, (t, 3), in su; NaN before and after it.

        Parameters
        ----------
        times : (t,) float
            In tu.
        """
        order = slice(None) if self.times[-1] >= self.times[0] else slice(None, None, -1)
        known, places = self.times[order], self.points[order]
        # a trajectory that starts on a front does so at its time, but for rounding
        slack = 1e-9 * float(np.abs(known).max())
        outside = (times < known[0] - slack) | (times > known[-1] + slack)
        found = np.stack([np.interp(times, known, column) for column in places.T], axis=1)
        found[outside] = np.nan
        return found


def trajectories(
    conductor: Conductor, lat: Floats, starts: Places, *, forward: bool = True
) -> tuple[Trajectory, ...]:
    """Return the trajectories of an activation map through some places.

    Parameters
    ----------
    conductor : Conductor
        The triangles and their diffusivity.
    lat : (n,) float
        Activation times, in tu; NaN where never.
    starts : Places
        Where they start.
    forward : bool
        Whether they are followed with the wave, or back to where it came from.
    """
    hats, _ = conductor.hat_gradients()
    heights = np.ascontiguousarray(lat if forward else -lat, dtype=np.float64)
    slope = np.einsum("mai,ma->mi", hats, heights[conductor.triangles])
    flow = np.einsum("mij,mj->mi", conductor.tangential(), slope)
    # what is left of a constant map is rounding
    rise = np.ptp(heights[conductor.triangles], axis=1)
    flow[rise <= ROUNDING * np.nanmax(np.abs(heights), initial=0.0)] = 0.0
    rates = np.einsum("mai,mi->ma", hats, flow)
    # a flow along an edge stays on it
    rates[np.abs(rates) <= ROUNDING * np.abs(rates).max(axis=1, keepdims=True)] = 0.0
    corners, first = conductor.corners_around()
    triangles = np.ascontiguousarray(conductor.triangles, dtype=np.int64)
    web = (triangles, twins(triangles), first, corners, rates, flow, slope)
    field = (np.ascontiguousarray(conductor.points), heights)
    track, found = np.empty((ROOM, 5)), []
    for start in zip(starts.triangles, starts.shares, strict=True):
        count, reason = follow(web, field, start, track)
        path = track[:count].copy()
        times = path[:, 3] if forward else -path[:, 3]
        end = ENDS[int(reason)]
        found.append(Trajectory(path[:, :3], times, path[:, 4].astype(np.int64), end))
    return tuple(found)
