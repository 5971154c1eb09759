"""What observers see of a march, and what is needed to take it up again."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from cardiosurf.arrays import Floats
from cardiosurf.stepping.schedule import Segment


@dataclass(frozen=True)
class Checkpoint:
    """All that a march needs to go on bit for bit; arrays and numbers only.

    Attributes
    ----------
    step : int
        Steps done since time 0.
    segment : Segment
        The stretch of equal steps that it lies in.
    done : int
        Steps done in that segment.
    states : (k, 2, n) float
        The last states (u, v), newest first.
    reactions : (k, 2, n) float
        Their reactions (f, g), in 1/tu; as many as were needed.
    """

    step: int
    segment: Segment
    done: int
    states: Floats
    reactions: Floats

    @property
    def time(self) -> float:
        """Time reached, in tu."""
        return self.segment.time(self.done)

    def to_arrays(self) -> dict[str, Floats]:
        """Return its content as arrays by name, for a file."""
        segment = self.segment
        position = [self.step, segment.start, segment.stop, segment.count, self.done]
        return {
            "position": np.array(position, dtype=np.float64),
            "states": self.states,
            "reactions": self.reactions,
        }

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, Floats]) -> "Checkpoint":
        """Return the checkpoint that ``to_arrays`` took apart."""
        step, start, stop, count, done = (float(number) for number in arrays["position"])
        return cls(
            int(step),
            Segment(start, stop, int(count)),
            int(done),
            np.asarray(arrays["states"], dtype=np.float64),
            np.asarray(arrays["reactions"], dtype=np.float64),
        )


def _no_checkpoint() -> Checkpoint:
    """Stand in for the checkpoint of a moment that no march made."""
    raise LookupError("this moment does not come from a march")


@dataclass(frozen=True)
class Moment:
    """One step of a march, as its observers see it.

    An instantaneous pulse is a moment of its own: ``time == previous_time``, the same step number,
    the states just before and just after it. The arrays are read-only and never change later, so
    they may be kept.

    Attributes
    ----------
    step : int
        Number of steps done.
    time, previous_time : float
        Time of the state and of the one before, in tu.
    state, previous_state : (2, n) float
        u and v at these times.
    pulse_pending : bool
        Whether a stimulus is still to come or still on.
    checkpoint : callable
        ``moment.checkpoint()`` returns the Checkpoint; costs nothing unless it is called.
    """

    step: int
    time: float
    state: Floats
    previous_time: float
    previous_state: Floats
    pulse_pending: bool = False
    checkpoint: Callable[[], Checkpoint] = field(default=_no_checkpoint, repr=False, compare=False)


class Observer(Protocol):
    """What watches a march: called once at its start, after every step and pulse, and at its end.

    A march that fails or is interrupted does not call ``finalize``.
    """

    def initialize(self, moment: Moment) -> None:
        """Take note of the state that the march starts from (both states of the moment)."""
        ...

    def handle(self, moment: Moment) -> None:
        """Take note of a step or of an instantaneous pulse."""
        ...

    def finalize(self, moment: Moment) -> None:
        """Take note of the last moment once more, and close what is open."""
        ...
