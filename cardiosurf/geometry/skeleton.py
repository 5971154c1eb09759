"""The curves a mesh must follow: open edges, part boundaries and region edges, cut at corners."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import scipy

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.arcs import Arc, Piece, made_even
from cardiosurf.geometry.levels import Key, Level
from cardiosurf.geometry.locate import onto_level, tangential
from cardiosurf.geometry.membership import contains, levels_of
from cardiosurf.geometry.regions import Region
from cardiosurf.geometry.sheet import Sheet
from cardiosurf.geometry.trace import Chain, Crossings, background, crossings, follow

_SAME = 0.005
_BESIDE = 1e-6
_THROUGH = 1e-5


@dataclass(frozen=True)
class Skeleton:
    """Corners (c, 3) and the arcs between them."""

    corners: Floats
    arcs: tuple[Arc, ...]


def skeleton(sheet: Sheet, regions: Mapping[str, Region], edge_length: float) -> Skeleton:
    """Return all curves across which the part or the membership of a region changes.

    Curves closer to each other than 0.005 edge lengths all along are taken for one; an open edge
    or a part boundary goes before a region's edge.

    Parameters
    ----------
    sheet : Sheet
        The exact surface.
    regions : mapping of str to Region
        Checked regions.
    edge_length : float
        Edge length of the mesh to be made, in su.
    """
    fixed = _unlike(sheet.levels())
    levels = _unlike((*fixed, *(one for r in regions.values() for one in levels_of(r, sheet))))
    same = _SAME * edge_length
    ground = background(sheet, levels)
    chains: list[Chain] = []
    for number, level in enumerate(levels):
        found = follow(number, level, ground, sheet)
        chains += [c for c in found if not _follows_earlier(c, levels[:number], sheet, same)]
    corners, sets, pinched = _clustered(crossings(chains, levels, ground, sheet), len(fixed), same)
    pieces = [p for c in chains for p in _split(c, corners, sets, pinched, 0.3 * ground.spacing)]
    pieces = [p for p in pieces if not (p.ends[0] == p.ends[1] >= 0 and p.length < 4.0 * same)]
    pieces = _joined(_real(pieces, levels, sheet, regions), len(corners), pinched)
    used = np.unique([end for p in pieces for end in p.ends if end >= 0]).astype(np.int64)
    renumbered = np.full(len(corners) + 1, -1)
    renumbered[used] = np.arange(len(used))
    step = 0.25 * ground.spacing
    arcs = [
        made_even(
            replace(p, ends=(int(renumbered[p.ends[0]]), int(renumbered[p.ends[1]]))),
            levels[p.level],
            sheet,
            step,
        )
        for p in pieces
    ]
    return Skeleton(corners[used], tuple(arcs))


def _unlike(levels: Sequence[Level]) -> tuple[Level, ...]:
    first: dict[Key, Level] = {}
    for level in levels:
        first.setdefault(level.key, level)
    return tuple(first.values())


def _follows_earlier(chain: Chain, earlier: Sequence[Level], sheet: Sheet, same: float) -> bool:
    for level in earlier:
        value = np.abs(level.value(chain.points))
        if value.max() > same:
            continue
        slope = tangential(level.gradient(chain.points), sheet.normal(chain.points))
        if (value <= same * np.linalg.norm(slope, axis=1) + 1e-12).all():
            return True
    return False


def _clustered(
    found: Crossings, fixed: int, same: float
) -> tuple[Floats, list[set[int]], set[int]]:
    """Return one corner for all crossings within ``same``, and the levels that meet in it.

    The best-defined crossing stands for the others: levels of the shape before levels of regions,
    steep crossings before tangential ones. The third are the corners in which a level crosses
    itself.
    """
    order = np.lexsort((-found.sine, -(found.pairs < fixed).sum(axis=1)))
    points, pairs = found.points[order], found.pairs[order]
    if not len(points):
        return points, [], set()
    near = scipy.spatial.cKDTree(points).query_ball_point(points, same)
    corner_of = np.full(len(points), -1)
    corners: list[int] = []
    sets: list[set[int]] = []
    for number, others in enumerate(near):
        if corner_of[number] < 0:
            corner_of[number] = len(corners)
            corners.append(number)
            sets.append(set())
            mine = np.asarray(others)
            corner_of[mine[corner_of[mine] < 0]] = corner_of[number]
        sets[corner_of[number]].update(pairs[number].tolist())
    pinched = set(corner_of[pairs[:, 0] == pairs[:, 1]].tolist())
    return points[corners], sets, pinched


def _split(
    chain: Chain, corners: Floats, sets: list[set[int]], pinched: set[int], reach: float
) -> list[Piece]:
    """Return the chain's pieces between corners; what hangs over at open ends is dropped."""
    mine = [i for i, levels in enumerate(sets) if chain.level in levels]
    length = np.linalg.norm(np.diff(chain.points, axis=0), axis=1)
    past = np.concatenate([[0.0], np.cumsum(length)])
    crossed = [i for i in mine if i in pinched]
    stops = _passed(chain, past, corners, np.array(sorted({*mine} - {*crossed}), dtype=int), reach)
    for corner in crossed:
        stops += _passed_often(chain, past, corner, corners[corner], reach)
    stops.sort(key=lambda stop: stop[1])
    if not stops:
        whole = (Piece(chain.level, chain.points, (-1, -1)),)
        return list(whole) if chain.closed else []
    pieces = [_between(chain, past, corners, one, other) for one, other in pairwise(stops)]
    if chain.closed:
        first = (stops[0][0], stops[0][1] + past[-1])
        pieces.append(_between(chain, past, corners, stops[-1], first))
    return [piece for piece in pieces if piece.length > 0.0]


def _passed(
    chain: Chain, past: Floats, corners: Floats, mine: Ints, reach: float
) -> list[tuple[int, float]]:
    """Return the corners among ``mine`` near the chain, and after which length each comes."""
    if not len(mine):
        return []
    start, step = chain.points[:-1], np.diff(chain.points, axis=0)
    length = np.linalg.norm(step, axis=1)
    away = corners[mine][:, None] - start[None]
    share = np.einsum("csk,sk->cs", away, step) / np.maximum(length**2, 1e-300)
    share = np.clip(share, 0.0, 1.0)
    distance = np.linalg.norm(away - share[:, :, None] * step[None], axis=2)
    close = np.flatnonzero(distance.min(axis=1) < reach)
    best = distance.argmin(axis=1)[close]
    place = past[best] + share[close, best] * length[best]
    return list(zip(mine[close].tolist(), place.tolist(), strict=True))


def _passed_often(
    chain: Chain, past: Floats, corner: int, at: Floats, reach: float
) -> list[tuple[int, float]]:
    """Return every passage of the chain through a corner in which its level crosses itself."""
    points = chain.points[:-1] if chain.closed else chain.points
    through = np.flatnonzero(np.linalg.norm(points - at, axis=1) < _THROUGH * reach)
    return [(corner, float(past[one])) for one in through]


def _between(
    chain: Chain, past: Floats, corners: Floats, one: tuple[int, float], other: tuple[int, float]
) -> Piece:
    points = chain.points
    if other[1] > past[-1]:
        points = np.concatenate([points, points[1:]])
        past = np.concatenate([past, past[1:] + past[-1]])
    margin = 1e-6 * past[-1]
    inner = points[(past > one[1] + margin) & (past < other[1] - margin)]
    ends = corners[[one[0]]], corners[[other[0]]]
    return Piece(chain.level, np.concatenate([ends[0], inner, ends[1]]), (one[0], other[0]))


def _real(
    pieces: Sequence[Piece], levels: Sequence[Level], sheet: Sheet, regions: Mapping[str, Region]
) -> list[Piece]:
    """Return the pieces across which something changes, those of regions alone marked soft."""
    if not pieces:
        return []
    shares = np.array([0.23, 0.5, 0.77])
    beside = _BESIDE * sheet.size
    sides: tuple[list[Floats], list[Floats]] = ([], [])
    for piece in pieces:
        level = levels[piece.level]
        at = onto_level(sheet.project(piece.at(shares)), level, sheet, 0.1 * piece.length)
        across = tangential(level.gradient(at), sheet.normal(at))
        across *= beside / np.maximum(np.linalg.norm(across, axis=1), 1e-300)[:, None]
        sides[0].append(sheet.project(at + across))
        sides[1].append(sheet.project(at - across))
    one, other = (_signature(np.concatenate(side), sheet, regions) for side in sides)
    differs = (one != other).any(axis=1).reshape(-1, 3).sum(axis=1) >= 2
    edge = (one[:, 0] != other[:, 0]).reshape(-1, 3).any(axis=1)
    return [
        replace(piece, soft=not bool(at_part))
        for piece, real, at_part in zip(pieces, differs, edge, strict=True)
        if real
    ]


def _signature(points: Floats, sheet: Sheet, regions: Mapping[str, Region]) -> Ints:
    part = sheet.part_of(points)
    on: Mask = part >= 0
    inside = [on & contains(region, sheet, points, part) for region in regions.values()]
    return np.stack([part, *(one.astype(np.int64) for one in inside)], axis=1)


def _joined(pieces: list[Piece], corners: int, pinched: set[int]) -> list[Piece]:
    """Return the pieces, those joined that run on into each other where nothing else ends.

    Where a level crosses itself two pieces of it may make an angle, and stay apart.
    """
    done = False
    while not done:
        done = True
        meet: list[list[int]] = [[] for _ in range(corners)]
        for number, piece in enumerate(pieces):
            for end in piece.ends:
                if end >= 0:
                    meet[end].append(number)
        gone: set[int] = set()
        new: list[Piece] = []
        for corner, here in enumerate(meet):
            if len(here) != 2 or gone & set(here) or corner in pinched:
                continue
            one, other = pieces[here[0]], pieces[here[1]]
            if one.level != other.level or one.soft != other.soft:
                continue
            new.append(one.closed() if here[0] == here[1] else one.followed_by(other, corner))
            gone.update(here)
            done = False
        pieces = [piece for number, piece in enumerate(pieces) if number not in gone] + new
    return pieces
