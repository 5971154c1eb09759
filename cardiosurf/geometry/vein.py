"""A square with a vein in its middle."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardiosurf.arrays import Floats, Ints
from cardiosurf.errors import InputError
from cardiosurf.geometry.levels import FlatLevel, Level, ThetaLevel
from cardiosurf.geometry.sheet import Window
from cardiosurf.geometry.tube import Tube
from cardiosurf.sections import Positive, Section

_EPSILON = 1e-9
# below this share of the root the vein's chart is too small at the tip for double precision
NARROWEST = 0.04


def check_radii(root_radius: float, tip_radius: float) -> None:
    """Raise InputError unless root / 25 <= tip < root."""
    if not 0 < NARROWEST * root_radius * (1.0 - 1e-9) <= tip_radius < root_radius:
        raise InputError(
            "geometry.tip_radius",
            f"{tip_radius} with root_radius {root_radius}",
            f"{NARROWEST * root_radius:g} <= tip_radius < {root_radius:g} (root_radius)",
            "the arc of the vein has the radius root_radius - tip_radius",
        )


@dataclass(frozen=True)
class Vein(Section):
    """The square abs(y), abs(z) <= half_width at x = 0 with a vein in its middle, in su.

    x = (A (1 - cos theta), rho sin phi, rho cos phi), rho = root - A sin theta, A = root - tip,
    0 <= theta <= pi/2. Parts: square, with the net (y, z), and vein, with the net (theta, phi).
    Open edges: right (greatest y), left, bottom (least z), top and tip.

    Source: Chun's paper, section 5.2.
    """

    kind: Literal["vein"] = "vein"
    root_radius: Positive = 105.0
    tip_radius: Positive = 35.0
    half_width: Positive = 150.0

    def check(self) -> None:
        """Raise InputError unless tip < root < half_width."""
        check_radii(self.root_radius, self.tip_radius)
        if not self.root_radius < self.half_width:
            raise InputError(
                "geometry.root_radius",
                f"{self.root_radius} with half_width {self.half_width}",
                "root_radius < half_width",
            )

    def extents(self) -> dict[str, float]:
        """Return the radius of the tip, in su: the root and the square are wider."""
        return {"tip_radius": self.tip_radius}

    def sheet(self, edge_length: float) -> "VeinSheet":
        """Return the exact surface (the same for every edge length)."""
        self.check()
        return VeinSheet(Tube(self.root_radius, self.tip_radius), self.half_width)


@dataclass(frozen=True)
class VeinSheet:
    """The exact surface of a square with a vein."""

    tube: Tube
    half_width: float

    parts = ("square", "vein")
    axes = (("y", "z"), ("theta", "phi"))
    edge_names = ("right", "left", "bottom", "top", "tip")
    periods = None

    @property
    def size(self) -> float:
        """Square root of the area."""
        return 2.0 * self.half_width

    @property
    def _window(self) -> Window:
        return Window((-self.half_width, self.half_width), (-self.half_width, self.half_width))

    @property
    def coarsest(self) -> float:
        """No limit: the circles and the rings of the vein have their own."""
        return np.inf

    def levels(self) -> tuple[Level, ...]:
        """Return the levels of the root circle, the tip and the square's sides."""
        tube, width = self.tube, self.half_width
        return (
            ThetaLevel(tube.root, tube.arc, 0.0),
            ThetaLevel(tube.root, tube.arc, 0.5 * np.pi),
            *(FlatLevel((0.0, 1.0, 0.0), offset) for offset in (-width, width)),
            *(FlatLevel((0.0, 0.0, 1.0), offset) for offset in (-width, width)),
        )

    def flat_level(self, normal: tuple[float, float, float], offset: float) -> Level | None:
        """Return the plane's level, or the circle that a plane x = const cuts."""
        return self.tube.cut_level(normal, offset)

    def polar_level(self, axis: str, angle: float) -> Level:
        """Return the level of theta or phi."""
        return self.tube.net_level(axis, angle)

    def project(self, points: Floats) -> Floats:
        """Return the nearest points of the surface."""
        return self.tube.project(points)

    def normal(self, points: Floats) -> Floats:
        """Return the unit normals, +x on the square."""
        return self.tube.normal(points)

    def part_of(self, points: Floats) -> Ints:
        """Return 0 on the square, 1 on the vein, -1 outside."""
        inside = np.abs(points[:, 1:]).max(axis=1) <= self.half_width + _EPSILON
        vein = np.hypot(points[:, 1], points[:, 2]) < self.tube.root
        part = np.where(vein, 1, np.where(inside, 0, -1))
        part[vein & (self.tube.theta(points) > 0.5 * np.pi + _EPSILON)] = -1
        return part.astype(np.int64)

    def net(self, points: Floats, part: Ints) -> Floats:
        """Return y, z on the square and theta, phi on the vein."""
        return self.tube.net(points, part == 1)

    def frame(self, points: Floats, part: Ints) -> Floats:
        """Return the unit vectors of the net."""
        return self.tube.frame(points, part == 1)

    def edge_of(self, points: Floats) -> Ints:
        """Return the edge: a side of the square, or the tip."""
        y, z = points[:, 1], points[:, 2]
        away = np.array([self.half_width - y, y + self.half_width])
        away = np.stack([*away, z + self.half_width, self.half_width - z], axis=0)
        tip = np.hypot(y, z) < self.tube.root
        return np.where(tip, 4, np.argmin(np.abs(away), axis=0)).astype(np.int64)

    def seeds(self, spacing: float) -> Floats:
        """Return a lattice on the square and rings on the vein."""
        return self.tube.spread(self._window, spacing)

    def flattened(self, points: Floats) -> Floats:
        """Return where the points lie in the chart."""
        return self.tube.chart(points)

    def triangulate(self, points: Floats) -> Ints:
        """Return the Delaunay triangles in the chart."""
        return self.tube.triangulate(points)

    def centres(self, points: Floats, triangles: Ints) -> Floats:
        """Return a surface point inside each triangle."""
        return self.tube.centres(points, triangles)
