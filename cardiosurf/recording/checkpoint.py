"""Checkpoints: a march and its observers on disk, so that a stopped run goes on bit for bit."""

import signal
import threading
import time
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np

from cardiosurf.errors import InputError
from cardiosurf.recording.observers import Recorder
from cardiosurf.recording.whole_file import whole_file
from cardiosurf.stepping.moment import Checkpoint, Moment

SCHEMA = "cardiosurf/checkpoint/2"


class CheckpointWriter:
    """Writes a checkpoint every so many seconds of wall time, and when it is told to stop.

    It must be the last of a march's observers: the others have then seen the moment it writes.

    Parameters
    ----------
    path : Path
        The checkpoint file; each checkpoint replaces the one before.
    every : float
        Wall time between two checkpoints, in seconds.
    recorders : mapping of str to Recorder
        The observers whose memory is kept, by name.
    identity : str
        What must be the same for a run to go on from it (the hash of the config).
    """

    def __init__(
        self, path: Path, every: float, recorders: Mapping[str, Recorder], identity: str
    ) -> None:
        self._path = path
        self._every = every
        self._recorders = recorders
        self._identity = identity
        self._written_at = time.monotonic()
        self._stopping = False

    def initialize(self, moment: Moment) -> None:
        """Start the clock."""
        self._written_at = time.monotonic()

    def handle(self, moment: Moment) -> None:
        """Write a checkpoint when one is due.

        Raises
        ------
        KeyboardInterrupt
            After the checkpoint that ``stop`` asked for.
        """
        if self._stopping or time.monotonic() - self._written_at >= self._every:
            self._write(moment)
            if self._stopping:
                raise KeyboardInterrupt

    def finalize(self, moment: Moment) -> None:
        """Leave the checkpoint: the recording is not written yet."""

    def remove(self) -> None:
        """Remove the checkpoint, once the recording is safely written."""
        self._path.unlink(missing_ok=True)

    def stop(self) -> None:
        """Have the march stop after the step it is at; a signal handler may call this."""
        self._stopping = True

    def _write(self, moment: Moment) -> None:
        arrays: dict[str, Any] = {
            "schema": np.asarray(SCHEMA),
            "identity": np.asarray(self._identity),
        }
        march = moment.checkpoint().to_arrays()
        arrays |= {f"march/{key}": value for key, value in march.items()}
        for name, recorder in self._recorders.items():
            arrays |= {f"{name}/{key}": value for key, value in recorder.snapshot().items()}
        with whole_file(self._path) as partial, partial.open("wb") as file:
            np.savez(file, **arrays)
        self._written_at = time.monotonic()


def restore_checkpoint(path: Path, recorders: Mapping[str, Recorder], identity: str) -> Checkpoint:
    """Give the recorders their memory back and return where the march goes on.

    Parameters
    ----------
    path : Path
        A file that ``CheckpointWriter`` wrote.
    recorders : mapping of str to Recorder
        The same observers, by the same names, newly made.
    identity : str
        What the run is; must be what the checkpoint was written for.

    Raises
    ------
    InputError
        No such file, no checkpoint, or one of another run.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        raise InputError(
            where=str(path),
            problem=f"cannot be read as a checkpoint: {error}",
            hint="run again from the start with --overwrite",
        ) from error
    if str(arrays.get("schema")) != SCHEMA or str(arrays["identity"]) != identity:
        raise InputError(
            where=str(path),
            problem="is a checkpoint of another config or of another version",
            allowed="the config and the overrides that the run was started with",
            hint="run again from the start with --overwrite",
        )
    for name, recorder in recorders.items():
        recorder.restore(_under(name, arrays))
    return Checkpoint.from_arrays(_under("march", arrays))


def _under(name: str, arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    prefix = f"{name}/"
    return {key.removeprefix(prefix): arrays[key] for key in arrays if key.startswith(prefix)}


@contextmanager
def stopped_by_signals(writer: CheckpointWriter) -> Iterator[None]:
    """Let Ctrl-C and SIGTERM end the march with a checkpoint instead of in mid-step.

    A second signal interrupts at once. Outside the main thread, where Python handles no signals,
    nothing is changed.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(number: int, frame: FrameType | None) -> None:
        writer.stop()
        signal.signal(number, signal.default_int_handler)

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
