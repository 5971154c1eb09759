"""Edges, angles and neighbours of a triangle list."""

import numpy as np
from scipy.sparse import csr_array

from cardiosurf.arrays import Floats, Ints, Mask


def numbered_edges(triangles: Ints) -> tuple[Ints, Ints]:
    """Return the edges (k, 2), lower vertex first, and each triangle's three edges (m, 3).

    Edge i of a triangle is opposite its vertex i.
    """
    half = np.sort(triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
    base = int(triangles.max(initial=0)) + 1
    keys, numbers = np.unique(half[:, 0] * base + half[:, 1], return_inverse=True)
    return np.stack([keys // base, keys % base], axis=1), numbers.reshape(-1, 3)


def open_edges(triangles: Ints) -> Ints:
    """Return the edges (k, 2) that have a single triangle, in the triangle's direction."""
    half = triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2)
    _, numbers = numbered_edges(triangles)
    single = np.bincount(numbers.ravel()) == 1
    return np.asarray(half[single[numbers.ravel()]])


def are_edges(pairs: Ints, triangles: Ints) -> Mask:
    """Return which of the vertex pairs (k, 2) are edges of the triangles, (k,)."""
    base = int(max(triangles.max(initial=0), pairs.max(initial=0))) + 1
    edges, _ = numbered_edges(triangles)
    low, high = pairs.min(axis=1), pairs.max(axis=1)
    return np.isin(low * base + high, edges[:, 0] * base + edges[:, 1])


def edge_vectors(points: Floats, triangles: Ints) -> Floats:
    """Return the edge vectors (m, 3, 3); edge i runs from vertex i + 1 to vertex i + 2."""
    corners = points[triangles]
    return corners[:, [2, 0, 1]] - corners[:, [1, 2, 0]]


def area_vectors(points: Floats, triangles: Ints) -> Floats:
    """Return the normals (m, 3) whose lengths are the triangles' areas."""
    corners = points[triangles]
    return 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def angles(points: Floats, triangles: Ints) -> Floats:
    """Return the angle at each vertex of each triangle, (m, 3), in degrees."""
    sides = edge_vectors(points, triangles)
    before, after = sides[:, [1, 2, 0]], sides[:, [2, 0, 1]]
    sine = np.linalg.norm(np.cross(before, after), axis=2)
    cosine = -np.einsum("mik,mik->mi", before, after)
    return np.asarray(np.degrees(np.arctan2(sine, cosine)))


def circumcentres(points: Floats, triangles: Ints) -> tuple[Floats, Floats]:
    """Return centres (m, 3) and radii (m,) of the circles through the triangles' vertices."""
    sides = edge_vectors(points, triangles)
    square = np.einsum("mik,mik->mi", sides, sides)
    weight = square * (square.sum(axis=1, keepdims=True) - 2.0 * square)
    total = np.maximum(weight.sum(axis=1, keepdims=True), 1e-300)
    centre = np.einsum("mi,mik->mk", weight / total, points[triangles])
    return centre, np.linalg.norm(centre - points[triangles[:, 0]], axis=1)


def incidence(triangles: Ints, count: int) -> csr_array:
    """Return the (count, m) matrix with a 1 where a vertex belongs to a triangle."""
    rows, columns = triangles.ravel(), np.repeat(np.arange(len(triangles)), 3)
    return csr_array((np.ones(len(rows)), (rows, columns)), shape=(count, len(triangles)))


def sharpness(points: Floats, triangles: Ints) -> Floats:
    """Return the smallest angle of each triangle, (m,), in degrees."""
    sides = edge_vectors(points, triangles)
    square = np.sort(np.einsum("mik,mik->mi", sides, sides), axis=1)
    twice = 2.0 * np.linalg.norm(area_vectors(points, triangles), axis=1)
    sine = twice / np.sqrt(np.maximum(square[:, 1] * square[:, 2], 1e-300))
    return np.asarray(np.degrees(np.arcsin(np.minimum(sine, 1.0))))
