"""The convergence guard: a run repeated on a finer mesh and with smaller steps."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

from cardiosurf.analysis.findings import judge_recording
from cardiosurf.analysis.guard import guard_finding, guard_run, guarded
from cardiosurf.analysis.verdict import GuardFinding
from cardiosurf.config import Loaded, overlay
from cardiosurf.errors import InputError, NumericalError
from cardiosurf.recording.hdf5 import read_recording
from cardiosurf.stepping.controls import Execution
from cardiosurf.study.batch import Done, Job, run_batch
from cardiosurf.study.folder import RECORDING, VERDICT, RunFolder
from cardiosurf.study.simulation import Result, simulate
from cardiosurf.study.steps import step_of
from cardiosurf.study.store import finished_run, note_finished, run_key

FINER = 1.5
"""How much finer the mesh of the first repetition is."""
SMALLER = 2.0
"""How much smaller the steps of the second are."""
FOLDER = "guard"


@dataclass(frozen=True)
class Repetition:
    """A run that another is compared with, its mesh edges in su and its step in tu."""

    job: Job
    edge_length: float
    step: float


def guard(
    loaded: Loaded,
    verdict: Mapping[str, Any],
    folder: Path,
    *,
    edge_length: float,
    workers: int = 1,
    execution: Execution | None = None,
) -> GuardFinding:
    """Repeat a run on a finer mesh and with smaller steps and tell whether its verdict stays.

    Repetitions that are in the folder are not run again; stopped ones go on. Other mass matrices
    are not tried: near a critical value all of them may err to one side, so that they agree says
    nothing (docs/findings.md).

    Parameters
    ----------
    loaded : Loaded
        The run's config.
    verdict : mapping
        Its verdict, as it stands in verdict.json.
    folder : Path
        Where the repetitions are kept.
    edge_length : float
        The run's mesh edges, in su (``auto`` resolved).
    workers : int
        How many repetitions go on at a time.
    execution : Execution, optional
        How each uses the machine.

    Raises
    ------
    InputError
        If the shape cannot be meshed more finely, or the folder cannot be used.
    NumericalError
        If a repetition breaks down.
    KeyboardInterrupt
        If it was stopped; the same call goes on.
    """
    wanted = repetitions(loaded, edge_length, lambda name, _: folder / name)
    done = run_batch([one.job for one in wanted], workers=workers, execution=execution)
    verdicts = [_verdict_of(one) for one in done]
    return guard_of(loaded, verdict, edge_length, list(zip(wanted, verdicts, strict=True)))


def repetitions(
    loaded: Loaded, edge_length: float, folder_of: Callable[[str, Loaded], Path]
) -> tuple[Repetition, ...]:
    """Return the runs that a run is compared with.

    Parameters
    ----------
    loaded : Loaded
        The run's config.
    edge_length : float
        Its mesh edges, in su (``auto`` resolved).
    folder_of : callable
        Gives a repetition its folder, by its name and config.
    """
    step = step_of(loaded.config)
    meshes = {
        "finer-mesh": (float(f"{edge_length / FINER:.6g}"), step),
        "smaller-step": (edge_length, float(f"{step / SMALLER:.6g}")),
    }
    wanted = []
    for name, (edge, shorter) in meshes.items():
        refined = _refined(loaded, edge, shorter)
        job = Job(name, refined, folder_of(name, refined))
        wanted.append(Repetition(job, edge, shorter))
    return tuple(wanted)


def guard_of(
    loaded: Loaded,
    verdict: Mapping[str, Any],
    edge_length: float,
    repeated: Sequence[tuple[Repetition, Mapping[str, Any]]],
) -> GuardFinding:
    """Tell whether a verdict stays in the repetitions of its run.

    Parameters
    ----------
    loaded : Loaded
        The run's config.
    verdict : mapping
        Its verdict, as it stands in verdict.json.
    edge_length : float
        Its mesh edges, in su.
    repeated : sequence of (Repetition, mapping)
        The repetitions and their verdicts.
    """
    tried = [guard_run(verdict, edge_length, step_of(loaded.config))]
    tried += [guard_run(found, one.edge_length, one.step) for one, found in repeated]
    start = min(stimulus.at for stimulus in loaded.config.stimulus)
    return guard_finding(tried, accuracy=loaded.config.accuracy, start=start)


def simulate_guarded(
    loaded: Loaded,
    path: Path,
    *,
    overwrite: bool = False,
    resume: bool = False,
    execution: Execution | None = None,
) -> Result:
    """Run a config like ``simulate``, then check whether its verdict is converged.

    The check stands in the verdict's ``guard``, its runs lie in the folder ``guard``. A finished
    run of the same config that was made for a guard is not made again.

    Parameters
    ----------
    loaded, path, overwrite, resume, execution
        As in ``simulate``.

    Raises
    ------
    InputError, NumericalError, KeyboardInterrupt
        As ``simulate`` and ``guard`` do.
    """
    folder, key = RunFolder(path), run_key(loaded)
    there = None if overwrite else finished_run(path, key)
    if there is None:
        begun = perf_counter()
        result = simulate(loaded, path, overwrite=overwrite, resume=resume, execution=execution)
        seconds = perf_counter() - begun
        note_finished(path, key, seconds, result.meta)
    else:
        record = there[1]
        recording = read_recording(path / RECORDING, with_frames=False)
        result = Result(judge_recording(recording), folder, record.meta or {})
        seconds = record.seconds or 0.0
    finding = guard(
        loaded,
        result.verdict.to_json(),
        path / FOLDER,
        edge_length=float(result.meta["edge_length"]),
        execution=execution,
    )
    verdict = guarded(result.verdict, finding)
    folder.write_text(path / VERDICT, json.dumps(verdict.to_json(), indent=2) + "\n")
    note_finished(path, key, seconds, result.meta)
    return Result(verdict, folder, result.meta)


def _refined(loaded: Loaded, edge_length: float, step: float) -> Loaded:
    return overlay(
        loaded,
        [
            f"mesh.edge_length={edge_length!r}",
            f"time.step={step!r}",
            "record.frames_every=null",
        ],
    )


def _verdict_of(done: Done) -> dict[str, Any]:
    """Return the verdict of a repetition.

    Raises
    ------
    InputError, NumericalError
        What the repetition ended with.
    """
    if done.verdict is not None:
        return done.verdict
    if done.kind == "input":
        raise InputError(f"--guard, {done.name}", done.error)
    if done.kind == "numerical":
        raise NumericalError(f"--guard, {done.name}: {done.error}")
    msg = f"{done.name}: {done.error}"
    raise RuntimeError(msg)
