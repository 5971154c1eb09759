"""Time the everyday things against a yardstick of the same run, and write benchmarks/README.md.

Whole processes on one core, the median of several runs; ratios within one run are what counts,
seconds depend on the machine.
"""

import os
import platform
import statistics
import subprocess
import sys
import tempfile
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from time import perf_counter

import numpy as np
from scipy.sparse.linalg import LinearOperator, cg

from cardiosurf.config import load
from cardiosurf.stepping.solvers import conjugate_gradients
from cardiosurf.study.setup import set_up

HERE = Path(__file__).parent
CONFIG = HERE.parent / "configs" / "t_domain.yaml"
RUNS = 5


def process(*words: str) -> float:
    """Return the median wall time of a process, in s; it makes its mesh anew."""
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    environment |= {"CARDIOSURF_CACHE": "off"}
    took = []
    for _ in range(RUNS):
        begun = perf_counter()
        subprocess.run([sys.executable, *words], check=True, capture_output=True, env=environment)
        took.append(perf_counter() - begun)
    return statistics.median(took)


def solves() -> tuple[float, float]:
    """Return the median times of one diffusion solve with scipy's CG and with ours, in s."""
    setup = set_up(load(CONFIG).config)
    mass, stiffness = setup.problem.operators.mass, setup.problem.operators.stiffness
    matrix = (mass + stiffness).tocsr()
    rhs = mass @ np.random.default_rng(0).random(mass.shape[0])
    inverse = 1.0 / matrix.diagonal()
    jacobi = LinearOperator(matrix.shape, matvec=lambda r: inverse * r)
    own = conjugate_gradients(1e-7)(matrix)
    # a march starts from an extrapolation of the last states, good to about 1e-5
    exact, _ = cg(matrix, rhs, rtol=1e-12, M=jacobi)
    guess = exact * (1.0 + 1e-5 * np.random.default_rng(1).standard_normal(len(exact)))

    def median(solve) -> float:
        took = []
        for _ in range(20 * RUNS):
            begun = perf_counter()
            solve()
            took.append(perf_counter() - begun)
        return statistics.median(took)

    return (
        median(lambda: cg(matrix, rhs, x0=guess, rtol=1e-7, M=jacobi)),
        median(lambda: own(rhs, guess)),
    )


def main() -> None:
    """Measure and write the page."""
    bare = process("-c", "pass")
    scientific = process("-c", "import numpy, scipy.sparse.linalg, h5py, pydantic, skfem")
    helped = process("-m", "cardiosurf", "--help")
    with tempfile.TemporaryDirectory() as folder:
        run = process("-m", "cardiosurf", "run", str(CONFIG), "-o", folder, "--overwrite")
    scipys, ours = solves()
    rows = [
        ("`python -c pass`", bare, 1.0),
        ("`import numpy, scipy, h5py, pydantic, skfem`", scientific, scientific / bare),
        ("`cardiosurf --help`", helped, helped / bare),
        ("`cardiosurf run configs/t_domain.yaml`, YAML to verdict", run, run / scientific),
        ("one diffusion solve, `scipy.sparse.linalg.cg`", scipys, 1.0),
        ("one diffusion solve, ours", ours, ours / scipys),
    ]
    against = ["", "1st", "1st", "2nd", "", "5th"]
    packages = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "scikit-fem"))
    packages = f"Python {platform.python_version()}, {packages}"
    lines = [
        "# Benchmarks",
        "",
        "Written by `make bench`; whole processes on one core, medians. Ratios within one run are",
        "what counts, seconds depend on the machine.",
        "",
        f"{datetime.now(UTC):%Y-%m-%d}, {platform.machine()}, {packages}",
        "",
        "| what | seconds | ratio | to row |",
        "|---|---|---|---|",
    ]
    lines += [
        f"| {what} | {seconds:.3g} | {ratio:.2f} | {row} |"
        for (what, seconds, ratio), row in zip(rows, against, strict=True)
    ]
    (HERE / "README.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
