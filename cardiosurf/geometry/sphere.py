"""The sphere."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
import scipy

from cardiosurf.arrays import Floats, Ints
from cardiosurf.errors import InputError
from cardiosurf.geometry.levels import FlatLevel, Level
from cardiosurf.geometry.regions import Direction
from cardiosurf.geometry.topology import area_vectors, centroids
from cardiosurf.sections import SMALLEST, Positive, Section

_FEWEST = 4
_ON_AXIS = 1e-6


@dataclass(frozen=True)
class Sphere(Section):
    """The sphere of the given radius about the origin, in su.

    Its net is (theta, phi): theta the polar angle from the pole, phi the azimuth about it,
    right-handed. phi = 0 is the meridian on the side of +x; with the pole on the x axis, where
    that says nothing, on the side of +y. No open edges.

    With the unit pole p, a = x - (x . p) p made a unit vector, b = p x a, points have
    cos theta = p . n and phi = atan2(b . n, a . n), n = point / radius: with the usual pole +z,
    phi = atan2(y, x).
    """

    kind: Literal["sphere"] = "sphere"
    radius: Positive = 50.0
    pole: Direction = (0.0, 0.0, 1.0)

    def check(self) -> None:
        """Raise InputError if the radius is not positive or the pole has no direction."""
        if not self.radius > 0:
            raise InputError("geometry.radius", f"{self.radius} is not positive", "above 0")
        if max(map(abs, self.pole)) < SMALLEST:
            raise InputError("geometry.pole", f"{list(self.pole)}", "any direction", "[0, 0, 1]")

    def extents(self) -> dict[str, float]:
        """Return the radius, in su."""
        return {"radius": self.radius}

    def sheet(self, edge_length: float) -> "SphereSheet":
        """Return the exact surface (the same for every edge length)."""
        self.check()
        return SphereSheet(self.radius, self.pole)


@dataclass(frozen=True)
class SphereSheet:
    """The exact surface of a sphere about the origin, theta measured from a pole."""

    radius: float
    pole: tuple[float, float, float] = (0.0, 0.0, 1.0)

    parts = ("sphere",)
    axes = (("theta", "phi"),)
    edge_names = ()
    periods = None

    @cached_property
    def _basis(self) -> Floats:
        """The directions of phi = 0 and phi = pi/2 on the equator, and the pole, (3, 3)."""
        pole = np.array(self.pole) / np.linalg.norm(self.pole)
        towards = np.eye(3)[1 if np.hypot(pole[1], pole[2]) < _ON_AXIS else 0]
        first = towards - (towards @ pole) * pole
        first /= np.linalg.norm(first)
        return np.stack([first, np.cross(pole, first), pole])

    @property
    def size(self) -> float:
        """Square root of the area."""
        return float(self.radius * np.sqrt(4.0 * np.pi))

    @property
    def coarsest(self) -> float:
        """Half the radius."""
        return 0.5 * self.radius

    def levels(self) -> tuple[Level, ...]:
        """Return nothing: one part, no open edges."""
        return ()

    def flat_level(self, normal: tuple[float, float, float], offset: float) -> Level | None:
        """Return the plane's level, None if it passes beside the sphere."""
        return FlatLevel(normal, offset) if abs(offset) < self.radius else None

    def polar_level(self, axis: str, angle: float) -> Level:
        """Return the plane through the circle theta = angle, or through the meridian phi."""
        first, second, pole = self._basis
        if axis == "theta":
            return FlatLevel(_triple(pole), float(self.radius * np.cos(angle)))
        return FlatLevel(_triple(np.cos(angle) * second - np.sin(angle) * first), 0.0)

    def project(self, points: Floats) -> Floats:
        """Return the points moved along their radii."""
        return self.radius * self.normal(points)

    def normal(self, points: Floats) -> Floats:
        """Return the outward unit vectors."""
        return np.asarray(points / np.maximum(np.linalg.norm(points, axis=1), 1e-300)[:, None])

    def part_of(self, points: Floats) -> Ints:
        """Return 0 everywhere."""
        return np.zeros(len(points), dtype=np.int64)

    def net(self, points: Floats, part: Ints) -> Floats:
        """Return theta in [0, pi] and phi in (-pi, pi]."""
        x, y, z = (points @ axis for axis in self._basis)
        return np.stack([np.arctan2(np.hypot(x, y), z), np.arctan2(y, x)], axis=1)

    def frame(self, points: Floats, part: Ints) -> Floats:
        """Return the unit vectors along growing theta and phi."""
        theta, phi = self.net(points, part).T
        st, ct, sp, cp = np.sin(theta), np.cos(theta), np.sin(phi), np.cos(phi)
        along_theta = np.stack([ct * cp, ct * sp, -st], axis=1)
        along_phi = np.stack([-sp, cp, np.zeros_like(sp)], axis=1)
        return np.stack([along_theta, along_phi], axis=1) @ self._basis

    def edge_of(self, points: Floats) -> Ints:
        """Return -1: there is no open edge."""
        return np.full(len(points), -1, dtype=np.int64)

    def seeds(self, spacing: float) -> Floats:
        """Return the vertices of an icosahedron whose faces are cut into n^2 triangles."""
        faces = 4.0 * np.pi * self.radius**2 / (np.sqrt(3.0) / 4.0 * spacing**2)
        pieces = max(_FEWEST, round(float(np.sqrt(faces / 20.0))))
        corners = _icosahedron()
        hull = scipy.spatial.ConvexHull(corners).simplices
        i, j = np.meshgrid(np.arange(pieces + 1), np.arange(pieces + 1), indexing="ij")
        keep = i + j <= pieces
        first, second = i[keep] / pieces, j[keep] / pieces
        weights = _equalised(np.stack([first, second, 1.0 - first - second], axis=1))
        points = np.einsum("wk,fkd->fwd", weights, corners[hull]).reshape(-1, 3)
        points = self.project(points)
        _, first_seen = np.unique(
            np.round(points / self.radius, 9) + 0.0, axis=0, return_index=True
        )
        return points[np.sort(first_seen)]

    def flattened(self, points: Floats) -> Floats:
        """Return the points: their Delaunay triangles are those of their convex hull."""
        return points

    def triangulate(self, points: Floats) -> Ints:
        """Return the convex hull's triangles (the sphere's Delaunay triangles), outward."""
        triangles = scipy.spatial.ConvexHull(points).simplices.astype(np.int64)
        outward = area_vectors(points, triangles)
        inverted = np.einsum("md,md->m", outward, points[triangles].sum(axis=1)) < 0
        triangles[inverted] = triangles[inverted][:, [0, 2, 1]]
        return triangles

    def centres(self, points: Floats, triangles: Ints) -> Floats:
        """Return the centroids moved along their radii."""
        return self.project(centroids(points, triangles))


def _triple(vector: Floats) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z


def _icosahedron() -> Floats:
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    base = np.array([[0.0, s, t * golden] for s in (-1.0, 1.0) for t in (-1.0, 1.0)])
    corners = np.concatenate([np.roll(base, turn, axis=1) for turn in range(3)])
    return np.asarray(corners / np.linalg.norm(corners[0]))


def _equalised(weights: Floats) -> Floats:
    # equal steps on the flat face give small triangles at its corners once they are on the sphere;
    # equal angles seen from the centre even this out (0.5536 is half the angle of an edge)
    half = 0.5 * np.arctan(2.0)
    bent = np.tan(half * (2.0 * weights - 1.0)) + np.tan(half)
    bent[weights < 1e-12] = 0.0
    return np.asarray(bent / bent.sum(axis=1, keepdims=True))
