"""The flat rectangle."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardiosurf.arrays import Floats, Ints
from cardiosurf.errors import InputError
from cardiosurf.geometry.levels import FlatLevel, Level
from cardiosurf.geometry.sheet import Window, planar_delaunay
from cardiosurf.geometry.topology import centroids
from cardiosurf.sections import Coordinate, Section

_EPSILON = 1e-9


@dataclass(frozen=True)
class Plane(Section):
    """The rectangle x[0] <= x <= x[1], y[0] <= y <= y[1] in the plane z = 0, in su.

    Its open edges are left (least x), right, bottom (least y) and top; the net is (x, y).
    """

    kind: Literal["plane"] = "plane"
    x: tuple[Coordinate, Coordinate] = (-100.0, 100.0)
    y: tuple[Coordinate, Coordinate] = (-100.0, 100.0)

    def check(self) -> None:
        """Raise InputError if the rectangle is empty."""
        for name, limits in (("x", self.x), ("y", self.y)):
            if not limits[0] < limits[1]:
                raise InputError(
                    f"geometry.{name}",
                    f"{list(limits)} is not a range",
                    "two numbers, the smaller first",
                )

    def extents(self) -> dict[str, float]:
        """Return the two sides, in su."""
        return {"x": self.x[1] - self.x[0], "y": self.y[1] - self.y[0]}

    def sheet(self, edge_length: float) -> "PlaneSheet":
        """Return the exact surface (the same for every edge length)."""
        self.check()
        return PlaneSheet(self.x, self.y)


@dataclass(frozen=True)
class PlaneSheet:
    """The exact surface of a rectangle in the plane z = 0."""

    x: tuple[float, float]
    y: tuple[float, float]

    parts = ("plane",)
    axes = (("x", "y"),)
    edge_names = ("left", "right", "bottom", "top")
    periods = None

    @property
    def size(self) -> float:
        """Square root of the area."""
        return float(np.sqrt(Window(self.x, self.y).area()))

    @property
    def coarsest(self) -> float:
        """No limit: the surface is flat."""
        return np.inf

    def levels(self) -> tuple[Level, ...]:
        """Return the levels of the four edges."""
        return (
            *(FlatLevel((1.0, 0.0, 0.0), limit) for limit in self.x),
            *(FlatLevel((0.0, 1.0, 0.0), limit) for limit in self.y),
        )

    def flat_level(self, normal: tuple[float, float, float], offset: float) -> Level | None:
        """Return the plane's level, None if it is parallel to the surface."""
        if np.hypot(normal[0], normal[1]) < _EPSILON:
            return None
        return FlatLevel(normal, offset)

    def polar_level(self, axis: str, angle: float) -> Level:
        """Raise InputError: a plane has no angles."""
        raise InputError(
            "region", f"{axis} = {angle} on a plane", "polar on vein, sphere, torus or atrium"
        )

    def project(self, points: Floats) -> Floats:
        """Return the points with z = 0."""
        return np.asarray(points * np.array([1.0, 1.0, 0.0]))

    def normal(self, points: Floats) -> Floats:
        """Return +z everywhere."""
        return np.broadcast_to(np.array([0.0, 0.0, 1.0]), points.shape)

    def part_of(self, points: Floats) -> Ints:
        """Return 0 within the rectangle, -1 outside."""
        x, y = points[:, 0], points[:, 1]
        inside = (x >= self.x[0] - _EPSILON) & (x <= self.x[1] + _EPSILON)
        inside &= (y >= self.y[0] - _EPSILON) & (y <= self.y[1] + _EPSILON)
        return np.where(inside, 0, -1)

    def net(self, points: Floats, part: Ints) -> Floats:
        """Return x and y."""
        return points[:, :2].copy()

    def frame(self, points: Floats, part: Ints) -> Floats:
        """Return the unit vectors along x and y."""
        return np.broadcast_to(np.eye(3)[:2], (len(points), 2, 3)).copy()

    def edge_of(self, points: Floats) -> Ints:
        """Return the nearest of the four edges."""
        x, y = points[:, 0], points[:, 1]
        away = [x - self.x[0], self.x[1] - x, y - self.y[0], self.y[1] - y]
        return np.asarray(np.argmin(np.abs(away), axis=0).astype(np.int64))

    def seeds(self, spacing: float) -> Floats:
        """Return a hexagonal lattice."""
        lattice = Window(self.x, self.y).lattice(spacing)
        return np.column_stack([lattice, np.zeros(len(lattice))])

    def flattened(self, points: Floats) -> Floats:
        """Return x and y."""
        return points[:, :2].copy()

    def triangulate(self, points: Floats) -> Ints:
        """Return the Delaunay triangles in the plane."""
        return planar_delaunay(points[:, :2])

    def centres(self, points: Floats, triangles: Ints) -> Floats:
        """Return the centroids."""
        return centroids(points, triangles)
