"""One simulation from its config to its verdict."""

import json
from collections.abc import Mapping
from contextlib import ExitStack, suppress
from dataclasses import dataclass, fields, replace
from pathlib import Path
from time import perf_counter
from typing import Any

from cardiosurf.analysis.findings import judge_recording
from cardiosurf.analysis.verdict import Verdict
from cardiosurf.config import Loaded
from cardiosurf.errors import InputError, NumericalError
from cardiosurf.recording.checkpoint import (
    CheckpointWriter,
    read_conclusion,
    restore_checkpoint,
)
from cardiosurf.recording.hdf5 import write_recording
from cardiosurf.recording.observers import Activation, Frames, Probes, Recorder
from cardiosurf.recording.probe_sites import place_probes
from cardiosurf.recording.progress import ProgressBar
from cardiosurf.recording.provenance import provenance
from cardiosurf.recording.quiescence import Quiescence
from cardiosurf.recording.recording import FrameSeries, Recording
from cardiosurf.recording.signals import stopped_by_signals
from cardiosurf.recording.spool import Spool
from cardiosurf.recording.xdmf import write_xdmf
from cardiosurf.stepping.controls import Execution
from cardiosurf.stepping.march import Outcome, march
from cardiosurf.stepping.rest import at_rest, never
from cardiosurf.study.folder import CONFIG, RECORDING, VERDICT, RunFolder
from cardiosurf.study.setup import Setup, set_up


@dataclass(frozen=True)
class Result:
    """A finished run.

    Attributes
    ----------
    verdict : Verdict
        What it says.
    folder : RunFolder
        Where its files are.
    meta : mapping
        How it was computed and how long that took.
    """

    verdict: Verdict
    folder: RunFolder
    meta: Mapping[str, Any]


@dataclass(frozen=True)
class _Watch:
    """The observers of a run that a recording is made of."""

    activation: Activation
    quiescence: Quiescence
    probes: Probes
    spool: Spool | None
    frames: Frames | None

    @property
    def recorders(self) -> dict[str, Recorder]:
        every: dict[str, Recorder] = {
            "activation": self.activation,
            "quiescence": self.quiescence,
            "probes": self.probes,
        }
        if self.frames is not None:
            every["frames"] = self.frames
        return every


def simulate(
    loaded: Loaded,
    path: Path,
    *,
    overwrite: bool = False,
    resume: bool = False,
    execution: Execution | None = None,
) -> Result:
    """Run a config and write recording, XDMF, resolved config and verdict into a folder.

    Parameters
    ----------
    loaded : Loaded
        The config, its resolved text and hash.
    path : Path
        The run's folder; made if it is not there.
    overwrite : bool
        Whether a finished run in the folder may be replaced.
    resume : bool
        Whether to go on from where an unfinished run in the folder was stopped.
    execution : Execution, optional
        How the machine is used.

    Raises
    ------
    InputError
        If the config does not fit its surface or the folder cannot be used.
    NumericalError
        If the computation breaks down; the message names the step.
    KeyboardInterrupt
        If the run was stopped; it can be resumed then.
    """
    begun = perf_counter()
    folder = RunFolder(path)
    with folder.in_use(), ExitStack() as open_files:
        resuming = folder.open(overwrite=overwrite, resume=resume)
        try:
            with loaded.naming_lines():
                setup = set_up(loaded.config, execution)
                watch = _watch(loaded, setup, folder)
            if watch.spool is not None:
                open_files.callback(watch.spool.close)
            set_up_seconds = perf_counter() - begun
            outcome = _march(loaded, setup, folder, watch, resuming=resuming)
            recording = _recording(loaded, setup, watch, outcome, set_up_seconds)
            verdict = _write(loaded, recording, folder)
        except BaseException as error:
            # what broke down breaks down again; anything else can go on from its checkpoint
            if isinstance(error, NumericalError) or not folder.resumable:
                folder.discard_partial()
            raise
    return Result(verdict, folder, recording.meta)


def _watch(loaded: Loaded, setup: Setup, folder: RunFolder) -> _Watch:
    record = loaded.config.record
    probes = place_probes(setup.surface, record.probes)
    if record.frames_every is None:
        return _Watch(Activation(), Quiescence(), probes, None, None)
    spool = Spool(folder.spool, len(setup.surface.points))
    return _Watch(Activation(), Quiescence(), probes, spool, Frames(record.frames_every, spool))


def _march(
    loaded: Loaded, setup: Setup, folder: RunFolder, watch: _Watch, *, resuming: bool
) -> Outcome:
    config = loaded.config
    writer = CheckpointWriter(
        folder.checkpoint, config.record.checkpoint_every, watch.recorders, loaded.sha256
    )
    start = None
    if resuming:
        start = restore_checkpoint(folder.checkpoint, watch.recorders, loaded.sha256)
        ended = read_conclusion(folder.checkpoint)
        if ended is not None:
            return Outcome(**ended, controls=setup.controls)
    with ExitStack() as stack:
        progress = stack.enter_context(
            ProgressBar(config.name, config.time.end, setup.surface.vertex_areas())
        )
        stack.enter_context(stopped_by_signals(writer.stop))
        outcome = march(
            setup.problem,
            setup.controls,
            [*watch.recorders.values(), progress, writer],
            stop=at_rest if config.time.stop_at_rest else never,
            start=start,
        )
        numbers = [field.name for field in fields(Outcome) if field.name != "controls"]
        # where there is no room for a checkpoint there may still be some for the recording
        with suppress(InputError):
            writer.conclude({name: getattr(outcome, name) for name in numbers})
    if writer.stopping:
        raise KeyboardInterrupt
    return outcome


def _recording(
    loaded: Loaded, setup: Setup, watch: _Watch, outcome: Outcome, set_up_seconds: float
) -> Recording:
    frames = FrameSeries.none(len(setup.surface.points))
    return Recording(
        name=loaded.config.name,
        surface=setup.surface,
        tissue=setup.tissue,
        targets=setup.targets(loaded.config),
        pulses=setup.pulses,
        activations=watch.activation.activations(),
        repolarisations=watch.activation.repolarisations(),
        frames=frames if watch.spool is None else watch.spool.series(),
        probes=watch.probes.traces(),
        end_time=outcome.end_time,
        stop_reason=outcome.reason,
        config=loaded.text,
        config_sha256=loaded.sha256,
        meta=_meta(loaded, setup, outcome, set_up_seconds),
        quiescent_at=watch.quiescence.since,
    )


def _meta(loaded: Loaded, setup: Setup, outcome: Outcome, set_up_seconds: float) -> dict[str, Any]:
    controls = outcome.controls
    return {
        **provenance(),
        "vertices": len(setup.surface.points),
        "triangles": len(setup.surface.triangles),
        "accuracy": loaded.config.accuracy,
        "edge_length": setup.edge.edge_length,
        "edge_reason": setup.edge.reason,
        "edge_lat_error": setup.edge.lat_error,
        "mass": loaded.config.mesh.mass,
        "scheme": controls.scheme.name,
        "step": outcome.longest_step,
        "step_reason": controls.step.reason,
        "lat_error": controls.step.lat_error,
        "solver": controls.solver.name,
        "solver_reason": controls.solver.reason,
        "engine": outcome.engine,
        "threads": controls.execution.threads,
        "steps": outcome.steps,
        "iterations": outcome.iterations,
        "most_iterations": outcome.most_iterations,
        "set_up_seconds": set_up_seconds,
        "march_seconds": outcome.seconds,
        "solve_seconds": outcome.solve_seconds,
        "observer_seconds": outcome.observer_seconds,
    }


def _write(loaded: Loaded, recording: Recording, folder: RunFolder) -> Verdict:
    """Write all files of a finished run aside, then put them into place together."""
    verdict = judge_recording(recording)
    try:
        folder.stage()
        # publishing sees to all of them being on the disk, which takes less than one by one
        write_recording(folder.staged / RECORDING, recording, synced=False)
        write_xdmf(folder.staged / RECORDING, synced=False)
        folder.write_text(folder.staged / CONFIG, loaded.text, synced=False)
        text = json.dumps(verdict.to_json(), indent=2) + "\n"
        folder.write_text(folder.staged / VERDICT, text, synced=False)
        folder.publish()
    except InputError as error:
        if not folder.resumable:
            raise
        # the march is here, so another folder is no help
        remedy = error.hint.partition(", or ")[0]
        raise replace(error, hint=f"{remedy}, then go on with --resume") from error
    return verdict
