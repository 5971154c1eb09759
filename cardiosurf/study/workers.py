"""Worker processes of a batch: each runs one job after the other and ends with its parent."""

import os
import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from types import TracebackType
from typing import Any, Self

from cardiosurf.errors import NumericalError
from cardiosurf.stepping.controls import Execution
from cardiosurf.study.job import Done, Job, failed, run_job

PATIENCE = 60.0
"""How long a stopped run may take to write its checkpoint, in seconds."""
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class _Worker:
    """One process and the job that it works on.

    Parameters
    ----------
    execution : Execution
        How its runs use the machine.
    """

    def __init__(self, execution: Execution) -> None:
        # spawned: a forked process would share locks and threads of the numeric libraries
        context = get_context("spawn")
        self.pipe, far = context.Pipe()
        self.process: SpawnProcess = context.Process(
            target=_work, args=(far, execution), daemon=True
        )
        with _one_thread():
            self.process.start()
        far.close()
        self.busy_with: tuple[int, Job] | None = None

    def give(self, number: int, job: Job) -> None:
        """Hand a job over."""
        self.busy_with = number, job
        with suppress(BrokenPipeError):  # a process that died is found when it is listened to
            self.pipe.send(job)

    def receive(self) -> Done | None:
        """Return what came of the job; None: the process is gone."""
        try:
            done: Done = self.pipe.recv()
        except (EOFError, ConnectionResetError):
            return None
        self.busy_with = None
        return done

    def lost(self, job: Job) -> Done:
        """Return the Done of a job whose process died."""
        self.process.join(PATIENCE)
        error = NumericalError(
            f"the process of this run ended by itself (exit code {self.process.exitcode})",
            "fewer --workers or a larger mesh.edge_length: memory may have run out",
        )
        return failed(job.name, error, 0.0)


class Staff:
    """Worker processes that wait for more after a batch: starting one takes a second or two.

    Use it as a context manager: at its end no process is left behind.

    Parameters
    ----------
    workers : int
        How many processes there are at most; each is started when there is work for it.
    execution : Execution, optional
        How each run uses the machine; one thread unless it says so.
    """

    def __init__(self, workers: int, execution: Execution | None = None) -> None:
        execution = execution or Execution()
        if execution.threads is None:
            execution = replace(execution, threads=1)
        self.workers = workers
        self._execution = execution
        self._members: list[_Worker] = []

    def __enter__(self) -> Self:
        """Nothing is started yet."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End all processes, those that run after a checkpoint; a second signal kills them."""
        _dismiss(self._members)

    def run(self, jobs: Mapping[int, Job], settle: Callable[[int, Done], None]) -> None:
        """Run jobs and settle each as it ends.

        Parameters
        ----------
        jobs : mapping of int to Job
            The runs, in the order in which they are begun.
        settle : callable
            Called in this process with a job's number and what came of it.
        """
        left = list(jobs.items())
        while left or any(one.busy_with for one in self._members):
            while len(self._members) < min(self.workers, self._busy() + len(left)):
                self._members.append(_Worker(self._execution))
            for worker in self._members:
                if left and worker.busy_with is None:
                    worker.give(*left.pop(0))
            _listen(self._members, settle)

    def _busy(self) -> int:
        return sum(one.busy_with is not None for one in self._members)


def run_in_processes(
    jobs: Mapping[int, Job],
    workers: int,
    execution: Execution | None,
    settle: Callable[[int, Done], None],
) -> None:
    """Run jobs in processes of their own and settle each as it ends.

    Parameters
    ----------
    jobs : mapping of int to Job
        The runs, in the order in which they are begun.
    workers : int
        How many processes.
    execution : Execution, optional
        How each run uses the machine; one thread unless it says so.
    settle : callable
        Called in this process with a job's number and what came of it.

    Raises
    ------
    KeyboardInterrupt
        The batch was stopped. Runs that were on have written their checkpoints, and no process is
        left behind; a second signal kills what is still writing.
    """
    with Staff(workers, execution) as staff:
        staff.run(jobs, settle)


def _listen(staff: list[_Worker], settle: Callable[[int, Done], None]) -> None:
    """Wait for jobs that end and settle them; processes that died leave the staff."""
    ready = wait([one.pipe for one in staff if one.busy_with])
    for worker in [one for one in staff if one.pipe in ready]:
        if worker.busy_with is None:
            continue
        number, job = worker.busy_with
        done = worker.receive()
        if done is None:
            staff.remove(worker)
            done = worker.lost(job)
        settle(number, done)


def _dismiss(staff: list[_Worker]) -> None:
    """End all processes: those that wait for work at once, those that run after a checkpoint."""
    try:
        for worker in staff:
            worker.pipe.close()
            if worker.busy_with:
                worker.process.terminate()
        for worker in staff:
            worker.process.join(PATIENCE)
    finally:
        for worker in staff:
            if worker.process.is_alive():
                worker.process.kill()
                worker.process.join()


@contextmanager
def _one_thread() -> Iterator[None]:
    """Have processes that are started meanwhile compute with one thread each."""
    before = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _work(pipe: "Connection[Any, Any]", execution: Execution) -> None:
    """Run the jobs that come through a pipe until it is closed; the process's main function."""
    # Ctrl-C reaches every process of a terminal; the parent says what is to be stopped
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    with suppress(KeyboardInterrupt, EOFError, BrokenPipeError, ConnectionResetError):
        while True:
            job: Job = pipe.recv()
            pipe.send(run_job(job, execution))


def _end_with_parent() -> None:
    """Stop this process in order when its parent has died."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)
