"""Surfaces of revolution about a line parallel to z: exact surface and conformal chart."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.arrays import Floats, Ints
from cardiosurf.geometry.levels import FlatLevel, Level, RingLevel
from cardiosurf.geometry.periodic import periodic_delaunay, wrapped
from cardiosurf.geometry.profile import Profile
from cardiosurf.geometry.sheet import Periods

_EPSILON = 1e-9
_BEYOND = 2


@dataclass(frozen=True)
class RevolvedSheet:
    """The exact surface that a profile (rho, z)(s) makes when it turns about x = axis_x, y = 0.

    (x, y) = (axis_x + rho cos phi, rho sin phi). In the chart (w, phi), dw = ds / rho, angles are
    kept; it repeats itself after 2 pi in phi, and in w if the profile is closed.

    Parameters
    ----------
    profile : Profile
        The profile, carried on past open ends.
    axis_x : float
        Where the axis is, in su.
    parts : tuple of str
        Names of the parts along the profile.
    stations : tuple of float
        Arclengths at which they begin, and that of the end, in su.
    angles : tuple of float
        theta at the stations, in radians; between them it grows evenly with the arclength.
    edge_names : tuple of str
        Names of the open edges at the first and the last station; none if the profile is closed.
    coarsest : float
        Longest edge that still shows the surface's shape, in su.
    """

    profile: Profile
    axis_x: float
    parts: tuple[str, ...]
    stations: tuple[float, ...]
    angles: tuple[float, ...]
    edge_names: tuple[str, ...]
    coarsest: float

    @property
    def axes(self) -> tuple[tuple[str, str], ...]:
        """Theta and phi on every part."""
        return (("theta", "phi"),) * len(self.parts)

    @property
    def periods(self) -> Periods:
        """Periods of the chart."""
        return (self.profile.period if self.profile.closed else None), 2.0 * np.pi

    @property
    def _ends(self) -> tuple[float, float]:
        return self.stations[0], self.stations[-1]

    @property
    def size(self) -> float:
        """Square root of the area."""
        s, rho, _ = self.profile.sampled(self._ends)
        return float(np.sqrt(2.0 * np.pi * (0.5 * (rho[1:] + rho[:-1]) @ np.diff(s))))

    def levels(self) -> tuple[Level, ...]:
        """Return the levels of the open edges and of the rings between parts."""
        if self.profile.closed:
            return ()
        return tuple(self._ring_level(s) for s in self.stations)

    def _ring_level(self, s: float) -> RingLevel:
        return RingLevel(self.profile, self.axis_x, s)

    def flat_level(self, normal: tuple[float, float, float], offset: float) -> Level | None:
        """Return the level of a plane, None if it does not cut the surface.

        A plane z = c that cuts it in a single ring becomes that ring's level: where the surface is
        horizontal, z is flat to second order and useless as a level.
        """
        across = float(np.hypot(normal[0], normal[1]))
        if across < _EPSILON:
            return self._horizontal(offset * float(np.sign(normal[2])))
        _, rho, z = self.profile.sampled(self._ends)
        level = offset - normal[0] * self.axis_x
        if not (normal[2] * z - across * rho).min() < level < (normal[2] * z + across * rho).max():
            return None
        return FlatLevel(normal, offset)

    def _horizontal(self, z: float) -> Level | None:
        ends = np.array(self.stations)
        _, heights = self.profile.at(ends)
        near = np.flatnonzero(np.abs(heights - z) < _EPSILON)
        if len(near) and not self.profile.closed:
            return self._ring_level(float(ends[near[0]]))
        rings = self.profile.heights(z, self._ends)
        if not len(rings):
            return None
        return self._ring_level(float(rings[0])) if len(rings) == 1 else FlatLevel((0, 0, 1), z)

    def polar_level(self, axis: str, angle: float) -> Level:
        """Return the level of the ring theta = angle, or of the plane through the meridian phi."""
        if axis == "theta":
            return self._ring_level(float(self._arclength(np.array([angle]))[0]))
        normal = float(-np.sin(angle)), float(np.cos(angle)), 0.0
        return FlatLevel(normal, normal[0] * self.axis_x)

    def _arclength(self, theta: Floats) -> Floats:
        """Return the arclengths of theta (n,), carried on evenly past the ends."""
        s, knots = np.array(self.stations), np.array(self.angles)
        which = np.clip(np.searchsorted(knots[1:-1], theta), 0, len(knots) - 2)
        rate = (np.diff(s) / np.diff(knots))[which]
        return np.asarray(s[which] + rate * (theta - knots[which]))

    def _theta(self, s: Floats) -> Floats:
        knots, theta = np.array(self.stations), np.array(self.angles)
        which = np.clip(np.searchsorted(knots[1:-1], s), 0, len(knots) - 2)
        rate = (np.diff(theta) / np.diff(knots))[which]
        return np.asarray(theta[which] + rate * (s - knots[which]))

    def _placed(self, points: Floats) -> tuple[Floats, Floats]:
        """Return arclength and phi, each (n,), of the nearest points of the surface."""
        x, y = points[:, 0] - self.axis_x, points[:, 1]
        return self.profile.nearest(np.hypot(x, y), points[:, 2]), np.arctan2(y, x)

    def _at(self, s: Floats, phi: Floats) -> Floats:
        rho, z = self.profile.at(s)
        return np.stack([self.axis_x + rho * np.cos(phi), rho * np.sin(phi), z], axis=1)

    def project(self, points: Floats) -> Floats:
        """Return the nearest points of the surface."""
        return self._at(*self._placed(points))

    def normal(self, points: Floats) -> Floats:
        """Return the unit normals e_theta x e_phi."""
        s, phi = self._placed(points)
        outward, upward = self.profile.tangent(s)
        return np.stack([-upward * np.cos(phi), -upward * np.sin(phi), outward], axis=1)

    def part_of(self, points: Floats) -> Ints:
        """Return the part's number, -1 past an open edge; rings belong to the part before them."""
        if self.profile.closed:
            return np.zeros(len(points), dtype=np.int64)
        s, _ = self._placed(points)
        part = np.searchsorted(np.array(self.stations[1:-1]) + _EPSILON, s)
        part[(s < self._ends[0] - _EPSILON) | (s > self._ends[1] + _EPSILON)] = -1
        return part.astype(np.int64)

    def net(self, points: Floats, part: Ints) -> Floats:
        """Return theta and phi in (-pi, pi]."""
        s, phi = self._placed(points)
        return np.stack([self._theta(s), phi], axis=1)

    def frame(self, points: Floats, part: Ints) -> Floats:
        """Return the unit vectors along growing theta and phi."""
        s, phi = self._placed(points)
        outward, upward = self.profile.tangent(s)
        sine, cosine = np.sin(phi), np.cos(phi)
        along_theta = np.stack([outward * cosine, outward * sine, upward], axis=1)
        along_phi = np.stack([-sine, cosine, np.zeros_like(sine)], axis=1)
        return np.stack([along_theta, along_phi], axis=1)

    def edge_of(self, points: Floats) -> Ints:
        """Return 0 at the first open edge and 1 at the last, -1 if there is none."""
        if self.profile.closed:
            return np.full(len(points), -1, dtype=np.int64)
        s, _ = self._placed(points)
        return np.where(s < 0.5 * sum(self._ends), 0, 1)

    def seeds(self, spacing: float) -> Floats:
        """Return rings, two of them past each open edge."""
        first, last = self._ends
        rows = (last - first) / (np.sqrt(0.75) * spacing)
        if self.profile.closed:
            # a multiple of four: the highest and lowest rings are among them
            rings = max(8, 4 * round(rows / 4.0))
            s = first + (last - first) * np.arange(rings) / rings
        else:
            rings = max(4, round(rows))
            low, high = self.profile.limits
            past = np.arange(1, _BEYOND + 1)
            before, after = ((first - low) / _BEYOND, (high - last) / _BEYOND)
            step = (last - first) / rings
            s = np.concatenate(
                [
                    first - past[::-1] * min(step, before),
                    first + step * np.arange(rings + 1),
                    last + past * min(step, after),
                ]
            )
        return np.concatenate([self._ring(one, n % 2, spacing) for n, one in enumerate(s.tolist())])

    def _ring(self, s: float, shifted: int, spacing: float) -> Floats:
        rho = float(self.profile.at(np.array([s]))[0][0])
        count = max(12, round(2.0 * np.pi * rho / spacing))
        phi = 2.0 * np.pi * (np.arange(count) + 0.5 * shifted) / count
        return self._at(np.full(count, s), phi)

    def flattened(self, points: Floats) -> Floats:
        """Return w and phi."""
        s, phi = self._placed(points)
        return np.stack([self.profile.conformal(s), phi], axis=1)

    def triangulate(self, points: Floats) -> Ints:
        """Return the Delaunay triangles in the chart."""
        return periodic_delaunay(self.flattened(points), self.periods)

    def centres(self, points: Floats, triangles: Ints) -> Floats:
        """Return the surface points of the triangles' centroids in the chart."""
        flat = self.flattened(points)
        first = flat[triangles[:, 0]]
        steps = sum(wrapped(flat[triangles[:, k]] - first, self.periods) for k in (1, 2))
        w, phi = (first + steps / 3.0).T
        return self._at(self.profile.arclength(w), phi)
