"""What observers see of a march, and what is needed to take it up again."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.stepping.limits import THRESHOLD
from cardiosurf.stepping.schedule import Segment


class Crossings(NamedTuple):
    """Crossings of u = 0.5.

    Attributes
    ----------
    nodes : (k,) int
        Vertices.
    times : (k,) float
        When, interpolated inside the step, in tu.
    upward : (k,) bool
        True where u rises: an activation.
    """

    nodes: Ints
    times: Floats
    upward: Mask

    def then(self, later: "Crossings") -> "Crossings":
        """Return these and later ones."""
        return Crossings(*(np.concatenate(pair) for pair in zip(self, later, strict=True)))


def crossings_between(before: Floats, after: Floats, begun: float, ended: float) -> Crossings:
    """Return the crossings of 0.5 between two potentials (n,) at two times, interpolated linearly.

    Reaching 0.5 and turning back is none.
    """
    upward = after > THRESHOLD
    nodes = np.flatnonzero(upward != (before > THRESHOLD))
    rise = (THRESHOLD - before[nodes]) / (after[nodes] - before[nodes])
    return Crossings(nodes, begun + rise * (ended - begun), upward[nodes])


class Trace(NamedTuple):
    """Some vertices after every step of a stretch.

    Attributes
    ----------
    nodes : (w,) int
        Vertices.
    times : (k,) float
        After each step, in tu.
    values : (k, 2, w) float
        Their u and v.
    """

    nodes: Ints
    times: Floats
    values: Floats


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
    """A step of a march, as its observers see it, with what they missed of those before it.

    Steps at which no observer asked to look (``Patient``) have no moment of their own; the next
    one tells their crossings and traces. An instantaneous pulse is a moment of its own: ``time ==
    previous_time``, the same step number, the states just before and just after it. The arrays are
    read-only and never change later, so they may be kept.

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
        ``moment.checkpoint()`` returns the Checkpoint; costs nothing unless it is called. Where
        steps were passed over it is to be had only until the march goes on.
    crossed : Crossings or None
        All crossings of 0.5 since the moment before; None: those between the two states.
    trace : Trace or None
        What is watched, after every step since the moment before; None: at this one alone.
    """

    step: int
    time: float
    state: Floats
    previous_time: float
    previous_state: Floats
    pulse_pending: bool = False
    checkpoint: Callable[[], Checkpoint] = field(default=_no_checkpoint, repr=False, compare=False)
    crossed: Crossings | None = field(default=None, repr=False, compare=False)
    trace: Trace | None = field(default=None, repr=False, compare=False)

    def crossings(self) -> Crossings:
        """Return all crossings of 0.5 since the moment before."""
        if self.crossed is not None:
            return self.crossed
        before, after = self.previous_state[0], self.state[0]
        return crossings_between(before, after, self.previous_time, self.time)

    def watched(self, nodes: Ints) -> tuple[Floats, Floats]:
        """Return times (k,) and u, v (k, 2, ...) of vertices after every step since the last one.

        Parameters
        ----------
        nodes : (...) int
            Vertices that a ``Watching`` observer watches; any if no step was passed over.
        """
        if self.trace is None:
            return np.array([self.time]), self.state[:, nodes][None]
        place = np.searchsorted(self.trace.nodes, nodes)
        return self.trace.times, self.trace.values[:, :, place]


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


@runtime_checkable
class Patient(Protocol):
    """An observer that need not see every step, as it is content with crossings and traces."""

    def due(self) -> float:
        """Return the time from which on it wants the next moment, in tu; inf if any will do."""
        ...


@runtime_checkable
class Watching(Protocol):
    """An observer that wants to know some vertices after every step."""

    @property
    def watches(self) -> Ints:
        """The vertices, in any shape."""
        ...
