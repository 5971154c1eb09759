"""Synthetic tissue of any size, for benchmarks: sheets of nearly equilateral triangles."""

import numpy as np
from scipy.spatial import Delaunay

from cardiosurf.arrays import Floats, Ints
from cardiosurf.fem.operators import Operators, assemble

JITTER = 0.24
"""How far points are moved, in edges: so much that about 93 % have six neighbours."""


def sheet(nodes: int, edge: float, *, seed: int = 1) -> tuple[Floats, Ints]:
    """Return points (n, 3) and triangles (m, 3) of a square sheet of about so many nodes.

    A hexagonal grid, jittered, under a Delaunay triangulation: edges vary, and so does the number
    of neighbours, as it does in meshes of real shapes.
    """
    rng = np.random.default_rng(seed)
    across = round((nodes * np.sqrt(0.75)) ** 0.5)
    up = round(nodes / across)
    i, j = (index.ravel().astype(float) for index in np.meshgrid(range(across), range(up)))
    x, y = edge * (i + 0.5 * (j % 2)), edge * np.sqrt(0.75) * j
    inside = (i > 0) & (i < across - 1) & (j > 0) & (j < up - 1)
    moved = rng.uniform(-JITTER, JITTER, (2, len(x))) * edge * inside
    points = np.column_stack((x + moved[0], y + moved[1], np.zeros(len(x))))
    triangles = Delaunay(points[:, :2]).simplices.astype(np.int64)
    a, b, c = (points[triangles[:, k], :2] for k in range(3))
    one, other = b - a, c - a
    area = 0.5 * (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
    # slivers along the ragged rim are no tissue
    return points, triangles[np.abs(area) > 0.05 * edge**2]


def operators_of(points: Floats, triangles: Ints) -> Operators:
    """Return the matrices of isotropic, excitable tissue with the blended mass."""
    tensor = np.broadcast_to(np.eye(3), (len(triangles), 3, 3))
    return assemble(points, triangles, tensor, np.ones(len(triangles), bool))
