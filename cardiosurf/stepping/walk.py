"""The steps of a march one after another: from switch to switch, each a moment."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from cardiosurf.arrays import Floats
from cardiosurf.errors import NumericalError
from cardiosurf.fem.operators import Operators
from cardiosurf.kinetics import COMPILED, Kinetics
from cardiosurf.stepping.controls import Controls
from cardiosurf.stepping.moment import Checkpoint, Moment
from cardiosurf.stepping.place import Cost, Place, Stride, Wishes, check, located
from cardiosurf.stepping.schedule import Pulse, Segment, current, pending, schedule, switch_on
from cardiosurf.stepping.stepper import Advance, Multistep, Past, Stepper

if TYPE_CHECKING:
    from cardiosurf.stepping.compiled.engine import Engine


class Handover:
    """Matrices for one march, which is the only one to hold them once it has begun.

    The compiled march needs them only until it has laid them out in an order of its own.

    Parameters
    ----------
    operators : Operators
        M, R and K.
    """

    def __init__(self, operators: Operators) -> None:
        self._held = [operators]

    def take(self) -> Operators:
        """Return the matrices and forget them.

        Raises
        ------
        LookupError
            Somebody took them before.
        """
        if not self._held:
            raise LookupError("the matrices were handed over for one march, which has begun")
        return self._held.pop()


@dataclass(frozen=True)
class Problem:
    """What is marched: M u' = -K u + R f(u, v) + M s(t), v' = g(u, v) on excitable nodes.

    Attributes
    ----------
    operators : Operators or Handover
        M, R and K.
    kinetics : Kinetics
        f and g.
    pulses : tuple of Pulse
        The stimuli: jumps of u, or currents s.
    initial : (2, n) float or None
        u and v at time 0, before any pulse; None for u = v = 0.
    """

    operators: Operators | Handover
    kinetics: Kinetics
    pulses: tuple[Pulse, ...] = ()
    initial: Floats | None = None

    def take(self) -> Operators:
        """Return the matrices; those that were handed over are forgotten."""
        given = self.operators
        return given.take() if isinstance(given, Handover) else given


def walk(
    problem: Problem, controls: Controls, start: Checkpoint | None, wishes: Wishes
) -> Iterator[Stride]:
    """Yield the moment of the start, then every instantaneous pulse and the steps.

    In machine code only those steps are yielded that are wished for. Parameters and errors are
    those of ``march``.
    """
    stepper, engine = _stepper(problem, controls, wishes)
    place, past, plan = _take_up(problem, controls, stepper, start)
    yield Stride(_moment(place, past, past.states[0], place.time), None)
    for segment, behind in plan:
        place = Place(place.step, segment, behind)
        to_come = pending(problem.pulses, segment, controls.end)
        if behind == 0:
            before = past.states[0]
            past = stepper.begin(switch_on(problem.pulses, segment, before))
            if past.states[0] is not before:
                yield Stride(_moment(place, past, before, segment.start, to_come), None)
            del before
        source = current(problem.pulses, segment)
        while place.done < segment.count:
            if engine is not None and stepper.is_deep(past):
                from cardiosurf.stepping.compiled.steps import Stretch, compiled_steps

                # memory: the engine has states of its own
                engine.load(past.states)
                past = Past((), ())
                stretch = Stretch(place, source, to_come)
                yield from compiled_steps(engine, stepper, stretch, wishes)
                place, past = place.on(segment.count - place.done), Past(engine.states(), ())
            else:
                place = place.on(1)
                past, stride = _single(stepper, past, place, source, to_come)
                yield stride
                # memory: nothing holds on to states that are not needed any more
                del stride


def _single(
    stepper: Stepper, past: Past, place: Place, source: Floats | None, to_come: bool
) -> tuple[Past, Stride]:
    """Do the step to a place in NumPy; return the new past, and what is to be told."""
    new = _advance(stepper, past, place, source)
    longer = stepper.extend(past, new.state)
    cost = Cost(place.segment.step, 1, new.iterations, new.iterations, new.seconds)
    earlier = place.segment.time(place.done - 1)
    return longer, Stride(_moment(place, longer, past.states[0], earlier, to_come), cost)


def is_compiled(problem: Problem, controls: Controls) -> bool:
    """Return whether the march goes in machine code: it must be wanted, and know the problem."""
    scheme = controls.scheme
    parts = (scheme.state[1:], scheme.implicit, scheme.explicit)
    known = type(problem.kinetics) in COMPILED and all(len(part) <= 2 for part in parts)
    return controls.execution.jit and known and controls.solver.tolerance is not None


def _stepper(
    problem: Problem, controls: Controls, wishes: Wishes
) -> tuple[Stepper, "Engine | None"]:
    """Return the step rule of a problem, and what marches it in machine code, if that knows it."""
    operators = problem.take()
    excitable = operators.excitable_nodes
    if not is_compiled(problem, controls):
        steps = Multistep.of(operators, controls.solver.factory)
        return Stepper(problem.kinetics, controls.scheme, excitable, steps), None
    # numba is imported only where something is marched with it
    from cardiosurf.stepping.compiled.engine import Engine

    engine = Engine(
        operators,
        problem.kinetics,
        controls.scheme,
        tolerance=controls.solver.tolerance or 0.0,
        watch=wishes.watch,
        threads=controls.execution.fit(len(excitable)).threads or 1,
    )
    return Stepper(problem.kinetics, controls.scheme, excitable, engine.single), engine


def _take_up(
    problem: Problem, controls: Controls, stepper: Stepper, start: Checkpoint | None
) -> tuple[Place, Past, list[tuple[Segment, int]]]:
    """Return where the march begins, its past, and the segments to come with the steps done."""
    whole = schedule(problem.pulses, step=controls.step.step, end=controls.end)
    if start is None:
        nothing = np.zeros((2, len(stepper.excitable)))
        state = nothing if problem.initial is None else np.array(problem.initial)
        # a segment without length, all done: the pulses at time 0 are still to come
        place = Place(0, Segment(0.0, 0.0, 1), 1)
        return place, stepper.begin(state), [(segment, 0) for segment in whole]
    place = Place(start.step, start.segment, start.done)
    if start.segment in whole:
        ahead = whole[whole.index(start.segment) :]
        plan = [(segment, 0) for segment in ahead[1:]]
        if start.done < start.segment.count:
            plan.insert(0, (start.segment, start.done))
        return place, Past(tuple(start.states), tuple(start.reactions)), plan
    rest = schedule(problem.pulses, step=controls.step.step, end=controls.end, begin=start.time)
    return place, stepper.begin(start.states[0]), [(segment, 0) for segment in rest]


def _moment(
    place: Place, past: Past, before: Floats, earlier: float, to_come: bool = False
) -> Moment:
    """Return the moment at a place, after the state ``before`` at the time ``earlier``."""
    return Moment(
        place.step,
        place.time,
        past.states[0],
        earlier,
        before,
        to_come,
        partial(_checkpoint, place, past),
    )


def _checkpoint(place: Place, past: Past) -> Checkpoint:
    """Return the checkpoint of a place and its past."""
    return Checkpoint(*place, np.array(past.states), np.array(past.reactions))


def _advance(stepper: Stepper, past: Past, place: Place, source: Floats | None) -> Advance:
    """Return the step to a place; if it fails or blows up, raise naming step and time."""
    try:
        # an overflow is named below, with step and time
        with np.errstate(over="ignore", invalid="ignore"):
            new = stepper.advance(past, place.segment.step, source)
    except NumericalError as error:
        raise located(error, place) from error
    check(stepper, new.state, place, source)
    return new
