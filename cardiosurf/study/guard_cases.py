"""The convergence guard of many runs at a time."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from cardiosurf.analysis.verdict import GuardFinding
from cardiosurf.config import Loaded
from cardiosurf.stepping.controls import Execution
from cardiosurf.study.batch import Done, OnDone, run_batch
from cardiosurf.study.guard import Repetition, guard_of, repetitions
from cardiosurf.study.store import RunStore


@dataclass(frozen=True)
class Guarded:
    """What the repetitions of a run say.

    Attributes
    ----------
    finding : GuardFinding or None
        Whether its verdict stays; None: a repetition failed.
    failure : Done or None
        The repetition that failed.
    """

    finding: GuardFinding | None
    failure: Done | None = None


def guard_cases(
    finished: Mapping[str, tuple[Loaded, Done]],
    store: RunStore,
    *,
    workers: int = 1,
    execution: Execution | None = None,
    on_done: OnDone | None = None,
) -> dict[str, Guarded]:
    """Repeat runs on finer meshes and with smaller steps, all in one batch, and compare.

    Parameters
    ----------
    finished : mapping of str to (Loaded, Done)
        Config and outcome of each run, by its name; runs that failed are left out.
    store : RunStore
        Where the repetitions are kept.
    workers : int
        How many go on at a time.
    execution : Execution, optional
        How each uses the machine.
    on_done : callable, optional
        Called with the Done of every repetition, as they end.

    Raises
    ------
    KeyboardInterrupt
        The batch was stopped; called again it goes on.
    """
    wanted: dict[str, list[Repetition]] = {}
    for name, (loaded, done) in finished.items():
        if done.verdict is not None:
            edge = float(done.meta["edge_length"])
            found = repetitions(loaded, edge, lambda _, refined: store.folder_of(refined))
            wanted[name] = [_named(one, name) for one in found]
    jobs = [one.job for every in wanted.values() for one in every]
    ended = run_batch(jobs, workers=workers, execution=execution, on_done=on_done)
    by_name = {one.name: one for one in ended}
    return {
        name: _guarded(*finished[name], [(one, by_name[one.job.name]) for one in every])
        for name, every in wanted.items()
    }


def _named(one: Repetition, name: str) -> Repetition:
    return replace(one, job=replace(one.job, name=f"{name} {one.job.name}"))


def _guarded(loaded: Loaded, done: Done, repeated: list[tuple[Repetition, Done]]) -> Guarded:
    found: list[tuple[Repetition, Mapping[str, Any]]] = []
    for one, again in repeated:
        if again.verdict is None:
            return Guarded(None, again)
        found.append((one, again.verdict))
    edge = float(done.meta["edge_length"])
    return Guarded(guard_of(loaded, done.verdict or {}, edge, found))
