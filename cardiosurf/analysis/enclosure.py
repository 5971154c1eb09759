"""What a closed path on a surface runs round.

Every rim is closed with a lid of its own. A closed path along the edges of the triangles then
divides the surface into sides, and crossing the path from left to right lowers the number of turns
about what is there by one. Outside, where it is 0, is the side of the longest rim, or without rims
the larger side.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.analysis.rims import Rim
from cardiosurf.arrays import Floats, Ints
from cardiosurf.geometry.topology import areas, numbered_edges, twins


@dataclass(frozen=True)
class Enclosure:
    """The inside of a closed path.

    Attributes
    ----------
    rims : tuple of str
        Names of the rims that lie inside: the holes that it runs round.
    turns : int
        How often it runs round them, or round the tissue inside: positive counterclockwise, seen
        from the side from which the triangles' vertices run counterclockwise.
    area : float
        Excitable area inside, in su^2.
    """

    rims: tuple[str, ...]
    turns: int
    area: float


def closed_walk(vertices: Ints, triangles: Ints) -> Ints:
    """Return a closed walk from vertex to neighbouring vertex, (k,); it ends where it began.

    Parameters
    ----------
    vertices : (k,) int
        Vertices in turn, each the neighbour of the one before, or the same; from the last back to
        the first the shortest way along edges is taken.
    triangles : (m, 3) int
        Vertex numbers.
    """
    start, end = int(vertices[0]), int(vertices[-1])
    edges, _ = numbered_edges(triangles)
    count = int(triangles.max()) + 1
    graph = scipy.sparse.coo_array(
        (np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count)
    ).tocsr()
    _, before = scipy.sparse.csgraph.dijkstra(
        graph, directed=False, indices=[start], unweighted=True, return_predecessors=True
    )
    home, here = [], end
    while here != start:
        here = int(before[0, here])
        home.append(here)
    whole = np.r_[vertices, np.array(home, dtype=np.int64)]
    return np.asarray(whole[np.r_[True, whole[1:] != whole[:-1]]])


def enclosed(
    walk: Ints, points: Floats, triangles: Ints, rims: tuple[Rim, ...]
) -> Enclosure | None:
    """Return what a closed walk runs round; None if it does not divide the surface.

    Parameters
    ----------
    walk : (k,) int
        Vertices, each the neighbour of the one before; the last is the first.
    points : (n, 3) float
        Vertices of the surface, in su.
    triangles : (m, 3) int
        The excitable triangles, consistently oriented.
    rims : tuple of Rim
        Their rims, the longest first.
    """
    if len(walk) < 4:
        return None
    passes = _passes(walk, triangles)
    left, right = _sides(triangles, rims)
    cut = passes != 0
    size = len(triangles) + len(rims)
    joined = (left[~cut], right[~cut])
    graph = scipy.sparse.coo_array((np.ones(len(joined[0])), joined), shape=(size, size))
    count, part = scipy.sparse.csgraph.connected_components(graph, directed=False)
    own = areas(points, triangles)
    area = np.bincount(part[: len(triangles)], weights=own, minlength=count)
    outside = int(part[len(triangles)]) if rims else int(np.argmax(area))
    number = _numbers(count, outside, (part[left[cut]], part[right[cut]], passes[cut]))
    if number is None:
        return None
    inside = number != 0
    names = tuple(
        rim.name for rim, piece in zip(rims, part[len(triangles) :], strict=True) if inside[piece]
    )
    held = [piece for piece in part[len(triangles) :] if inside[piece]]
    # holes tell the turns; a walk round tissue alone takes the largest part of it
    middle = int(held[0]) if held else int(np.argmax(np.where(inside, area, -1.0)))
    return Enclosure(names, int(number[middle]), float(area[inside].sum()))


def _passes(walk: Ints, triangles: Ints) -> Ints:
    """Return how often a walk runs along each half edge, less how often the other way, (3 m,)."""
    count = int(triangles.max()) + 1
    keys = walk[:-1] * count + walk[1:]
    start, end = triangles[:, [1, 2, 0]].ravel(), triangles[:, [2, 0, 1]].ravel()
    known, times = np.unique(keys, return_counts=True)

    def of(wanted: Ints) -> Ints:
        place = np.minimum(np.searchsorted(known, wanted), len(known) - 1)
        return np.where(known[place] == wanted, times[place], 0)

    return np.asarray(of(start * count + end) - of(end * count + start))


def _sides(triangles: Ints, rims: tuple[Rim, ...]) -> tuple[Ints, Ints]:
    """Return what is left and right of each half edge, (3 m,): triangles, then the rims' lids."""
    count, half = int(triangles.max()) + 1, twins(triangles)
    left = np.arange(len(half)) // 3
    right = half // 3
    start, end = triangles[:, [1, 2, 0]].ravel(), triangles[:, [2, 0, 1]].ravel()
    (at_rim,) = np.nonzero(half < 0)
    keys = start[at_rim] * count + end[at_rim]
    order = np.argsort(keys)
    for number, rim in enumerate(rims):
        place = np.searchsorted(keys[order], rim.edges[:, 0] * count + rim.edges[:, 1])
        right[at_rim[order[place]]] = len(triangles) + number
    return left, right


def _numbers(count: int, outside: int, cuts: tuple[Ints, Ints, Ints]) -> Ints | None:
    """Return the turns about each part, 0 outside; None if they contradict each other.

    ``cuts`` are the parts left and right of the walk, and how often it runs between them that way.
    """
    number = np.zeros(count, dtype=np.int64)
    known = np.zeros(count, dtype=np.bool_)
    known[outside] = True
    steps = set(zip(*(cut.tolist() for cut in cuts), strict=True))
    going_on = True
    while going_on:
        going_on = False
        for left, right, passes in steps:
            if known[left] and not known[right]:
                number[right], known[right], going_on = number[left] - passes, True, True
            elif known[right] and not known[left]:
                number[left], known[left], going_on = number[right] + passes, True, True
    fits = all(number[left] - number[right] == passes for left, right, passes in steps)
    return number if fits else None
