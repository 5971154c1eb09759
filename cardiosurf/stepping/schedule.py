"""When the steps fall: equal ones between the switches of the stimuli, and on every switch."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np

from cardiosurf.arrays import Floats


class Pulse(Protocol):
    """What the time loop needs of a stimulus.

    A pulse without duration sets u to the larger of u and its profile, at once; one with a
    duration adds its profile to u_t while it lasts.
    """

    @property
    def time(self) -> float:
        """When it starts, in tu."""
        ...

    @property
    def duration(self) -> float:
        """How long it lasts, in tu; 0 for one that acts at once."""
        ...

    @property
    def profile(self) -> Floats:
        """Its strength at every vertex, (n,); of u, or in 1/tu with a duration."""
        ...

    @property
    def label(self) -> str:
        """Its name."""
        ...


@dataclass(frozen=True)
class Segment:
    """A stretch of time with equal steps and no switch of a stimulus inside.

    Attributes
    ----------
    start, stop : float
        Its ends, in tu.
    count : int
        Number of steps.
    """

    start: float
    stop: float
    count: int

    @property
    def step(self) -> float:
        """Length of a step, in tu.

        Rounded to 12 digits, so that the stretches of a regular train share their matrices.
        """
        return float(f"{(self.stop - self.start) / self.count:.12g}")

    def time(self, done: int) -> float:
        """Return the time after ``done`` of its steps, in tu; exactly ``stop`` after the last."""
        if done == self.count:
            return self.stop
        return self.start + (self.stop - self.start) * done / self.count


def schedule(
    pulses: Sequence[Pulse], *, step: float, end: float, begin: float = 0.0
) -> tuple[Segment, ...]:
    """Return the segments between ``begin`` and ``end``, divided at every switch of a pulse.

    Parameters
    ----------
    pulses : sequence of Pulse
        The stimuli.
    step : float
        The longest step allowed, in tu; those of a segment are equal and at most this long.
    end, begin : float
        Where the time ends and begins, in tu.
    """
    switches = {t for pulse in pulses for t in (pulse.time, pulse.time + pulse.duration)}
    marks = _apart({begin, *(t for t in switches if begin < t < end)})
    marks = [*(t for t in marks if not _close(t, end)), end]
    return tuple(
        # the margin keeps a ratio that is an integer up to rounding from costing one step more
        Segment(a, b, max(1, math.ceil((b - a) / step * (1.0 - 1e-9))))
        for a, b in pairwise(marks)
    )


def _apart(times: Iterable[float]) -> list[float]:
    """Return the times without those that differ from an earlier one by rounding only."""
    apart: list[float] = []
    for time in sorted(times):
        if not (apart and _close(time, apart[-1])):
            apart.append(time)
    return apart


def _close(a: float, b: float) -> bool:
    """Return whether two times are the same up to rounding."""
    return abs(a - b) <= 1e-9 * max(1.0, abs(a), abs(b))


def switch_on(pulses: Sequence[Pulse], segment: Segment, state: Floats) -> Floats:
    """Return the state after the instantaneous pulses at the segment's start: u <- max(u, profile).

    Doing it twice changes nothing; without a pulse that raises u, the state itself is returned.
    """
    raised = state
    for pulse in pulses:
        on = pulse.duration == 0.0 and _close(pulse.time, segment.start)
        if on and np.any(pulse.profile > raised[0]):
            raised = np.array((np.maximum(raised[0], pulse.profile), raised[1]))
    return raised


def current(pulses: Sequence[Pulse], segment: Segment) -> Floats | None:
    """Return the current s that is on during the segment, (n,), in 1/tu; None if there is none."""
    middle = (segment.start + segment.stop) / 2.0
    profiles = [p.profile for p in pulses if p.time < middle < p.time + p.duration]
    return np.sum(profiles, axis=0) if profiles else None


def pending(pulses: Sequence[Pulse], segment: Segment, end: float) -> bool:
    """Return whether a pulse is on during the segment, or still to come before ``end``."""
    middle = (segment.start + segment.stop) / 2.0
    return any(pulse.time + pulse.duration > middle and pulse.time < end for pulse in pulses)
