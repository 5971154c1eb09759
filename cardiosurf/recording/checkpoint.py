"""Checkpoints: a march and its observers on disk, so that a stopped run goes on bit for bit."""

import json
import time
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from cardiosurf.errors import InputError
from cardiosurf.recording.observers import Recorder
from cardiosurf.recording.whole_file import whole_file
from cardiosurf.stepping.moment import Checkpoint, Moment

SCHEMA = "cardiosurf/checkpoint/3"


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
        self._last: Moment | None = None

    @property
    def stopping(self) -> bool:
        """Whether ``stop`` was called."""
        return self._stopping

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

    def due(self) -> float:
        """Any moment will do: none is long in coming."""
        return np.inf

    def finalize(self, moment: Moment) -> None:
        """Leave the checkpoint, as the recording is not written yet, and keep the last moment."""
        self._last = moment

    def conclude(self, conclusion: Mapping[str, Any]) -> None:
        """Write a checkpoint of a march that is over, so that a resumed run need not march.

        Parameters
        ----------
        conclusion : mapping
            How the march ended, in numbers and texts; ``read_conclusion`` gives it back.

        Raises
        ------
        InputError
            The checkpoint cannot be written; the one before is still there then.
        """
        if self._last is not None:
            text = json.dumps(dict(conclusion), default=lambda number: number.item())
            self._write(self._last, conclusion=np.asarray(text))

    def remove(self) -> None:
        """Remove the checkpoint, once the recording is safely written."""
        self._path.unlink(missing_ok=True)

    def stop(self) -> None:
        """Have the march stop after the step it is at; a signal handler may call this."""
        self._stopping = True

    def _write(self, moment: Moment, **more: np.ndarray) -> None:
        arrays: dict[str, Any] = {
            "schema": np.asarray(SCHEMA),
            "identity": np.asarray(self._identity),
            **more,
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
    arrays = _load(path)
    if str(arrays.get("schema")) != SCHEMA or str(arrays.get("identity")) != identity:
        raise InputError(
            where=str(path),
            problem="is a checkpoint of another config or of another version",
            allowed="the config and the overrides that the run was started with",
            hint="run again from the start with --overwrite",
        )
    try:
        for name, recorder in recorders.items():
            recorder.restore(_under(name, arrays))
        start = Checkpoint.from_arrays(_under("march", arrays))
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise _unreadable(path, error) from error
    if start.states.ndim != 3 or start.states.shape[:2] < (1, 2):
        raise _unreadable(path, ValueError(f"states of shape {start.states.shape}"))
    return start


def read_conclusion(path: Path) -> Mapping[str, Any] | None:
    """Return how the march of a checkpoint ended, None if it is not over.

    Raises
    ------
    InputError
        No such file or no checkpoint.
    """
    arrays = _load(path)
    if "conclusion" not in arrays:
        return None
    try:
        conclusion: dict[str, Any] = json.loads(str(arrays["conclusion"]))
    except ValueError as error:
        raise _unreadable(path, error) from error
    return conclusion


def _load(path: Path) -> dict[str, np.ndarray]:
    """Return all arrays of a checkpoint file."""
    try:
        with np.load(path, allow_pickle=False) as file:
            return {name: file[name] for name in file.files}
    # what numpy and zipfile raise on files that are empty, cut, changed or of another kind
    except (
        OSError,
        ValueError,
        KeyError,
        TypeError,
        AttributeError,
        EOFError,
        NotImplementedError,
        RuntimeError,
        zipfile.BadZipFile,
        zlib.error,
    ) as error:
        raise _unreadable(path, error) from error


def _unreadable(path: Path, error: Exception) -> InputError:
    said = f"it lacks {error}" if isinstance(error, KeyError) else str(error)
    return InputError(
        where=str(path),
        problem=f"cannot be read as a checkpoint: {said or type(error).__name__}",
        hint="run again from the start with --overwrite",
    )


def _under(name: str, arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    prefix = f"{name}/"
    return {key.removeprefix(prefix): arrays[key] for key in arrays if key.startswith(prefix)}
