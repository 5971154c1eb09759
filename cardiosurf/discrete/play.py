"""The rule of Appendix B and its game: excited units charge the resting ones they face."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.discrete.network import Network
from cardiosurf.errors import InputError
from cardiosurf.sections import Count, Positive, Section

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
        raise InputError("initial", "no unit, or one that is not there", f"0 to {network.count - 1}")
    state = _State(network, rule, refuse)
    state.excite(first)
    while state.now < most and state.step():
        pass
    return state.result()


class _State:
    """Charges, what is left to give, and who is refractory until when."""

    def __init__(self, network: Network, rule: Rule, refuse: Mask | None) -> None:
        n = network.count
        self.network, self.rule, self.now = network, rule, 0.0
        self.charge, self.left = np.zeros(n), np.zeros(n)
        self.giving = np.zeros(n, dtype=np.bool_)
        self.ready = np.full(n, -np.inf)
        if refuse is not None:
            self.ready[refuse] = np.inf
        self.failures = np.zeros(n, dtype=np.int64)
        self.log: list[tuple[float, Ints]] = []

    def excite(self, units: Ints) -> None:
        """Excite units now."""
        self.log.append((self.now, units))
        self.ready[units] = self.now + self.rule.refractory
        self.charge[units], self.left[units], self.giving[units] = 0.0, self.rule.n_max, True

    def step(self) -> bool:
        """Go on to the next event; return whether there was one."""
        live = self._live()
        if len(live) == 0:
            return False
        sources, targets = self.network.sources[live], self.network.targets[live]
        n = self.network.count
        rates = self.network.speeds[live] / np.bincount(sources, minlength=n)[sources]
        gain = np.bincount(targets, weights=rates, minlength=n)
        loss = np.bincount(sources, weights=rates * self.network.costs[live], minlength=n)
        charged, spending = np.unique(targets), np.unique(sources)
        waits = self.ready[np.isfinite(self.ready) & (self.ready > self.now + SAME)] - self.now
        step = min(
            float(((1.0 - self.charge) / np.where(gain > 0, gain, 1.0))[charged].min()),
            float((self.left[spending] / loss[spending]).min()),
            float(waits.min()) if len(waits) else np.inf,
        )
        self.now += step
        self.charge += step * gain
        self.left -= step * loss
        self.giving[spending[self.left[spending] <= SAME]] = False
        fired = charged[self.charge[charged] >= 1.0 - SAME]
        if len(fired):
            self.excite(fired)
        self._fail()
        return True

    def _live(self) -> Ints:
        """Return the links from giving to resting units; end the sources that have none."""
        network = self.network
        resting = self.ready <= self.now + SAME
        live = np.flatnonzero(self.giving[network.sources] & resting[network.targets])
        self.giving[:] = False
        self.giving[network.sources[live]] = True
        return live

    def _fail(self) -> None:
        """Give up the charged units that nobody charges any more."""
        fed = np.zeros(self.network.count, dtype=np.bool_)
        fed[self.network.targets[self._live()]] = True
        lost = np.flatnonzero((self.charge > 0.0) & ~fed)
        self.charge[lost] = 0.0
        self.failures[lost] += 1
        if self.rule.failed == "refractory":
            self.ready[lost] = self.now + self.rule.refractory

    def result(self) -> Play:
        """Return what happened."""
        times = np.concatenate([np.full(len(units), at) for at, units in self.log])
        units = np.concatenate([units for _, units in self.log])
        first = np.full(self.network.count, np.nan)
        first[units[::-1]] = times[::-1]
        return Play(times, units, first, self.failures, self.now)
