"""All points of a scenario's sweep, run and laid out in rows."""

import json
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any, TypeAlias

from cardiosurf.config.expansion import varied
from cardiosurf.config.scenario_file import ReadyPoint, ScenarioFile
from cardiosurf.recording.whole_file import unwritable, whole_file
from cardiosurf.stepping.controls import Execution
from cardiosurf.study.batch import Done, Job, OnDone, run_batch
from cardiosurf.study.job import worst_exit_code
from cardiosurf.study.store import RunStore

CASES, RUNS, LISTING = "cases", "runs", "cases.json"
Row: TypeAlias = dict[str, Any]

_OF_TARGETS = ("verdict", "activated_fraction", "first_activation", "last_activation", "route")
_OF_REENTRY = ("max_activations", "cycle_length")


@dataclass(frozen=True)
class SweepResult:
    """What came of a sweep.

    Attributes
    ----------
    name : str
        The scenario's name.
    varied : tuple of str
        What was varied: key paths and parameters.
    rows : tuple of dict
        One a run, in the order of the points: ``case``, what was varied, and what was found.
    done : tuple of Done
        The runs, in the same order.
    seconds : float
        Wall time of the whole sweep.
    """

    name: str
    varied: tuple[str, ...]
    rows: tuple[Row, ...]
    done: tuple[Done, ...]
    seconds: float

    @property
    def exit_code(self) -> int:
        """0: every run ended; otherwise that of the worst failure."""
        return worst_exit_code(self.done)


def sweep(
    file: ScenarioFile,
    folder: Path,
    *,
    fresh: bool = False,
    workers: int = 1,
    execution: Execution | None = None,
    on_done: OnDone | None = None,
) -> SweepResult:
    """Write the resolved config of every point, run what is not there yet, and return the rows.

    Parameters
    ----------
    file : ScenarioFile
        A scenario that varies something.
    folder : Path
        Where ``cases/NAME.yaml`` and the runs go.
    fresh : bool
        Whether to make runs that are there already once more.
    workers : int
        How many runs go on at a time.
    execution : Execution, optional
        How each run uses the machine.
    on_done : callable, optional
        Called with the Done of every point, as they end.

    Raises
    ------
    InputError
        The scenario varies nothing, a point is wrong, or the folder cannot be written to.
    KeyboardInterrupt
        The sweep was stopped; called again it goes on from there.
    """
    begun = perf_counter()
    points = file.points()
    store = RunStore(folder / RUNS)
    jobs = [Job(one.name, one.loaded, store.folder_of(one.loaded)) for one in points]
    _write_cases(folder, points)
    if fresh:
        for job in jobs:
            shutil.rmtree(job.folder, ignore_errors=True)
    ended = run_batch(jobs, workers=workers, execution=execution, on_done=on_done)
    keys = varied(file.scenario)
    rows = tuple(row_of(one, done, keys) for one, done in zip(points, ended, strict=True))
    return SweepResult(file.scenario.name, keys, rows, tuple(ended), perf_counter() - begun)


def row_of(point: ReadyPoint, done: Done, keys: Sequence[str]) -> Row:
    """Return a run as one row of a table; what a failed run does not tell is None.

    Parameters
    ----------
    point : ReadyPoint
        The point.
    done : Done
        Its run.
    keys : sequence of str
        What is varied.
    """
    verdict: Mapping[str, Any] = done.verdict or {}
    reentry = verdict.get("reentry", {})
    row: Row = {"point": point.name, "case": point.case.name if point.case else None}
    row |= {key: point.point.values[key] for key in keys}
    row |= {"verdict": verdict.get("verdict"), "captured": verdict.get("captured")}
    for target in verdict.get("targets", ()):
        row |= {f"{target['name']}.{key}": target[key] for key in _OF_TARGETS}
    row |= {"reentry": reentry.get("verdict")} | {key: reentry.get(key) for key in _OF_REENTRY}
    row |= {key: verdict.get(key) for key in ("quiescent_at", "end")}
    row |= {key: done.meta.get(key) for key in ("edge_length", "step")}
    return row | {"seconds": done.seconds, "error": done.error.partition("\n")[0] or None}


def _write_cases(folder: Path, points: Sequence[ReadyPoint]) -> None:
    """Write the resolved configs, and remove those of an earlier expansion that are no more."""
    place = folder / CASES
    try:
        place.mkdir(parents=True, exist_ok=True)
        for name in set(_listed(folder)) - {f"{one.name}.yaml" for one in points}:
            (place / name).unlink(missing_ok=True)
    except OSError as error:
        raise unwritable(place, error) from error
    names = [f"{one.name}.yaml" for one in points]
    # first, so that a sweep that is stopped here knows later which files are its own
    with whole_file(folder / LISTING) as partial:
        partial.write_text(json.dumps(names, indent=1) + "\n", encoding="utf-8")
    for name, one in zip(names, points, strict=True):
        with whole_file(place / name) as partial:
            partial.write_text(one.loaded.text, encoding="utf-8")


def _listed(folder: Path) -> list[str]:
    """Return the names of the files that an earlier expansion wrote."""
    try:
        names = json.loads((folder / LISTING).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return []
    # a name with a folder in it is none of ours
    return [name for name in names if isinstance(name, str) and Path(name).name == name]
