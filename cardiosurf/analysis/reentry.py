"""Reentry: tissue that is activated twice by one and the same beat."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardiosurf.analysis.cycles import CycleLength, activated_shares, find_returns
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
    cycle_length_spread : float or None
        From the 5th to the 95th percentile of these times, in tu.
    last_reactivation : float or None
        When tissue was last activated again by the same beat, in tu.
    activated_shares : tuple of float
        Shares of the excitable area that were activated 0, 1, 2, ... times, by whatever beat.
    """

    verdict: ReentryVerdict
    max_activations: int
    cycle_length: float | None
    cycle_length_spread: float | None = None
    last_reactivation: float | None = None
    activated_shares: tuple[float, ...] = ()


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
    shares = activated_shares(waves.nodes, vertex_areas)
    returns = find_returns(waves)
    area = vertex_areas[np.unique(returns.nodes)].sum()
    if not len(returns.times) or area < REENTRY_AREA * vertex_areas.sum():
        return ReentryFinding("none", most, None, activated_shares=shares)
    cycle = CycleLength.of(returns.cycles)
    last = float(returns.times.max())
    going_on = active and cycle.median is not None and last >= end - 2.0 * cycle.median
    verdict: ReentryVerdict = "sustained" if going_on else "transient"
    return ReentryFinding(verdict, most, cycle.median, cycle.spread, last, shares)
