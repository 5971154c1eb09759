"""Which stimulus every activation goes back to.

An activation is set off by the activation of a neighbour shortly before it, or by a stimulus. So
each has a parent, the latest activation of a neighbouring vertex before it, or none; following
the parents leads to the beat of a stimulus that it goes back to. Two activations of one vertex
that go back to the same beat mean that a wave came back.
"""

from dataclasses import dataclass

import numpy as np

from cardiosurf.analysis.neighbours import neighbours
from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.recording.recording import Events
from cardiosurf.tissue.stimuli import Pulse

FLICKER = 0.5
"""Activations of one vertex closer than this share of the usual APD are one: a rim that dips."""


@dataclass(frozen=True)
class Waves:
    """All activations, sorted by vertex and then by time, without flicker.

    Attributes
    ----------
    nodes : (k,) int
        The vertex of each activation.
    times : (k,) float
        Its time, in tu.
    beats : (k,) int
        The beat that it goes back to: equal numbers, the same beat.
    pulses : (k,) int
        The pulse that this beat belongs to (a long current can set off several), -1 for none.
    """

    nodes: Ints
    times: Floats
    beats: Ints
    pulses: Ints


def usual_duration(activations: Events, repolarisations: Events, count: int) -> float:
    """Return the median APD of the first activations, in tu; infinite without repolarisation.

    Parameters
    ----------
    activations, repolarisations : Events
        Crossings of u = 0.5 upward and downward.
    count : int
        Number of vertices.
    """
    durations = repolarisations.first(count) - activations.first(count)
    durations = durations[np.isfinite(durations)]
    return float(np.median(durations)) if durations.size else float("inf")


def _sorted_without_flicker(activations: Events, gap: float) -> tuple[Ints, Floats]:
    order = np.lexsort((activations.times, activations.nodes))
    nodes, times = activations.nodes[order], activations.times[order]
    keep = np.ones(len(nodes), dtype=np.bool_)
    keep[1:] = (nodes[1:] != nodes[:-1]) | (times[1:] - times[:-1] > gap)
    return nodes[keep], times[keep]


def _parents(nodes: Ints, times: Floats, triangles: Ints, window: float) -> Ints:
    """Return for each activation the latest one of a neighbour before it, or itself for none."""
    count = int(max(triangles.max(), nodes.max(initial=0))) + 1
    neighbour, event = neighbours(triangles, count).at(nodes)
    # sorted by vertex, then time: one number orders them, and finds "before this, at that vertex"
    span = float(times.max(initial=0.0)) + 1.0
    key = nodes * span + times
    found = np.searchsorted(key, neighbour * span + times[event]) - 1
    valid = (found >= 0) & (nodes[found] == neighbour)
    valid &= (times[found] < times[event]) & (times[event] - times[found] <= window)
    event, found = event[valid], found[valid]
    parent = np.arange(len(nodes))
    if event.size:
        since = times[found]
        own = np.flatnonzero(np.r_[True, event[1:] != event[:-1]])
        latest = np.repeat(np.maximum.reduceat(since, own), np.diff(np.r_[own, event.size]))
        # of two at the same time the later written, that of the higher vertex number, stays
        parent[event[since == latest]] = found[since == latest]
    return parent


def _roots(parent: Ints) -> Ints:
    """Return the first ancestor of each activation."""
    root = parent
    while True:
        further = root[root]
        if np.array_equal(further, root):
            return root
        root = further


def strongly(pulse: Pulse) -> Mask:
    """Return the vertices where a pulse is at least half as strong as at its strongest, (n,)."""
    return np.asarray(pulse.profile >= 0.5 * pulse.profile.max())


def _starts(
    nodes: Ints, times: Floats, pulses: tuple[Pulse, ...], slack: float
) -> tuple[Ints, Floats]:
    """Return for activations without parent the pulse that they go back to, and since when.

    Whatever starts where no pulse acts (across a scar, say) is put down to the last pulse before
    it, as part of what that pulse set off at its beginning.
    """
    pulse = np.full(len(nodes), -1, dtype=np.int64)
    since = times.copy()
    for number, given in enumerate(pulses):
        during = (times >= given.time - 1e-9) & (times <= given.time + given.duration + slack)
        pulse[during & (given.profile[nodes] > 0.0)] = number
    for number, given in reversed(list(enumerate(pulses))):
        stray = (pulse < 0) & (times >= given.time)
        pulse[stray], since[stray] = number, given.time
    return pulse, since


def trace_waves(
    activations: Events,
    repolarisations: Events,
    triangles: Ints,
    pulses: tuple[Pulse, ...],
    count: int,
) -> Waves:
    """Trace every activation back to the beat that it goes back to.

    Parameters
    ----------
    activations, repolarisations : Events
        Crossings of u = 0.5 upward and downward.
    triangles : (m, 3) int
        Vertex numbers.
    pulses : tuple of Pulse
        The stimuli, in the order of time.
    count : int
        Number of vertices.
    """
    duration = usual_duration(activations, repolarisations, count)
    gap = FLICKER * duration if np.isfinite(duration) else 0.0
    nodes, times = _sorted_without_flicker(activations, gap)
    if not nodes.size:
        nothing = np.empty(0, dtype=np.int64)
        return Waves(nothing, times, nothing, nothing)
    root = _roots(_parents(nodes, times, triangles, duration))
    slack = gap if gap > 0.0 else float("inf")
    roots = np.unique(root)
    pulse = np.full(len(nodes), -1, dtype=np.int64)
    pulse[roots], since = _starts(nodes[roots], times[roots], pulses, slack)
    beat = np.zeros(len(nodes), dtype=np.int64)
    beat[roots] = _beats(pulse[roots], since, gap)
    return Waves(nodes, times, beat[root], pulse[root])


def _beats(pulse: Ints, times: Floats, gap: float) -> Ints:
    """Return the number of each start's beat: starts of a pulse further apart than gap differ."""
    order = np.lexsort((times, pulse))
    new = np.ones(len(order), dtype=np.int64)
    same = pulse[order][1:] == pulse[order][:-1]
    near = times[order][1:] - times[order][:-1] <= gap
    new[1:] = ~(same & near)
    beats = np.empty(len(order), dtype=np.int64)
    beats[order] = np.cumsum(new) - 1
    return beats
