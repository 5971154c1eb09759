"""How a march goes: the section ``time`` of a config, and the decisions it leads to."""

import os
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from annotated_types import Ge, Le

from cardiosurf.errors import InputError
from cardiosurf.kinetics import COMPILED, Kinetics
from cardiosurf.sections import Positive, Section, Span
from cardiosurf.stepping.schemes import SCHEMES, Scheme
from cardiosurf.stepping.solvers import LOOSEST_TOLERANCE, SolverChoice, choose_solver
from cardiosurf.stepping.step_rule import ACCURACY, StepChoice, asked_step, auto_step

if TYPE_CHECKING:
    from cardiosurf.fem.operators import Operators

MOST_STEPS = 1e7
NODES_A_THREAD = 10_000


@dataclass(frozen=True)
class TimeSection(Section):
    """How time goes: ``end`` and the longest ``step`` in tu, scheme and linear solver."""

    end: Span
    step: Positive | Literal["auto"] = "auto"
    scheme: Literal["imex_euler", "cnab2", "sbdf2"] = "sbdf2"
    solver: Literal["auto", "cg", "direct"] = "auto"
    tolerance: Annotated[float, Ge(1e-13), Le(LOOSEST_TOLERANCE)] = 1e-7
    stop_at_rest: bool = True


@dataclass(frozen=True)
class Execution:
    """How the machine is used; no result depends on it but for rounding.

    Attributes
    ----------
    jit : bool
        Whether to march in machine code where scheme, kinetics and solver are known to it;
        otherwise NumPy and SciPy do it.
    threads : int or None
        How many threads share a march in machine code; None: as many as pay (``fit``).
    """

    jit: bool = True
    threads: int | None = None

    def fit(self, nodes: int) -> "Execution":
        """Return this with the number of threads settled for a mesh.

        Threads meet a dozen times a step, so a second one pays on large meshes only
        (docs/numerics.md). OMP_NUM_THREADS bounds what is taken without being asked for, as it
        does for other programs: that is how batches keep to one core a run.
        """
        if self.threads is not None:
            return self
        free = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1
        bound = os.environ.get("OMP_NUM_THREADS", "")
        most = min(free, int(bound)) if bound.isdecimal() and int(bound) > 0 else free
        return replace(self, threads=max(1, min(most, nodes // NODES_A_THREAD)))


@dataclass(frozen=True)
class Controls:
    """What a march needs to know beside its problem.

    Attributes
    ----------
    scheme : Scheme
        The coefficients of the time integration.
    step : StepChoice
        The longest step, in tu, and why.
    end : float
        When to end, in tu.
    solver : SolverChoice
        The linear solver, and why.
    execution : Execution
        How the machine is used.
    """

    scheme: Scheme
    step: StepChoice
    end: float
    solver: SolverChoice
    execution: Execution = field(default_factory=Execution)


def decide(
    section: TimeSection,
    kinetics: Kinetics,
    operators: "Operators",
    *,
    accuracy: float = ACCURACY,
    execution: Execution | None = None,
) -> Controls:
    """Return the controls that the section asks for, each "auto" decided.

    Parameters
    ----------
    section : TimeSection
        What the user wants.
    kinetics : Kinetics
        The reaction, whose rate sets the automatic step.
    operators : Operators
        The matrices, whose size and stiffness set the automatic solver.
    accuracy : float
        Relative LAT error that an automatic step stays in its share of.
    execution : Execution, optional
        How the machine is used.

    Raises
    ------
    InputError
        The run would take more than 10 million steps.
    NumericalError
        The step asked for is unstable.
    """
    scheme = SCHEMES[section.scheme]
    if section.step == "auto":
        step = auto_step(scheme, kinetics, accuracy)
    else:
        # steps fall on the end, so none is longer than the whole
        step = asked_step(scheme, kinetics, min(section.step, section.end))
    steps = section.end / step.step
    if steps > MOST_STEPS:
        given = (
            "time.step: auto, set by the constants of kinetics" if section.step == "auto" else ""
        )
        raise InputError(
            "time.step",
            f"{steps:.3g} steps of {step.step:g} tu up to time.end ({section.end:g} tu)"
            + (f" ({given})" if given else ""),
            f"at most {MOST_STEPS:.0e} steps",
            "slower kinetics, or a smaller time.end"
            if given
            else "a larger time.step, or a smaller time.end",
        )
    execution = execution or Execution()
    weight = step.step * scheme.implicit[0] / scheme.state[0]
    rates = operators.stiffness.diagonal() / operators.mass.diagonal()
    solver = choose_solver(
        len(rates),
        stiffness=weight * float(np.mean(rates)),
        steps=steps,
        wanted=section.solver,
        tolerance=section.tolerance,
        compiled=execution.jit and type(kinetics) in COMPILED,
    )
    settled = execution.fit(len(rates))
    return Controls(scheme, step, section.end, solver, settled)
