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
    count = len(points)
    fitted, scatter = np.full((2, count, values.shape[1]), np.nan)
    tree = scipy.spatial.cKDTree(points)
    close = tree.sparse_distance_matrix(
        scipy.spatial.cKDTree(places), reach, output_type="coo_matrix"
    )
    here, there = close.row, close.col
    weight = (1.0 - (close.data / reach) ** 2) ** 2
    away = (places[there] - points[here]) / reach
    seen = np.einsum("kai,ki->ka", tangent_planes(normals)[here], away)
    terms = np.concatenate([np.ones((len(seen), 1)), seen], axis=1)
    system = np.empty((count, 3, 3))
    for i in range(3):
        for j in range(3):
            system[:, i, j] = np.bincount(here, weight * terms[:, i] * terms[:, j], count)
    total = np.maximum(system[:, 0, 0], 1e-300)
    flattest = np.linalg.eigvalsh(system / total[:, None, None])[:, 0]
    known = (np.bincount(here, minlength=count) >= FEWEST) & (flattest > FLATTEST)
    for part, column in enumerate(values.T):
        right = np.stack(
            [np.bincount(here, weight * terms[:, i] * column[there], count) for i in range(3)], 1
        )
        line = np.zeros((count, 3))
        line[known] = np.linalg.solve(system[known], right[known][:, :, None])[:, :, 0]
        left = column[there] - np.einsum("ki,ki->k", terms, line[here])
        spread = np.sqrt(np.bincount(here, weight * left * left, count) / total)
        fitted[known, part], scatter[known, part] = line[known, 0], spread[known]
    return fitted, scatter
