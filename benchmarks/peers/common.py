"""What all peer scripts share; needs NumPy alone, as each runs in an interpreter of its own."""

import argparse
import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

# rogers_mcculloch: u_t = ... + C1 u (u - A) (1 - u) - C2 u v,  v_t = B1 (u - B2 v)
A, B1, B2, C1, C2 = 0.13, 0.013, 1.0, 0.26, 0.1
THRESHOLD = 0.5


@dataclass(frozen=True)
class Problem:
    """The contents of a problem file (benchmarks/problems.py)."""

    problem: str
    edge: float
    end: float
    points: np.ndarray
    triangles: np.ndarray
    tensor: np.ndarray
    initial: np.ndarray


def arguments(description: str, add: Callable[[argparse.ArgumentParser], None] | None = None):
    """Return the problem that the command line names, and the command line."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("problem", type=Path)
    parser.add_argument("--dt", type=float, required=True, help="step, in tu")
    parser.add_argument("--out", type=Path, required=True, help="file for the LAT map")
    if add is not None:
        add(parser)
    given = parser.parse_args()
    with np.load(given.problem) as stored:
        values = {name: stored[name] for name in Problem.__dataclass_fields__}
    scalars = {"problem": str, "edge": float, "end": float}
    return Problem(**{k: scalars[k](v) if k in scalars else v for k, v in values.items()}), given


def steps_of(problem: Problem, dt: float) -> int:
    """Return how many steps of dt reach the end."""
    return round(problem.end / dt)


def peak_bytes() -> int:
    """Return the most memory that this program has had.

    Not getrusage's ru_maxrss: that begins with the memory of the process that started this one.
    """
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    return 1024 * int(re.search(r"VmHWM:\s+(\d+) kB", status)[1])


class Stopwatch:
    """Seconds of set-up and of the march.

    Seconds of the processor, not of the wall: on a core that is shared they do not count the
    others' time, and on an idle core they are the same.
    """

    def __init__(self) -> None:
        self._begun = process_time()
        self._wall = perf_counter()
        self.setup = self.loop = self.wall = 0.0

    def start(self) -> None:
        """Set-up is over, the march begins."""
        # what was used before this object was made (imports) is set-up as well
        self.setup = process_time()
        self._begun, self._wall = self.setup, perf_counter()

    def stop(self) -> None:
        """The march is over."""
        self.loop = process_time() - self._begun
        self.wall = perf_counter() - self._wall


class Activation:
    """First upward crossing of u = 0.5, interpolated in the step; for codes that have none."""

    def __init__(self, u: np.ndarray) -> None:
        self.lat = np.where(u > THRESHOLD, 0.0, np.nan)
        self._waiting = u <= THRESHOLD

    def see(self, before: np.ndarray, after: np.ndarray, time: float, dt: float) -> None:
        """Note the crossings of the step that ended at a time."""
        nodes = np.flatnonzero((after > THRESHOLD) & self._waiting)
        if len(nodes):
            low, high = before[nodes], after[nodes]
            self.lat[nodes] = time - dt + dt * (THRESHOLD - low) / (high - low)
            self._waiting[nodes] = False


def report(  # noqa: PLR0913, PLR0917
    given: argparse.Namespace,
    problem: Problem,
    code: str,
    version: str,
    watch: Stopwatch,
    lat: np.ndarray,
    mesh: tuple[np.ndarray, np.ndarray] | None = None,
    **more,
) -> None:
    """Write the LAT map (and the mesh it lives on, if it is not the problem's) and the line."""
    own = {} if mesh is None else {"points": mesh[0], "triangles": mesh[1]}
    np.savez(given.out, lat=lat, **own)
    line = {
        "code": code,
        "version": version,
        "problem": problem.problem,
        "edge": problem.edge,
        "dt": given.dt,
        "nodes": len(lat),
        "steps": steps_of(problem, given.dt),
        "setup_seconds": watch.setup,
        "loop_seconds": watch.loop,
        "loop_wall_seconds": watch.wall,
        "peak_bytes": peak_bytes(),
        **more,
    }
    print(json.dumps(line))
