"""Edges, angles and neighbours of a triangle list."""

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask


def numbered_edges(triangles: Ints) -> tuple[Ints, Ints]:
    """Return the edges (k, 2), lower vertex first, and each triangle's three edges (m, 3).

    Edge i of a triangle is opposite its vertex i.
    """
    order, first, half = _by_edge(triangles)
    numbers = np.empty(len(order), dtype=np.int64)
    numbers[order] = np.cumsum(first) - 1
    return half[order[first]], numbers.reshape(-1, 3)


def open_edges(triangles: Ints) -> Ints:
    """Return the edges (k, 2) that have a single triangle, in the triangle's direction."""
    count = int(triangles.max(initial=-1)) + 1
    # around an inner vertex each neighbour is once the next and once the one before; squares tell
    # apart what plain numbers might not
    names, after, before = (triangles[:, [i, (i + 1) % 3, (i + 2) % 3]].T.ravel() for i in range(3))
    labels = np.arange(count, dtype=np.float64)
    rim = np.zeros(count, dtype=bool)
    for label in (labels, (labels * labels) % 1e6):
        rim |= np.bincount(names, label[after] - label[before], count) != 0.0
    near = np.flatnonzero(corners_in(rim, triangles) >= 2)
    order, first, _ = _by_edge(triangles[near])
    single = first & np.append(first[1:], True)
    row, corner = np.divmod(np.sort(order[single]), 3)
    row = near[row]
    edges = np.stack([triangles[row, (corner + 1) % 3], triangles[row, (corner + 2) % 3]], axis=1)
    # the triangle beyond an edge to an inner vertex was not looked at
    return np.asarray(edges[rim[edges].all(axis=1)])


def corners_in(mask: Mask, triangles: Ints) -> Ints:
    """Return how many vertices of each triangle are in the mask (n,), (m,)."""
    number = mask.view(np.int8)
    one, two, three = (number[triangles[:, i]] for i in range(3))
    return np.asarray(one + two + three)


def twins(triangles: Ints) -> Ints:
    """Return for each half edge the one of the neighbouring triangle, -1 at open edges, (3 m,).

    Half edge 3 t + i is the edge of triangle t opposite its vertex i.
    """
    order, first, _ = _by_edge(triangles)
    second = np.flatnonzero(~first)
    twin = np.full(len(order), -1)
    twin[order[second]], twin[order[second - 1]] = order[second - 1], order[second]
    return twin


def _by_edge(triangles: Ints) -> tuple[Ints, Mask, Ints]:
    """Return all edges of all triangles in the order of their vertices.

    That is the order (3 m,), whether an edge is the first of its like there, and the edges
    themselves (3 m, 2), lower vertex first, not in order; edge i of triangle t is number 3 t + i.
    """
    one, other = triangles[:, [1, 2, 0]].ravel(), triangles[:, [2, 0, 1]].ravel()
    half = np.stack([np.minimum(one, other), np.maximum(one, other)], axis=1)
    base = int(triangles.max(initial=0)) + 1
    keys, bits = half[:, 0] * base + half[:, 1], len(half).bit_length()
    if base * base < 2 ** (63 - bits):
        # one sort of plain numbers is much quicker than an argsort
        packed = np.sort((keys << bits) | np.arange(len(keys)))
        keys, order = packed >> bits, packed & ((1 << bits) - 1)
    else:
        order = np.argsort(keys, kind="stable")
        keys = keys[order]
    first = np.concatenate([np.ones(min(1, len(keys)), dtype=bool), keys[1:] != keys[:-1]])
    return order, first, half


def are_edges(pairs: Ints, triangles: Ints) -> Mask:
    """Return which of the vertex pairs (k, 2) are edges of the triangles, (k,)."""
    base = int(max(triangles.max(initial=0), pairs.max(initial=0))) + 1
    # the pairs are few: most triangles have nothing to do with them
    asked = np.zeros(base, dtype=bool)
    asked[pairs] = True
    near = triangles[corners_in(asked, triangles) >= 2]
    edges = near[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2)
    there, wanted = np.sort(_keys(edges, base)), _keys(pairs, base)
    if not len(there):
        return np.zeros(len(pairs), dtype=bool)
    at = np.minimum(np.searchsorted(there, wanted), len(there) - 1)
    return np.asarray(there[at] == wanted)


def _keys(pairs: Ints, base: int) -> Ints:
    return np.asarray(pairs.min(axis=1) * base + pairs.max(axis=1))


def edge_vectors(points: Floats, triangles: Ints) -> Floats:
    """Return the edge vectors (m, 3, 3); edge i runs from vertex i + 1 to vertex i + 2."""
    corners = points[triangles]
    sides = np.empty_like(corners)
    for one in range(3):
        np.subtract(corners[:, (one + 2) % 3], corners[:, (one + 1) % 3], out=sides[:, one])
    return sides


def area_vectors(points: Floats, triangles: Ints) -> Floats:
    """Return the normals (m, 3) whose lengths are the triangles' areas."""
    return np.stack(area_columns(corner_columns(points, triangles)), axis=1)


def areas(points: Floats, triangles: Ints) -> Floats:
    """Return the triangles' areas, (m,)."""
    x, y, z = area_columns(corner_columns(points, triangles))
    return np.sqrt(x * x + y * y + z * z)


def centroids(points: Floats, triangles: Ints) -> Floats:
    """Return the means of the triangles' vertices, (m, d), for points (n, d)."""
    middle = np.empty((len(triangles), points.shape[1]))
    one, two, three = np.ascontiguousarray(triangles.T)
    for axis, column in enumerate(np.ascontiguousarray(points.T)):
        middle[:, axis] = (column[one] + column[two] + column[three]) / 3.0
    return middle


def corner_columns(points: Floats, triangles: Ints) -> list[list[Floats]]:
    """Return the three coordinates of the three vertices, each (m,).

    Arithmetic on whole columns is several times quicker than on rows of three.
    """
    columns = np.ascontiguousarray(points.T)
    return [[column[vertex] for column in columns] for vertex in np.ascontiguousarray(triangles.T)]


def area_columns(corners: list[list[Floats]]) -> tuple[Floats, Floats, Floats]:
    """Return the coordinates of ``area_vectors``, each (m,), for ``corner_columns``."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = corners
    ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
    return 0.5 * (uy * vz - uz * vy), 0.5 * (uz * vx - ux * vz), 0.5 * (ux * vy - uy * vx)


def edge_lengths(points: Floats, triangles: Ints) -> Floats:
    """Return the lengths of the edges, (3, m); edge i is opposite vertex i."""
    corners = corner_columns(points, triangles)
    return np.sqrt(np.stack([_square(corners[i - 2], corners[i - 1]) for i in range(3)]))


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


def sharpness(points: Floats, triangles: Ints) -> Floats:
    """Return the smallest angle of each triangle, (m,), in degrees."""
    corners = corner_columns(points, triangles)
    return sharpness_of(corners, area_columns(corners))


def sharpness_of(corners: list[list[Floats]], area: tuple[Floats, Floats, Floats]) -> Floats:
    """Return the smallest angles, (m,), for ``corner_columns`` and ``area_columns``."""
    x, y, z = area
    twice = 2.0 * np.sqrt(x * x + y * y + z * z)
    one, two, three = (_square(corners[i], corners[j]) for i, j in ((1, 2), (2, 0), (0, 1)))
    # the product of the two longer sides
    longer, shorter = np.maximum(one, two), np.minimum(one, two)
    product = np.maximum(longer, three) * np.maximum(shorter, np.minimum(longer, three))
    sine = twice / np.sqrt(np.maximum(product, 1e-300))
    return np.asarray(np.degrees(np.arcsin(np.minimum(sine, 1.0))))


def _square(one: list[Floats], other: list[Floats]) -> Floats:
    x, y, z = (b - a for a, b in zip(one, other, strict=True))
    return x * x + y * y + z * z
