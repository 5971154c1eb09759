"""The steps of the rest of a segment, marched in machine code."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from cardiosurf.arrays import Floats
from cardiosurf.stepping.compiled.engine import Engine, Leg
from cardiosurf.stepping.moment import Checkpoint, Moment
from cardiosurf.stepping.place import Cost, Place, Stride, Wishes, check, located
from cardiosurf.stepping.stepper import Stepper


class Stretch(NamedTuple):
    """The rest of a segment.

    Attributes
    ----------
    place : Place
        Where it begins.
    source : (n,) float or None
        The current that is on, in 1/tu.
    to_come : bool
        Whether a pulse is still on or to come.
    """

    place: Place
    source: Floats | None
    to_come: bool


def compiled_steps(
    engine: Engine, stepper: Stepper, stretch: Stretch, wishes: Wishes
) -> Iterator[Stride]:
    """Yield the moments of a stretch, marched in machine code.

    Parameters
    ----------
    engine : Engine
        What marches; it holds the last states, before and afterwards.
    stepper : Stepper
        The step rule, for the reactions of a checkpoint and the remedies of a failure.
    stretch : Stretch
        Where and under which current.
    wishes : Wishes
        Which steps the observers want to see.

    Raises
    ------
    NumericalError
        As ``march``.
    """
    place, segment = stretch.place, stretch.place.segment
    while place.done < segment.count:
        times = _times(place, wishes.due(), engine.room)
        leg = engine.go(times, segment.step, stretch.source, pending=stretch.to_come)
        if leg.steps:
            place = place.on(leg.steps)
            checkpoint = partial(_checkpoint, place, engine, stepper, engine.strides)
            yield _stride(place, stretch.to_come, leg, checkpoint)
        _check(engine, stepper, place.on(1), stretch.source)


def _times(place: Place, due: float, most: int) -> Floats:
    """Return the present time and those of the steps up to the one that is due."""
    segment = place.segment
    count = min(segment.count - place.done, most)
    times = [place.time]
    for done in range(place.done + 1, place.done + count + 1):
        times.append(segment.time(done))
        if times[-1] >= due:
            break
    return np.array(times)


def _stride(place: Place, to_come: bool, leg: Leg, checkpoint: Callable[[], Checkpoint]) -> Stride:
    """Return the moment after a leg of the compiled march."""
    for state in (leg.state, leg.previous):
        state.setflags(write=False)
    moment = Moment(
        place.step,
        place.time,
        leg.state,
        place.segment.time(place.done - 1),
        leg.previous,
        to_come,
        checkpoint,
        leg.crossings,
        leg.trace,
    )
    step = place.segment.step
    return Stride(moment, Cost(step, leg.steps, leg.iterations, leg.most, leg.seconds))


def _checkpoint(place: Place, engine: Engine, stepper: Stepper, strides: int) -> Checkpoint:
    """Return the checkpoint of a place, if the compiled march is still there."""
    if engine.strides != strides:
        raise LookupError("the march has gone on: its checkpoint is to be had at the moment only")
    states = engine.states()
    reactions = [stepper.reaction(state) for state in states[: len(stepper.scheme.explicit)]]
    return Checkpoint(*place, np.array(states), np.array(reactions))


def _check(engine: Engine, stepper: Stepper, place: Place, source: Floats | None) -> None:
    """Raise if the compiled march failed in the step to a place."""
    if engine.failure is not None:
        raise located(engine.failure, place)
    if engine.broken is not None:
        check(stepper, engine.broken, place, source)
