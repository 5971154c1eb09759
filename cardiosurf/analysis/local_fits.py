"""Gradients of vertex fields by parabolas over the vertices around, on a triangulated surface."""

import numpy as np
import scipy

from cardiosurf.analysis.neighbours import neighbours
from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.topology import area_vectors

FEWEST = 9
"""Vertices for the six numbers of a parabola: with fewer the fit follows every bump."""
FLATTEST = 1e-3
"""Least eigenvalue of a well-posed fit, where the greatest is about 1."""


class LocalFits:
    """Gradients by least squares: a parabola over the vertices within some rings.

    Places are seen from above each vertex's tangent plane, in which the surface's symbols vanish
    at the vertex itself, so the gradient is that on the surface, and of a tangential vector field
    the tangential part is its covariant derivative.

    Parameters
    ----------
    points : (n, 3) float
        Vertices, in su.
    triangles : (m, 3) int
        Vertex numbers.
    rings : int
        How many edges away the vertices of a fit may be.

    Attributes
    ----------
    normals : (n, 3) float
        Unit normals of the vertices.
    known : (n,) bool
        Where there are vertices enough for a fit.
    """

    def __init__(self, points: Floats, triangles: Ints, rings: int) -> None:
        count = len(points)
        self.normals = vertex_normals(points, triangles)
        planes = tangent_planes(self.normals)
        here, there = _within(triangles, count, rings)
        away = points[there] - points[here]
        edge = float(np.sqrt(np.mean(np.einsum("ki,ki->k", away, away))))
        x, y = np.einsum("kai,ki->ak", planes[here], away) / edge
        terms = (np.ones_like(x), x, y, 0.5 * x * x, x * y, 0.5 * y * y)
        system = np.empty((count, 6, 6))
        for i in range(6):
            for j in range(i + 1):
                sums = np.bincount(here, terms[i] * terms[j], count)
                system[:, i, j] = system[:, j, i] = sums
        number = np.bincount(here, minlength=count)
        flattest = np.linalg.eigvalsh(system / np.maximum(number, 1)[:, None, None])[:, 0]
        self.known: Mask = np.asarray((number >= FEWEST) & (flattest > FLATTEST))
        inverse = np.full((count, 6, 6), np.nan)
        inverse[self.known] = np.linalg.inv(system[self.known])
        # term by term: all of the inverses at every pair would take a gigabyte at 10^5 vertices
        along, across = (
            sum(inverse[here, row, k] * term for k, term in enumerate(terms)) / edge
            for row in (1, 2)
        )
        first, second = planes[here].transpose(1, 2, 0)
        shares = along * first + across * second
        self._operators = [
            scipy.sparse.csr_array((share, (here, there)), shape=(count, count)) for share in shares
        ]

    def gradient(self, field: Floats) -> Floats:
        """Return the gradient, (n, 3), of a field (n,), or (n, 3, c) of one with c parts."""
        return np.stack([operator @ field for operator in self._operators], axis=1)


def vertex_normals(points: Floats, triangles: Ints) -> Floats:
    """Return unit normals at the vertices, (n, 3): means of the triangles' by area; NaN at none."""
    vectors = area_vectors(points, triangles)
    total = np.zeros_like(points)
    for corner in range(3):
        np.add.at(total, triangles[:, corner], vectors)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):
        return np.asarray(total / np.where(length > 0.0, length, np.nan))


def tangent_planes(normals: Floats) -> Floats:
    """Return an orthonormal pair of vectors at right angles to each normal, (n, 2, 3)."""
    steepest = np.argmin(np.abs(normals), axis=1)
    first = np.cross(normals, np.eye(3)[steepest])
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(normals, first)], axis=1)


def _within(triangles: Ints, count: int, rings: int) -> tuple[Ints, Ints]:
    """Return all pairs of vertices at most some edges apart, each with itself too."""
    around = neighbours(triangles, count)
    shape = (count, count)
    owners = np.repeat(np.arange(count), around.counts)
    links = (np.ones(len(owners), dtype=np.bool_), (owners, around.items))
    step = scipy.sparse.csr_array(links, shape=shape) + scipy.sparse.eye_array(count, dtype=bool)
    pairs = step
    for _ in range(rings - 1):
        pairs = pairs @ step
    rows = np.repeat(np.arange(count), np.diff(pairs.indptr))
    return rows, np.asarray(pairs.indices, dtype=np.int64)
