"""The raw file that frames are written to while a run goes on."""

import os
from pathlib import Path

import numpy as np

from cardiosurf.arrays import Floats
from cardiosurf.errors import InputError
from cardiosurf.recording.recording import FrameSeries
from cardiosurf.recording.whole_file import unwritable


class Spool:
    """Frames one after another in a file: time (float64), u (n float32), v (n float32).

    Parameters
    ----------
    path : Path
        The file; what it holds already is kept until ``truncate`` or the first ``append``.
    nodes : int
        Number of nodes n.

    Raises
    ------
    InputError
        The file cannot be written.
    """

    def __init__(self, path: Path, nodes: int) -> None:
        self.path = path
        row = np.dtype([("time", "<f8"), ("u", "<f4", (nodes,)), ("v", "<f4", (nodes,))])
        self._row = np.zeros((), dtype=row)
        self._count = 0
        try:
            # kept open: a frame a file would cost as much again as its numbers
            self._file = path.open("r+b" if path.exists() else "w+b", buffering=0)
        except OSError as error:
            raise unwritable(path, error) from error

    def __len__(self) -> int:
        """Return the number of frames."""
        return self._count

    def append(self, time: float, state: Floats) -> None:
        """Write a frame: ``time`` in tu, ``state`` (2, n)."""
        row = self._row
        row["time"], row["u"], row["v"] = time, state[0], state[1]
        try:
            if self._count == 0:
                self._file.truncate(0)
            written = os.pwrite(self._file.fileno(), row.data, self._count * row.itemsize)
        except OSError as error:
            raise unwritable(self.path, error) from error
        if written != row.itemsize:
            raise unwritable(self.path, OSError(28, os.strerror(28)))
        self._count += 1

    def flush(self) -> None:
        """See to it that all frames are on the disk."""
        os.fsync(self._file.fileno())

    def truncate(self, count: int) -> None:
        """Keep the first ``count`` frames only.

        Raises
        ------
        InputError
            The file holds fewer frames.
        """
        if self.path.stat().st_size < count * self._row.itemsize:
            raise InputError(
                where=str(self.path),
                problem=f"holds fewer than the {count} frames that the checkpoint speaks of",
                hint="run again from the start with --overwrite",
            )
        self._file.truncate(count * self._row.itemsize)
        self._count = count

    def close(self) -> None:
        """Close the file; its frames can still be read."""
        self._file.close()

    def series(self) -> FrameSeries:
        """Return the frames; u and v stay in the file and are read as they are used."""
        if self._count == 0:
            return FrameSeries.none(self._row["u"].shape[0])
        rows = np.memmap(self.path, dtype=self._row.dtype, mode="r", shape=(self._count,))
        return FrameSeries(times=np.array(rows["time"]), u=rows["u"], v=rows["v"])
