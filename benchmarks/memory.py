"""The memory that a march takes: ``python benchmarks/memory.py NODES`` prints it as JSON.

A process of its own: the most that a process ever held is known for the whole of it only.
"""

import gc
import json
import resource
import sys
import tracemalloc

import numpy as np
from sheets import operators_of, sheet

from cardiosurf.fem.operators import Operators
from cardiosurf.kinetics import RogersMcCulloch
from cardiosurf.recording.observers import Activation
from cardiosurf.stepping.controls import Controls, Execution
from cardiosurf.stepping.march import Problem, march
from cardiosurf.stepping.schemes import SCHEMES
from cardiosurf.stepping.solvers import choose_solver
from cardiosurf.stepping.step_rule import StepChoice


def bytes_of(operators: Operators) -> int:
    """Return the size of mass and stiffness; arrays that they share count once."""
    arrays = {
        getattr(matrix, name).ctypes.data: getattr(matrix, name).nbytes
        for matrix in (operators.mass, operators.stiffness)
        for name in ("data", "indices", "indptr")
    }
    return sum(arrays.values())


def march_over(nodes: int, steps: int) -> tuple[int, int, int]:
    """March a wave; return nodes, bytes of the matrices and most bytes held beside them."""
    points, triangles = sheet(nodes, 2.0)
    operators = operators_of(points, triangles)
    n = len(points)
    u = (points[:, 0] < 10.0).astype(float)
    problem = Problem(operators, RogersMcCulloch(), (), np.array((u, np.zeros(n))))
    solver = choose_solver(n, wanted="cg")
    controls = Controls(
        SCHEMES["sbdf2"], StepChoice(1.0, "benchmark"), float(steps), solver, Execution(True, 1)
    )
    del points, triangles, u
    gc.collect()
    tracemalloc.start()
    march(problem, controls, (Activation(),))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return n, bytes_of(operators), peak


def main() -> None:
    march_over(2_000, 10)
    n, matrices, engine = march_over(int(sys.argv[1]), 40)
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    print(
        json.dumps(
            {
                "nodes": n,
                "matrices": matrices / n,
                "engine": engine / n,
                "peak": (matrices + engine) / n,
                "process with set-up, MB": most / 1e6,
            }
        )
    )


if __name__ == "__main__":
    main()
