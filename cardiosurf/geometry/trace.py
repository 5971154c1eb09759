"""The curves on the surface where levels are zero, and the points where two of them cross."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.levels import Level
from cardiosurf.geometry.locate import onto_crossing, onto_level
from cardiosurf.geometry.pinches import ON_LEVEL, saddles
from cardiosurf.geometry.sheet import Sheet
from cardiosurf.geometry.topology import centroids, edge_vectors, numbered_edges

_FINENESS = 75.0
_NOISE = 1e-9


@dataclass(frozen=True)
class Background:
    """A triangulation of the surface that levels are followed on; not the mesh itself.

    Attributes
    ----------
    points : (n, 3) float
        Vertices, also past the open edges.
    triangles, edges, edges_of : (m, 3), (k, 2), (m, 3) int
        Triangles, edges, and the edges of each triangle.
    spacing : float
        Usual edge length, in su.
    pinches : tuple of (k, 3) float
        Where the curve of each level crosses itself; these are vertices.
    """

    points: Floats
    triangles: Ints
    edges: Ints
    edges_of: Ints
    spacing: float
    pinches: tuple[Floats, ...] = ()


@dataclass(frozen=True)
class Chain:
    """A connected curve of points (k, 3) on one level, in order; closed ones end as they begin."""

    level: int
    points: Floats
    closed: bool


@dataclass(frozen=True)
class Crossings:
    """Points (c, 3) where levels cross, the sine of the angle and the two levels (c, 2).

    Where a level crosses itself both are the same, and the sine counts as 1.
    """

    points: Floats
    sine: Floats
    pairs: Ints


def background(sheet: Sheet, levels: Sequence[Level]) -> Background:
    """Return a background on which every closed piece of every level shows a change of sign."""
    spacing = sheet.size / _FINENESS
    points = sheet.seeds(spacing)
    found = _triangulated(sheet, points, spacing)
    hidden = [_hidden(level, found, sheet) for level in levels]
    bent = [saddles(level, found.points, found.edges, sheet, spacing) for level in levels]
    pairs = zip(levels, bent, strict=True)
    pinches = tuple(points[np.abs(level.value(points)) < ON_LEVEL] for level, points in pairs)
    centres = np.concatenate([np.empty((0, 3)), *bent, *hidden])
    if not len(centres):
        return replace(found, pinches=pinches)
    rings = _rings(centres, sheet, spacing)
    apart = scipy.spatial.cKDTree(points).query(rings)[0] > 1e-3 * spacing * 2.0**-14
    found = _triangulated(sheet, np.concatenate([points, rings[apart]]), spacing)
    return replace(found, pinches=pinches)


def follow(number: int, level: Level, ground: Background, sheet: Sheet) -> list[Chain]:
    """Return the chains of one level."""
    inside = level.value(ground.points) >= -_NOISE
    crossed = np.flatnonzero(inside[ground.edges[:, 0]] != inside[ground.edges[:, 1]])
    if not len(crossed):
        return []
    points = _on_edges(level, ground, crossed, sheet)
    place = np.full(len(ground.edges), -1)
    place[crossed] = np.arange(len(crossed))
    hits = place[ground.edges_of]
    hits = hits[(hits >= 0).sum(axis=1) == 2]
    links = np.sort(hits, axis=1)[:, 1:]
    walks = _walks(links, len(crossed))
    curves = [(_without_repeats(points[order], ground.spacing), closed) for order, closed in walks]
    # a plane that only touches the surface leaves a single point
    return [Chain(number, curve, closed) for curve, closed in curves if len(curve) > 2]


def crossings(
    chains: Sequence[Chain], levels: Sequence[Level], ground: Background, sheet: Sheet
) -> Crossings:
    """Return the points where two levels cross, found by Newton from all triangles near both."""
    centres = centroids(ground.points, ground.triangles)
    tree = scipy.spatial.cKDTree(centres)
    cells = [np.zeros(len(ground.triangles), dtype=bool) for _ in levels]
    for chain in chains:
        cells[chain.level][tree.query(chain.points, k=min(10, tree.n))[1].ravel()] = True
    starts, pairs = [np.empty((0, 3))], [np.empty((0, 2), dtype=np.int64)]
    for first in range(len(levels)):
        for second in range(first + 1, len(levels)):
            both = np.flatnonzero(cells[first] & cells[second])
            starts.append(centres[both])
            pairs.append(np.tile([first, second], (len(both), 1)))
    start, pair = sheet.project(np.concatenate(starts)), np.concatenate(pairs)
    found, residual, sine = onto_crossing(start, pair, levels, sheet, ground.spacing)
    near_by = np.linalg.norm(found - start, axis=1) < 3.0 * ground.spacing
    good = near_by & (residual < 1e-8) & ~_pinched(found, pair, ground)
    places, own = _pinches(levels, ground)
    return Crossings(
        np.concatenate([found[good], places]),
        np.concatenate([sine[good], np.ones(len(places))]),
        np.concatenate([pair[good], own]),
    )


def _pinches(levels: Sequence[Level], ground: Background) -> tuple[Floats, Ints]:
    """Return where levels cross themselves (k, 3), paired (k, 2) with all that pass there."""
    through = [
        (place, (number, other))
        for number, places in enumerate(ground.pinches)
        for place in places
        for other, level in enumerate(levels)
        if other == number or abs(level.value(place[None])[0]) < ON_LEVEL
    ]
    spots = np.array([place for place, _ in through], dtype=np.float64).reshape(-1, 3)
    return spots, np.array([pair for _, pair in through], dtype=np.int64).reshape(-1, 2)


def _pinched(points: Floats, pairs: Ints, ground: Background) -> Mask:
    """Return which crossings are where one of their levels crosses itself: Newton is lost there."""
    lost = np.zeros(len(points), dtype=bool)
    for number, places in enumerate(ground.pinches):
        mine = np.flatnonzero((pairs == number).any(axis=1))
        for place in places:
            away = np.linalg.norm(points[mine] - place, axis=1)
            lost[mine[away < 1e-3 * ground.spacing]] = True
    return lost


def _triangulated(sheet: Sheet, points: Floats, spacing: float) -> Background:
    triangles = sheet.triangulate(points)
    # the chart also has triangles across the hole of a vein and around the outside
    longest = np.linalg.norm(edge_vectors(points, triangles), axis=2).max(axis=1)
    triangles = triangles[longest < 4.0 * spacing]
    edges, edges_of = numbered_edges(triangles)
    return Background(points, triangles, edges, edges_of, spacing)


def _hidden(level: Level, ground: Background, sheet: Sheet) -> Floats:
    """Return points (k, 3) of extreme level where a piece of its curve hides between vertices."""
    value = level.value(ground.points)
    side = np.where(value >= -_NOISE, 1.0, -1.0)
    first, second = ground.edges.T
    least = np.ones(len(value), dtype=bool)
    for here, there in ((first, second), (second, first)):
        least[here[(side[here] != side[there]) | (np.abs(value[here]) > np.abs(value[there]))]] = (
            False
        )
    least &= (np.abs(value) < 2.0 * ground.spacing) & (np.abs(value) > _NOISE)
    best = ground.points[least]
    if not len(best):
        return best
    best = _downhill(level, best, side[least], sheet, 2.0 * ground.spacing)
    return best[level.value(best) * side[least] < -_NOISE]


def _downhill(level: Level, start: Floats, side: Floats, sheet: Sheet, reach: float) -> Floats:
    """Return where side * level is least near each start, by zooming in on it."""
    angle = 2.0 * np.pi * np.arange(12) / 12
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    disc = np.concatenate([[[0.0, 0.0]], ring, 0.5 * ring])
    best = start
    for _ in range(40):
        normal = sheet.normal(best)
        axis = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
        along = np.cross(normal, axis)
        along /= np.linalg.norm(along, axis=1)[:, None]
        basis = np.stack([along, np.cross(normal, along)], axis=1)
        tries = best[:, None] + reach * np.einsum("jk,nkd->njd", disc, basis)
        tries = sheet.project(tries.reshape(-1, 3)).reshape(tries.shape)
        value = level.value(tries.reshape(-1, 3)).reshape(tries.shape[:2]) * side[:, None]
        best = tries[np.arange(len(best)), np.argmin(value, axis=1)]
        reach *= 0.7
    return best


def _rings(centres: Floats, sheet: Sheet, spacing: float) -> Floats:
    angle = 2.0 * np.pi * np.arange(16) / 16
    apart = scipy.spatial.cKDTree(centres).query_pairs(1e-3 * spacing, output_type="ndarray")
    centres = np.delete(centres, apart[:, 1], axis=0)
    clouds = [centres]
    for normal, centre in zip(sheet.normal(centres), centres, strict=True):
        along = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
        along /= np.linalg.norm(along)
        ring = np.outer(np.cos(angle), along) + np.outer(np.sin(angle), np.cross(normal, along))
        clouds += [sheet.project(centre + spacing * 2.0**-power * ring) for power in range(12)]
    return np.concatenate(clouds)


def _on_edges(level: Level, ground: Background, crossed: Ints, sheet: Sheet) -> Floats:
    ends = ground.points[ground.edges[crossed]]
    first, second = level.value(ends[:, 0]), level.value(ends[:, 1])
    share = np.clip(first / np.where(first == second, 1.0, first - second), 0.0, 1.0)
    start = sheet.project(ends[:, 0] + share[:, None] * (ends[:, 1] - ends[:, 0]))
    found = onto_level(start, level, sheet, 0.5 * ground.spacing)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    astray = np.linalg.norm(found - start, axis=1) > 0.5 * length
    astray |= np.abs(level.value(found)) > 1e-8
    if astray.any():
        found[astray] = _bisected(level, ends[astray], sheet)
    return found


def _bisected(level: Level, ends: Floats, sheet: Sheet) -> Floats:
    low, high = ends[:, 0].copy(), ends[:, 1].copy()
    inside = level.value(low) >= -_NOISE
    for _ in range(60):
        middle = sheet.project(0.5 * (low + high))
        same = (level.value(middle) >= -_NOISE) == inside
        low[same], high[~same] = middle[same], middle[~same]
    return low


def _without_repeats(points: Floats, spacing: float) -> Floats:
    step = np.linalg.norm(np.diff(points, axis=0), axis=1)
    keep = np.concatenate([[True], step > 1e-7 * spacing])
    return np.asarray(points[keep])


def _walks(links: Ints, count: int) -> list[tuple[Ints, bool]]:
    """Return the connected walks through nodes 0..count-1 that the links (k, 2) make."""
    beside: list[list[int]] = [[] for _ in range(count)]
    for one, other in links.tolist():
        beside[one].append(other)
        beside[other].append(one)
    seen = [False] * count
    walks: list[tuple[Ints, bool]] = []
    starts = [node for node in range(count) if len(beside[node]) == 1]
    for start in [*starts, *range(count)]:
        if seen[start] or not beside[start]:
            continue
        walk, node = [start], start
        seen[start] = True
        while (following := next((n for n in beside[node] if not seen[n]), None)) is not None:
            walk.append(following)
            seen[following] = True
            node = following
        closed = len(walk) > 2 and start in beside[walk[-1]]
        walks.append((np.array([*walk, start] if closed else walk), closed))
    return walks
