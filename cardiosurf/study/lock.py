"""One process at a time in a folder."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from cardiosurf.errors import InputError
from cardiosurf.recording.whole_file import unwritable

try:
    import fcntl
except ImportError:  # not on Windows
    fcntl = None  # type: ignore[assignment]

NAME = "lock"
"""The lock file; it says nothing unless a process holds a lock on it."""
ATTEMPTS = 100
"""How often a folder may vanish under the lock: a run that ends removes it."""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Make a folder and keep other processes out of it; the system frees it if this one dies.

    Parameters
    ----------
    folder : Path
        Where the lock file is; made with its parents if it is not there.

    Raises
    ------
    InputError
        Another process has the lock, or the folder cannot be written to.
    """
    try:
        descriptor = _lock(folder)
    except OSError as error:
        raise unwritable(folder.parent, error) from error
    try:
        yield
    finally:
        os.close(descriptor)


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Make a folder of many runs and keep other commands out of it; an empty one does not stay.

    Parameters
    ----------
    folder : Path
        The folder of a check or a sweep.

    Raises
    ------
    InputError
        Another command is working in the folder, or it cannot be written to.
    """
    inside = folder / ".working"
    with locked(inside):
        try:
            yield
        finally:
            with suppress(OSError):  # another command may be moving in
                (inside / NAME).unlink(missing_ok=True)
                inside.rmdir()
                folder.rmdir()


def _lock(folder: Path) -> int:
    """Return the descriptor of the locked lock file."""
    for _ in range(ATTEMPTS):
        folder.mkdir(parents=True, exist_ok=True)
        try:
            descriptor = os.open(folder / NAME, os.O_RDWR | os.O_CREAT, 0o666)
        except FileNotFoundError:
            continue  # the process before has just removed the folder
        try:
            if fcntl is not None:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(descriptor)
            raise InputError(
                str(folder.parent),
                "another run is working in this folder",
                "one run at a time in a folder",
                f"wait for it, or give another folder: -o {folder.parent}-2",
            ) from None
        except OSError:
            pass  # a file system without locks
        if _is_still(folder / NAME, descriptor):
            return descriptor
        os.close(descriptor)
    raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))


def _is_still(path: Path, descriptor: int) -> bool:
    """Return whether the path is still the open file, not one removed or made anew meanwhile."""
    try:
        return os.path.samestat(path.stat(), os.fstat(descriptor))
    except FileNotFoundError:
        return False
