"""The memory that a march takes: ``python benchmarks/memory.py NODES`` prints it as JSON.

A process of its own: the most that a process ever held is known for the whole of it only.
"""

import gc
import json
import resource
import sys
import tracemalloc
from dataclasses import dataclass

import numpy as np
from sheets import operators_of, sheet

from cardiosurf.kinetics import RogersMcCulloch
from cardiosurf.recording.observers import Activation
from cardiosurf.stepping.controls import Controls, Execution
from cardiosurf.stepping.march import Handover, Problem, march
from cardiosurf.stepping.schemes import SCHEMES
from cardiosurf.stepping.solvers import choose_solver
from cardiosurf.stepping.step_rule import StepChoice


@dataclass(frozen=True)
class Wall:
    """A stimulus along one side at the start."""

    profile: np.ndarray
    time: float = 0.0
    duration: float = 0.0
    label: str = "wall"


def march_over(nodes: int, steps: int) -> tuple[int, int, int]:
    """March a wave; return nodes, the bytes held before it, and the most held during it.

    Counted is all that a march holds: the matrices it is handed, what it makes of them, states,
    the stimulus, and the activations that an observer collects.
    """
    tracemalloc.start()
    points, triangles = sheet(nodes, 2.0)
    operators = operators_of(points, triangles)
    n = len(points)
    problem = Problem(
        Handover(operators), RogersMcCulloch(), (Wall((points[:, 0] < 10.0).astype(float)),)
    )
    solver = choose_solver(n, wanted="cg")
    controls = Controls(
        SCHEMES["sbdf2"], StepChoice(1.0, "benchmark"), float(steps), solver, Execution(True, 1)
    )
    del points, triangles, operators
    gc.collect()
    before, _ = tracemalloc.get_traced_memory()
    tracemalloc.reset_peak()
    march(problem, controls, (Activation(),))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return n, before, peak


def main() -> None:
    march_over(2_000, 10)
    n, before, peak = march_over(int(sys.argv[1]), 40)
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    print(
        json.dumps(
            {
                "nodes": n,
                "handed over": before / n,
                "peak": peak / n,
                "process with set-up, MB": most / 1e6,
            }
        )
    )


if __name__ == "__main__":
    main()
