"""Scenarios run and compared with what is expected of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter
from typing import Any, Literal

from cardiosurf.config.expectation import Plain
from cardiosurf.config.scenario_file import ReadyCase, ScenarioFile
from cardiosurf.errors import InputError
from cardiosurf.stepping.controls import Execution
from cardiosurf.study.batch import Done, Job, OnDone, run_batch
from cardiosurf.study.guard_cases import Guarded, guard_cases
from cardiosurf.study.history import Change, Past, change_since, read_history, write_history
from cardiosurf.study.job import worst_exit_code
from cardiosurf.study.outcome import Compared, compare, findings_of, probe_lats
from cardiosurf.study.pairs import PairResult, judge_pair
from cardiosurf.study.store import RunStore

RUNS = "runs"
Status = Literal["agrees", "differs", "failed"]


@dataclass(frozen=True)
class CaseResult:
    """What came of one case.

    Attributes
    ----------
    scenario, case : str
        Which.
    published, note : str
        What the scenario says about it.
    coarsened : bool
        Whether it was run at the coarser settings of ``fast``.
    compared : tuple of Compared
        Every expectation beside what was found.
    done : Done
        The run: verdict or error, and what it took.
    folder : Path
        Where its files are.
    change : Change or None
        What is different from when it last agreed; None: it agrees, or never did here.
    guarded : Guarded or None
        What repetitions on a finer mesh and with smaller steps say; None: not asked for.
    """

    scenario: str
    case: str
    published: str
    note: str
    coarsened: bool
    compared: tuple[Compared, ...]
    done: Done
    folder: Path
    change: Change | None
    guarded: Guarded | None = None

    @property
    def status(self) -> Status:
        """Whether everything is as expected."""
        if self.done.verdict is None:
            return "failed"
        return "agrees" if all(one.agrees for one in self.compared) else "differs"

    @property
    def converged(self) -> str | None:
        """What the convergence guard says, ``failed`` if a repetition broke down, None without."""
        if self.guarded is None:
            return None
        return "failed" if self.guarded.finding is None else self.guarded.finding.converged


@dataclass(frozen=True)
class CheckResult:
    """What came of all scenarios.

    Attributes
    ----------
    cases : tuple of CaseResult
        In the order of the files.
    pairs : tuple of PairResult
        Likewise.
    seconds : float
        Wall time of the whole check.
    """

    cases: tuple[CaseResult, ...]
    pairs: tuple[PairResult, ...]
    seconds: float

    @property
    def exit_code(self) -> int:
        """0: all as expected; 1: something differs; 3: a run broke down; 2, 70: other failures."""
        failed = worst_exit_code(case.done for case in self.cases)
        if failed:
            return failed
        fine = all(one.status == "agrees" for one in self.cases)
        return 0 if fine and all(pair.agrees for pair in self.pairs) else 1


@dataclass(frozen=True)
class How:
    """How a check runs its cases.

    Attributes
    ----------
    fast : bool
        At the coarser settings that their scenario states.
    guard : bool
        Again on a finer mesh and with smaller steps, to tell whether their verdicts stay.
    """

    fast: bool = False
    guard: bool = False


@dataclass(frozen=True)
class _Planned:
    """A case and the job that answers it."""

    file: ScenarioFile
    ready: ReadyCase
    job: Job

    @property
    def key(self) -> str:
        """Under which name the case has a past."""
        return f"{self.job.name} (fast)" if self.ready.coarsened else self.job.name


def check(
    files: Sequence[ScenarioFile],
    folder: Path,
    *,
    how: How = How(),
    workers: int = 1,
    execution: Execution | None = None,
    on_done: OnDone | None = None,
) -> CheckResult:
    """Run the cases of scenarios and compare them with what is expected.

    Parameters
    ----------
    files : sequence of ScenarioFile
        The scenarios.
    folder : Path
        Where runs are kept, to be used again, and what the cases were when they last agreed.
    how : How
        At the coarser settings that scenarios state, with a convergence guard, or neither.
    workers : int
        How many runs go on at a time.
    execution : Execution, optional
        How each run uses the machine.
    on_done : callable, optional
        Called with the Done of every case, as they end; its name is ``scenario/case``.

    Raises
    ------
    InputError
        A scenario or a case's config is wrong, two scenarios have one name; nothing is run then.
    KeyboardInterrupt
        The check was stopped; called again it goes on from there.
    """
    begun = perf_counter()
    store = RunStore(folder / RUNS)
    _check_names(files)
    planned = [
        _Planned(file, ready, Job(_name(file, ready), ready.loaded, store.folder_of(ready.loaded)))
        for file in files
        for ready in file.cases(fast=how.fast)
    ]
    history = read_history(folder)
    # the longest first, so that no worker is left with one at the end
    by_cost = sorted(planned, key=lambda one: -_cost(history.get(one.key)))
    ended = run_batch(
        [one.job for one in by_cost], workers=workers, execution=execution, on_done=on_done
    )
    by_name = {done.name: done for done in ended}
    guarded: dict[str, Guarded] = {}
    if how.guard:
        finished = {one.job.name: (one.job.loaded, by_name[one.job.name]) for one in planned}
        guarded = guard_cases(
            finished, store, workers=workers, execution=execution, on_done=on_done
        )
    findings = {one.job.name: _findings(one, by_name[one.job.name]) for one in planned}
    cases = tuple(
        replace(
            _result(one, by_name[one.job.name], findings[one.job.name], history.get(one.key)),
            guarded=guarded.get(one.job.name),
        )
        for one in planned
    )
    if planned:
        write_history(folder, history | _agreed(planned, cases, findings))
    return CheckResult(cases, _pairs(files, planned, by_name), perf_counter() - begun)


def _name(file: ScenarioFile, ready: ReadyCase) -> str:
    return f"{file.scenario.name}/{ready.case.name}"


def _check_names(files: Sequence[ScenarioFile]) -> None:
    """Refuse two scenarios of one name, whose cases could not be told apart."""
    first: dict[str, Path] = {}
    for file in files:
        name = file.scenario.name
        if name in first:
            raise InputError(
                file.document.where(("name",)),
                f"{name!r} is also the name of {first[name]}",
                "scenarios with names that differ",
            )
        first[name] = file.path


def _cost(past: Past | None) -> float:
    return float("inf") if past is None else past.seconds


def _findings(planned: _Planned, done: Done) -> dict[str, Plain]:
    """Return what a case found; probes are read only where something is expected of them."""
    if done.verdict is None:
        return {}
    found = findings_of(done.verdict)
    if any(one.key.startswith("lat.") for one in planned.ready.expected):
        found |= probe_lats(planned.job.folder)
    return found


def _result(
    planned: _Planned, done: Done, findings: Mapping[str, Plain], past: Past | None
) -> CaseResult:
    compared = compare(planned.ready.expected, findings) if done.verdict is not None else ()
    change = None
    if past is not None and not all(one.agrees for one in compared):
        change = change_since(past, findings, planned.ready.loaded.text)
    return CaseResult(
        scenario=planned.file.scenario.name,
        case=planned.ready.case.name,
        published=planned.ready.case.published,
        note=planned.ready.case.note,
        coarsened=planned.ready.coarsened,
        compared=compared,
        done=done,
        folder=planned.job.folder,
        change=change,
    )


def _agreed(
    planned: Sequence[_Planned],
    cases: Sequence[CaseResult],
    findings: Mapping[str, Mapping[str, Plain]],
) -> dict[str, Past]:
    return {
        one.key: Past(findings[one.job.name], one.ready.loaded.text, case.done.seconds)
        for one, case in zip(planned, cases, strict=True)
        if case.status == "agrees"
    }


def _pairs(
    files: Sequence[ScenarioFile], planned: Sequence[_Planned], ended: Mapping[str, Done]
) -> tuple[PairResult, ...]:
    found: list[PairResult] = []
    for file in files:
        own = [one for one in planned if one.file is file]
        verdicts: dict[str, Mapping[str, Any] | None] = {
            one.ready.case.name: ended[one.job.name].verdict for one in own
        }
        configs = {one.ready.case.name: one.ready.loaded for one in own}
        name = file.scenario.name
        found += [judge_pair(name, pair, verdicts, configs) for pair in file.scenario.pairs]
    return tuple(found)
