"""Many runs, some at a time: what is finished is used again, what was stopped goes on."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from cardiosurf.stepping.controls import Execution
from cardiosurf.study.job import Done, Job, reused_job, run_job
from cardiosurf.study.store import run_key
from cardiosurf.study.workers import Staff, run_in_processes

__all__ = ["Done", "Job", "OnDone", "run_batch"]

OnDone = Callable[[Done], object]


def run_batch(
    jobs: Sequence[Job],
    *,
    workers: int = 1,
    execution: Execution | None = None,
    on_done: OnDone | None = None,
    staff: Staff | None = None,
) -> list[Done]:
    """Run all jobs that are not finished already and return what came of each, in their order.

    A run that fails does not stop the others. Jobs with the same folder and config are run once.

    Parameters
    ----------
    jobs : sequence of Job
        The runs.
    workers : int
        How many runs go on at a time, each in a process of its own with one thread; 1: all in
        this process.
    execution : Execution, optional
        How each run uses the machine; with several workers each has one thread unless it says so.
    on_done : callable, optional
        Called in this process with the Done of every job, as they end.
    staff : Staff, optional
        Processes that were started for an earlier batch, used again instead of new ones.

    Raises
    ------
    KeyboardInterrupt
        The batch was stopped by Ctrl-C or SIGTERM; every run's folder is finished or can be
        resumed, and the same batch goes on from there.
    """
    done: dict[int, Done] = {}
    waiting: dict[tuple[Path, str], list[int]] = {}

    def settle(number: int, one: Done) -> None:
        done[number] = one
        if on_done is not None:
            on_done(one)

    for number, job in enumerate(jobs):
        found = reused_job(job)
        if found is not None:
            settle(number, found)
        else:
            waiting.setdefault((job.folder, run_key(job.loaded)), []).append(number)

    firsts = [numbers[0] for numbers in waiting.values()]
    groups = dict(zip(firsts, waiting.values(), strict=True))

    def settle_all(number: int, one: Done) -> None:
        for twin in groups[number]:
            again = twin != number and one.verdict is not None
            settle(twin, replace(one, name=jobs[twin].name, reused=again))

    if min(workers, len(firsts)) > 1:
        wanted = {number: jobs[number] for number in firsts}
        if staff is not None:
            staff.run(wanted, settle_all)
        else:
            run_in_processes(wanted, min(workers, len(firsts)), execution, settle_all)
    else:
        for number in firsts:
            settle_all(number, run_job(jobs[number], execution))
    return [done[number] for number in range(len(jobs))]
