"""How good a mesh is."""

from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.arrays import Ints
from cardiosurf.geometry.surface import Surface
from cardiosurf.geometry.topology import angles, numbered_edges, open_edges


@dataclass(frozen=True)
class Quality:
    """Counts and measures of a mesh.

    Attributes
    ----------
    vertices, triangles, edges : int
        Counts.
    smallest_angle, largest_angle : float
        Over all triangles, in degrees.
    shortest_edge, mean_edge, longest_edge : float
        Edge lengths, in su.
    components : int
        Connected pieces; 1 is right.
    duplicates : int
        Vertices in the same place as another one; 0 is right.
    orphans : int
        Vertices of no triangle; 0 is right.
    crossed : int
        Edges with more than two triangles, or two that disagree on the orientation; 0 is right.
    euler : int
        Vertices - edges + triangles: 2 for a sphere, 1 for a disc, 0 for a ring or a torus.
    loops : int
        Closed curves that the open edges make.
    area : float
        In su^2.
    """

    vertices: int
    triangles: int
    edges: int
    smallest_angle: float
    largest_angle: float
    shortest_edge: float
    mean_edge: float
    longest_edge: float
    components: int
    duplicates: int
    orphans: int
    crossed: int
    euler: int
    loops: int
    area: float


def quality(surface: Surface) -> Quality:
    """Return the measures of a surface's mesh."""
    points, triangles = surface.points, surface.triangles
    count = len(points)
    edges, numbers = numbered_edges(triangles)
    length = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
    corner = angles(points, triangles)
    used = np.zeros(count, dtype=bool)
    used[triangles] = True
    close = scipy.spatial.cKDTree(points).query_pairs(
        1e-9 * float(np.ptp(points)), output_type="ndarray"
    )
    border = open_edges(triangles)
    return Quality(
        vertices=count,
        triangles=len(triangles),
        edges=len(edges),
        smallest_angle=float(corner.min()),
        largest_angle=float(corner.max()),
        shortest_edge=float(length.min()),
        mean_edge=float(length.mean()),
        longest_edge=float(length.max()),
        components=_pieces(edges, np.flatnonzero(used)),
        duplicates=len(close),
        orphans=int((~used).sum()),
        crossed=_crossed(triangles, numbers),
        euler=int(used.sum()) - len(edges) + len(triangles),
        loops=_pieces(border, np.unique(border)) if len(border) else 0,
        area=float(surface.areas().sum()),
    )


def _pieces(edges: Ints, vertices: Ints) -> int:
    place = np.full(int(vertices.max()) + 1, -1)
    place[vertices] = np.arange(len(vertices))
    ends = place[edges]
    size = len(vertices)
    graph = scipy.sparse.coo_array(
        (np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(size, size)
    )
    return int(scipy.sparse.csgraph.connected_components(graph, directed=False)[0])


def _crossed(triangles: Ints, numbers: Ints) -> int:
    uses = np.bincount(numbers.ravel())
    half = triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2)
    upward = np.bincount(numbers.ravel(), weights=np.where(half[:, 0] < half[:, 1], 1, -1))
    return int(((uses > 2) | ((uses == 2) & (upward != 0))).sum())
