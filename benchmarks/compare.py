"""Time every installed code to 1, 0.5 and 0.1 % of LAT, on one core.

    python benchmarks/compare.py --core 1
    python benchmarks/compare.py --problems A --codes cardiosurf finitewave

Each code climbs its ladder of edge lengths and steps, cheap to dear, once; the runs that decide a
figure, and those nearly as fast, are repeated and their medians taken.
Two figures for each target: *cheapest* is the fastest run whose error is below the target, be it by
errors that cancel; *assured* asks that the next finer mesh, the next shorter step, and all measured
runs that are finer in both, are below it as well.
"""

import argparse
import json
import os
import platform
import statistics
import tempfile
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
from lat_error import Locator, lat_error, load_reference
from problems import PROBLEMS, write_problem
from runners import CARDIOSURF, HERE, PEERS, Runner

TARGETS = (0.01, 0.005, 0.001)
RESULTS = HERE / "results" / "peers.json"
NEARLY = 1.3  # runs up to this much slower than the fastest are repeated with it


@dataclass
class Measured:
    """A configuration of a code, its error and what its runs took."""

    code: str
    problem: str
    edge: float
    dt: float
    error: float
    detail: dict
    loops: list[float] = field(default_factory=list)

    @property
    def seconds(self) -> float:
        """Median seconds of the loop."""
        return statistics.median(self.loops) if self.loops else np.inf

    def as_json(self) -> dict:
        """Return what the results file holds of it."""
        return self.detail | {
            "code": self.code,
            "problem": self.problem,
            "edge": self.edge,
            "dt": self.dt,
            "error": self.error if np.isfinite(self.error) else None,
            "loop_seconds": self.seconds if self.loops else None,
            "loops": self.loops,
        }


class Ladder:
    """The runs of one code on one problem."""

    def __init__(self, runner: Runner, problem: str, meshes: "Meshes", longest: float) -> None:
        self.runner, self.problem, self._meshes, self._longest = runner, problem, meshes, longest
        self.runs: dict[tuple[float, float], Measured] = {}
        self._rungs = {edge: runner.steps(edge) for edge in runner.edges}

    def climb(self) -> None:
        """Run cheap to dear, until the tightest target is assured and twice its cost is passed."""
        pairs = [(edge, dt) for edge, steps in self._rungs.items() for dt in steps]
        limit, pace = np.inf, 0.0
        for edge, dt in sorted(pairs, key=lambda pair: _cost(*pair)):
            if _cost(edge, dt) > limit or _cost(edge, dt) * pace > self._longest:
                break
            if self._vain(edge, dt):
                continue
            self.runs[edge, dt] = run = self._first(edge, dt)
            print(f"  {edge:6.3g} {dt:6.3g} {run.error:9.3%} {run.seconds:9.3f} s", flush=True)
            if run.loops:
                pace = run.seconds / _cost(edge, dt)
            if limit == np.inf and (best := self.best(TARGETS[-1], assured=True)) is not None:
                limit = 2.0 * _cost(best.edge, best.dt)

    def _vain(self, edge: float, dt: float) -> bool:
        """Whether refining this far has stopped helping, in space or in time, short of the goal."""
        edges, (level, place) = list(self._rungs), self._place(edge, dt)
        coarser = [(e, self._rungs[e][place]) for e in edges[:level]]
        longer = [(edge, one) for one in self._rungs[edge][:place]]
        return any(self._stuck(line) for line in (coarser, longer))

    def _stuck(self, line: list[tuple[float, float]]) -> bool:
        errors = [self.runs[pair].error for pair in line if pair in self.runs]
        if len(errors) < 2:
            return False
        before, last = errors[-2:]
        return last > TARGETS[-1] and abs(last - before) < 0.1 * before

    def _place(self, edge: float, dt: float) -> tuple[int, int]:
        return list(self._rungs).index(edge), self._rungs[edge].index(dt)

    def best(self, target: float, *, assured: bool) -> Measured | None:
        """Return the fastest run below a target."""
        good = [
            run
            for run in self.runs.values()
            if run.error <= target and (not assured or self._assured(run, target))
        ]
        return min(good, key=lambda run: run.seconds, default=None)

    def repeat(self, times: int) -> None:
        """Repeat the runs that decide a figure until the fastest have been run often enough."""
        for target in TARGETS:
            for assured in (False, True):
                while again := self._candidates(target, times, assured=assured):
                    for run in again:
                        line = self._run(run.edge, run.dt)
                        run.loops.append(line["loop_seconds"])

    def _candidates(self, target: float, times: int, *, assured: bool) -> list[Measured]:
        best = self.best(target, assured=assured)
        if best is None:
            return []
        return [
            run
            for run in self.runs.values()
            if run.error <= target
            and run.seconds <= NEARLY * best.seconds
            and (not assured or self._assured(run, target))
            and len(run.loops) < times
        ]

    def _assured(self, run: Measured, target: float) -> bool:
        edges, (level, place) = list(self._rungs), self._place(run.edge, run.dt)
        if level + 1 == len(edges):
            return False
        finer = edges[level + 1]
        needed = [(finer, self._rungs[finer][place])]
        if place + 1 < len(self._rungs[run.edge]):
            needed.append((run.edge, self._rungs[run.edge][place + 1]))
        if any(pair not in self.runs for pair in needed):
            return False
        below = [one for one in self.runs.values() if one.edge <= run.edge and one.dt <= run.dt]
        return all(one.error <= target for one in [*below, *(self.runs[pair] for pair in needed)])

    def _run(self, edge: float, dt: float) -> dict:
        return self.runner.run(self._meshes.path(self.problem, edge), dt, self._meshes.out)

    def _first(self, edge: float, dt: float) -> Measured:
        line = self._run(edge, dt)
        run = Measured(self.runner.name, self.problem, edge, dt, np.inf, line)
        if "failed" not in line:
            found = self._meshes.error(self.problem, edge)
            run.error, run.loops = found.rms, [line["loop_seconds"]]
            line |= {"largest_error": found.largest, "disagree": found.disagree}
        return run


def _cost(edge: float, dt: float) -> float:
    return 1.0 / (edge**2 * dt)


class Meshes:
    """The problem files of this run, each made when it is first asked for."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.out = folder / "lat.npz"
        self.path = cache(self._path)
        self._locator = cache(self._make_locator)
        self._reference = cache(load_reference)

    def _path(self, problem: str, edge: float) -> Path:
        path = self._folder / f"{problem}-{edge:.4f}.npz"
        write_problem(problem, edge, path)
        return path

    def _make_locator(self, problem: str, edge: float) -> Locator:
        with np.load(self.path(problem, edge)) as mesh:
            return Locator(mesh["points"], mesh["triangles"], self._reference(problem)[0])

    def error(self, problem: str, edge: float):
        """Return the error of the LAT map that was written last."""
        at, reference = self._reference(problem)
        with np.load(self.out) as written:
            if "points" in written:
                locate = Locator(written["points"], written["triangles"], at)
            else:
                locate = self._locator(problem, edge)
            return lat_error(locate(written["lat"]), reference)


def figures(ladder: Ladder) -> list[dict]:
    """Return the fastest run of a ladder for each target, of both kinds."""
    return [
        {
            "code": ladder.runner.name,
            "problem": ladder.problem,
            "target": target,
            "kind": "assured" if assured else "cheapest",
            "run": None if found is None else found.as_json(),
        }
        for target in TARGETS
        for assured in (False, True)
        for found in [ladder.best(target, assured=assured)]
    ]


def keep(ladder: Ladder, absent: list[str]) -> dict:
    """Put a ladder into the results file, in the place of an older one; return all results."""
    RESULTS.parent.mkdir(exist_ok=True)
    old = json.loads(RESULTS.read_text(encoding="utf-8")) if RESULTS.exists() else {}
    key = ladder.runner.name, ladder.problem
    news = {"best": figures(ladder), "runs": [run.as_json() for run in ladder.runs.values()]}
    results = {
        "machine": platform.machine(),
        "python": platform.python_version(),
        "not_installed": absent,
    }
    for part, new in news.items():
        others = [one for one in old.get(part, []) if (one["code"], one["problem"]) != key]
        results[part] = others + new
    RESULTS.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    return results


def table(results: dict, titles: dict[str, str]) -> list[str]:
    """Return the lines of a table in Markdown."""
    lines = []
    for problem, posed in PROBLEMS.items():
        lines += [
            f"**{problem}**: {posed.title}. Seconds of the loop (edge, dt):",
            "",
            "| code | " + " | ".join(f"to {100 * t:g} %" for t in TARGETS) + " | set-up, s | MB |",
            "|---|" + "---|" * (len(TARGETS) + 2),
        ]
        for name, title in titles.items():
            for kind in ("cheapest", "assured"):
                found = {
                    one["target"]: one["run"]
                    for one in results["best"]
                    if (one["code"], one["problem"], one["kind"]) == (name, problem, kind)
                }
                if found:
                    lines.append(f"| {title}, {kind} | " + " | ".join(_cells(found)) + " |")
        lines.append("")
    return lines + [f"{titles[name]}: not installed" for name in results["not_installed"]]


def _cells(found: dict[float, dict | None]) -> list[str]:
    cells = [
        "not reached"
        if found[t] is None
        else "{loop_seconds:.3f} ({edge:.3g}, {dt:.3g})".format(**found[t])
        for t in TARGETS
    ]
    # set-up and memory go with the run to the middle target, or the nearest there is
    shown = next((found[t] for t in (*TARGETS[1:], TARGETS[0]) if found[t]), None)
    if shown is None:
        return [*cells, "", ""]
    return [*cells, f"{shown['setup_seconds']:.1f}", f"{shown['peak_bytes'] / 1e6:.0f}"]


def main() -> None:
    """Measure what the command line asks for."""
    runners = {runner.name: runner for runner in (CARDIOSURF, *PEERS)}
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--problems", nargs="+", choices=PROBLEMS, default=list(PROBLEMS))
    parser.add_argument("--codes", nargs="+", choices=runners, default=list(runners))
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--longest", type=float, default=20.0, help="s, of a run worth trying")
    parser.add_argument("--core", type=int, help="run everything on this core")
    given = parser.parse_args()
    if given.core is not None:
        os.sched_setaffinity(0, {given.core})
    chosen = [runners[name] for name in given.codes]
    absent = [runner.name for runner in chosen if not runner.installed]
    results = {"best": [], "not_installed": absent}
    with tempfile.TemporaryDirectory() as folder:
        for problem in given.problems:
            meshes = Meshes(Path(folder))
            for runner in chosen:
                if runner.name in absent or problem not in runner.problems:
                    continue
                print(f"{runner.title}, problem {problem}: edge, dt, error, seconds", flush=True)
                ladder = Ladder(runner, problem, meshes, given.longest)
                ladder.climb()
                ladder.repeat(given.repeats)
                results = keep(ladder, absent)
    print("\n".join(table(results, {name: runner.title for name, runner in runners.items()})))


if __name__ == "__main__":
    main()
