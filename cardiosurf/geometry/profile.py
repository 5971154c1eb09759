"""A plane curve of circular arcs and straight lines, to be turned about an axis."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cardiosurf.arrays import Floats, Ints

_SAMPLES = 4096


@dataclass(frozen=True)
class Profile:
    """A curve (rho, z)(s) by arclength, made of bows that run on into each other smoothly.

    A bow of curvature kappa (0: straight) turns the heading alpha by kappa t over a length t:

        (rho, z) = (rho, z)_0 + t sin(k) / k (cos(alpha_0 + k), sin(alpha_0 + k)),  k = kappa t / 2

    Parameters
    ----------
    start : pair of float
        rho, the distance from the axis, and z where the curve begins, in su.
    heading : float
        Direction there, in radians from +rho towards +z.
    bows : tuple of pairs of float
        Curvature in 1/su, above 0 for a turn to the left, and length in su of each bow.
    before : float
        Length from the beginning to s = 0, in su.
    closed : bool
        Whether the curve ends where it begins.
    """

    start: tuple[float, float]
    heading: float
    bows: tuple[tuple[float, float], ...]
    before: float = 0.0
    closed: bool = False

    @cached_property
    def _knots(self) -> Floats:
        """Arclength, rho, z and heading where each bow begins, (b + 1, 4)."""
        rows = [np.array([-self.before, *self.start, self.heading])]
        for curvature, length in self.bows:
            last = rows[-1]
            rho, z = _along(last, curvature, np.array([length]))
            half = 0.5 * curvature * length
            rows.append(np.array([last[0] + length, rho[0], z[0], last[3] + half + half]))
        return np.array(rows)

    @property
    def limits(self) -> tuple[float, float]:
        """Arclengths of the beginning and the end."""
        return float(self._knots[0, 0]), float(self._knots[-1, 0])

    @property
    def length(self) -> float:
        """Whole length, in su."""
        return self.limits[1] - self.limits[0]

    def at(self, s: Floats) -> tuple[Floats, Floats]:
        """Return rho and z (n,) at the arclengths (n,)."""
        s, which = self._bow_at(s)
        rho, z = np.empty(len(s)), np.empty(len(s))
        for number in np.flatnonzero(np.bincount(which, minlength=len(self.bows))):
            mine, knot = which == number, self._knots[number]
            rho[mine], z[mine] = _along(knot, self.bows[number][0], s[mine] - knot[0])
        return rho, z

    def tangent(self, s: Floats) -> tuple[Floats, Floats]:
        """Return the rho and z components (n,) of the unit tangent at the arclengths (n,)."""
        s, which = self._bow_at(s)
        curvature = np.array([bow[0] for bow in self.bows])[which]
        half = 0.5 * curvature * (s - self._knots[which, 0])
        heading = self._knots[which, 3] + half + half
        return np.cos(heading), np.sin(heading)

    def curvature(self, s: Floats) -> Floats:
        """Return the curvature (n,) at the arclengths (n,), in 1/su; it jumps between bows."""
        return np.asarray(np.array([bow[0] for bow in self.bows])[self._bow_at(s)[1]])

    def _bow_at(self, s: Floats) -> tuple[Floats, Ints]:
        """Return the arclengths within the curve's period and the bows they lie on, each (n,)."""
        s = np.asarray(s, dtype=np.float64)
        if self.closed:
            s = self.limits[0] + np.mod(s - self.limits[0], self.length)
        return s, np.clip(np.searchsorted(self._knots[1:-1, 0], s), 0, len(self.bows) - 1)

    def nearest(self, rho: Floats, z: Floats) -> Floats:
        """Return the arclengths (n,) of the curve's points nearest to the points."""
        best = np.full(len(rho), np.inf)
        found = np.zeros(len(rho))
        for knot, (curvature, length) in zip(self._knots, self.bows, strict=False):
            along = np.minimum(np.maximum(_foot(knot, curvature, length, (rho, z)), 0.0), length)
            at_rho, at_z = _along(knot, curvature, along)
            away = (at_rho - rho) ** 2 + (at_z - z) ** 2
            nearer = away < best
            found = np.where(nearer, knot[0] + along, found)
            best = np.where(nearer, away, best)
        return found

    @cached_property
    def _table(self) -> tuple[Floats, Floats]:
        """Arclengths and the integral of ds / rho up to each."""
        s = np.linspace(*self.limits, _SAMPLES + 1)
        step, middle = np.diff(s), 0.5 * (s[1:] + s[:-1])
        # two-point Gauss
        shift = step / np.sqrt(12.0)
        mean = 0.5 * sum(1.0 / self.at(middle + side * shift)[0] for side in (-1.0, 1.0))
        return s, np.concatenate([[0.0], np.cumsum(mean * step)])

    @property
    def period(self) -> float:
        """The integral of ds / rho over the whole curve."""
        return float(self._table[1][-1])

    def conformal(self, s: Floats) -> Floats:
        """Return the integral of ds / rho from the beginning to the arclengths (n,)."""
        return np.asarray(np.interp(s, *self._table))

    def arclength(self, conformal: Floats) -> Floats:
        """Return the arclengths (n,) of values of that integral (n,)."""
        if self.closed:
            conformal = np.mod(conformal, self.period)
        return np.asarray(np.interp(conformal, self._table[1], self._table[0]))

    def heights(self, z: float, within: tuple[float, float]) -> Floats:
        """Return all arclengths (k,) between two limits at which the curve passes the height z."""
        s = np.linspace(*within, _SAMPLES + 1)
        above = self.at(s)[1] > z
        at = np.flatnonzero(above[1:] != above[:-1])
        low, high = s[at], s[at + 1]
        for _ in range(60):
            middle = 0.5 * (low + high)
            same = (self.at(middle)[1] > z) == above[at]
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        return np.asarray(0.5 * (low + high))

    def sampled(self, within: tuple[float, float]) -> tuple[Floats, Floats, Floats]:
        """Return arclength, rho and z at many points between two limits."""
        s = np.linspace(*within, _SAMPLES + 1)
        return (s, *self.at(s))


def _along(knot: Floats, curvature: float, t: Floats) -> tuple[Floats, Floats]:
    """Return rho and z, each (n,), at the lengths t (n,) past a knot."""
    half = 0.5 * curvature * t
    chord = t * np.sinc(half / np.pi) if curvature else t
    middle = knot[3] + half
    return knot[1] + chord * np.cos(middle), knot[2] + chord * np.sin(middle)


def _foot(knot: Floats, curvature: float, length: float, points: tuple[Floats, Floats]) -> Floats:
    """Return how far past a knot (n,) the bow, carried on, is nearest to the points."""
    rho, z = points[0] - knot[1], points[1] - knot[2]
    cosine, sine = np.cos(knot[3]), np.sin(knot[3])
    if curvature == 0.0:
        return np.asarray(rho * cosine + z * sine)
    # from the centre, which lies 1 / curvature to the left; headings count from the bow's middle
    sign = np.sign(curvature)
    rho, z = rho + sine / curvature, z - cosine / curvature
    middle = knot[3] + 0.5 * curvature * length
    turned = np.arctan2(sign * rho, -sign * z) - middle
    turned -= 2.0 * np.pi * np.round(turned / (2.0 * np.pi))
    return np.asarray(0.5 * length + turned / curvature)
