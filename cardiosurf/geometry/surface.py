"""A triangulated surface that knows its named parts, its net frame and its open edges."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.topology import areas


@dataclass(frozen=True)
class Surface:
    """A triangulated surface in space.

    Attributes
    ----------
    points : (n, 3) float
        Vertices, on the exact surface.
    triangles : (m, 3) int
        Vertex numbers, consistently oriented.
    parts : tuple of str
        Names of the surface's parts ("vein", "right_rectangle", ...).
    part_of : (m,) int
        Index into ``parts``, a triangle.
    axes : tuple of pairs of str
        For each part the names of the two net axes, ("x", "y") or ("theta", "phi").
    frame : (m, 2, 3) float
        Unit vectors e1, e2 of the orthogonal net at each triangle, in the triangle's plane.
    net : (m, 2) float
        Net coordinates (in the order of ``axes``) of each triangle's centroid.
    edges : mapping of str to (k, 2) int
        Open edges by name ("right", "left", "tip", ...): pairs of vertex numbers.
        Every open edge of the mesh is in exactly one of them.
    regions : mapping of str to (m,) bool
        Triangles of the regions the mesh was made to resolve, by the name they were given under.
    """

    points: Floats
    triangles: Ints
    parts: tuple[str, ...]
    part_of: Ints
    axes: tuple[tuple[str, str], ...]
    frame: Floats
    net: Floats
    edges: Mapping[str, Ints]
    regions: Mapping[str, Mask]

    def areas(self) -> Floats:
        """Return the area of each triangle, (m,), in su^2."""
        return areas(self.points, self.triangles)

    def vertex_areas(self) -> Floats:
        """Return the area of each vertex (a third of its triangles'), (n,), in su^2."""
        shares = np.repeat(self.areas() / 3.0, 3)
        total = np.bincount(self.triangles.ravel(), weights=shares, minlength=len(self.points))
        return total.astype(np.float64)
