"""How every code is started, on which problems and over which ladder of edge lengths and steps."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
VENV = ROOT / ".venv-peers" / "bin" / "python"
DEBIAN = Path("/usr/bin/python3")

ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)


def fixed(*steps: float) -> Callable[[float], tuple[float, ...]]:
    """Return a ladder of steps that is the same at every edge length."""
    return lambda edge: steps


def stable(edge: float, *shares: float) -> tuple[float, ...]:
    """Return shares of the longest step that explicit differences bear with d_xx = 4, d_yy = 1."""
    return tuple(share * edge**2 / 10.0 for share in shares)


@dataclass(frozen=True)
class Runner:
    """A code among those compared.

    Attributes
    ----------
    name, title : str
        Its key in the results and its name in the table.
    python : Path
        The interpreter that has it.
    module : str
        What that interpreter must be able to import.
    script : tuple of str
        Script in benchmarks/peers and the options that make it this code.
    edges : tuple of float
        Its ladder of edge lengths in su, coarse to fine.
    steps : callable
        Its ladder of steps in tu at an edge length, long to short.
    problems : str
        The problems that it can solve.
    """

    name: str
    title: str
    python: Path
    module: str
    script: tuple[str, ...]
    edges: tuple[float, ...]
    steps: Callable[[float], tuple[float, ...]]
    problems: str = "ABT"
    environment: dict[str, str] = field(default_factory=dict)

    @property
    def installed(self) -> bool:
        """Whether its interpreter is there and can import it."""
        if not self.python.exists():
            return False
        trial = [self.python, "-c", f"import {self.module}"]
        return not subprocess.run(
            trial, check=False, capture_output=True, env=self._environment
        ).returncode

    @property
    def _environment(self) -> dict[str, str]:
        # the project's own modules must not leak into the peers' interpreters
        inherited = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        return inherited | ONE_THREAD | self.environment

    def run(self, problem: Path, dt: float, out: Path) -> dict:
        """Run the script once; return its line, or ``failed`` with the reason."""
        script, *options = self.script
        words = [self.python, HERE / "peers" / script, problem, "--dt", repr(dt), "--out", out]
        done = subprocess.run(
            [*map(str, words), *options],
            check=False,
            capture_output=True,
            text=True,
            env=self._environment,
        )
        if done.returncode:
            return {"failed": (done.stderr.strip() or "no message").splitlines()[-1]}
        return json.loads(done.stdout.strip().splitlines()[-1])


blended = partial(
    Runner,
    # beyond 5 su an edge spans half a front
    edges=(5.0, 4.5, 4.0, 3.6, 3.3, 2.8, 2.4, 2.0, 1.7, 1.4, 1.2, 1.0),
    steps=fixed(4.0, 3.0, 2.5, 2.0, 1.5, 1.25, 1.0, 0.7, 0.5),
)
consistent = partial(
    Runner,
    edges=(3.3, 2.8, 2.4, 2.0, 1.7, 1.4, 1.2, 1.0, 0.85, 0.7, 0.6),
    steps=fixed(4.0, 3.0, 2.0, 1.5, 1.0, 0.5),
)

CARDIOSURF = blended(
    "cardiosurf",
    "cardiosurf",
    Path(sys.executable),
    "cardiosurf",
    ("cardiosurf_march.py",),
    environment={"PYTHONPATH": str(ROOT)},
)
PEERS = (
    Runner(
        "torchcor",
        "TorchCor, CPU",
        VENV,
        "torchcor",
        ("torchcor_fem.py",),
        edges=(5.0, 4.0, 3.3, 2.8, 2.4, 2.0, 1.7, 1.4, 1.2, 1.0, 0.85),
        steps=fixed(3.0, 2.0, 1.4, 1.0, 0.7, 0.5, 0.35, 0.25),
    ),
    Runner(
        "finitewave",
        "Finitewave",
        VENV,
        "finitewave",
        ("finitewave_fd.py",),
        # whole numbers of cells between the centre and the block's edge
        edges=tuple(50.0 / n for n in (20, 24, 27, 30, 35, 40, 50, 60, 66, 72)),
        steps=lambda edge: stable(edge, 0.95, 0.6),
        problems="A",
    ),
    consistent(
        "fenicsx",
        "FEniCSx as its users write it",
        DEBIAN,
        "dolfinx",
        ("fenicsx.py",),
    ),
    consistent(
        "fenicsx_tuned",
        "FEniCSx hand-tuned, consistent mass",
        DEBIAN,
        "dolfinx",
        ("fenicsx.py", "--style", "tuned", "--guess", "3", "--rtol", "1e-5", "--matrix", "sell"),
    ),
    blended(
        "fenicsx_blended",
        "FEniCSx hand-tuned, our blended mass",
        DEBIAN,
        "dolfinx",
        (
            *("fenicsx.py", "--style", "tuned", "--mass", "blended"),
            *("--guess", "3", "--rtol", "1e-5", "--matrix", "sell"),
        ),
    ),
)
