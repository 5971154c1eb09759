"""Marches whole stretches of equal steps in machine code."""

from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from functools import cache
from time import perf_counter
from typing import Any

import numpy as np

from cardiosurf.arrays import Floats, Ints
from cardiosurf.errors import NumericalError
from cardiosurf.fem.operators import Operators
from cardiosurf.stepping.compiled.gradients import (
    CROSSINGS,
    GOAL,
    ITERATIONS,
    LEFT,
    MOST,
    REASON,
    STEPS,
)
from cardiosurf.stepping.compiled.laws import constants_of
from cardiosurf.stepping.compiled.passes import NEW_U, NEW_V, U0, U1, U2, U3, V0, V1
from cardiosurf.stepping.compiled.rows import arrange, weigh
from cardiosurf.stepping.compiled.stride import (
    FULL,
    FULL_AND_REST_CHANGED,
    REST_CHANGED,
    UNSOLVED,
    UNSOUND,
    stride,
)
from cardiosurf.stepping.compiled.work import FIRST_SLOTS, Rule, make_work, scar_of
from cardiosurf.stepping.moment import Crossings, Trace, crossings_between
from cardiosurf.stepping.schemes import Scheme
from cardiosurf.stepping.solvers import not_converged
from cardiosurf.stepping.stepper import Advance, Past

LEAST_STEPS, MOST_STEPS = 8, 256
SECONDS = 0.05
"""Steps of a stride, and about its longest time, so that signals and bars are served. Below eight
steps what is told after a stride would count on large meshes."""


# from this many states the next guess is extrapolated with these weights
_GUESSES = {1: (1.0,), 2: (2.0, -1.0), 3: (3.0, -3.0, 1.0), 4: (4.0, -6.0, 4.0, -1.0)}


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    """Return the threads that help the main one."""
    return ThreadPoolExecutor(threads - 1, thread_name_prefix="stride")


@dataclass(frozen=True)
class Leg:
    """What a stride did.

    Attributes
    ----------
    steps : int
        Steps done.
    iterations, most : int
        Iterations in all, and in the worst step.
    seconds, marching : float
        Wall time, and that of the steps alone.
    crossings : Crossings
        All crossings of 0.5.
    trace : Trace
        The watched vertices after every step.
    state, previous : (2, n) float
        The state after the last step and before it.
    """

    steps: int
    iterations: int
    most: int
    seconds: float
    marching: float
    crossings: Crossings
    trace: Trace
    state: Floats
    previous: Floats


class Engine:
    """The compiled march of one problem with one scheme.

    It keeps the last states itself, in an order of its own: ``load`` sets them, ``states``
    returns them.

    Parameters
    ----------
    operators : Operators
        M, R and K, of which nothing is kept but what the engine makes of them.
    kinetics : Kinetics
        A model of the registry.
    scheme : Scheme
        One with at most two past states, reactions and diffusion terms.
    tolerance : float
        Of conjugate gradients.
    watch : (w,) int
        Vertices whose state is told after every step.
    threads : int
        How many threads share the work.
    """

    def __init__(
        self,
        operators: Operators,
        kinetics: Any,
        scheme: Scheme,
        *,
        tolerance: float,
        watch: Ints,
        threads: int,
    ) -> None:
        self._arrangement = arrange(operators)
        self._work = make_work(self._arrangement, operators.excitable_nodes, watch, MOST_STEPS)
        self._scar = scar_of(operators, self._arrangement)
        self._watch = watch
        self._scheme = scheme
        self._constants = constants_of(kinetics)
        self._tolerance = tolerance
        self._threads = threads
        self._weight = 0.0
        self._resting = False
        self._seconds_a_step = SECONDS
        self._source: Floats | None = None
        self.strides = 0

    def load(self, states: tuple[Floats, ...]) -> None:
        """Take the last states, (2, n) each, newest first; at least as many as the scheme needs."""
        work, vertex = self._work, self._arrangement.vertex
        work.slots[:] = FIRST_SLOTS
        work.guess[:] = 0.0
        known = states[:4]
        for k, state in enumerate(known):
            work.fields[work.slots[U0 + k], : len(vertex)] = state[0][vertex]
        for k, state in enumerate(known[:2]):
            work.fields[work.slots[V0 + k], : len(vertex)] = state[1][vertex]
        work.guess[: len(known)] = _GUESSES[len(known)]
        self._resting = False
        self.strides += 1

    def states(self) -> tuple[Floats, ...]:
        """Return the last states, newest first; of those before the last two u alone counts."""
        known = int(np.count_nonzero(self._work.guess))
        older = [(U2, NEW_V), (U3, NEW_V)]
        return tuple(self._state(*slots) for slots in [(U0, V0), (U1, V1), *older][:known])

    def _state(self, u: int, v: int) -> Floats:
        """Return the state (2, n) of two slots, in the order of the vertices."""
        work, row = self._work, self._arrangement.row
        state = np.empty((2, len(row)))
        for place, slot in enumerate((u, v)):
            np.take(work.fields[work.slots[slot]], row, out=state[place])
        return state

    def single(
        self, scheme: Scheme, past: Past, dt: float, current: Floats | None, strictness: float = 1.0
    ) -> Advance:
        """Return one step of a scheme from a given past.

        Parameters
        ----------
        scheme : Scheme
            As deep as the past at the most.
        past : Past
            The last states.
        dt : float
            The step, in tu.
        current : (n,) float or None
            The current that is on, in 1/tu.
        strictness : float
            Factor on the tolerance.

        Raises
        ------
        NumericalError
            Conjugate gradients did not converge.
        """
        self.load(past.states)
        work = self._fit(current)
        rule = self._rule(scheme, dt, pending=True)
        rule = rule._replace(tolerance=strictness * self._tolerance)
        work.report[:] = 0
        seconds = self._run(rule, work, np.array((0.0, dt)))
        if self.failure is not None:
            raise self.failure
        slots = (U0, V0) if self.broken is None else (NEW_U, NEW_V)
        return Advance(self._state(*slots), int(work.report[ITERATIONS]), seconds)

    def go(self, times: Floats, dt: float, source: Floats | None, *, pending: bool) -> Leg:
        """Do steps of dt up to the given times, or up to where rest begins or ends.

        Parameters
        ----------
        times : (k + 1,) float
            The present time and those after the steps, in tu; see ``room``.
        dt : float
            The step, in tu.
        source : (n,) float or None
            The current that is on, in 1/tu.
        pending : bool
            Whether a pulse is to come: there is no rest then.

        Returns
        -------
        Leg
            What was done. Where a step fails it ends before that; see ``failure``, ``broken``.
        """
        begun = perf_counter()
        work = self._fit(source)
        rule = self._rule(self._scheme, dt, pending=pending)
        work.report[:] = 0
        marching = self._run(rule, work, times)
        self.strides += 1
        leg = self._leg(times, begun, marching)
        if leg.steps:
            self._seconds_a_step = max(marching / leg.steps, 1e-7)
        if work.report[REASON] in (REST_CHANGED, FULL_AND_REST_CHANGED):
            self._resting = not self._resting
        return leg

    @property
    def failure(self) -> NumericalError | None:
        """Why the last stride ended before its time with a step that failed; None if it did not."""
        report, reals = self._work.report, self._work.reals
        if report[REASON] == UNSOLVED:
            return not_converged(int(report[ITERATIONS]), reals[LEFT], reals[GOAL])
        return None

    @property
    def broken(self) -> Floats | None:
        """The state (2, n) that is not sound, if the last stride ended with one."""
        return self._state(NEW_U, NEW_V) if self._work.report[REASON] == UNSOUND else None

    @property
    def room(self) -> int:
        """The most steps that a stride should have."""
        return int(np.clip(SECONDS / self._seconds_a_step, LEAST_STEPS, MOST_STEPS))

    def _fit(self, source: Floats | None) -> Any:
        """Take the current that is on into the work space."""
        if source is not self._source:
            current = np.zeros(0) if source is None else source[self._arrangement.vertex]
            self._work = self._work._replace(current=current)
            self._source = source
        return self._work

    def _rule(self, scheme: Scheme, dt: float, *, pending: bool) -> Rule:
        """Return a step's numbers, and have the matrix that it needs."""
        a0, b0 = scheme.state[0], scheme.implicit[0]
        state = [-a / a0 for a in scheme.state[1:]]
        push = [dt * c / a0 for c in scheme.explicit]
        weight = dt * b0 / a0
        if weight != self._weight:
            weigh(self._arrangement.rows, weight)
            self._weight = weight
        return Rule(
            constants=self._constants,
            state0=state[0],
            state1=state[1] if len(state) > 1 else 0.0,
            push0=push[0],
            push1=push[1] if len(push) > 1 else 0.0,
            implicit1=scheme.implicit[1] / b0 if len(scheme.implicit) > 1 else 0.0,
            weight=weight,
            current_step=dt / a0,
            tolerance=self._tolerance,
            watch_rest=not pending,
            resting=self._resting,
            threads=self._threads,
        )

    def _run(self, rule: Rule, work: Any, times: Floats) -> float:
        """Run the stride, in as many threads as share it; return the seconds."""
        rows, scar = self._arrangement.rows, self._scar
        begun = perf_counter()
        others = [
            _pool(self._threads).submit(stride, rows, rule, work, scar, times, number)
            for number in range(1, self._threads)
        ]
        stride(rows, rule, work, scar, times, 0)
        wait(others)
        return perf_counter() - begun

    def _leg(self, times: Floats, begun: float, marching: float) -> Leg:
        """Return what the stride did, in the order of the vertices."""
        work, vertex = self._work, self._arrangement.vertex
        steps, count = int(work.report[STEPS]), int(work.report[CROSSINGS])
        state, previous = self._state(U0, V0), self._state(U1, V1)
        rows, crossed_at, up = work.crossings[:count].T
        crossings = Crossings(vertex[rows.astype(np.int64)], crossed_at.copy(), up > 0.0)
        if work.report[REASON] in (FULL, FULL_AND_REST_CHANGED):
            last = crossings_between(previous[0], state[0], times[steps - 1], times[steps])
            crossings = crossings.then(last)
        return Leg(
            steps=steps,
            iterations=int(work.report[ITERATIONS]),
            most=int(work.report[MOST]),
            seconds=perf_counter() - begun,
            marching=marching,
            crossings=crossings,
            trace=Trace(self._watch, times[1 : steps + 1], work.watched[:steps].copy()),
            state=state,
            previous=previous,
        )
