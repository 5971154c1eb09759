"""Level functions: a region's edge is where one of them is zero on the surface."""

from dataclasses import dataclass
from typing import Protocol, TypeAlias

import numpy as np

from cardiosurf.arrays import Floats
from cardiosurf.geometry.profile import Profile

Key: TypeAlias = tuple[str, tuple[float, ...]]


class Level(Protocol):
    """A smooth function in space, near its zero set a signed distance."""

    @property
    def key(self) -> Key:
        """What two levels with the same zero set have in common."""
        ...

    def value(self, points: Floats) -> Floats:
        """Return the function at the points (n, 3), (n,), in su."""
        ...

    def gradient(self, points: Floats) -> Floats:
        """Return its gradient in space at the points (n, 3), (n, 3)."""
        ...


@dataclass(frozen=True)
class FlatLevel:
    """Level n . x - offset of a plane with the unit normal n."""

    normal: tuple[float, float, float]
    offset: float

    @property
    def key(self) -> Key:
        """Normal and offset, the first non-zero component of the normal made positive."""
        numbers = np.round([*self.normal, self.offset], 9)
        sign = np.sign(numbers[np.flatnonzero(numbers)[0]])
        return "flat", tuple(float(number) for number in sign * numbers + 0.0)

    def value(self, points: Floats) -> Floats:
        """Return the signed distance from the plane, (n,)."""
        return np.asarray(points @ np.asarray(self.normal) - self.offset)

    def gradient(self, points: Floats) -> Floats:
        """Return the plane's normal at every point, (n, 3)."""
        return np.broadcast_to(np.asarray(self.normal), points.shape)


@dataclass(frozen=True)
class BallLevel:
    """Level abs(x - centre) - radius of a ball."""

    centre: tuple[float, float, float]
    radius: float

    @property
    def key(self) -> Key:
        """Centre and radius."""
        return "ball", tuple(float(x) for x in np.round([*self.centre, self.radius], 9) + 0.0)

    def value(self, points: Floats) -> Floats:
        """Return the signed distance from the sphere, (n,)."""
        return np.asarray(np.linalg.norm(points - np.asarray(self.centre), axis=1) - self.radius)

    def gradient(self, points: Floats) -> Floats:
        """Return the unit vectors away from the centre, (n, 3)."""
        away = points - np.asarray(self.centre)
        return np.asarray(away / np.maximum(np.linalg.norm(away, axis=1), 1e-300)[:, None])


@dataclass(frozen=True)
class ThetaLevel:
    """Level A (theta - theta_0) of a vein with arc radius A; theta_0 = 0 is the root circle.

    theta = atan2(root - rho, A - x) with rho = hypot(y, z) goes on smoothly into the flat part,
    where it is negative.
    """

    root: float
    arc: float
    theta: float

    @property
    def key(self) -> Key:
        """Root, arc and angle."""
        numbers = np.round([self.root, self.arc, self.theta], 9) + 0.0
        return "theta", tuple(float(x) for x in numbers)

    def value(self, points: Floats) -> Floats:
        """Return the signed length along the vein's meridian, (n,)."""
        rho = np.hypot(points[:, 1], points[:, 2])
        theta = np.arctan2(self.root - rho, self.arc - points[:, 0])
        return self.arc * (theta - self.theta)

    def gradient(self, points: Floats) -> Floats:
        """Return the gradient of A theta, (n, 3)."""
        rho = np.maximum(np.hypot(points[:, 1], points[:, 2]), 1e-300)
        inward, across = self.root - rho, self.arc - points[:, 0]
        scale = self.arc / np.maximum(inward**2 + across**2, 1e-300)
        along_rho = -across * scale / rho
        slope = np.empty_like(points)
        slope[:, 0] = inward * scale
        slope[:, 1], slope[:, 2] = along_rho * points[:, 1], along_rho * points[:, 2]
        return slope


@dataclass(frozen=True)
class RingLevel:
    """Level s - s_0 of a surface of revolution about the line x = axis_x, y = 0.

    s is the arclength along the profile at the nearest point. On a closed profile of length P the
    level is P / 2 pi sin(2 pi (s - s_0) / P), which is zero on the ring across as well.
    """

    profile: Profile
    axis_x: float
    s: float

    @property
    def key(self) -> Key:
        """Arclength."""
        return "ring", (float(np.round(self.s, 9) + 0.0),)

    def value(self, points: Floats) -> Floats:
        """Return the signed length along the profile, (n,)."""
        past = self._nearest(points) - self.s
        if not self.profile.closed:
            return past
        scale = self.profile.length / (2.0 * np.pi)
        return np.asarray(scale * np.sin(past / scale))

    def gradient(self, points: Floats) -> Floats:
        """Return its gradient, (n, 3): on the surface, the tangent of the profile."""
        s = self._nearest(points)
        outward, upward = self.profile.tangent(s)
        x, y = points[:, 0] - self.axis_x, points[:, 1]
        rho = np.maximum(np.hypot(x, y), 1e-300)
        slope = np.stack([outward * x / rho, outward * y / rho, upward], axis=1)
        if self.profile.closed:
            slope *= np.cos((s - self.s) * 2.0 * np.pi / self.profile.length)[:, None]
        return slope

    def _nearest(self, points: Floats) -> Floats:
        x, y, z = points.T
        return self.profile.nearest(np.hypot(x - self.axis_x, y), z)
