"""Where a wave came from: labels carried along the trajectories of an activation map.

A trajectory runs along D grad T (T the LAT, D the diffusivity tensor): the characteristics of the
anisotropic eikonal equation. Instead of tracing them one by one, a label given at the points where
trajectories start is carried along all of them at once by one sparse solve.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.arrays import Floats, Ints, Mask


def triangle_gradients(points: Floats, triangles: Ints, values: Floats) -> Floats:
    """Return the gradient of a vertex field on each triangle, (m, 3), in units of the field per su.

    Parameters
    ----------
    points : (n, 3) float
        Vertices, in su.
    triangles : (m, 3) int
        Vertex numbers.
    values : (n,) float
        The field; NaN makes the gradients of the adjoining triangles NaN.
    """
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    squared = np.einsum("ij,ij->i", normal, normal)[:, None]
    opposite = (c - b, a - c, b - a)
    total = sum(values[triangles[:, k]][:, None] * opposite[k] for k in range(3))
    gradient: Floats = np.cross(normal, total) / squared
    return gradient


def _upwind_feet(
    points: Floats, triangles: Ints, back: Floats, corner: int
) -> tuple[Mask, Floats, Floats]:
    """Follow ``back`` from one corner to the opposite edge.

    Returns whether the edge is hit, where along it (0..1), and how directly (the cosine with the
    direction to the edge's middle: the better of several triangles is taken by it).
    """
    apex = points[triangles[:, corner]]
    p = points[triangles[:, (corner + 1) % 3]] - apex
    q = points[triangles[:, (corner + 2) % 3]] - apex
    pp, pq, qq = (np.einsum("ij,ij->i", *pair) for pair in ((p, p), (p, q), (q, q)))
    bp, bq = np.einsum("ij,ij->i", back, p), np.einsum("ij,ij->i", back, q)
    determinant = pp * qq - pq**2
    along_p = (bp * qq - bq * pq) / determinant
    along_q = (bq * pp - bp * pq) / determinant
    total = along_p + along_q
    slack = 1e-9 * np.abs(total)
    hit = (total > 0) & (along_p >= -slack) & (along_q >= -slack)
    where = np.clip(along_q / np.where(hit, total, 1.0), 0.0, 1.0)
    middle = p + q
    directness = np.einsum("ij,ij->i", back, middle) / np.sqrt(
        np.einsum("ij,ij->i", back, back) * np.einsum("ij,ij->i", middle, middle) + 1e-300
    )
    return hit, where, directness


@dataclass(frozen=True)
class _Feet:
    """For each vertex in ``vertex`` its upwind point: ``share`` of the way from ``a`` to ``b``."""

    vertex: Ints
    a: Ints
    b: Ints
    share: Floats

    def chosen(self, which: Mask | Ints) -> "_Feet":
        """Return some of them."""
        return _Feet(self.vertex[which], self.a[which], self.b[which], self.share[which])


def _feet(points: Floats, triangles: Ints, back: Floats, lat: Floats) -> _Feet:
    """Return the most direct upwind point of each vertex that has one."""
    vertex, foot_a, foot_b, share, directness = [], [], [], [], []
    for corner in range(3):
        hit, where, how = _upwind_feet(points, triangles, back, corner)
        vertex.append(triangles[hit, corner])
        foot_a.append(triangles[hit, (corner + 1) % 3])
        foot_b.append(triangles[hit, (corner + 2) % 3])
        share.append(where[hit])
        directness.append(how[hit])
    feet = _Feet(*(np.concatenate(parts) for parts in (vertex, foot_a, foot_b, share)))
    # feet earlier than the vertex: then no set of vertices can wait for itself (its earliest
    # vertex would need an earlier foot), and the system for the labels has one solution
    at_foot = (1 - feet.share) * lat[feet.a] + feet.share * lat[feet.b]
    earlier = at_foot < lat[feet.vertex]
    feet, how = feet.chosen(earlier), np.concatenate(directness)[earlier]
    feet = feet.chosen(np.lexsort((-how, feet.vertex)))
    return feet.chosen(np.diff(feet.vertex, prepend=-1) > 0)


def carry_labels(
    points: Floats, triangles: Ints, tensor: Floats, lat: Floats, labels: Floats
) -> Floats:
    """Carry labels from where trajectories start to every vertex that they reach.

    Parameters
    ----------
    points : (n, 3) float
        Vertices, in su.
    triangles : (m, 3) int
        The triangles to look at: the activated ones of a target.
    tensor : (m, 3, 3) float
        Diffusivity on those triangles, in su^2/tu.
    lat : (n,) float
        Local activation times, finite on all these triangles' vertices, in tu.
    labels : (n, k) float
        The labels a trajectory gets when it starts at a vertex, i.e. when none of the given
        triangles is upwind of it.

    Returns
    -------
    (n, k) float
        The labels carried along; NaN at vertices of no given triangle.
    """
    gradient = triangle_gradients(points, triangles, lat)
    feet = _feet(points, triangles, -np.einsum("mij,mj->mi", tensor, gradient), lat)
    # the system holds the vertices of these triangles only, by their numbers among themselves
    own = np.zeros(len(points), dtype=np.bool_)
    own[triangles] = True
    number, count = np.cumsum(own) - 1, int(own.sum())
    i, a, b = number[feet.vertex], number[feet.a], number[feet.b]
    weights = np.r_[1 - feet.share, feet.share]
    places = (np.r_[i, i], np.r_[a, b])
    carried = scipy.sparse.coo_array((weights, places), shape=(count, count)).tocsr()
    start = np.ones((count, 1))
    start[i] = 0.0
    identity = scipy.sparse.eye_array(count, format="csr")
    system = scipy.sparse.linalg.splu((identity - carried).tocsc())
    result: Floats = np.full(labels.shape, np.nan)
    result[own] = system.solve(start * labels[own])
    return result
