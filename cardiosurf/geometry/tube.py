"""A plane x = 0 that turns into a vein: the exact surface of both, in one conformal chart."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.levels import FlatLevel, Level, ThetaLevel
from cardiosurf.geometry.sheet import Window, planar_delaunay
from cardiosurf.geometry.topology import centroids

_EPSILON = 1e-9
_STEEPEST = 0.8 * np.pi


@dataclass(frozen=True)
class Tube:
    """The plane x = 0 outside the root circle, and the vein inside it.

    x = (A (1 - cos theta), rho sin phi, rho cos phi), rho = root - A sin theta, A = root - tip,
    0 <= theta <= pi/2, meets the plane at theta = 0 with a common tangent.
    In the chart the plane is itself; the vein is radius root exp(-mu), angle phi, with
    mu(theta) = int_0^theta A dt / rho(t), which keeps angles.

    Parameters
    ----------
    root, tip : float
        Radii of the root circle and of the open tip, in su.
    """

    root: float
    tip: float

    @property
    def arc(self) -> float:
        """Radius A of the vein's meridian."""
        return self.root - self.tip

    @property
    def _slant(self) -> float:
        return float(np.sqrt(self.root**2 - self.arc**2))

    def theta(self, points: Floats) -> Floats:
        """Return theta, (n,); negative in the plane."""
        rho = np.hypot(points[:, 1], points[:, 2])
        return np.arctan2(self.root - rho, self.arc - points[:, 0])

    def at(self, theta: Floats, phi: Floats) -> Floats:
        """Return the vein's points (n, 3) at the angles."""
        rho = self.root - self.arc * np.sin(theta)
        x = 2.0 * self.arc * np.sin(0.5 * theta) ** 2
        points = np.empty((len(theta), 3))
        points[:, 0], points[:, 1], points[:, 2] = x, rho * np.sin(phi), rho * np.cos(phi)
        return points

    def project(self, points: Floats) -> Floats:
        """Return the nearest points (n, 3) of the surface."""
        rho = np.hypot(points[:, 1], points[:, 2])
        moved: Floats = points * np.array([0.0, 1.0, 1.0])
        vein = np.flatnonzero(rho < self.root)
        inside = points[vein]
        phi = np.arctan2(inside[:, 1], inside[:, 2])
        moved[vein] = self.at(np.arctan2(self.root - rho[vein], self.arc - inside[:, 0]), phi)
        return moved

    def normal(self, points: Floats) -> Floats:
        """Return the unit normals (n, 3): +x on the plane."""
        x, y, z = points.T
        rho = np.hypot(y, z)
        sine, cosine = self._meridian(x, rho)
        flat = (rho >= self.root) | (sine <= 0.0)
        normal = np.empty_like(points)
        normal[:, 0] = np.where(flat, 1.0, cosine)
        side = np.where(flat, 0.0, sine / np.maximum(rho, 1e-300))
        normal[:, 1], normal[:, 2] = side * y, side * z
        return normal

    def _meridian(self, x: Floats, rho: Floats) -> tuple[Floats, Floats]:
        """Return sine and cosine of theta."""
        inward, across = self.root - rho, self.arc - x
        away = np.maximum(np.hypot(inward, across), 1e-300)
        return inward / away, across / away

    def on_vein(self, points: Floats) -> tuple[Floats, Floats]:
        """Return theta and phi, each (n,)."""
        return self.theta(points), np.arctan2(points[:, 1], points[:, 2])

    def net(self, points: Floats, vein: Mask) -> Floats:
        """Return theta and phi where the mask (n,) is true, y and z elsewhere, (n, 2)."""
        net = points[:, 1:].copy()
        net[vein, 0], net[vein, 1] = self.on_vein(points[vein])
        return net

    def frame(self, points: Floats, vein: Mask) -> Floats:
        """Return the unit vectors (n, 2, 3) along growing coordinates of the net."""
        frame = np.empty((len(points), 2, 3))
        frame[:] = np.eye(3)[1:]
        theta, phi = self.on_vein(points[vein])
        st, ct, sp, cp = np.sin(theta), np.cos(theta), np.sin(phi), np.cos(phi)
        along_theta = np.stack([st, -ct * sp, -ct * cp], axis=1)
        along_phi = np.stack([np.zeros_like(sp), cp, -sp], axis=1)
        frame[vein] = np.stack([along_theta, along_phi], axis=1)
        return frame

    def net_level(self, axis: str, angle: float) -> Level:
        """Return the level of theta = angle or of the plane through phi = angle."""
        if axis == "theta":
            return ThetaLevel(self.root, self.arc, angle)
        return FlatLevel((0.0, float(np.cos(angle)), float(-np.sin(angle))), 0.0)

    def cut_level(self, normal: tuple[float, float, float], offset: float) -> Level | None:
        """Return the level of a plane; planes x = c are the vein's circles theta = const.

        Near x = 0 the function x is flat to second order and useless as a level; theta is not.
        """
        if np.hypot(normal[1], normal[2]) > _EPSILON:
            return FlatLevel(normal, offset)
        height = offset * float(np.sign(normal[0]))
        if height < -_EPSILON or height > self.arc + _EPSILON:
            return None
        cosine = float(np.clip(1.0 - height / self.arc, 0.0, 1.0)) if height > _EPSILON else 1.0
        return ThetaLevel(self.root, self.arc, float(np.arccos(cosine)))

    def chart(self, points: Floats) -> Floats:
        """Return the chart's coordinates (n, 2)."""
        rho = np.hypot(points[:, 1], points[:, 2])
        theta = np.clip(self.theta(points), 0.0, _STEEPEST)
        radius = np.where(rho >= self.root, rho, self.root * np.exp(-self._mu(theta)))
        return points[:, 1:] * (radius / np.maximum(rho, 1e-300))[:, None]

    def unchart(self, flat: Floats) -> Floats:
        """Return the surface points (n, 3) of chart points (n, 2)."""
        radius = np.maximum(np.hypot(flat[:, 0], flat[:, 1]), 1e-300)
        mu = np.clip(np.log(self.root / radius), 0.0, float(self._mu(np.array(_STEEPEST))))
        half = np.arctan(-self.arc / self._slant) + 0.5 * self._slant / self.arc * mu
        theta = 2.0 * np.arctan2(
            self._slant * np.sin(half) + self.arc * np.cos(half), self.root * np.cos(half)
        )
        vein = self.at(theta, np.arctan2(flat[:, 0], flat[:, 1]))
        plane = np.column_stack([np.zeros(len(flat)), flat])
        return np.where((radius >= self.root)[:, None], plane, vein)

    def _mu(self, theta: Floats) -> Floats:
        slope = (self.root * np.tan(0.5 * theta) - self.arc) / self._slant
        start = np.arctan(-self.arc / self._slant)
        return np.asarray(2.0 * self.arc / self._slant * (np.arctan(slope) - start))

    def triangulate(self, points: Floats) -> Ints:
        """Return the Delaunay triangles in the chart."""
        return planar_delaunay(self.chart(points))

    def centres(self, points: Floats, triangles: Ints) -> Floats:
        """Return the surface points of the triangles' centroids in the chart."""
        return self.unchart(centroids(self.chart(points), triangles))

    def spread(self, window: Window, spacing: float) -> Floats:
        """Return a lattice on the plane and rings on the vein, two of them past its tip."""
        lattice = window.lattice(spacing)
        outside = np.hypot(lattice[:, 0], lattice[:, 1]) > self.root
        plane = np.column_stack([np.zeros(len(lattice)), lattice])[outside]
        rings = max(4, round(0.5 * np.pi * self.arc / (np.sqrt(0.75) * spacing)))
        return np.concatenate([plane, *(self._ring(j, rings, spacing) for j in range(rings + 3))])

    def _ring(self, number: int, rings: int, spacing: float) -> Floats:
        theta = 0.5 * np.pi * number / rings
        rho = self.root - self.arc * np.sin(theta)
        count = max(12, round(2.0 * np.pi * rho / spacing))
        phi = 2.0 * np.pi * (np.arange(count) + 0.5 * (number % 2)) / count
        return self.at(np.full(count, theta), phi)
