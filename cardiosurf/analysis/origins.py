"""Where a wave came from: labels carried along the trajectories of an activation map.

A trajectory runs along D grad T (T the LAT, D the diffusivity tensor): the characteristics of the
anisotropic eikonal equation. Instead of tracing them one by one, a label given at the points where
trajectories start is carried along all of them at once by one sparse solve.
"""

import numpy as np
from scipy.sparse import coo_array, eye_array
from scipy.sparse.linalg import splu

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
    back = -np.einsum("mij,mj->mi", tensor, gradient)
    count = len(points)
    vertex, foot_a, foot_b, share, directness = [], [], [], [], []
    for corner in range(3):
        hit, where, how = _upwind_feet(points, triangles, back, corner)
        vertex.append(triangles[hit, corner])
        foot_a.append(triangles[hit, (corner + 1) % 3])
        foot_b.append(triangles[hit, (corner + 2) % 3])
        share.append(where[hit])
        directness.append(how[hit])
    i, a, b = np.concatenate(vertex), np.concatenate(foot_a), np.concatenate(foot_b)
    s, how = np.concatenate(share), np.concatenate(directness)
    # feet earlier than the vertex: then no set of vertices can wait for itself (its earliest
    # vertex would need an earlier foot), and the system below has one solution
    keep = (1 - s) * lat[a] + s * lat[b] < lat[i]
    order = np.lexsort((-how[keep], i[keep]))
    i, a, b, s = i[keep][order], a[keep][order], b[keep][order], s[keep][order]
    first = np.flatnonzero(np.r_[True, i[1:] != i[:-1]]) if i.size else np.empty(0, dtype=np.int64)
    i, a, b, s = i[first], a[first], b[first], s[first]
    carried = coo_array((np.r_[1 - s, s], (np.r_[i, i], np.r_[a, b])), shape=(count, count)).tocsr()
    start = np.ones((count, 1))
    start[i] = 0.0
    system = splu((eye_array(count, format="csr") - carried).tocsc())
    result: Floats = system.solve(start * labels)
    beyond = np.ones(count, dtype=np.bool_)
    beyond[triangles.ravel()] = False
    result[beyond] = np.nan
    return result
