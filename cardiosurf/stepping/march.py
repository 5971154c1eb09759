"""The only time loop: marches a problem to rest or to its end, watched by observers."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Literal

import numpy as np

from cardiosurf.stepping.controls import Controls
from cardiosurf.stepping.moment import Checkpoint, Moment, Observer, Patient, Watching
from cardiosurf.stepping.place import Cost, Wishes
from cardiosurf.stepping.rest import at_rest, never
from cardiosurf.stepping.walk import Handover, Problem, is_compiled, walk

__all__ = [
    "Checkpoint",
    "Controls",
    "Handover",
    "Moment",
    "Observer",
    "Outcome",
    "Problem",
    "march",
]


@dataclass(frozen=True)
class Outcome:
    """How a march ended, and what it took.

    Attributes
    ----------
    end_time : float
        Time reached, in tu.
    reason : {"rest", "end"}
        Whether the stopping rule or the end of time ended it.
    steps : int
        Steps done by this march (without those before its checkpoint).
    longest_step : float
        The longest step used, in tu: at most the one asked for, as steps fall on every switch.
    iterations, most_iterations : int
        Iterations of the linear solver, in all and in the worst step; 0 for a direct one.
    seconds, solve_seconds, observer_seconds : float
        Wall time of the march, and of it in the linear solver (in machine code: in whole steps)
        and in the observers.
    engine : {"compiled", "numpy"}
        What marched.
    controls : Controls
        Scheme, step and solver, with the reasons for them.
    """

    end_time: float
    reason: Literal["rest", "end"]
    steps: int
    longest_step: float
    iterations: int
    most_iterations: int
    seconds: float
    solve_seconds: float
    observer_seconds: float
    engine: Literal["compiled", "numpy"]
    controls: Controls


def march(
    problem: Problem,
    controls: Controls,
    observers: Sequence[Observer] = (),
    *,
    stop: Callable[[Moment], bool] = at_rest,
    start: Checkpoint | None = None,
) -> Outcome:
    """March the problem from time 0, or from a checkpoint, until ``stop`` says so or to the end.

    Parameters
    ----------
    problem : Problem
        The equation and its stimuli.
    controls : Controls
        Scheme, step, end and linear solver.
    observers : sequence of Observer
        Called in this order; after every step, unless all of them are ``Patient``.
    stop : callable
        Asked after every step; True ends the march. ``at_rest`` and ``never`` are known to the
        compiled march and leave it its long strides.
    start : Checkpoint, optional
        Goes on from there, bit for bit. With another step or a later end it goes on from the
        checkpoint's state, with a new starting step.

    Raises
    ------
    NumericalError
        The solution blew up or the linear solver did not converge; names step and time.
    """
    begun = perf_counter()
    strides = walk(problem, controls, start, _wishes(observers, stop))
    moment = next(strides).moment
    costs: list[Cost] = []
    watching = _tell([observer.initialize for observer in observers], moment)
    reason: Literal["rest", "end"] = "end"
    for moment, cost in strides:
        watching += _tell([observer.handle for observer in observers], moment)
        if cost is not None:
            costs.append(cost)
            if stop(moment):
                reason = "rest"
                break
    watching += _tell([observer.finalize for observer in observers], moment)
    return Outcome(
        end_time=moment.time,
        reason=reason,
        steps=sum(cost.steps for cost in costs),
        longest_step=max((cost.step for cost in costs), default=0.0),
        iterations=sum(cost.iterations for cost in costs),
        most_iterations=max((cost.most for cost in costs), default=0),
        seconds=perf_counter() - begun,
        solve_seconds=sum(cost.seconds for cost in costs),
        observer_seconds=watching,
        engine="compiled" if is_compiled(problem, controls) else "numpy",
        controls=controls,
    )


def _wishes(observers: Sequence[Observer], stop: Callable[[Moment], bool]) -> Wishes:
    """Return what the observers want to see."""
    patient = [observer for observer in observers if isinstance(observer, Patient)]
    watched = [observer.watches for observer in observers if isinstance(observer, Watching)]
    watch = np.unique(np.concatenate([np.zeros(0, np.int64), *(w.ravel() for w in watched)]))
    if len(patient) < len(observers) or stop not in (at_rest, never):
        return Wishes(watch=watch)
    return Wishes(lambda: min((observer.due() for observer in patient), default=np.inf), watch)


def _tell(verbs: Sequence[Callable[[Moment], None]], moment: Moment) -> float:
    """Tell the observers and return the seconds they took."""
    begun = perf_counter()
    for verb in verbs:
        verb(moment)
    return perf_counter() - begun
