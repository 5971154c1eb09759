"""From the skeleton to a mesh: Delaunay triangles whose edges follow every arc."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.errors import NumericalError
from cardiosurf.geometry.frontier import Frontier, first_stations, frontier, halved, sizes
from cardiosurf.geometry.sheet import Sheet
from cardiosurf.geometry.skeleton import Skeleton
from cardiosurf.geometry.smoothing import improved, relaxed
from cardiosurf.geometry.topology import (
    angles,
    are_edges,
    circumcentres,
    edge_vectors,
    numbered_edges,
)

_CLEAR = 0.6
_FLOOR = 0.03
_SMOOTH_ROUNDS = 6
_ROUNDS = 80
_SMALLEST_ANGLE = 27.0
_LONGEST = 1.7
_SHORTEST = 0.55


@dataclass(frozen=True)
class Draft:
    """A mesh in the making: where its vertices on the skeleton are, and the free ones."""

    stations: tuple[Floats, ...]
    free: Floats


def mesh(sheet: Sheet, bones: Skeleton, edge_length: float) -> tuple[Floats, Ints]:
    """Return vertices (n, 3) and triangles (m, 3) that follow the skeleton.

    Vertices are set on the arcs and evenly between them; the Delaunay triangulation is smoothed,
    and refined at the circumcentres of bad triangles (Ruppert, J Algorithms 18:548, 1995) until
    all angles that the skeleton leaves free are above 27 degrees.

    Raises
    ------
    NumericalError
        If an arc cannot be followed.
    """
    floor = _FLOOR * edge_length
    stations = tuple(first_stations(bones, edge_length, floor, sheet))
    draft = Draft(stations, _scattered(sheet, bones, stations, edge_length))
    lost: Mask = np.zeros(0, dtype=bool)
    for number in range(_ROUNDS):
        front = frontier(bones, draft.stations, sheet)
        points = np.concatenate([front.points, draft.free])
        triangles = _inside(sheet, points)
        lost = ~are_edges(front.segments, triangles)
        if lost.any():
            draft = _recovered(draft, bones, front, lost)
            continue
        if number < _SMOOTH_ROUNDS:
            moved = relaxed(points, triangles, len(front.points), sheet)
            draft = replace(draft, free=moved[len(front.points) :])
            if number < _SMOOTH_ROUNDS - 1:
                draft = _thinned(draft, front, triangles, edge_length)
            continue
        better = _refined(draft, bones, front, triangles, sheet, edge_length)
        if better is None:
            break
        draft = better
    if lost.any():
        raise NumericalError("the mesh cannot follow the region edges", "a smaller edge_length")
    return _without_orphans(improved(points, triangles, len(front.points), sheet), triangles)


def _scattered(
    sheet: Sheet, bones: Skeleton, stations: tuple[Floats, ...], edge_length: float
) -> Floats:
    seeds = sheet.seeds(edge_length)
    seeds = seeds[sheet.part_of(seeds) >= 0]
    front = frontier(bones, stations, sheet)
    if not len(front.segments):
        return seeds
    wanted = sizes(front, edge_length, seeds)
    tree = cKDTree(np.concatenate([front.points, front.middles]))
    return seeds[tree.query(seeds)[0] > _CLEAR * wanted]


def _inside(sheet: Sheet, points: Floats) -> Ints:
    triangles, centres = sheet.triangulate(points)
    return triangles[sheet.part_of(centres) >= 0]


def _recovered(draft: Draft, bones: Skeleton, front: Frontier, lost: Mask) -> Draft:
    """Remove the free vertices in the circles of lost segments; halve those that have none."""
    crowd = np.zeros(len(draft.free), dtype=bool)
    alone = lost.copy()
    if len(draft.free):
        near = cKDTree(draft.free).query_ball_point(front.middles[lost], 0.5 * front.lengths[lost])
        for number, found in zip(np.flatnonzero(lost), near, strict=True):
            crowd[found] = True
            alone[number] = not found
    stations = halved(bones, draft.stations, front, alone)
    return Draft(tuple(stations), draft.free[~crowd])


def _thinned(draft: Draft, front: Frontier, triangles: Ints, edge_length: float) -> Draft:
    """Remove free vertices that are too near another vertex."""
    fixed = len(front.points)
    points = np.concatenate([front.points, draft.free])
    edges, _ = numbered_edges(triangles)
    edges = edges[edges[:, 1] >= fixed]
    length = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
    short = length < _SHORTEST * sizes(front, edge_length, points[edges].mean(axis=1))
    gone: set[int] = set()
    for one, other in edges[short][np.argsort(length[short], kind="stable")].tolist():
        if one not in gone:
            gone.add(other)
    keep = np.ones(len(points), dtype=bool)
    keep[list(gone)] = False
    return replace(draft, free=draft.free[keep[fixed:]])


def _refined(
    draft: Draft,
    bones: Skeleton,
    front: Frontier,
    triangles: Ints,
    sheet: Sheet,
    edge_length: float,
) -> Draft | None:
    """Return the draft with vertices added at bad triangles, None if there is nothing to do."""
    points = np.concatenate([front.points, draft.free])
    bad, worth = _bad(points, triangles, front, edge_length)
    if not len(bad):
        return None
    order = np.argsort(worth, kind="stable")
    centre, radius = circumcentres(points, triangles[bad[order]])
    centre = sheet.project(centre)
    split = np.zeros(len(front.segments), dtype=bool)
    inside = sheet.part_of(centre) >= 0
    if len(front.segments):
        tree = cKDTree(front.middles)
        away, which = tree.query(centre, k=min(6, tree.n))
        away, which = away.reshape(len(centre), -1), which.reshape(len(centre), -1)
        within = away < 0.5 * front.lengths[which]
        blocked = within.any(axis=1)
        split[which[within]] = True
        split &= front.lengths > _FLOOR * edge_length
        inside &= ~blocked
    new = _apart(centre[inside], radius[inside])
    if not split.any() and not len(new):
        return None
    stations = halved(bones, draft.stations, front, split)
    return Draft(tuple(stations), np.concatenate([draft.free, new]))


def _bad(
    points: Floats, triangles: Ints, front: Frontier, edge_length: float
) -> tuple[Ints, Floats]:
    """Return the triangles that need another vertex, and their smallest angles."""
    corner = angles(points, triangles)
    least = corner.min(axis=1)
    sides = np.linalg.norm(edge_vectors(points, triangles), axis=2)
    wanted = sizes(front, edge_length, points[triangles].mean(axis=1))
    bad = (least < _SMALLEST_ANGLE) | (sides.max(axis=1) > _LONGEST * wanted)
    bad &= sides.min(axis=1) > 0.5 * _FLOOR * edge_length
    rows = np.flatnonzero(bad)
    if not len(rows) or not len(front.segments):
        return rows, least[rows]
    at = corner[rows].argmin(axis=1)
    tip = triangles[rows, at]
    forced = np.ones(len(rows), dtype=bool)
    for turn in (1, 2):
        other = triangles[rows, (at + turn) % 3]
        forced &= are_edges(np.stack([tip, other], axis=1), _as_triangles(front.segments))
    rows = rows[~forced]
    return rows, least[rows]


def _as_triangles(segments: Ints) -> Ints:
    return segments[:, [0, 1, 1]]


def _apart(points: Floats, radius: Floats) -> Floats:
    """Return the points without those nearer to an earlier one than their radius."""
    if not len(points):
        return points
    near = cKDTree(points).query_ball_point(points, 0.9 * radius)
    taken = np.zeros(len(points), dtype=bool)
    for number, others in enumerate(near):
        taken[number] = not taken[others].any()
    return points[taken]


def _without_orphans(points: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    used = np.unique(triangles)
    renumbered = np.full(len(points), -1)
    renumbered[used] = np.arange(len(used))
    return points[used], renumbered[triangles]
