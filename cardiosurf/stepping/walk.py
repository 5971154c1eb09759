"""The steps of a march one after another: from switch to switch, each a moment."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from cardiosurf.arrays import Floats
from cardiosurf.errors import NumericalError
from cardiosurf.fem.operators import Operators
from cardiosurf.kinetics import Kinetics
from cardiosurf.stepping.controls import Controls
from cardiosurf.stepping.moment import Checkpoint, Moment
from cardiosurf.stepping.schedule import Pulse, Segment, current, pending, schedule, switch_on
from cardiosurf.stepping.step_rule import ERROR_COEFFICIENTS, auto_step, reaction_rate
from cardiosurf.stepping.stepper import Advance, Past, Stepper

BLOW_UP = 10.0
# steps after a switch of the stimuli in which a blow-up is put down to them
SOON = 20


@dataclass(frozen=True)
class Problem:
    """What is marched: M u' = -K u + R f(u, v) + M s(t), v' = g(u, v) on excitable nodes.

    Attributes
    ----------
    operators : Operators
        M, R and K.
    kinetics : Kinetics
        f and g.
    pulses : tuple of Pulse
        The stimuli: jumps of u, or currents s.
    initial : (2, n) float or None
        u and v at time 0, before any pulse; None for u = v = 0.
    """

    operators: Operators
    kinetics: Kinetics
    pulses: tuple[Pulse, ...] = ()
    initial: Floats | None = None


class Cost(NamedTuple):
    """What a step took: its length in tu, the solver's iterations and seconds."""

    step: float
    iterations: int
    seconds: float


class Stride(NamedTuple):
    """A moment, and what getting there took; nothing for the first moment and for a pulse."""

    moment: Moment
    cost: Cost | None


class _Place(NamedTuple):
    """How far the march is: steps since time 0, the segment, steps done in it."""

    step: int
    segment: Segment
    done: int


def walk(problem: Problem, controls: Controls, start: Checkpoint | None) -> Iterator[Stride]:
    """Yield the moment of the start, then every instantaneous pulse and every step.

    Parameters and errors are those of ``march``.
    """
    stepper = Stepper.of(
        problem.operators,
        problem.kinetics,
        scheme=controls.scheme,
        factory=controls.solver.factory,
    )
    place, past, plan = _take_up(problem, controls, stepper, start)
    yield Stride(_moment(place, past, past.states[0], place.segment.time(place.done)), None)
    step = place.step
    for segment, behind in plan:
        to_come = pending(problem.pulses, segment, controls.end)
        if behind == 0:
            before = past.states[0]
            past = stepper.begin(switch_on(problem.pulses, segment, before))
            if past.states[0] is not before:
                place = _Place(step, segment, 0)
                yield Stride(_moment(place, past, before, segment.start, to_come), None)
        source = current(problem.pulses, segment)
        for done in range(behind + 1, segment.count + 1):
            step += 1
            place, before = _Place(step, segment, done), past.states[0]
            new = _advance(stepper, past, place, source)
            past = stepper.extend(past, new.state)
            cost = Cost(segment.step, new.iterations, new.seconds)
            yield Stride(_moment(place, past, before, segment.time(done - 1), to_come), cost)


def _take_up(
    problem: Problem, controls: Controls, stepper: Stepper, start: Checkpoint | None
) -> tuple[_Place, Past, list[tuple[Segment, int]]]:
    """Return where the march begins, its past, and the segments to come with the steps done."""
    whole = schedule(problem.pulses, step=controls.step.step, end=controls.end)
    if start is None:
        n = problem.operators.mass.shape[0]
        state = np.zeros((2, n)) if problem.initial is None else np.array(problem.initial)
        # a segment without length, all done: the pulses at time 0 are still to come
        place = _Place(0, Segment(0.0, 0.0, 1), 1)
        return place, stepper.begin(state), [(segment, 0) for segment in whole]
    place = _Place(start.step, start.segment, start.done)
    if start.segment in whole:
        ahead = whole[whole.index(start.segment) :]
        plan = [(segment, 0) for segment in ahead[1:]]
        if start.done < start.segment.count:
            plan.insert(0, (start.segment, start.done))
        return place, Past(tuple(start.states), tuple(start.reactions)), plan
    rest = schedule(problem.pulses, step=controls.step.step, end=controls.end, begin=start.time)
    return place, stepper.begin(start.states[0]), [(segment, 0) for segment in rest]


def _moment(
    place: _Place, past: Past, before: Floats, earlier: float, to_come: bool = False
) -> Moment:
    """Return the moment at a place, after the state ``before`` at the time ``earlier``."""
    return Moment(
        place.step,
        place.segment.time(place.done),
        past.states[0],
        earlier,
        before,
        to_come,
        partial(_checkpoint, place, past),
    )


def _checkpoint(place: _Place, past: Past) -> Checkpoint:
    """Return the checkpoint of a place and its past."""
    return Checkpoint(*place, np.array(past.states), np.array(past.reactions))


def _advance(stepper: Stepper, past: Past, place: _Place, source: Floats | None) -> Advance:
    """Return the step to a place; if it fails or blows up, raise naming step and time."""
    segment = place.segment
    where = f"at step {place.step}, t = {segment.time(place.done):g} tu"
    try:
        # an overflow is named below, with step and time
        with np.errstate(over="ignore", invalid="ignore"):
            new = stepper.advance(past, segment.step, source)
    except NumericalError as error:
        raise NumericalError(f"{error.problem}, {where}", error.hint) from error
    lowest, highest = float(new.state[0].min()), float(new.state[0].max())
    if not -BLOW_UP <= lowest <= highest <= BLOW_UP:
        raise NumericalError(
            f"the potential blew up to {max(-lowest, highest):.3g} {where}",
            _remedy(stepper, place, source),
        )
    if not np.isfinite(new.state[1].sum()):
        raise NumericalError(
            f"the recovery is not finite {where}",
            f"a time.step below {segment.step:g}, or slower kinetics",
        )
    return new


def _remedy(stepper: Stepper, place: _Place, source: Floats | None) -> str:
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
