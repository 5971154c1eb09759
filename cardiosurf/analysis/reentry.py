"""Reentry: tissue that is activated more often than it was stimulated."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardiosurf.arrays import Floats, Mask
from cardiosurf.recording.recording import Events

ReentryVerdict = Literal["none", "transient", "sustained"]

REENTRY_AREA = 0.01
"""Share of the excitable area that must be reactivated: less is flicker at the edge of a block."""


@dataclass(frozen=True)
class ReentryFinding:
    """Whether activation came back.

    Attributes
    ----------
    verdict : str
        ``none``; ``sustained``: still active at the end, with new activations of already activated
        tissue within the last two cycles; ``transient``: it came back but had ended by then.
    max_activations : int
        The largest number of activations of any vertex.
    cycle_length : float or None
        Median time between successive activations of reactivated tissue, in tu.
    """

    verdict: ReentryVerdict
    max_activations: int
    cycle_length: float | None


def reentry_finding(
    events: Events, vertex_areas: Floats, *, beats: int, end: float, active_at_end: Mask
) -> ReentryFinding:
    """Tell whether tissue was activated more often than stimuli account for.

    Parameters
    ----------
    events : Events
        All activations.
    vertex_areas : (n,) float
        Excitable area that belongs to each vertex, in su^2.
    beats : int
        Number of distinct times at which stimuli were given: each can activate a vertex once.
    end : float
        When the recording ends, in tu.
    active_at_end : (n,) bool
        Vertices above u = 0.5 at the end.
    """
    counts = np.bincount(events.nodes, minlength=len(vertex_areas))
    most = int(counts.max(initial=0))
    again = counts > beats
    if vertex_areas[again].sum() < REENTRY_AREA * vertex_areas.sum():
        return ReentryFinding("none", most, None)
    order = np.lexsort((events.times, events.nodes))
    node, time = events.nodes[order], events.times[order]
    same = node[1:] == node[:-1]
    intervals = (time[1:] - time[:-1])[same & again[node[1:]]]
    cycle = float(np.median(intervals))
    rank = np.arange(len(node)) - np.searchsorted(node, node)
    latest = float(time[rank >= beats].max())
    going_on = bool(active_at_end.any()) and latest >= end - 2.0 * cycle
    return ReentryFinding("sustained" if going_on else "transient", most, cycle)
