"""How neighbouring trajectories part and meet: the measured relative acceleration.

The paper's hypothesis is about n, the vector from a trajectory to its neighbour at equal LAT, and
its second derivative along the trajectories. Here n is measured: between trajectories that start
side by side on a front, at equal times, and its length |n| is differentiated by the time.
"""

from dataclasses import dataclass

import numpy as np

from cardiosurf.analysis.conductor import Conductor
from cardiosurf.analysis.trajectories import Places, Trajectory, trajectories
from cardiosurf.analysis.wavefronts import Wavefront
from cardiosurf.arrays import Floats

WINDOW = 6
"""Levels on each side of one that a derivative is fitted to."""


@dataclass(frozen=True)
class Separations:
    """Distances of neighbouring trajectories at equal times, and their derivatives.

    Attributes
    ----------
    times : (t,) float
        LAT, in tu.
    places : (p, t, 3) float
        Halfway between the trajectories of each pair, in su; NaN where one of them is not.
    vectors : (p, t, 3) float
        From one to the other, in su.
    length : (p, t) float
        |n|, in su.
    rate : (p, t) float
        Its first derivative by the time, in su/tu; NaN within a window of either end.
    acceleration : (p, t) float
        Its second derivative, in su/tu^2.
    rate_error, acceleration_error : (p, t) float
        Standard errors of these, by the kinks of |n| in the window; kinks partly cancel, so on
        smooth maps they are two to three times too large.
    window : float
        Half the time that a parabola is fitted to, in tu.
    """

    times: Floats
    places: Floats
    vectors: Floats
    length: Floats
    rate: Floats
    acceleration: Floats
    rate_error: Floats
    acceleration_error: Floats
    window: float

    @property
    def relative(self) -> Floats:
        """Return the relative acceleration |n|''/|n|, (p, t), in 1/tu^2.

        Divided by the square of the speed it is that by the length of the way; where the speed is
        the same everywhere, -K_G with the Gaussian curvature K_G (Jacobi's equation).
        """
        return self.acceleration / self.length

    @property
    def relative_error(self) -> Floats:
        """Return the standard error of ``relative``, (p, t), in 1/tu^2."""
        return self.acceleration_error / self.length


def separations(
    conductor: Conductor,
    lat: Floats,
    front: Wavefront,
    *,
    spacing: float | None = None,
    window: int = WINDOW,
    forward: bool = True,
) -> Separations:
    """Measure the relative acceleration of the trajectories that start on a front.

    Levels of time are as far apart as a front needs for a mean edge: closer ones would count the
    same kinks of the trajectories, which lie on edges, more than once.

    Parameters
    ----------
    conductor : Conductor
        The triangles and their diffusivity.
    lat : (n,) float
        Activation times, in tu; NaN where never.
    front : Wavefront
        Where they start (``wavefronts``).
    spacing : float, optional
        Distance of neighbours on the front, in su; two mean edges without.
    window : int
        Levels on each side that a derivative is fitted to; at least 2.
    forward : bool
        Whether to follow the wave, or to go back to where it came from.
    """
    edge, pace = edge_and_pace(conductor, lat)
    chosen = spread_over(front, 2.0 * edge if spacing is None else spacing)
    starts = Places(front.places.triangles[chosen], front.places.shares[chosen])
    paths = trajectories(conductor, lat, starts, forward=forward)
    every = edge * pace * (1.0 if forward else -1.0)
    ends = [path.times[-1] for path in paths]
    farthest = max(ends) if forward else min(ends)
    levels = np.arange(int((farthest - front.time) / every) + 1, dtype=np.float64)
    return measure(paths, front.time + every * levels, window=window, closed=front.closed)


def measure(
    paths: tuple[Trajectory, ...], times: Floats, *, window: int = WINDOW, closed: bool = False
) -> Separations:
    """Return distances and their derivatives of trajectories, each with the next.

    Parameters
    ----------
    paths : tuple of Trajectory
        In the order in which they lie side by side.
    times : (t,) float
        Levels of equal distance, in tu.
    window : int
        Levels on each side that a derivative is fitted to; at least 2.
    closed : bool
        Whether the first is a neighbour of the last.
    """
    places = np.stack([path.at(times) for path in paths])
    return between(places, times, window=window, closed=closed)


def between(places: Floats, times: Floats, *, window: int, closed: bool) -> Separations:
    """Return distances and their derivatives of places that move, each with the next.

    Parameters
    ----------
    places : (k, t, 3) float
        In the order in which they lie side by side, in su; NaN where they are not.
    times : (t,) float
        Levels of equal distance, in tu.
    window : int
        Levels on each side that a derivative is fitted to; at least 2.
    closed : bool
        Whether the first is a neighbour of the last.
    """
    following = np.roll(places, -1, axis=0) if closed else places[1:]
    places = places if closed else places[:-1]
    vectors = following - places
    length = np.linalg.norm(vectors, axis=2)
    every = float(times[1] - times[0]) if len(times) > 1 else 1.0
    values, errors = _derivatives(length, every, window)
    return Separations(
        times=times,
        places=0.5 * (places + following),
        vectors=vectors,
        length=length,
        rate=values[0],
        acceleration=values[1],
        rate_error=errors[0],
        acceleration_error=errors[1],
        window=abs(every) * window,
    )


def _derivatives(length: Floats, every: float, window: int) -> tuple[Floats, Floats]:
    """Return first and second derivatives (2, p, t) of parabolas over windows, and their errors.

    A trajectory is bent from triangle to triangle, so |n| has kinks rather than scatter: with
    kinks of the variance that its second differences have in the window, independent of each other,
    the errors are those of the fit's response to them.
    """
    values, errors = np.full((2, 2, *length.shape), np.nan)
    if length.shape[1] <= 2 * window:
        return values, errors
    steps = np.arange(-window, window + 1)
    powers = np.stack([np.ones_like(steps), steps, 0.5 * steps * steps], axis=1)
    fit = powers @ np.linalg.inv(powers.T @ powers)
    windows = np.lib.stride_tricks.sliding_window_view(length, 2 * window + 1, axis=1)
    kinks = np.diff(windows, n=2, axis=2)
    variance = kinks.var(axis=2, ddof=1)
    # what a kink at each inner step makes of the fit, and of the slope in the middle
    response = np.maximum(steps[:, None] - steps[None, 1:-1], 0).T @ fit
    response[:, 1] -= np.where(steps[1:-1] < 0, 1.0, np.where(steps[1:-1] == 0, 0.5, 0.0))
    inside = slice(window, -window)
    for k in range(2):
        scale = abs(every) ** -(k + 1)
        values[k, :, inside] = windows @ fit[:, k + 1] * every ** -(k + 1)
        errors[k, :, inside] = np.sqrt(variance * np.sum(response[:, k + 1] ** 2)) * scale
    return values, errors


def edge_and_pace(conductor: Conductor, lat: Floats) -> tuple[float, float]:
    """Return the mean edge, in su, and the median time that a front takes for a su, in tu."""
    hats, areas = conductor.hat_gradients()
    slope = np.einsum("mai,ma->mi", hats, lat[conductor.triangles])
    pace = np.linalg.norm(slope, axis=1)
    # a triangle's area is that of an equilateral one of the mean edge, roughly
    edge = float(np.sqrt(np.mean(areas) * 4.0 / np.sqrt(3.0)))
    moving = pace[np.isfinite(pace) & (pace > 0.0)]
    return edge, float(np.median(moving)) if moving.size else float("nan")


def spread_over(front: Wavefront, spacing: float) -> list[int]:
    """Return points of a front about ``spacing`` apart, an equal part of its length each."""
    arc, length = front.arc(), front.length()
    count = max(int(length / spacing), 1)
    wanted = length * np.arange(count if front.closed else count + 1) / count
    return sorted({int(np.argmin(np.abs(arc - s))) for s in wanted})
