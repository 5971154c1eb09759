"""Time the everyday things against a yardstick of the same run: commands, a run's stages, solves.

Whole processes on one core, medians of several runs; ratios within one run are what counts, seconds
depend on the machine. Writes benchmarks/results/everyday.json.
"""

import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from time import perf_counter

import numpy as np
from results import write
from scipy.sparse.linalg import LinearOperator, cg

from cardiosurf.analysis.findings import judge_recording
from cardiosurf.config import load
from cardiosurf.recording.hdf5 import read_recording, write_recording
from cardiosurf.recording.observers import Activation
from cardiosurf.recording.xdmf import write_xdmf
from cardiosurf.stepping.march import march
from cardiosurf.stepping.solvers import conjugate_gradients
from cardiosurf.study.setup import Setup, set_up

CONFIGS = Path(__file__).resolve().parent.parent / "configs"
CONFIG = CONFIGS / "t_domain.yaml"
RUNS = 7
# as installed packages are: with their byte code beside them
BYTECODE = tempfile.mkdtemp(prefix="bytecode-")
ENVIRONMENT = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
ENVIRONMENT |= {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "PYTHONPYCACHEPREFIX": BYTECODE,
}


def median(call: Callable[[], object], runs: int = RUNS) -> float:
    """Return the median wall time of a call, in s."""
    took = []
    for _ in range(runs):
        begun = perf_counter()
        call()
        took.append(perf_counter() - begun)
    return statistics.median(took)


def process(*words: str, **environment: str) -> float:
    """Return the median wall time of a Python process, in s."""
    given = ENVIRONMENT | environment

    def run() -> None:
        subprocess.run([sys.executable, *words], check=True, capture_output=True, env=given)

    run()  # once for the byte code and the caches
    return median(run)


def commands() -> list[tuple[str, float]]:
    """Return what whole commands take, the yardsticks first."""
    program = ("-m", "cardiosurf")
    with tempfile.TemporaryDirectory() as folder:
        run = (*program, "run", str(CONFIG), "--overwrite", "-o", folder)
        compiled = str(Path(folder) / "compiled")
        rows = [
            ("`python -c pass`", process("-c", "pass")),
            ("`import numpy`", process("-c", "import numpy")),
            (
                "`import numpy, scipy, h5py, pydantic, skfem, numba`",
                process("-c", "import numpy, scipy.sparse.linalg, h5py, pydantic, skfem, numba"),
            ),
            ("`cardiosurf --help`", process(*program, "--help")),
            (
                "`cardiosurf validate configs/t_domain.yaml`",
                process(*program, "validate", str(CONFIG)),
            ),
            ("`cardiosurf schema`", process(*program, "schema")),
            ("`cardiosurf run configs/t_domain.yaml`, warm", process(*run)),
            ("the same, mesh made anew", process(*run, CARDIOSURF_CACHE="off")),
            ("the same, `--no-jit`", process(*run, "--no-jit")),
            ("`cardiosurf analyze` of it", process(*program, "analyze", folder)),
        ]
        begun = perf_counter()
        given = ENVIRONMENT | {"NUMBA_CACHE_DIR": compiled, "CARDIOSURF_CACHE": "off"}
        subprocess.run([sys.executable, *run], check=True, capture_output=True, env=given)
        rows.append(("the first run of all: compiled, mesh made anew", perf_counter() - begun))
        check = ("check", str(CONFIGS.parent / "scenarios"), "--fast", "--workers", "2")
        begun = perf_counter()
        given = ENVIRONMENT | {"CARDIOSURF_CACHE_DIR": str(Path(folder) / "meshes")}
        subprocess.run(
            [sys.executable, *program, *check, "-o", str(Path(folder) / "check")],
            check=True,
            capture_output=True,
            env=given,
        )
        rows.append(
            (
                "`cardiosurf check scenarios --fast --workers 2`, nothing kept",
                perf_counter() - begun,
            )
        )
    return rows


def stages(config: Path, *options: str) -> dict[str, float]:
    """Return what the stages of a run take in a process that has all modules and machine code."""
    loaded = load(config, options)
    os.environ["CARDIOSURF_CACHE"] = "off"
    cold = median(lambda: set_up(loaded.config), 3)
    os.environ.pop("CARDIOSURF_CACHE")
    setup: Setup = set_up(loaded.config)
    warm = median(lambda: set_up(loaded.config), 3)
    with tempfile.TemporaryDirectory() as folder:
        run = [sys.executable, "-m", "cardiosurf", "run", str(config), "--json", "-o", folder]
        for option in options:
            run += ["--set", option]
        begun = perf_counter()
        done = subprocess.run(run, check=True, capture_output=True, env=ENVIRONMENT)
        whole = perf_counter() - begun
        json.loads(done.stdout)
        recording = read_recording(Path(folder) / "recording.h5")
        marching = recording.meta["march_seconds"]
        written = Path(folder) / "again.h5"

        def record() -> None:
            write_recording(written, replace(recording, name="again"))
            write_xdmf(written)

        recorded = median(record, 3)
    # handed over for one march, the matrices are taken here for several
    problem = replace(setup.problem, operators=setup.problem.take())
    return {
        "vertices": len(setup.surface.points),
        "steps": recording.meta["steps"],
        "set_up_cold": cold,
        "set_up_warm": warm,
        "march": median(lambda: march(problem, setup.controls, [Activation()]), 3),
        "march_in_run": marching,
        "judge": median(lambda: judge_recording(recording), 3),
        "record": recorded,
        "whole": whole,
    }


def solves() -> tuple[float, float]:
    """Return the median times of one diffusion solve with scipy's CG and with our NumPy one."""
    setup = set_up(load(CONFIG).config)
    operators = setup.problem.take()
    mass, stiffness = operators.mass, operators.stiffness
    matrix = (mass + stiffness).tocsr()
    rhs = mass @ np.random.default_rng(0).random(mass.shape[0])
    inverse = 1.0 / matrix.diagonal()
    jacobi = LinearOperator(matrix.shape, matvec=lambda r: inverse * r)
    own = conjugate_gradients(1e-7)(matrix)
    # a march starts from an extrapolation of the last states, good to about 1e-5
    exact, _ = cg(matrix, rhs, rtol=1e-12, M=jacobi)
    guess = exact * (1.0 + 1e-5 * np.random.default_rng(1).standard_normal(len(exact)))
    return (
        median(lambda: cg(matrix, rhs, x0=guess, rtol=1e-7, M=jacobi), 100),
        median(lambda: own(rhs, guess, rhs), 100),
    )


def main() -> None:
    """Measure and write."""
    rows = commands()
    long = ("time.stop_at_rest=false", "time.end=20000")
    content = {
        "commands": rows,
        "stages": {
            "configs/t_domain.yaml": stages(CONFIG),
            "configs/t_domain_literal.yaml": stages(CONFIGS / "t_domain_literal.yaml"),
            "configs/plane_block.yaml": stages(CONFIGS / "plane_block.yaml"),
            "configs/t_domain.yaml, 20,000 tu": stages(CONFIG, *long),
        },
        "solves": dict(zip(("scipy", "ours"), solves(), strict=True)),
    }
    write("everyday", content)
    for what, seconds in rows:
        print(f"{seconds:8.3f} s  {what}")
    shutil.rmtree(BYTECODE)
    for what, found in content["stages"].items():
        print(what, {key: round(value, 3) for key, value in found.items()})


if __name__ == "__main__":
    main()
