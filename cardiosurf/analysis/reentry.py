"""Reentry: tissue that is activated twice by one and the same beat."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardiosurf.analysis.waves import Waves
from cardiosurf.arrays import Floats

ReentryVerdict = Literal["none", "transient", "sustained"]

REENTRY_AREA = 0.01
"""Share of the excitable area that must be reactivated: less is noise at the edge of a block."""


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
        Median time between successive activations of a vertex by the same beat, in tu.
    """

    verdict: ReentryVerdict
    max_activations: int
    cycle_length: float | None


def reentry_finding(
    waves: Waves, vertex_areas: Floats, *, end: float, active: bool
) -> ReentryFinding:
    """Tell whether a wave came back to tissue that it had activated before.

    Parameters
    ----------
    waves : Waves
        All activations and the beats that they go back to.
    vertex_areas : (n,) float
        Excitable area that belongs to each vertex, in su^2.
    end : float
        When the recording ends, in tu.
    active : bool
        Whether any tissue was above u = 0.5 then.
    """
    most = int(np.bincount(waves.nodes).max(initial=0))
    order = np.lexsort((waves.times, waves.beats, waves.nodes))
    nodes, beats, times = waves.nodes[order], waves.beats[order], waves.times[order]
    again = np.flatnonzero((nodes[1:] == nodes[:-1]) & (beats[1:] == beats[:-1])) + 1
    area = vertex_areas[np.unique(nodes[again])].sum()
    if not again.size or area < REENTRY_AREA * vertex_areas.sum():
        return ReentryFinding("none", most, None)
    cycle = float(np.median(times[again] - times[again - 1]))
    going_on = active and float(times[again].max()) >= end - 2.0 * cycle
    return ReentryFinding("sustained" if going_on else "transient", most, cycle)
