"""The rule of Appendix B and its game: excited units charge the resting ones they face."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.discrete.network import Network
from cardiosurf.errors import InputError
from cardiosurf.sections import Positive, Section

SAME = 1e-9
"""Charges and times closer than this are the same: sums of a few hundred shares."""


@dataclass(frozen=True, kw_only=True)
class Rule(Section):
    """What a unit can do.

    An excited unit charges the resting units that it faces, 1 unit of charge in all in 1 unit of
    time, the same to each; a unit that has got 1 is excited. So k targets of one source take the
    time k, and k targets of m sources k/m (property iv). A source has ``n_max`` to give (property
    ii); it is done when that is spent or when nothing that it faces is at rest. A target that was
    charged and has no source left has failed.

    Attributes
    ----------
    n_max : float
        How many units one unit can excite.
    refractory : float
        How long a unit cannot be excited, counted from its excitation, in excitation times.
    failed : str
        What becomes of a unit that was charged in vain: ``refractory``, as SC-ii takes for
        granted, or ``rest``, its charge lost.
    """

    n_max: Positive = 3.0
    refractory: Positive = 30.0
    failed: Literal["refractory", "rest"] = "refractory"


@dataclass(frozen=True)
class Play:
    """What happened.

    Attributes
    ----------
    times : (k,) float
        When units were excited, rising.
    units : (k,) int
        Which unit it was.
    first : (n,) float
        When each unit was excited first; NaN never.
    failures : (n,) int
        How often each unit was charged in vain.
    end : float
        When the last thing happened.
    """

    times: Floats
    units: Ints
    first: Floats
    failures: Ints
    end: float


def play(
    network: Network,
    rule: Rule,
    initial: Ints,
    *,
    most: float = 1e4,
    refuse: Mask | None = None,
) -> Play:
    """Play the game until no excited unit has anything left to do.

    Parameters
    ----------
    network : Network
        The units and their links.
    rule : Rule
        What a unit can do.
    initial : (k,) int
        The units that are excited at time 0.
    most : float
        When to stop at the latest, in excitation times; a circulating wave never ends.
    refuse : (n,) bool, optional
        Units that are never excited.

    Raises
    ------
    InputError
        If an initial unit is not there.
    """
    first = np.unique(np.asarray(initial, dtype=np.int64))
    if len(first) == 0 or first[0] < 0 or first[-1] >= network.count:
        raise InputError(
            "initial", "no unit, or one that is not there", f"0 to {network.count - 1}"
        )
    state = _State(network, rule, refuse)
    state.excite(first)
    while state.now < most and state.step():
        pass
    return state.result()


class _State:
    """Charges, what is left to give, and who is refractory until when.

    Only the links of giving units are looked at, so an event costs what the front is long.
    """

    def __init__(self, network: Network, rule: Rule, refuse: Mask | None) -> None:
        n = network.count
        self.rule, self.now = rule, 0.0
        order = np.argsort(network.sources, kind="stable")
        self.targets, self.speeds = network.targets[order], network.speeds[order]
        self.costs = network.costs[order]
        self.counts = np.bincount(network.sources, minlength=n)
        self.starts = np.concatenate([[0], np.cumsum(self.counts)])
        self.charge, self.left = np.zeros(n), np.zeros(n)
        self.giving = np.zeros(0, dtype=np.int64)
        self.ready = np.full(n, -np.inf)
        if refuse is not None:
            self.ready[refuse] = np.inf
        self.failures = np.zeros(n, dtype=np.int64)
        self.charged = np.zeros(0, dtype=np.int64)
        self.log: list[tuple[float, Ints]] = []

    def excite(self, units: Ints) -> None:
        """Excite units now."""
        self.log.append((self.now, units))
        self.ready[units] = self.now + self.rule.refractory
        self.charge[units], self.left[units] = 0.0, self.rule.n_max
        self.giving = np.concatenate([self.giving, units])

    def step(self) -> bool:
        """Go on to the next event; return whether there was one."""
        sources, links, recovery = self._live()
        if len(links) == 0:
            return False
        spending, of_source, shares = np.unique(sources, return_inverse=True, return_counts=True)
        charged, of_target = np.unique(self.targets[links], return_inverse=True)
        rates = self.speeds[links] / shares[of_source]
        gain = np.bincount(of_target, weights=rates)
        loss = np.bincount(of_source, weights=rates * self.costs[links])
        missing = 1.0 - self.charge[charged]
        step = min(
            float((missing / gain).min()), float((self.left[spending] / loss).min()), recovery
        )
        self.now += step
        self.charge[charged] += step * gain
        self.left[spending] -= step * loss
        self.giving = spending[self.left[spending] > SAME]
        fired = charged[self.charge[charged] >= 1.0 - SAME]
        if len(fired):
            self.excite(fired)
        self._fail(charged)
        return True

    def _live(self) -> tuple[Ints, Ints, float]:
        """Return the links from giving to resting units, and in what time another one recovers.

        A giving unit that faces no resting one is done.
        """
        counts = self.counts[self.giving]
        ends = np.cumsum(counts)
        within = np.arange(ends[-1] if len(ends) else 0) - np.repeat(ends - counts, counts)
        links = np.repeat(self.starts[self.giving], counts) + within
        sources = np.repeat(self.giving, counts)
        wait = self.ready[self.targets[links]] - self.now
        resting = wait <= SAME
        self.giving = np.unique(sources[resting])
        return sources[resting], links[resting], float(wait[~resting].min(initial=np.inf))

    def _fail(self, charged: Ints) -> None:
        """Give up the charged units that nobody charges any more."""
        fed = self.targets[self._live()[1]]
        held = np.union1d(self.charged, charged)
        lost = np.setdiff1d(held[self.charge[held] > 0.0], fed)
        self.charged = np.intersect1d(held, fed)
        self.charge[lost] = 0.0
        self.failures[lost] += 1
        if self.rule.failed == "refractory":
            self.ready[lost] = self.now + self.rule.refractory

    def result(self) -> Play:
        """Return what happened."""
        times = np.concatenate([np.full(len(units), at) for at, units in self.log])
        units = np.concatenate([units for _, units in self.log])
        first = np.full(len(self.ready), np.nan)
        first[units[::-1]] = times[::-1]
        return Play(times, units, first, self.failures, self.now)
