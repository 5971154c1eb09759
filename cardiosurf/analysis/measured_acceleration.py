"""The relative acceleration of neighbouring trajectories, measured, as a map over the surface.

Pairs of trajectories are followed from fronts all over the surface, forward and back, and
|n|''/|n| is measured along each (``separations``). A vertex takes its value from the pairs that
pass near it. A second map comes from derivatives of the LAT (``front_riccati``), without any
trajectory: where the two agree, the measure means something.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.analysis.conductor import Conductor
from cardiosurf.analysis.front_riccati import FrontRiccati, front_riccati
from cardiosurf.analysis.local_fits import tangent_planes, vertex_normals
from cardiosurf.analysis.separations import WINDOW, between, edge_and_pace, spread_over
from cardiosurf.analysis.trajectories import Places, Trajectory, trajectories
from cardiosurf.analysis.wavefronts import Wavefront, wavefronts
from cardiosurf.arrays import Floats, Ints
from cardiosurf.recording.recording import Recording

SHORTER = 4
"""Levels of a shorter window, to see what the window does."""
LEFT_OUT = WINDOW**2 / (WINDOW**2 - SHORTER**2)
"""What a parabola leaves out goes with the square of how far it reaches."""
SPACING = 2.0
"""Distance of neighbours where they start, in mean edges."""
STRIDE = 4
"""Levels from one front with starts to the next."""
REACH = 3.0
"""How far from a vertex the pairs that it takes its value from may be, in mean edges."""
FEWEST = 6
"""Places of pairs that a vertex needs for a value."""
FLATTEST = 0.01
"""Least eigenvalue of a fit whose places lie on all sides of the vertex."""
MOST_FRONTS = 10_000
"""So many fronts, one edge or more apart, are more than a wave runs through."""
CLOSEST = 0.1
"""Trajectories nearer to each other, in mean edges, have run into one: no pair any more."""


@dataclass(frozen=True)
class Pairs:
    """Measurements along pairs of trajectories.

    Attributes
    ----------
    places : (k, 3) float
        Halfway between the two, in su.
    rate : (k,) float
        |n|'/|n|, in 1/tu.
    relative : (k,) float
        |n|''/|n|, in 1/tu^2.
    shorter : (k,) float
        The same with ``SHORTER`` levels on each side.
    window : float
        Half the time that each was fitted to, in tu.
    """

    places: Floats
    rate: Floats
    relative: Floats
    shorter: Floats
    window: float


@dataclass(frozen=True)
class MeasuredAcceleration:
    """The relative acceleration at the vertices, measured in two ways; NaN where it is not known.

    Attributes
    ----------
    rate, rate_error : (n,) float
        |n|'/|n| of the pairs, in 1/tu: above 0 where neighbours part, below where they meet.
    relative, relative_error : (n,) float
        |n|''/|n| of the pairs, in 1/tu^2. The errors are the scatter of the pairs about the fit,
        and what the second derivative changes by when its window is shorter, scaled up as errors
        of parabolas go.
    by_lat : FrontRiccati
        The same from derivatives of the LAT.
    edge : float
        Mean edge of the mesh, in su.
    window : float
        Half the time that the pairs' derivatives are fitted to, in tu.
    """

    rate: Floats
    rate_error: Floats
    relative: Floats
    relative_error: Floats
    by_lat: FrontRiccati
    edge: float
    window: float


def measured_acceleration(
    conductor: Conductor, lat: Floats, labels: Ints | None = None
) -> MeasuredAcceleration:
    """Return the relative acceleration of an activation map at the vertices.

    Parameters
    ----------
    conductor : Conductor
        The triangles and their diffusivity.
    lat : (n,) float
        Activation times, in tu; NaN where never.
    labels : (m,) int, optional
        The tissue of each triangle, for the derivatives of the LAT.
    """
    edge, _ = edge_and_pace(conductor, lat)
    pairs = pairs_everywhere(conductor, lat)
    change = pairs.relative - pairs.shorter
    values = np.stack([pairs.rate, pairs.relative, change], axis=1)
    normals = vertex_normals(conductor.points, conductor.triangles)
    fitted, scatter = at_places(conductor.points, normals, pairs.places, values, REACH * edge)
    return MeasuredAcceleration(
        rate=fitted[:, 0],
        rate_error=scatter[:, 0],
        relative=fitted[:, 1],
        relative_error=np.hypot(scatter[:, 1], LEFT_OUT * fitted[:, 2]),
        by_lat=front_riccati(conductor, lat, labels),
        edge=edge,
        window=pairs.window,
    )


def recorded_accelerations(recording: Recording) -> MeasuredAcceleration:
    """Return the measured relative acceleration of the first wave of a run.

    Parameters
    ----------
    recording : Recording
        A finished run.
    """
    tissue = recording.tissue
    conductor = Conductor.of(recording.surface, tissue)
    labels = tissue.patch_of[tissue.excitable]
    return measured_acceleration(conductor, recording.first_activation, labels)


def pairs_everywhere(conductor: Conductor, lat: Floats) -> Pairs:
    """Measure pairs of trajectories that start on fronts all over the surface.

    Parameters
    ----------
    conductor : Conductor
        The triangles and their diffusivity.
    lat : (n,) float
        Activation times, in tu; NaN where never.
    """
    edge, pace = edge_and_pace(conductor, lat)
    every = edge * pace
    half = WINDOW + STRIDE // 2
    steps = every * np.arange(-half, half + 1, dtype=np.float64)
    fronts = _fronts(conductor, lat, STRIDE * every)
    chosen = [spread_over(front, SPACING * edge) for front in fronts]
    ways = _followed(conductor, lat, fronts, chosen)
    found: list[tuple[Floats, ...]] = []
    for front, points in zip(fronts, chosen, strict=True):
        times = front.time + steps
        places = np.stack([_at(next(ways), times) for _ in points])
        pair, near = (
            between(places, times, window=reach, closed=front.closed) for reach in (WINDOW, SHORTER)
        )
        length = np.where(pair.length > CLOSEST * edge, pair.length, np.nan)
        parts = (pair.rate / length, pair.acceleration / length, near.acceleration / length)
        known = np.isfinite(parts[1])
        found.append((pair.places[known], *(part[known] for part in parts)))
    if not found:
        return Pairs(np.zeros((0, 3)), np.zeros(0), np.zeros(0), np.zeros(0), WINDOW * every)
    columns = [np.concatenate(part) for part in zip(*found, strict=True)]
    return Pairs(columns[0], columns[1], columns[2], columns[3], WINDOW * every)


def _fronts(conductor: Conductor, lat: Floats, apart: float) -> list[Wavefront]:
    """Return fronts so many tu apart, all that are long enough for two neighbours."""
    edge, _ = edge_and_pace(conductor, lat)
    known = lat[np.isfinite(lat)]
    # where tissue was excited all at once, or never, no front runs
    if not (known.size and np.isfinite(apart) and np.ptp(known) < MOST_FRONTS * apart):
        return []
    times = np.arange(known.min() + 0.5 * apart, known.max(), apart)
    every = [front for time in times for front in wavefronts(conductor, lat, float(time))]
    return [front for front in every if front.length() > 2.0 * SPACING * edge]


def _followed(
    conductor: Conductor, lat: Floats, fronts: list[Wavefront], chosen: list[list[int]]
) -> Iterator[tuple[Trajectory, Trajectory]]:
    """Yield the way on and the way back from each chosen point of each front, in their order."""
    if not fronts:
        return
    parts = [
        (front.places.triangles[points], front.places.shares[points])
        for front, points in zip(fronts, chosen, strict=True)
    ]
    triangles, shares = (np.concatenate(part) for part in zip(*parts, strict=True))
    starts = Places(triangles, shares)
    later = trajectories(conductor, lat, starts)
    yield from zip(later, trajectories(conductor, lat, starts, forward=False), strict=True)


def _at(ways: tuple[Trajectory, Trajectory], times: Floats) -> Floats:
    """Return where a point of a front is at times before and after it, (t, 3)."""
    later, earlier = (way.at(times) for way in ways)
    return np.where(np.isfinite(later), later, earlier)


def at_places(
    points: Floats, normals: Floats, places: Floats, values: Floats, reach: float
) -> tuple[Floats, Floats]:
    """Return fits of scattered values at some points, and the scatter about them.

    A line in both directions by least squares, weighted with (1 - (r/reach)^2)^2, r the distance.

    Parameters
    ----------
    points, normals : (n, 3) float
        Where to, in su, and the surface's normals there.
    places : (k, 3) float
        Where the values are, in su.
    values : (k, c) float
        The values.
    reach : float
        Places farther away do not count, in su.

    Returns
    -------
    fitted, scatter : (n, c) float
        NaN where there are too few places, or none on one side.
    """
    tree = scipy.spatial.cKDTree(points)
    close = tree.sparse_distance_matrix(
        scipy.spatial.cKDTree(places), reach, output_type="coo_matrix"
    )
    here, there = close.row.astype(np.int64), close.col.astype(np.int64)
    away = (places[there] - points[here]) / reach
    seen = np.einsum("kai,ki->ak", tangent_planes(normals)[here], away)
    lines = _Lines(here, seen, (1.0 - (close.data / reach) ** 2) ** 2, len(points))
    columns = [lines.fit(column[there]) for column in values.T]
    fitted, scatter = (np.stack(part, axis=1) for part in zip(*columns, strict=True))
    return fitted, scatter


class _Lines:
    """Weighted fits a + b x + c y about some points, from pairs of a point and a place near it.

    Parameters
    ----------
    here : (k,) int
        The point of each pair.
    seen : (2, k) float
        Where its place is, seen from above, in units of the reach.
    weight : (k,) float
        What it counts.
    count : int
        Number of points n.
    """

    def __init__(self, here: Ints, seen: Floats, weight: Floats, count: int) -> None:
        self.here, self.weight, self.count = here, weight, count
        self.terms = (np.ones(len(here)), *seen)
        sums = [[self._sum(one * other) for other in self.terms] for one in self.terms]
        self.system = np.stack([np.stack(row, axis=1) for row in sums], axis=1)
        self.total = np.maximum(self.system[:, 0, 0], 1e-300)
        flattest = np.linalg.eigvalsh(self.system / self.total[:, None, None])[:, 0]
        number = np.bincount(here, minlength=count)
        self.known = (number >= FEWEST) & (flattest > FLATTEST)

    def fit(self, values: Floats) -> tuple[Floats, Floats]:
        """Return a and the scatter about the line, (n,) each, of values (k,)."""
        right = np.stack([self._sum(term * values) for term in self.terms], axis=1)
        line = np.full((self.count, 3), np.nan)
        known = self.known
        line[known] = np.linalg.solve(self.system[known], right[known][:, :, None])[:, :, 0]
        left = values - np.einsum("ik,ki->k", np.stack(self.terms), line[self.here])
        return line[:, 0], np.sqrt(self._sum(left * left) / self.total)

    def _sum(self, values: Floats) -> Floats:
        """Return the weighted sums over the pairs of each point, (n,)."""
        return np.bincount(self.here, self.weight * values, self.count).astype(np.float64)
