"""From the skeleton to a mesh: Delaunay triangles whose edges follow every arc."""

from dataclasses import dataclass, replace

import numpy as np
import scipy

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.errors import NumericalError
from cardiosurf.geometry.flips import updated
from cardiosurf.geometry.frontier import Frontier, Line, first_lines, frontier, halved, sizes
from cardiosurf.geometry.refinement import FLOOR, Bad, bad_triangles, remedy
from cardiosurf.geometry.sheet import Sheet
from cardiosurf.geometry.skeleton import Skeleton
from cardiosurf.geometry.smoothing import improved, relaxed
from cardiosurf.geometry.topology import are_edges, corners_in, edge_lengths, numbered_edges

_CLEAR = 0.6
_SHORTEST = 0.55
_LEAST = 1e-5
_SMOOTH_ROUNDS = 2
_ROUNDS = 80
_SWEEPS = 4
_FINAL_SWEEPS = 30
# smallest angle asked for, and what must do after so many rounds
_ASKED = 27.0
_ENOUGH = 22.0
_PATIENCE = 30
_TRIES = 3
# part of a mesh is looked at in a zone: in units of the edge length, how far around it vertices
# are triangulated, which of the triangles can be trusted, and which are judged
_AROUND = 10.0
_TRUSTED = 7.0
_JUDGED = 4.0


@dataclass(frozen=True)
class Job:
    """What is to be meshed: the exact surface, the skeleton, the edge length in su."""

    sheet: Sheet
    bones: Skeleton
    edge_length: float


@dataclass(frozen=True)
class Draft:
    """A mesh in the making.

    Attributes
    ----------
    lines : tuple of Line
        Its vertices on the skeleton's arcs.
    free : (f, 3) float
        The other ones.
    hull : (m, 3) int, or None
        Delaunay triangles of all its vertices, where they are known.
    """

    lines: tuple[Line, ...]
    free: Floats
    hull: Ints | None = None


@dataclass(frozen=True)
class View:
    """A draft triangulated, all of it or around a zone that still needs work.

    Attributes
    ----------
    front : Frontier
        Vertices and segments on the skeleton.
    points : (n, 3) float
        All vertices, those of the front first.
    triangles : (m, 3) int
        Delaunay triangles on the surface, of all vertices or of those around the zone.
    hull : (h, 3) int
        These and those past open edges.
    judged : (n,) bool
        Vertices in the zone: all their triangles are there, and right.
    lost : (s,) bool
        Segments in the zone that are no edges of triangles.
    """

    front: Frontier
    points: Floats
    triangles: Ints
    hull: Ints
    judged: Mask
    lost: Mask

    @property
    def free(self) -> Mask:
        """Vertices that may move, (n,)."""
        return self.judged & (np.arange(len(self.points)) >= len(self.front.points))


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
    job = Job(sheet, bones, edge_length)
    lines = first_lines(bones, edge_length, FLOOR * edge_length, sheet)
    draft = _smoothed(Draft(lines, _scattered(job, lines)), job)
    best, worst, zone, wholes = None, -1.0, None, 0
    for number in range(_ROUNDS):
        view = _seen(draft, job, zone)
        if view.lost.any():
            draft = _recovered(draft, view, job)
            continue
        points = improved(view.points, view.triangles, view.free, sheet, sweeps=_SWEEPS)
        view = replace(view, points=points)
        draft = replace(draft, free=points[len(view.front.points) :])
        bad = _bad(view, edge_length, _ASKED if number < _PATIENCE else _ENOUGH)
        if view.judged.all():
            wholes += 1
            if (least := float(bad.least.min(initial=90.0))) >= worst:
                best, worst = view, least
        draft, helped = _refined(draft, view, job, bad)
        if view.judged.all() and (not helped or wholes == _TRIES):
            break
        zone = points[bad.triangles].mean(axis=1) if helped and number < _ROUNDS - 3 else None
    if best is None:
        raise NumericalError("the mesh cannot follow the region edges", "a smaller edge_length")
    points = improved(best.points, best.triangles, best.free, sheet, sweeps=_FINAL_SWEEPS)
    return _without_orphans(points, best.triangles)


def _scattered(job: Job, lines: tuple[Line, ...]) -> Floats:
    """Return seeds that are clear of the skeleton."""
    seeds = job.sheet.seeds(job.edge_length)
    seeds = seeds[job.sheet.part_of(seeds) >= 0]
    front = frontier(job.bones.corners, lines)
    if not len(front.segments):
        return seeds
    tree = scipy.spatial.cKDTree(np.concatenate([front.points, front.middles]))
    # no edge is wanted longer than edge_length: seeds farther away are clear
    reach = _CLEAR * job.edge_length
    away = np.asarray(tree.query(seeds, distance_upper_bound=reach * (1.0 + 1e-9))[0])
    near = np.flatnonzero(np.isfinite(away))
    keep = np.ones(len(seeds), dtype=bool)
    keep[near] = away[near] > _CLEAR * sizes(front, job.edge_length, seeds[near])
    return seeds[keep]


def _smoothed(draft: Draft, job: Job) -> Draft:
    for number in range(_SMOOTH_ROUNDS):
        view = _seen(draft, job, None)
        if view.lost.any():
            draft = _recovered(draft, view, job)
            continue
        points = relaxed(view.points, view.triangles, view.free, job.sheet)
        gone = np.zeros(len(points), dtype=bool)
        if number < _SMOOTH_ROUNDS - 1:
            gone = _too_near(replace(view, points=points), job.edge_length)
        draft = _moved_on(draft, view, points, gone, job.sheet)
    return draft


def _moved_on(draft: Draft, view: View, points: Floats, gone: Mask, sheet: Sheet) -> Draft:
    """Return the draft with all vertices of a view in new places but those that are gone."""
    moved = (points != view.points).any(axis=1)
    hull = updated(sheet.flattened(points), view.hull, moved, gone, periods=sheet.periods)
    if hull is not None:
        hull = (np.cumsum(~gone) - 1)[hull]
    fixed = len(view.front.points)
    return Draft(draft.lines, points[fixed:][~gone[fixed:]], hull)


def _seen(draft: Draft, job: Job, zone: Floats | None) -> View:
    """Return the draft triangulated: all of it, or around the zone's points (k, 3)."""
    front = frontier(job.bones.corners, draft.lines)
    points = np.concatenate([front.points, draft.free])
    away = np.zeros(len(points))
    if zone is not None:
        reach = _AROUND * job.edge_length
        found, _ = scipy.spatial.cKDTree(zone).query(points, distance_upper_bound=reach)
        away = np.asarray(found) / job.edge_length
    near = np.flatnonzero(np.isfinite(away))
    hull = draft.hull if zone is None else None
    if hull is None:
        hull = near[job.sheet.triangulate(points[near])]
    # a triangle with a free vertex is past no open edge
    doubtful = np.flatnonzero(corners_in(np.arange(len(points)) < len(front.points), hull) == 3)
    past = job.sheet.part_of(job.sheet.centres(points, hull[doubtful])) < 0
    triangles = np.delete(hull, doubtful[past], axis=0)
    triangles = triangles[corners_in(away < _TRUSTED, triangles) == 3]
    judged = np.asarray(away < _JUDGED)
    lost = judged[front.segments].all(axis=1) & ~are_edges(front.segments, triangles)
    return View(front, points, triangles, hull, judged, lost)


def _recovered(draft: Draft, view: View, job: Job) -> Draft:
    """Remove the free vertices in the circles of lost segments; halve those that have none."""
    front, lost = view.front, view.lost
    crowd = np.zeros(len(draft.free), dtype=bool)
    alone = lost.copy()
    if len(draft.free):
        near = scipy.spatial.cKDTree(draft.free).query_ball_point(
            front.middles[lost], 0.5 * front.lengths[lost]
        )
        for number, found in zip(np.flatnonzero(lost), near, strict=True):
            crowd[found] = True
            alone[number] = not found
    if (front.lengths[alone] < _LEAST * job.edge_length).any():
        # halving would go on, and double the vertices each time
        raise NumericalError(
            "the mesh cannot follow region edges that graze each other or the surface's own",
            "a region moved by a little, or a smaller edge_length",
        )
    return Draft(halved(draft.lines, front, alone, job.sheet), draft.free[~crowd])


def _too_near(view: View, edge_length: float) -> Mask:
    """Return the free vertices that are too near another vertex, (n,)."""
    fixed, points = len(view.front.points), view.points
    # no edge is wanted longer than edge_length: a look at the short ones will do
    row = np.flatnonzero(edge_lengths(points, view.triangles).min(axis=0) < _SHORTEST * edge_length)
    edges, _ = numbered_edges(view.triangles[row])
    edges = edges[edges[:, 1] >= fixed]
    length = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
    short = length < _SHORTEST * sizes(view.front, edge_length, points[edges].mean(axis=1))
    gone = np.zeros(len(points), dtype=bool)
    for one, other in edges[short][np.argsort(length[short], kind="stable")].tolist():
        if not gone[one]:
            gone[other] = True
    return gone


def _bad(view: View, edge_length: float, asked: float) -> Bad:
    triangles = view.triangles[corners_in(view.judged, view.triangles) == 3]
    return bad_triangles(view.points, triangles, view.front, edge_length, asked)


def _refined(draft: Draft, view: View, job: Job, bad: Bad) -> tuple[Draft, bool]:
    """Return the draft with vertices added at bad triangles, and whether there are any."""
    if not len(bad.triangles):
        return draft, False
    new, split = remedy(bad, view.points, view.front, job.sheet, job.edge_length)
    lines = halved(draft.lines, view.front, split, job.sheet)
    return Draft(lines, np.concatenate([draft.free, new])), len(new) > 0 or bool(split.any())


def _without_orphans(points: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    used = np.zeros(len(points), dtype=bool)
    used[triangles] = True
    return points[used], (np.cumsum(used) - 1)[triangles]
