"""Critical values of a config: its runs, what they answer, and where the answer changes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from cardiosurf.errors import InputError, NumericalError
from cardiosurf.stepping.controls import Execution
from cardiosurf.study.batch import Done, Job, run_batch
from cardiosurf.study.critical import Change, find_changes
from cardiosurf.study.store import RunStore
from cardiosurf.study.threshold_plan import Plan
from cardiosurf.study.threshold_result import Level, RunRow, Threshold, critical_value
from cardiosurf.study.workers import Staff


@dataclass
class _Runs:
    """Answers by running what the store does not hold yet."""

    plan: Plan
    store: RunStore
    staff: Staff
    execution: Execution | None
    on_run: Callable[[RunRow], object]
    rows: list[RunRow] = field(default_factory=list)

    def ask(self, number: int, values: Sequence[float]) -> list[str]:
        level = self.plan.levels[number]
        jobs = []
        for value in values:
            loaded = self.plan.at(level, value)
            name = f"{self.plan.vary} = {value:g} on edges of {level.edge_length:g} su"
            jobs.append(Job(name, loaded, self.store.folder_of(loaded)))
        by_name = dict(zip((job.name for job in jobs), values, strict=True))

        def settle(done: Done) -> None:
            row = _row(self.plan, level, by_name[done.name], done)
            if row is not None:
                self.on_run(row)

        finished = run_batch(
            jobs,
            workers=self.staff.workers,
            execution=self.execution,
            on_done=settle,
            staff=self.staff,
        )
        found = []
        for value, done in zip(values, finished, strict=True):
            row = _row(self.plan, level, value, done)
            if row is None:
                raise _failure(done)
            found.append(row)
        self.rows += found
        return [row.answer for row in found]


def find_threshold(
    plan: Plan,
    store: RunStore,
    *,
    workers: int = 1,
    execution: Execution | None = None,
    on_run: Callable[[RunRow], object] = lambda row: None,
) -> Threshold:
    """Return every critical value of a config between two values, with its error.

    Parameters
    ----------
    plan : Plan
        What is looked for.
    store : RunStore
        Where runs are kept; those that are there are not run again.
    workers : int
        How many runs go on at a time.
    execution : Execution, optional
        How each run uses the machine.
    on_run : callable
        Called with each run as it ends.

    Raises
    ------
    InputError
        If the key does not take a value of the interval, or the config cannot be run with it.
    NumericalError
        If a run breaks down.
    KeyboardInterrupt
        If the search was stopped; the same search goes on from the store.
    """
    for level in plan.levels:
        for value in (plan.search.low, plan.search.high):
            plan.at(level, value)
    sizes = [level.edge_length for level in plan.levels]
    with Staff(workers, execution) as staff:
        runs = _Runs(plan, store, staff, execution, on_run)
        changes = find_changes(runs.ask, sizes, plan.search)
    return Threshold(
        name=plan.loaded.config.name,
        config_sha256=plan.loaded.sha256,
        vary=plan.vary,
        between=(plan.search.low, plan.search.high),
        tolerance=plan.search.tolerance,
        scan=plan.search.scan,
        question=str(plan.question),
        levels=plan.levels,
        changes=tuple(critical_value(change, plan.levels) for change in changes),
        runs=tuple(sorted(runs.rows, key=lambda row: (-row.edge_length, row.value))),
        notes=tuple(_notes(plan, changes, runs.rows)),
    )


def _row(plan: Plan, level: Level, value: float, done: Done) -> RunRow | None:
    """Return what a search keeps of a run, None if the run failed."""
    verdict = done.verdict
    if verdict is None:
        return None
    return RunRow(
        edge_length=level.edge_length,
        step=level.step,
        value=value,
        answer=plan.question.answer(verdict),
        verdict=verdict["verdict"],
        activated_fraction={t["name"]: t["activated_fraction"] for t in verdict["targets"]},
        end=verdict["end"],
        settled=not plan.question.is_open(verdict),
        seconds=done.seconds,
        reused=done.reused,
    )


def _failure(done: Done) -> Exception:
    """Return the error that ends a search whose run failed."""
    if done.kind == "input":
        return InputError(done.name, done.error, hint="an interval in which every value can be run")
    if done.kind == "numerical":
        return NumericalError(f"{done.name}: {done.error}")
    return RuntimeError(f"{done.name}: {done.error}")


def _notes(plan: Plan, changes: Sequence[Change], rows: Sequence[RunRow]) -> list[str]:
    """Return what a reader should know before believing the values."""
    notes = []
    unsettled = sum(not row.settled for row in rows)
    if unsettled:
        notes.append(
            f"{unsettled} of {len(rows)} runs ended before all tissue was at rest, and might answer"
            " differently later; raise time.end"
        )
    for change in changes:
        bracket = next(b for b in reversed(change.brackets) if b is not None)
        if bracket.half_width > plan.search.tolerance * (1.0 + 1e-9):
            notes.append(
                f"{change.below} -> {change.above}: the bound of {plan.search.most} runs on a mesh"
                " was reached; the answer changes too often for a threshold"
            )
    return notes
