"""Where a wave came from, step by step: a path on the surface that goes back in time.

The path follows the characteristics of the anisotropic eikonal equation, -D grad T with T the time
of the wave that passes just then (a vertex has one for each of its activations: the nearest in time
counts). It is straight in each triangle. Where it would leave the tissue, or two triangles send it
into each other, it runs along the edge between them to the earlier end.
"""

from dataclasses import dataclass

import numpy as np

from cardiosurf.analysis.neighbours import Lists, triangles_around
from cardiosurf.analysis.waves import Waves
from cardiosurf.arrays import Floats, Ints
from cardiosurf.geometry.topology import twins

SMALL = 1e-12
MOST_STEPS = 100_000


@dataclass(frozen=True)
class Path:
    """A path back in time.

    Attributes
    ----------
    points : (k, 3) float
        Its points, the latest first, in su.
    times : (k,) float
        When the wave was there, in tu; falling.
    triangles : (k - 1,) int
        The triangle that each piece lies in.
    vertices : (k,) int
        The vertex nearest to each point, of those at the ends of the edge it lies on.
    """

    points: Floats
    times: Floats
    triangles: Ints
    vertices: Ints


@dataclass(frozen=True)
class Ground:
    """What a path runs over.

    Attributes
    ----------
    points : (n, 3) float
        Vertices, in su.
    triangles : (m, 3) int
        Those that paths may cross.
    tensor : (m, 3, 3) float
        Their diffusivity, in su^2/tu.
    beyond : (3 m,) int
        For each half edge that of the neighbour, -1 at a rim.
    around : Lists
        The triangles at each vertex.
    times, starts : (k,), (n + 1,)
        Activation times, one vertex after another, in tu; where those of each vertex begin.
    window : float
        Activations farther from the path's time than this are other waves', in tu.
    """

    points: Floats
    triangles: Ints
    tensor: Floats
    beyond: Ints
    around: Lists
    times: Floats
    starts: Ints
    window: float

    @classmethod
    def of(
        cls, points: Floats, triangles: Ints, tensor: Floats, waves: Waves, window: float
    ) -> "Ground":
        """Return the ground for paths over some triangles with their diffusivity."""
        count = len(points)
        starts = np.searchsorted(waves.nodes, np.arange(count + 1))
        around = triangles_around(triangles, count)
        return cls(points, triangles, tensor, twins(triangles), around, waves.times, starts, window)

    def time_at(self, vertex: int, time: float) -> float:
        """Return the activation of a vertex nearest to a time; NaN if none is within the window."""
        known = self.times[self.starts[vertex] : self.starts[vertex + 1]]
        if not known.size:
            return np.nan
        nearest = float(known[np.argmin(np.abs(known - time))])
        return nearest if abs(nearest - time) <= self.window else np.nan

    def slopes(self, triangle: int, time: float) -> tuple[Floats, Floats, float] | None:
        """Return how a wave passed a triangle about some time; None if not over all of it.

        That is the activation times of its corners (3,); how the barycentric coordinates change
        along -D grad T, (3,); and how steeply T falls that way, in tu/su.
        """
        corners = self.triangles[triangle]
        times = np.array([self.time_at(int(vertex), time) for vertex in corners])
        if np.isnan(times).any():
            return None
        a, b, c = self.points[corners]
        normal = np.cross(b - a, c - a)
        rises = np.cross(normal, (c - b, a - c, b - a)) / (normal @ normal)
        gradient = times @ rises
        back = -self.tensor[triangle] @ gradient
        length = float(np.linalg.norm(back))
        if length < SMALL:
            return None
        return times, rises @ back, float(-(gradient @ back) / length)


@dataclass(frozen=True)
class _Place:
    """Where a path is: on the edge from vertex ``a`` to ``b``, ``share`` of the way (0: at a).

    ``half`` is the half edge of the triangle that lies ahead, -1 if the path cannot go on there or
    is at a vertex.
    """

    a: int
    b: int
    share: float
    time: float
    half: int


def _across(ground: Ground, triangle: int, entry: Floats, time: float) -> _Place | None:
    """Follow the path across a triangle from the barycentric ``entry``; None: it leads outward."""
    passed = ground.slopes(triangle, time)
    if passed is None:
        return None
    times, change, _ = passed
    at_edge = entry <= SMALL
    if (change[at_edge] < 0.0).any():
        return None
    falling = change < 0.0
    way = np.full(3, np.inf)
    way[falling] = entry[falling] / -change[falling]
    out = int(np.argmin(way))
    where = np.maximum(entry + way[out] * change, 0.0)
    one, other = (out + 1) % 3, (out + 2) % 3
    share = float(where[other] / (where[one] + where[other]))
    corners = ground.triangles[triangle]
    reached = float((1.0 - share) * times[one] + share * times[other])
    half = int(ground.beyond[3 * triangle + out])
    return _Place(int(corners[one]), int(corners[other]), share, reached, half)


def _from_vertex(ground: Ground, vertex: int, time: float) -> tuple[_Place, int] | None:
    """Go on from a vertex: across the triangle that the path leads into, else along an edge."""
    best: tuple[float, _Place, int] | None = None
    along: tuple[float, _Place, int] | None = None
    own, _ = ground.around.at(np.array([vertex]))
    for triangle in own.tolist():
        corners = ground.triangles[triangle]
        entry = (corners == vertex).astype(np.float64)
        passed = ground.slopes(triangle, time)
        place = None if passed is None else _across(ground, triangle, entry, time)
        if passed is not None and place is not None and (best is None or passed[2] > best[0]):
            best = (passed[2], place, triangle)
        for neighbour in corners[corners != vertex].tolist():
            since = ground.time_at(neighbour, time)
            length = float(np.linalg.norm(ground.points[neighbour] - ground.points[vertex]))
            fall = (time - since) / length
            if fall > 0.0 and (along is None or fall > along[0]):
                along = (fall, _Place(neighbour, neighbour, 0.0, since, -1), triangle)
    chosen = best or along
    return None if chosen is None else (chosen[1], chosen[2])


def _next(ground: Ground, place: _Place, behind: int) -> tuple[_Place, int] | None:
    """Return the next place and the triangle between; ``behind`` is the triangle just crossed."""
    if place.a == place.b:
        return _from_vertex(ground, place.a, place.time)
    if place.half >= 0:
        triangle, out = divmod(place.half, 3)
        entry = np.zeros(3)
        # the neighbour runs along the shared edge the other way
        entry[(out + 1) % 3], entry[(out + 2) % 3] = place.share, 1.0 - place.share
        ahead = _across(ground, triangle, entry, place.time)
        if ahead is not None and ahead.time < place.time:
            return ahead, triangle
    ends = [(ground.time_at(vertex, place.time), vertex) for vertex in (place.a, place.b)]
    known = [end for end in ends if not np.isnan(end[0])]
    if not known:
        return None
    since, vertex = min(known)
    return _Place(vertex, vertex, 0.0, min(since, place.time), -1), behind


def trace_back(ground: Ground, vertex: int, time: float, until: float) -> Path:
    """Follow a wave back from one activation of a vertex.

    Parameters
    ----------
    ground : Ground
        What the path runs over.
    vertex : int
        Where it begins.
    time : float
        The activation that it begins at, in tu.
    until : float
        How far back it goes, in tu; it ends earlier where the wave began.
    """
    place, triangle = _Place(vertex, vertex, 0.0, time, -1), -1
    places, triangles = [place], []
    while place.time > until and len(places) < MOST_STEPS:
        following = _next(ground, place, triangle)
        if following is None:
            break
        place, triangle = following
        places.append(place)
        triangles.append(triangle)
    ends = np.array([(place.a, place.b) for place in places])
    share = np.array([place.share for place in places])[:, None]
    return Path(
        points=(1.0 - share) * ground.points[ends[:, 0]] + share * ground.points[ends[:, 1]],
        times=np.array([place.time for place in places]),
        triangles=np.array(triangles, dtype=np.int64),
        vertices=np.where(share[:, 0] < 0.5, ends[:, 0], ends[:, 1]),
    )
