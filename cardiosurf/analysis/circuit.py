"""The circuit of a reentrant wave: the closed path on the surface that it runs round once a cycle.

A path back in time (``backtrack``) from a late activation turns with the wave and settles on the
way that all its later activations come from. Where it meets itself one cycle earlier it is closed.
"""

from dataclasses import dataclass

import numpy as np

from cardiosurf.analysis.backtrack import Ground, Path, trace_back
from cardiosurf.analysis.cycles import Returns
from cardiosurf.analysis.enclosure import Enclosure, closed_walk, enclosed
from cardiosurf.analysis.rims import Rim
from cardiosurf.analysis.waves import Waves
from cardiosurf.arrays import Floats, Ints
from cardiosurf.geometry.surface import Surface
from cardiosurf.geometry.topology import edge_lengths
from cardiosurf.tissue.tensor import Tissue

CYCLES = (0.5, 1.5)
"""A path is closed where it was between so many cycles ago."""
TRACED = 6.0
"""How many cycles a path goes back to settle."""
CLOSED = 0.1
"""Paths are often closed exactly: where they run from vertex to vertex they merge."""
STARTS = 8
"""From how many late activations paths are tried."""


@dataclass(frozen=True)
class Circuit:
    """A closed path on the surface, run round once a cycle.

    Attributes
    ----------
    points : (k, 3) float
        Its points in the order of time, in su; from the last one it goes back to the first.
    times : (k,) float
        When the wave was at each, in tu.
    triangles : (k - 1,) int
        The triangle of the surface that each piece between two points lies in.
    period : float
        From when the wave was at the first point to when it was there again, in tu.
    length : float
        In su.
    gap : float
        How far it is from being closed, in su; counted in ``length``.
    enclosure : Enclosure or None
        What it runs round; None if it does not divide the surface (a way round a handle).
    """

    points: Floats
    times: Floats
    triangles: Ints
    period: float
    length: float
    gap: float
    enclosure: Enclosure | None

    @property
    def speed(self) -> float:
        """Mean speed along it, in su/tu."""
        return self.length / self.period


@dataclass(frozen=True)
class _Loop:
    """Points ``first`` to ``last`` of a path, the latest first, that close just after ``first``."""

    first: int
    last: int
    period: float
    gap: float


def find_circuit(
    surface: Surface, tissue: Tissue, waves: Waves, returns: Returns, rims: tuple[Rim, ...]
) -> Circuit | None:
    """Return the circuit of the wave that came back last; None if no path closes.

    Parameters
    ----------
    surface, tissue : Surface, Tissue
        Paths run over the excitable triangles, along -D grad T.
    waves : Waves
        All activations.
    returns : Returns
        Those by which a wave came back.
    rims : tuple of Rim
        The rims of the excitable tissue.
    """
    if not len(returns.times):
        return None
    cycle = float(np.median(returns.cycles))
    (inside,) = np.nonzero(tissue.excitable)
    triangles = surface.triangles[inside]
    ground = Ground.of(surface.points, triangles, tissue.tensor[inside], waves, 0.5 * cycle)
    edge = float(edge_lengths(surface.points, triangles).mean())
    for vertex, time in _late_activations(returns, cycle):
        path = trace_back(ground, vertex, time, time - TRACED * cycle)
        loop = _closing(path, cycle, edge)
        if loop is None:
            continue
        walk = closed_walk(path.vertices[loop.first : loop.last + 1][::-1], triangles)
        around = enclosed(walk, surface.points, triangles, rims)
        return _circuit(path, loop, inside, around)
    return None


def _late_activations(returns: Returns, cycle: float) -> list[tuple[int, float]]:
    """Return vertices and times to begin at: the last return, and others over the cycle before."""
    order = np.argsort(-returns.times, kind="stable")
    late = order[returns.times[order] > returns.times[order[0]] - cycle]
    chosen = late[np.unique(np.linspace(0, len(late) - 1, STARTS).astype(int))]
    return [(int(returns.nodes[one]), float(returns.times[one])) for one in chosen]


def _closing(path: Path, cycle: float, edge: float) -> _Loop | None:
    """Return the latest loop closed to ``CLOSED`` edges, else the best to one edge; or None."""
    points, times = path.points, path.times
    best: _Loop | None = None
    # pieces run from each point to the next, backward in time
    step = np.diff(points, axis=0)
    squared = np.maximum(np.einsum("id,id->i", step, step), 1e-300)
    for last in range(1, len(points)):
        late, early = times[last] + CYCLES[1] * cycle, times[last] + CYCLES[0] * cycle
        begin, end = np.searchsorted(-times, (-late, -early))
        pieces = slice(int(begin), min(int(end), last - 1))
        if pieces.stop <= pieces.start:
            continue
        offset = points[last] - points[:-1][pieces]
        share = np.einsum("id,id->i", offset, step[pieces]) / squared[pieces]
        share = np.clip(share, 0.0, 1.0)
        apart = np.linalg.norm(offset - share[:, None] * step[pieces], axis=1)
        one = int(np.argmin(apart))
        gap = float(apart[one])
        if gap < (edge if best is None else best.gap):
            first = pieces.start + one
            passed = times[first] + share[one] * (times[first + 1] - times[first])
            best = _Loop(first, last, float(passed - times[last]), gap)
            # the path may meet itself better still in cycles before the wave had settled
            if gap <= CLOSED * edge:
                return best
    return best


def _circuit(path: Path, loop: _Loop, inside: Ints, around: Enclosure | None) -> Circuit:
    # the piece in which it closes is left from where the path was a period after its last point
    whole = path.times[loop.last] + loop.period
    first = path.points[loop.first : loop.first + 2]
    span = path.times[loop.first] - path.times[loop.first + 1]
    share = (path.times[loop.first] - whole) / span if span > 0.0 else 0.0
    start = (1.0 - share) * first[0] + share * first[1]
    points = np.vstack((start, path.points[loop.first + 1 : loop.last + 1]))[::-1]
    times = np.r_[whole, path.times[loop.first + 1 : loop.last + 1]][::-1]
    pieces = path.triangles[loop.first : loop.last][::-1]
    length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()) + loop.gap
    return Circuit(points, times, inside[pieces], loop.period, length, loop.gap, around)
