"""Which triangles of a mesh are bad, and which vertices mend them."""

from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.frontier import Frontier, sizes, wedges
from cardiosurf.geometry.sheet import Sheet
from cardiosurf.geometry.topology import angles, are_edges, circumcentres, edge_lengths, sharpness

FLOOR = 0.03
_LONGEST = 1.7
_FORCED = 21.5


@dataclass(frozen=True)
class Bad:
    """Triangles (k, 3) that need another vertex, and the smallest angle (k,) of each."""

    triangles: Ints
    least: Floats


def bad_triangles(
    points: Floats, triangles: Ints, front: Frontier, edge_length: float, smallest: float
) -> Bad:
    """Return the triangles that are too sharp or too large, without those nothing can mend.

    Parameters
    ----------
    points, triangles : (n, 3), (m, 3)
        The mesh.
    front : Frontier
        Its first vertices.
    edge_length : float
        Edge length wanted far from short segments, in su.
    smallest : float
        Smallest angle that is good enough, in degrees.
    """
    sides = edge_lengths(points, triangles)
    longest = sides.max(axis=0)
    wanted = np.full(len(triangles), float(edge_length))
    # no edge is wanted longer than edge_length, nor shorter than the shortest segment
    doubtful = longest > _LONGEST * min(edge_length, float(front.lengths.min(initial=np.inf)))
    wanted[doubtful] = sizes(front, edge_length, points[triangles[doubtful]].mean(axis=1))
    bad = (sharpness(points, triangles) < smallest + 1e-6) | (longest > _LONGEST * wanted)
    bad &= sides.min(axis=0) > 0.5 * FLOOR * edge_length
    rows = np.flatnonzero(bad)
    corner = angles(points, triangles[rows])
    least = corner.min(axis=1)
    if not len(rows) or not len(front.segments):
        return Bad(triangles[rows], least)
    at = corner.argmin(axis=1)
    tip, one, other = (triangles[rows, (at + turn) % 3] for turn in range(3))
    segments = front.segments[:, [0, 1, 1]]
    settled = are_edges(np.stack([tip, one], axis=1), segments)
    settled &= are_edges(np.stack([tip, other], axis=1), segments)
    settled |= _across_wedge(np.stack([one, other], axis=1), least, front)
    return Bad(triangles[rows[~settled]], least[~settled])


def remedy(
    bad: Bad, points: Floats, front: Frontier, sheet: Sheet, edge_length: float
) -> tuple[Floats, Mask]:
    """Return new vertices (k, 3) at circumcentres and the segments (s,) that must be halved.

    A circumcentre in the circle around a segment is not taken; the segment is halved instead.
    The worst triangles come first, and no two new vertices come into one circle.
    """
    order = np.argsort(bad.least, kind="stable")
    centre, radius = circumcentres(points, bad.triangles[order])
    centre = sheet.project(centre)
    split = np.zeros(len(front.segments), dtype=bool)
    inside = sheet.part_of(centre) >= 0
    if len(front.segments):
        tree = scipy.spatial.cKDTree(front.middles)
        near = tree.query(centre, k=min(6, tree.n))
        away, which = (np.asarray(one).reshape(len(centre), -1) for one in near)
        within = away < 0.5 * front.lengths[which]
        split[which[within]] = True
        split &= front.lengths > FLOOR * edge_length
        split[[one for _, *pair in wedges(front) for one in pair]] = False
        inside &= ~within.any(axis=1)
    return _apart(centre[inside], radius[inside]), split


def _across_wedge(edges: Ints, least: Floats, front: Frontier) -> Mask:
    """Return which edges (k, 2) join the two arcs of a sharp corner at like distances from it.

    No vertex can do much for the triangles on such an edge: it is short because the corner is
    sharp (Miller, Pav and Walkington, 2003).
    """
    across = np.zeros(len(edges), dtype=bool)
    on = (edges < len(front.points)).all(axis=1)
    for corner, *pair in wedges(front):
        ends = front.points[front.segments[pair]].sum(axis=1) - 2.0 * front.points[corner]
        cosine = float(ends[0] @ ends[1]) / float(np.prod(np.linalg.norm(ends, axis=1)))
        hopeless = np.degrees(np.arccos(min(1.0, cosine))) < _FORCED
        arcs = sorted(int(front.arc_of[one]) for one in pair)
        rows = np.flatnonzero(on & ~across & (hopeless | (least > _FORCED)))
        match = (np.sort(front.arc_at[edges[rows]], axis=1) == arcs).all(axis=1)
        away = np.linalg.norm(front.points[edges[rows]] - front.points[corner], axis=2)
        across[rows[match & (away.max(axis=1) < 1.3 * away.min(axis=1))]] = True
    return across


def _apart(points: Floats, radius: Floats) -> Floats:
    """Return the points without those nearer to an earlier one than their radius."""
    if not len(points):
        return points
    near = scipy.spatial.cKDTree(points).query_ball_point(points, 0.9 * radius)
    taken = np.zeros(len(points), dtype=bool)
    for number, others in enumerate(near):
        taken[number] = not taken[others].any()
    return points[taken]
