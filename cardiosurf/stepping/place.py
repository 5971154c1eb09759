"""Where a march is, what it yields, and whether a state is sound."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from cardiosurf.arrays import Floats, Ints
from cardiosurf.errors import NumericalError
from cardiosurf.stepping.limits import BLOW_UP
from cardiosurf.stepping.moment import Moment
from cardiosurf.stepping.schedule import Segment
from cardiosurf.stepping.step_rule import ERROR_COEFFICIENTS, auto_step, reaction_rate
from cardiosurf.stepping.stepper import Stepper

# steps after a switch of the stimuli in which a blow-up is put down to them
SOON = 20


@dataclass(frozen=True)
class Wishes:
    """What the observers want to see.

    Attributes
    ----------
    due : callable
        Returns the time from which on a moment is wanted, in tu; -inf for every step.
    watch : (w,) int
        Vertices whose state is wanted after every step, sorted.
    """

    due: Callable[[], float] = lambda: -np.inf
    watch: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))


class Cost(NamedTuple):
    """What steps took: their length in tu, their number, iterations, the most of one, seconds."""

    step: float
    steps: int
    iterations: int
    most: int
    seconds: float


class Stride(NamedTuple):
    """A moment, and what getting there took; nothing for the first moment and for a pulse."""

    moment: Moment
    cost: Cost | None


class Place(NamedTuple):
    """How far the march is: steps since time 0, the segment, steps done in it."""

    step: int
    segment: Segment
    done: int

    @property
    def time(self) -> float:
        """Time reached, in tu."""
        return self.segment.time(self.done)

    def on(self, steps: int) -> "Place":
        """Return the place some steps further in the segment."""
        return self._replace(step=self.step + steps, done=self.done + steps)


def _where(place: Place) -> str:
    return f"at step {place.step}, t = {place.time:g} tu"


def located(error: NumericalError, place: Place) -> NumericalError:
    """Return the error with step and time."""
    return NumericalError(f"{error.problem}, {_where(place)}", error.hint)


def check(stepper: Stepper, state: Floats, place: Place, source: Floats | None) -> None:
    """Raise if a state is not sound."""
    where = _where(place)
    lowest, highest = float(state[0].min()), float(state[0].max())
    if not -BLOW_UP <= lowest <= highest <= BLOW_UP:
        raise NumericalError(
            f"the potential blew up to {max(-lowest, highest):.3g} {where}",
            _remedy(stepper, place, source),
        )
    if not np.isfinite(state[1].sum()):
        raise NumericalError(
            f"the recovery is not finite {where}",
            f"a time.step below {place.segment.step:g}, or slower kinetics",
        )


def _remedy(stepper: Stepper, place: Place, source: Floats | None) -> str:
    """Return what to try after a blow-up: what is likely its cause comes first."""
    step = place.segment.step
    advice = [f"a time.step below {step:g}"]
    if _auto(stepper) < step:
        advice.append("time.step: auto")
    # a stable step is not what makes u run away just after, or during, a stimulus
    elif source is not None or place.done <= SOON:
        advice.insert(0, "a weaker stimulus (its amplitude or strength)")
    return ", or ".join(advice)


def _auto(stepper: Stepper) -> float:
    """Return the step that auto stands for, infinite where the rule knows none."""
    with np.errstate(all="ignore"):
        known = 0.0 < reaction_rate(stepper.kinetics) < np.inf
    if not known or stepper.scheme.name not in ERROR_COEFFICIENTS:
        return np.inf
    return auto_step(stepper.scheme, stepper.kinetics).step
