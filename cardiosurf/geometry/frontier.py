"""The mesh's vertices and edges on the skeleton."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.arcs import Arc
from cardiosurf.geometry.sheet import Sheet
from cardiosurf.geometry.skeleton import Skeleton

_ROUNDS = 24
_GROWTH = 0.4
_SHARP = 0.5


@dataclass(frozen=True)
class Frontier:
    """The skeleton cut into mesh edges.

    Attributes
    ----------
    points : (p, 3) float
        Vertices on the skeleton: first the corners, then those on the arcs.
    segments : (s, 2) int
        Mesh edges on the skeleton, as pairs of vertex numbers.
    arc_of, slot : (s,) int
        The arc of each segment, and which of the arc's intervals it is.
    arc_at : (p,) int
        The arc of each vertex, -1 for a corner.
    lengths : (s,) float
        Length of each segment, in su.
    corners : int
        Number of corners.
    """

    points: Floats
    segments: Ints
    arc_of: Ints
    slot: Ints
    arc_at: Ints
    lengths: Floats
    corners: int

    @property
    def middles(self) -> Floats:
        """Middles of the segments, (s, 3)."""
        return np.asarray(self.points[self.segments].mean(axis=1))

    def spacing(self) -> Floats:
        """Return the shortest segment at each vertex, (p,)."""
        least = np.full(len(self.points), np.inf)
        np.minimum.at(least, self.segments.ravel(), np.repeat(self.lengths, 2))
        return least


@dataclass(frozen=True)
class Line:
    """The vertices of one arc: their arclengths (k,) and places (k, 3)."""

    arc: Arc
    stations: Floats
    places: Floats

    def halved(self, slots: Ints, sheet: Sheet) -> "Line":
        """Return the line with one more vertex in the middle of each of the intervals."""
        arc, at = self.arc, self.stations
        around = np.concatenate([at, [at[0] + arc.length]]) if arc.loop else at
        middle = 0.5 * (around[slots] + around[slots + 1])
        return line(arc, np.sort(np.concatenate([at, middle])), sheet)


def line(arc: Arc, stations: Floats, sheet: Sheet) -> Line:
    """Return the line with vertices at the arclengths."""
    return Line(arc, stations, arc.places(stations, sheet))


def frontier(corners: Floats, lines: Sequence[Line]) -> Frontier:
    """Return the vertices and edges of the lines between the corners (c, 3)."""
    points, segments, arc_of, slot = [corners], [], [], []
    start = len(corners)
    for number, one in enumerate(lines):
        inner = one.places if one.arc.loop else one.places[1:-1]
        names = start + np.arange(len(inner))
        if one.arc.loop:
            along = np.concatenate([names, names[:1]])
        else:
            along = np.concatenate([[one.arc.ends[0]], names, [one.arc.ends[1]]])
        points.append(inner)
        segments.append(np.stack([along[:-1], along[1:]], axis=1))
        arc_of.append(np.full(len(along) - 1, number))
        slot.append(np.arange(len(along) - 1))
        start += len(inner)
    if not segments:
        none = np.empty(0, dtype=np.int64)
        return Frontier(corners, none.reshape(0, 2), none, none, none, np.empty(0), 0)
    every, pairs = np.concatenate(points), np.concatenate(segments)
    return Frontier(
        points=every,
        segments=pairs,
        arc_of=np.concatenate(arc_of),
        slot=np.concatenate(slot),
        arc_at=np.repeat(np.arange(-1, len(lines)), [len(one) for one in points]),
        lengths=np.linalg.norm(every[pairs[:, 1]] - every[pairs[:, 0]], axis=1),
        corners=len(corners),
    )


def halved(lines: Sequence[Line], front: Frontier, which: Mask, sheet: Sheet) -> tuple[Line, ...]:
    """Return the lines with one more vertex in the middle of each of the segments marked."""
    new = list(lines)
    for number in np.unique(front.arc_of[which]).tolist():
        slots = front.slot[which & (front.arc_of == number)]
        new[number] = lines[number].halved(slots, sheet)
    return tuple(new)


def first_lines(
    bones: Skeleton, edge_length: float, floor: float, sheet: Sheet
) -> tuple[Line, ...]:
    """Return lines with vertices about edge_length apart, closer where arcs run side by side.

    A segment is halved while a vertex of another one lies in the circle around it, but not below
    the length ``floor``.
    """
    lines = tuple(line(arc, arc.stations(edge_length, sheet), sheet) for arc in bones.arcs)
    for _ in range(_ROUNDS):
        front = frontier(bones.corners, lines)
        crowded = _crowded(front) & (front.lengths > floor)
        if not crowded.any():
            break
        lines = halved(lines, front, crowded, sheet)
    return _evened(lines, frontier(bones.corners, lines), sheet)


def sizes(front: Frontier, edge_length: float, points: Floats) -> Floats:
    """Return the edge length wanted at the points (n, 3): smaller near short segments."""
    spacing = front.spacing()
    small = spacing < 0.9 * edge_length
    wanted = np.full(len(points), edge_length)
    if not small.any() or not len(points):
        return wanted
    tree = scipy.spatial.cKDTree(front.points[small])
    near = tree.query(points, k=min(8, tree.n), distance_upper_bound=3.0 * edge_length)
    away, which = (np.asarray(one).reshape(len(points), -1) for one in near)
    reached = np.append(spacing[small], np.inf)[which] + _GROWTH * away
    return np.asarray(np.minimum(wanted, reached.min(axis=1)))


def wedges(front: Frontier) -> list[tuple[int, int, int]]:
    """Return corners with two segments that leave it less than 60 degrees apart, and those two."""
    found: list[tuple[int, int, int]] = []
    beside: dict[int, list[int]] = {}
    for number, ends in enumerate(front.segments.tolist()):
        for end in ends:
            if end < front.corners:
                beside.setdefault(end, []).append(number)
    for corner, segments in beside.items():
        away = front.points[front.segments[segments]].sum(axis=1) - 2.0 * front.points[corner]
        away /= front.lengths[segments][:, None]
        cosine = away @ away.T
        for one, other in zip(*np.nonzero(np.triu(cosine > _SHARP, 1)), strict=True):
            found.append((corner, segments[one], segments[other]))
    return found


def _evened(lines: Sequence[Line], front: Frontier, sheet: Sheet) -> tuple[Line, ...]:
    """Return the lines with first vertices equally far along both arcs of a sharp corner.

    Vertices at equal distances keep the triangles between the arcs as good as the corner allows.
    """
    new = list(lines)
    nearest: dict[int, float] = {}
    sides: list[tuple[int, int]] = []
    for corner, *pair in wedges(front):
        shortest = min(float(front.lengths[one]) for one in pair)
        nearest[corner] = min(shortest, nearest.get(corner, np.inf))
        sides += [(corner, one) for one in pair]
    for corner, segment in dict.fromkeys(sides):
        number = int(front.arc_of[segment])
        arc, at = new[number].arc, new[number].stations
        if len(at) < 3:
            continue
        wanted = nearest[corner]
        if arc.ends[0] == corner and front.slot[segment] == 0:
            at = np.concatenate([[0.0, wanted], at[at > 1.5 * wanted]])
        else:
            rest = at[at < arc.length - 1.5 * wanted]
            at = np.concatenate([rest, [arc.length - wanted, arc.length]])
        new[number] = line(arc, at, sheet)
    return tuple(new)


def _crowded(front: Frontier) -> Mask:
    """Return the segments whose circle holds a vertex, except of a segment with a common end."""
    tree = scipy.spatial.cKDTree(front.points)
    middles, reach = front.middles, 0.5 * front.lengths * (1.0 - 1e-6)
    crowded = np.zeros(len(middles), dtype=bool)
    some = np.flatnonzero(tree.query_ball_point(middles, reach, return_length=True))
    if not len(some):
        return crowded
    beside: dict[int, set[int]] = {}
    for one, other in front.segments.tolist():
        beside.setdefault(one, set()).add(other)
        beside.setdefault(other, set()).add(one)
    near = tree.query_ball_point(middles[some], reach[some])
    for number, inside in zip(some, near, strict=True):
        one, other = front.segments[number].tolist()
        own = {one, other}
        for end in (one, other):
            if end < front.corners:
                own |= beside[end]
        crowded[number] = not own.issuperset(inside)
    return crowded
