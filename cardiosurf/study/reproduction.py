"""The paper's experiments brought up to date: what has no kept result is run, and kept."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from cardiosurf.arrays import Floats
from cardiosurf.config import Loaded
from cardiosurf.config.scenario_file import ScenarioFile
from cardiosurf.errors import InputError, NumericalError
from cardiosurf.study.batch import Done, Job, run_batch
from cardiosurf.study.check import How, check
from cardiosurf.study.folder import RECORDING
from cardiosurf.study.question import parse_question
from cardiosurf.study.results import ASKED, Entry, Kind, Results, case_json, current
from cardiosurf.study.store import RunStore
from cardiosurf.study.threshold import find_threshold
from cardiosurf.study.threshold_plan import Plan, key_path, plan_levels, plan_search
from cardiosurf.study.wanted import (
    Wanted,
    against_of,
    wanted_cases,
    wanted_entrances,
    wanted_thresholds,
)

SCAN = 9
STAGES: tuple[Kind, ...] = ("cases", "thresholds", "entrances")
_NOT_KEPT = ("run", "reused", "change", "published", "note")
"""What a check tells of a case that is of this machine, of this call, or the scenario's."""


@dataclass(frozen=True)
class Work:
    """Where and how missing results are made.

    Attributes
    ----------
    results : Results
        Where they are kept.
    folder : Path
        Where the runs are.
    workers : int
        How many go on at a time.
    say : callable
        Called with a line whenever something has been made.
    """

    results: Results
    folder: Path
    workers: int = 1
    say: Callable[[str], object] = field(default=lambda line: None)

    @property
    def store(self) -> RunStore:
        """The runs."""
        return RunStore(self.folder / "runs")

    def missing(self, kind: Kind, wanted: Sequence[Wanted]) -> list[Wanted]:
        """Return what there is no current result of."""
        there = self.results.read(kind)
        return [one for one in wanted if current(there.get(one.name), one.asked) is None]


_Wanting: TypeAlias = Callable[[Sequence[ScenarioFile]], list[Wanted]]
_Updating: TypeAlias = Callable[[Sequence[ScenarioFile], Work], None]


def bring_up_to_date(
    files: Sequence[ScenarioFile], work: Work, stages: Collection[str] = STAGES
) -> None:
    """Make what is missing among the kept results of scenarios, and drop what they have no more.

    Parameters
    ----------
    files : sequence of ScenarioFile
        The scenarios.
    work : Work
        Where and how.
    stages : collection of str
        Of ``STAGES``, what to bring up to date; others are passed over.

    Raises
    ------
    InputError
        A scenario is wrong, or a folder cannot be written to.
    NumericalError
        A run broke down.
    KeyboardInterrupt
        It was stopped; the same call goes on.
    """
    # what is wrong with a search need not wait for all that is run before it
    for one in wanted_thresholds(files):
        _plan(one, work)
        against_of(one)
    names = [file.scenario.name for file in files]
    updates: tuple[tuple[Kind, _Wanting, _Updating], ...] = (
        ("cases", wanted_cases, update_cases),
        ("thresholds", wanted_thresholds, update_thresholds),
        ("entrances", wanted_entrances, update_entrances),
    )
    for kind, wanted, update in updates:
        if kind in stages:
            update(files, work)
            work.results.prune(kind, names, [one.name for one in wanted(files)])


def update_cases(files: Sequence[ScenarioFile], work: Work) -> None:
    """Check the cases that have no current result, with the convergence guard.

    Raises
    ------
    InputError
        A scenario is wrong.
    KeyboardInterrupt
        It was stopped; the same call goes on.
    """
    missing = {one.name: one for one in work.missing("cases", wanted_cases(files))}
    partial = []
    for file in files:
        own = {one.ready.case.name for one in missing.values() if one.file is file}
        if own:
            cases = tuple(case for case in file.scenario.cases if case.name in own)
            partial.append(replace(file, scenario=replace(file.scenario, cases=cases, pairs=())))
    if not partial:
        return
    found = check(
        partial,
        work.folder,
        how=How(guard=True),
        workers=work.workers,
        on_done=lambda done: work.say(_line(done)),
    )
    entries = work.results.read("cases")
    for case in found.cases:
        name = f"{case.scenario}/{case.case}"
        data = {key: value for key, value in case_json(case).items() if key not in _NOT_KEPT}
        entries[name] = {ASKED: missing[name].asked, **data}
    work.results.write("cases", entries)


def update_thresholds(files: Sequence[ScenarioFile], work: Work) -> None:
    """Search for the critical values that have no current result.

    Raises
    ------
    InputError
        A search is wrong.
    NumericalError
        A run broke down.
    KeyboardInterrupt
        It was stopped; the same call goes on.
    """
    for one in work.missing("thresholds", wanted_thresholds(files)):
        found = find_threshold(_plan(one, work), work.store, workers=work.workers)
        data = found.to_json()
        data["runs"] = len(found.runs)
        entry: Entry = {ASKED: one.asked, "against": against_of(one), **data}
        work.results.keep("thresholds", one.name, entry | {"seconds": round(found.seconds, 1)})
        work.say(f"{one.name}: {len(found.changes)} change{'s' * (len(found.changes) != 1)}")


def update_entrances(files: Sequence[ScenarioFile], work: Work) -> None:
    """Measure the front before the entrances that have no current result.

    Raises
    ------
    InputError
        The run has no such patch.
    NumericalError
        A run broke down.
    KeyboardInterrupt
        It was stopped; the same call goes on.
    """
    # measuring takes more than a run that is there already
    from cardiosurf.analysis.entrance import patch_entrances  # noqa: PLC0415
    from cardiosurf.recording.hdf5 import read_recording  # noqa: PLC0415

    for one in work.missing("entrances", wanted_entrances(files)):
        if one.search is None or one.search.entrance is None:
            continue
        folder, done = run_case(one.ready.loaded, one.name, work)
        recording = read_recording(folder / RECORDING, with_frames=False)
        pieces = patch_entrances(recording, one.search.entrance)
        entry = {
            ASKED: one.asked,
            "against": against_of(one),
            "verdict": (done.verdict or {})["verdict"],
            "edge_length": done.meta["edge_length"],
            "pieces": [_rounded(asdict(piece)) for piece in pieces],
        }
        work.results.keep("entrances", one.name, entry)
        work.say(f"{one.name}: front measured before {one.search.entrance}")


def run_case(loaded: Loaded, name: str, work: Work) -> tuple[Path, Done]:
    """Return the folder of a config's run and its Done; it is run if it is not there.

    Parameters
    ----------
    loaded : Loaded
        The config.
    name : str
        What messages call it.
    work : Work
        Where it is kept.

    Raises
    ------
    InputError, NumericalError
        It cannot be run, or broke down.
    """
    folder = work.store.folder_of(loaded)
    (done,) = run_batch([Job(name, loaded, folder)])
    if done.verdict is not None:
        return folder, done
    if done.kind == "internal":
        msg = f"{name}: {done.error}"
        raise RuntimeError(msg)
    raise (InputError(name, done.error) if done.kind == "input" else NumericalError(done.error))


def _plan(one: Wanted, work: Work) -> Plan:
    """Return the search of a case."""
    search, loaded = one.search, one.ready.loaded
    if search is None:
        raise TypeError(one.name)
    targets = [target.name for target in loaded.config.targets]
    return Plan(
        loaded,
        key_path(search.vary),
        plan_search(search.between, search.tolerance, scan=SCAN, workers=work.workers),
        plan_levels(loaded, search.edges),
        parse_question(search.of, targets),
    )


def _line(done: Done) -> str:
    found = done.verdict["verdict"] if done.verdict else f"failed ({done.kind})"
    return f"{done.name}: {found}, {'reused' if done.reused else f'{done.seconds:.1f} s'}"


def _rounded(profile: dict[str, Any]) -> dict[str, Any]:
    """Return a profile with five digits, and None for NaN, as JSON has it."""

    def plain(value: float | Floats) -> Any:
        if isinstance(value, np.ndarray):
            return [plain(each) for each in value.tolist()]
        if isinstance(value, list):
            return [plain(each) for each in value]
        return float(f"{value:.5g}") if np.isfinite(value) else None

    return {key: plain(value) for key, value in profile.items() if key != "points"}
