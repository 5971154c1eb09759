"""A file that takes a full disk calmly."""

import errno
import io
import os
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer, WriteableBuffer


class SteadyFile(io.FileIO):
    """A file for h5py to write to that raises what went wrong only when it is closed.

    The HDF5 library cannot close a file that it cannot write to, and goes on complaining until the
    process ends. So after the first failed write this file accepts everything and writes nothing;
    closing it raises the error.

    Parameters
    ----------
    path : Path
        The file to make.

    Raises
    ------
    OSError
        On closing: what a write said (disk full, ...).
    """

    def __init__(self, path: Path) -> None:
        super().__init__(path, "w+")
        self._failure: OSError | None = None

    def write(self, data: "ReadableBuffer", /) -> int:
        """Write ``data`` and return its length."""
        length = memoryview(data).nbytes
        if self._failure is None:
            try:
                if super().write(data) != length:
                    self._failure = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            except OSError as error:
                self._failure = error
        return length

    def readinto(self, room: "WriteableBuffer", /) -> int:
        """Fill ``room``; what a failed write left out reads as zeros."""
        view = memoryview(room).cast("B")
        count = super().readinto(view) or 0
        view[count:] = bytes(len(view) - count)
        return len(view)

    def truncate(self, size: int | None = None, /) -> int:
        """Make the file this long."""
        return super().truncate(size) if self._failure is None else size or 0

    def close(self) -> None:
        """Close the file and raise what went wrong."""
        super().close()
        failure, self._failure = self._failure, None
        if failure is not None:
            raise failure
