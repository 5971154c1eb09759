"""What the mesher needs of a shape: the exact surface, a chart of it and its parts."""

from dataclasses import dataclass
from typing import Protocol, TypeAlias

import numpy as np
import scipy

from cardiosurf.arrays import Floats, Ints
from cardiosurf.geometry.levels import Level

_GHOSTS = 8

Periods: TypeAlias = tuple[float | None, float | None]
"""After how much each coordinate of a chart repeats itself, None if it does not."""


class Sheet(Protocol):
    """The exact surface of a shape, carried on a little past its open edges.

    The part number of a point past an open edge is -1, so that open edges, part boundaries and
    region edges are all found in the same way: as curves across which something changes.
    """

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the parts."""
        ...

    @property
    def axes(self) -> tuple[tuple[str, str], ...]:
        """Names of the net axes of each part."""
        ...

    @property
    def edge_names(self) -> tuple[str, ...]:
        """Names of the open edges."""
        ...

    @property
    def size(self) -> float:
        """Square root of the surface's area, roughly, in su."""
        ...

    @property
    def coarsest(self) -> float:
        """Longest edge that still shows the surface's shape, in su."""
        ...

    @property
    def periods(self) -> Periods | None:
        """Periods of the chart, None if it does not repeat itself."""
        ...

    def levels(self) -> tuple[Level, ...]:
        """Return the levels whose zero sets hold the open edges and the part boundaries."""
        ...

    def flat_level(self, normal: tuple[float, float, float], offset: float) -> Level | None:
        """Return the level of the plane normal . x = offset, None if it cannot cut the surface."""
        ...

    def polar_level(self, axis: str, angle: float) -> Level:
        """Return the level of theta or phi = angle."""
        ...

    def project(self, points: Floats) -> Floats:
        """Return the points (n, 3) moved to the exact surface."""
        ...

    def normal(self, points: Floats) -> Floats:
        """Return unit normals e1 x e2 at points (n, 3) of the surface."""
        ...

    def part_of(self, points: Floats) -> Ints:
        """Return the part's number of each point (n, 3), -1 past an open edge."""
        ...

    def net(self, points: Floats, part: Ints) -> Floats:
        """Return the net coordinates (n, 2) of points in the given parts."""
        ...

    def frame(self, points: Floats, part: Ints) -> Floats:
        """Return the unit net vectors e1, e2 (n, 2, 3) at points in the given parts."""
        ...

    def edge_of(self, points: Floats) -> Ints:
        """Return the open edge's number that each point (n, 3) of an open edge lies on."""
        ...

    def seeds(self, spacing: float) -> Floats:
        """Return points (n, 3) spread evenly over the surface and a little past open edges."""
        ...

    def flattened(self, points: Floats) -> Floats:
        """Return where the points lie in the chart, (n, 2); a sphere's stay, (n, 3)."""
        ...

    def triangulate(self, points: Floats) -> Ints:
        """Return the Delaunay triangles (m, 3) of the points, counter-clockwise or outward."""
        ...

    def centres(self, points: Floats, triangles: Ints) -> Floats:
        """Return a surface point inside each triangle, (m, 3)."""
        ...


@dataclass(frozen=True)
class Window:
    """A rectangle of the chart, to be filled with points."""

    first: tuple[float, float]
    second: tuple[float, float]

    def lattice(self, spacing: float) -> Floats:
        """Return a hexagonal lattice (n, 2) that fits the rectangle, with three rows beyond."""
        (a0, a1), (b0, b1) = self.first, self.second
        rows = max(1, round((a1 - a0) / (spacing * np.sqrt(0.75))))
        columns = max(1, round((b1 - b0) / spacing))
        row, column = np.meshgrid(
            np.arange(-4, rows + 5), np.arange(-4, columns + 5), indexing="ij"
        )
        first = a0 + (a1 - a0) * row / rows
        second = b0 + (b1 - b0) * (column + 0.5 * (row % 2)) / columns
        return np.stack([first.ravel(), second.ravel()], axis=1)

    def area(self) -> float:
        """Return the rectangle's area."""
        return (self.first[1] - self.first[0]) * (self.second[1] - self.second[0])


def planar_delaunay(flat: Floats) -> Ints:
    """Return the Delaunay triangles (m, 3), counter-clockwise, of points (n, 2) in a chart.

    A ring of far points is added for the time being: without it, qhull makes slivers of the
    points along a straight outer edge.
    """
    count = len(flat)
    middle = 0.5 * (flat.min(axis=0) + flat.max(axis=0))
    radius = 4.0 * np.ptp(flat, axis=0).max() + 1e-300
    angle = 0.1 + 2.0 * np.pi * np.arange(_GHOSTS) / _GHOSTS
    ghosts = middle + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    found = scipy.spatial.Delaunay(np.concatenate([flat, ghosts])).simplices
    # columns: all() over rows of three and products of pairs are slow
    one, two, three = np.ascontiguousarray(found.T)
    found = found[(one < count) & (two < count) & (three < count)].astype(np.int64)
    one, two, three = np.ascontiguousarray(found.T)
    x, y = np.ascontiguousarray(flat.T)
    turn = (x[two] - x[one]) * (y[three] - y[one]) - (y[two] - y[one]) * (x[three] - x[one])
    wrong = np.flatnonzero(turn < 0)
    found[wrong, 1], found[wrong, 2] = three[wrong], two[wrong]
    return np.asarray(found)
