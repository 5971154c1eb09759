"""One run of a batch: made, gone on with where it was stopped, or found finished."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any, Literal

from cardiosurf.config import Loaded
from cardiosurf.errors import InputError, NumericalError
from cardiosurf.stepping.controls import Execution
from cardiosurf.study.folder import RunFolder
from cardiosurf.study.store import (
    finished_run,
    forget,
    note_begun,
    note_finished,
    read_record,
    run_key,
)

ErrorKind = Literal["numerical", "input", "internal"]


@dataclass(frozen=True)
class Job:
    """One run that is wanted.

    Attributes
    ----------
    name : str
        What the batch calls it; names within a batch differ.
    loaded : Loaded
        Its config.
    folder : Path
        Where its files are to be; ``RunStore.folder_of`` names a place that no other run has.
    """

    name: str
    loaded: Loaded
    folder: Path


@dataclass(frozen=True)
class Done:
    """What came of a job.

    Attributes
    ----------
    name : str
        The job's name.
    verdict : dict or None
        The verdict as it stands in verdict.json; None: the run failed.
    error : str
        What went wrong, as the command line would say it.
    kind : str or None
        ``numerical``: the computation broke down; ``input``: the config does not fit its surface,
        or the folder cannot be used; ``internal``: a mistake in cardiosurf. None: nothing failed.
    seconds : float
        Wall time of the run; where it was reused, of the run that made it.
    meta : mapping
        How it was computed (``Recording.meta``); empty after a failure.
    reused : bool
        Whether the run was there already.
    """

    name: str
    verdict: dict[str, Any] | None
    error: str
    kind: ErrorKind | None
    seconds: float
    meta: Mapping[str, Any]
    reused: bool


def run_job(job: Job, execution: Execution | None = None) -> Done:
    """Run one job in this process, or go on with it where it was stopped.

    Parameters
    ----------
    job : Job
        The run.
    execution : Execution, optional
        How the machine is used.

    Raises
    ------
    KeyboardInterrupt
        The run was stopped; it goes on from its checkpoint the next time.
    """
    begun = perf_counter()
    try:
        verdict, meta = _simulated(job, execution)
        seconds = perf_counter() - begun
        note_finished(job.folder, run_key(job.loaded), seconds, meta)
    except (Exception, KeyboardInterrupt) as error:
        forget(job.folder)
        if isinstance(error, KeyboardInterrupt):
            raise
        return failed(job.name, error, perf_counter() - begun)
    return Done(job.name, verdict, "", None, seconds, meta, reused=False)


def failed(name: str, error: Exception, seconds: float) -> Done:
    """Return the Done of a job that an error ended.

    Parameters
    ----------
    name : str
        The job's name.
    error : Exception
        What the run raised.
    seconds : float
        How long it took to fail.
    """
    kind: ErrorKind = "internal"
    text = f"{type(error).__name__}: {error}"
    if isinstance(error, NumericalError | InputError):
        kind, text = ("input" if isinstance(error, InputError) else "numerical"), str(error)
    elif isinstance(error, MemoryError):
        kind, text = "numerical", "there is not enough memory\n  try: a larger mesh.edge_length"
    return Done(name, None, text, kind, seconds, {}, reused=False)


def worst_exit_code(ended: Iterable[Done]) -> int:
    """Return the exit code that failed runs end with: 2 input, 3 numerical, 70 internal; else 0.

    Parameters
    ----------
    ended : iterable of Done
        What came of the jobs.
    """
    codes = {"input": 2, "numerical": 3, "internal": 70, None: 0}
    return max((codes[done.kind] for done in ended), default=0)


def reused_job(job: Job) -> Done | None:
    """Return the Done of a job whose run is in its folder, None if it has to be run.

    Parameters
    ----------
    job : Job
        The run.
    """
    found = finished_run(job.folder, run_key(job.loaded))
    if found is None:
        return None
    verdict, record = found
    return Done(job.name, verdict, "", None, record.seconds or 0.0, record.meta or {}, reused=True)


def _simulated(job: Job, execution: Execution | None) -> tuple[dict[str, Any], Mapping[str, Any]]:
    """Run a job; return its verdict as JSON data and how it was computed."""
    # all that a march takes: a batch whose runs are all there does without
    from cardiosurf.study.simulation import simulate  # noqa: PLC0415

    record, key = read_record(job.folder), run_key(job.loaded)
    resume = RunFolder(job.folder).resumable and record is not None and record.key == key
    if not resume:
        note_begun(job.folder, key)
    try:
        result = simulate(
            job.loaded, job.folder, overwrite=True, resume=resume, execution=execution
        )
    except InputError:
        if not resume:
            raise
        # a checkpoint that cannot be used costs time and nothing else
        result = simulate(job.loaded, job.folder, overwrite=True, execution=execution)
    # as it is read back from its file: lists, not tuples
    verdict: dict[str, Any] = json.loads(json.dumps(result.verdict.to_json()))
    return verdict, dict(result.meta)
