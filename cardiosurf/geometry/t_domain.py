"""The T-domain: a wide rectangle, a narrow one, and a vein where they meet."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardiosurf.arrays import Floats, Ints
from cardiosurf.errors import InputError
from cardiosurf.geometry.levels import FlatLevel, Level, ThetaLevel
from cardiosurf.geometry.sheet import Window
from cardiosurf.geometry.tube import Tube
from cardiosurf.geometry.vein import check_radii
from cardiosurf.sections import Positive, Section

_EPSILON = 1e-9
_VEIN, _RIGHT, _LEFT = 0, 1, 2
_CUSP_WIDTH = 0.6
_NARROW = 0.25
_SHARP = np.cos(np.radians(25.0))


@dataclass(frozen=True)
class TDomain(Section):
    """Two rectangles in the plane x = 0 and a vein where they meet, in su.

    Parts: right_rectangle 0 <= y <= length, abs(z) <= right_half_width and left_rectangle
    -length <= y <= 0, abs(z) <= left_half_width, both outside the root circle, with the net
    (y, z); vein (see Vein) with the net (theta, phi). Open edges: right (y = length), left, top
    (the sides with z > 0), bottom, tip, and inner: the shoulders y = 0 between the two widths and
    the stretches of root circle with no plane beside them.

    With root_radius = left_half_width (the default reading) the left rectangle's sides touch the
    root circle at y = 0: the gap between side and circle, about y^2 / (2 root), closes as a cusp,
    which no mesh can follow. It is cut off where it is 0.6 edge_length wide; the cut end, and the
    circle beside it, are inner edges. Both ends together lose 2/3 w sqrt(2 w root), w = 0.6
    edge_length: about 14 su^2 at edge length 2.5, 0.02 % of the whole; it vanishes with the edge
    length to the power 1.5. The same is done where a side meets the circle at less than 25
    degrees or passes it within a quarter of an edge length.

    Source: Chun's paper, section 5.4. The literal reading has root_radius 105.
    """

    kind: Literal["t_domain"] = "t_domain"
    root_radius: Positive = 70.0
    tip_radius: Positive = 35.0
    length: Positive = 150.0
    right_half_width: Positive = 150.0
    left_half_width: Positive = 70.0

    def check(self) -> None:
        """Raise InputError unless the root circle fits and the left part is not the wider."""
        check_radii(self.root_radius, self.tip_radius)
        for name, limit in (("length", self.length), ("right_half_width", self.right_half_width)):
            if not self.root_radius < limit:
                raise InputError(
                    "geometry.root_radius",
                    f"{self.root_radius} with {name} {limit}",
                    f"root_radius < {name}",
                )
        if not 0 < self.left_half_width <= self.right_half_width:
            raise InputError(
                "geometry.left_half_width",
                f"{self.left_half_width} with right_half_width {self.right_half_width}",
                "0 < left_half_width <= right_half_width",
            )

    def extents(self) -> dict[str, float]:
        """Return the tip's radius and the narrow rectangle's half width, in su."""
        return {"tip_radius": self.tip_radius, "left_half_width": self.left_half_width}

    def sheet(self, edge_length: float) -> "TDomainSheet":
        """Return the exact surface, its cusps cut off where they are 0.6 edge_length wide."""
        self.check()
        root, width = self.root_radius, self.left_half_width
        cusp = None
        if width - root < _NARROW * edge_length and width > _SHARP * root:
            reach = max(width - _CUSP_WIDTH * edge_length, 0.0)
            cusp = float(np.sqrt(root**2 - reach**2))
        return TDomainSheet(
            Tube(root, self.tip_radius), self.length, self.right_half_width, width, cusp
        )


@dataclass(frozen=True)
class TDomainSheet:
    """The exact surface of a T-domain; the left rectangle begins at y = -cusp beside the circle."""

    tube: Tube
    length: float
    right_half_width: float
    left_half_width: float
    cusp: float | None

    parts = ("vein", "right_rectangle", "left_rectangle")
    axes = (("theta", "phi"), ("y", "z"), ("y", "z"))
    edge_names = ("right", "left", "bottom", "top", "tip", "inner")
    periods = None

    @property
    def size(self) -> float:
        """Square root of the area of the rectangle around it."""
        return float(np.sqrt(self._window.area()))

    @property
    def _window(self) -> Window:
        return Window((-self.length, self.length), (-self.right_half_width, self.right_half_width))

    @property
    def coarsest(self) -> float:
        """No limit: the circles and the rings of the vein have their own."""
        return np.inf

    def levels(self) -> tuple[Level, ...]:
        """Return the levels of the root circle, the tip and all straight edges."""
        tube = self.tube
        across = {-self.length, 0.0, self.length}
        if self.cusp is not None:
            across.add(-self.cusp)
        along = {
            side * w for side in (-1, 1) for w in (self.left_half_width, self.right_half_width)
        }
        return (
            ThetaLevel(tube.root, tube.arc, 0.0),
            ThetaLevel(tube.root, tube.arc, 0.5 * np.pi),
            *(FlatLevel((0.0, 1.0, 0.0), offset) for offset in sorted(across)),
            *(FlatLevel((0.0, 0.0, 1.0), offset) for offset in sorted(along)),
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
        """Return the unit normals, +x on the rectangles."""
        return self.tube.normal(points)

    def part_of(self, points: Floats) -> Ints:
        """Return 0 on the vein, 1 and 2 on the right and left rectangle, -1 outside."""
        y, z = points[:, 1], np.abs(points[:, 2])
        part = np.full(len(points), -1, dtype=np.int64)
        within = np.abs(y) <= self.length + _EPSILON
        left = within & (y < 0) & (z <= self.left_half_width + _EPSILON)
        if self.cusp is not None:
            left &= y <= -self.cusp
        part[left] = _LEFT
        part[within & (y >= 0) & (z <= self.right_half_width + _EPSILON)] = _RIGHT
        vein = np.hypot(y, z) < self.tube.root
        part[vein] = _VEIN
        part[vein & (self.tube.theta(points) > 0.5 * np.pi + _EPSILON)] = -1
        return part

    def net(self, points: Floats, part: Ints) -> Floats:
        """Return y, z on the rectangles and theta, phi on the vein."""
        return self.tube.net(points, part == _VEIN)

    def frame(self, points: Floats, part: Ints) -> Floats:
        """Return the unit vectors of the net."""
        return self.tube.frame(points, part == _VEIN)

    def edge_of(self, points: Floats) -> Ints:
        """Return the edge: a side, the tip, or inner for all that is left."""
        y, z = points[:, 1], points[:, 2]
        tolerance = 1e-6 * self.length
        side = np.where(y > 0, self.right_half_width, self.left_half_width)
        edge = np.full(len(points), 5, dtype=np.int64)
        edge[np.abs(z + side) < tolerance] = 2
        edge[np.abs(z - side) < tolerance] = 3
        edge[np.abs(y) < tolerance] = 5
        edge[np.abs(y - self.length) < tolerance] = 0
        edge[np.abs(y + self.length) < tolerance] = 1
        edge[
            (np.hypot(y, z) < self.tube.root) & (np.abs(points[:, 0] - self.tube.arc) < tolerance)
        ] = 4
        return edge

    def seeds(self, spacing: float) -> Floats:
        """Return a lattice on the plane and rings on the vein."""
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
