"""Files that appear whole or not at all."""

import errno
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from cardiosurf.errors import InputError


@contextmanager
def whole_file(path: Path, *, synced: bool = True) -> Iterator[Path]:
    """Give a path beside ``path`` to write to, and rename it to ``path`` once it is complete.

    Whatever goes wrong inside the ``with`` block, the unfinished file is removed and ``path`` is
    left as it was. A killed process leaves at most ``<name>.partial``, which nothing reads and the
    next write replaces.

    Parameters
    ----------
    path : Path
        The file to write; its folder must exist.
    synced : bool
        Whether it is on the disk when it gets its name. Several files that get other names
        together are on the disk sooner if ``sync`` sees to that once all of them are written.

    Raises
    ------
    InputError
        The folder cannot be written to, or the disk is full.
    """
    partial = path.with_name(path.name + ".partial")
    try:
        partial.unlink(missing_ok=True)
        yield partial
        if synced:
            sync(partial)
        partial.replace(path)
    except BaseException as error:
        with suppress(OSError):  # below a file there is nothing to remove, and that is no news
            partial.unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise unwritable(path, error) from error
        raise


def sync(path: Path) -> None:
    """See to it that a file is on the disk."""
    with path.open("rb") as written:
        os.fsync(written.fileno())


_NO_ROOM = ("a disk with room", "free some space, or give another folder with -o")
_FORBIDDEN = (
    "a folder that may be written to",
    "change the permissions, or give another folder with -o",
)
_IN_THE_WAY = (
    "a path on which files are not folders, nor folders files",
    "something of that name is in the way: move it, or give another folder with -o",
)
_ADVICE = {
    errno.ENOSPC: _NO_ROOM,
    errno.EDQUOT: _NO_ROOM,
    errno.EFBIG: _NO_ROOM,
    errno.EACCES: _FORBIDDEN,
    errno.EPERM: _FORBIDDEN,
    errno.EROFS: _FORBIDDEN,
    errno.ENOTDIR: _IN_THE_WAY,
    errno.EEXIST: _IN_THE_WAY,
    errno.EISDIR: _IN_THE_WAY,
    errno.ENAMETOOLONG: ("a shorter name", "give a folder with a shorter name: -o"),
}
"""What would be accepted and what to try, by the system's reason."""


def unwritable(path: Path, error: OSError) -> InputError:
    """Return the error that says why ``path`` cannot be written, and what to do about it."""
    allowed, hint = _ADVICE.get(
        error.errno or 0, ("a folder that can be written to", "give another folder with -o")
    )
    return InputError(
        where=str(path),
        problem=f"cannot be written: {error.strerror or error}",
        allowed=allowed,
        hint=hint,
    )


@contextmanager
def whole_files(folder: Path, names: Sequence[str]) -> Iterator[Path]:
    """Give a folder to write several files to, and put them into ``folder`` once all are there.

    Whatever goes wrong inside the ``with`` block, or is in the way of one of them, ``folder`` is
    left as it was; it is made if it is not there.

    Parameters
    ----------
    folder : Path
        Where they belong.
    names : sequence of str
        Their names.

    Raises
    ------
    InputError
        The folder cannot be written to, or the disk is full.
    """
    check_folder(folder, names)
    new = not folder.exists()
    try:
        with TemporaryDirectory(dir=made_folder(folder), prefix=".partial-") as staged:
            yield Path(staged)
            for name in names:
                with (Path(staged) / name).open("rb") as written:
                    os.fsync(written.fileno())
            for name in names:
                (Path(staged) / name).replace(folder / name)
    except BaseException as error:
        if new:
            with suppress(OSError):  # what another process wrote there stays
                folder.rmdir()
        if isinstance(error, OSError):
            raise unwritable(folder, error) from error
        raise


def check_folder(folder: Path, names: Sequence[str] = ()) -> None:
    """Refuse a folder that files could not be written to, before any work is done.

    Parameters
    ----------
    folder : Path
        The folder; it need not be there.
    names : sequence of str
        The files.

    Raises
    ------
    InputError
        It is a file, or lies below one, or may not be written to; or one of the names is that of a
        folder in it.
    """
    there = folder
    try:
        while not there.exists() and there != there.parent:
            there = there.parent
        if not there.is_dir():
            raise unwritable(folder, NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR)))
        if not os.access(there, os.W_OK):
            raise unwritable(folder, PermissionError(errno.EACCES, os.strerror(errno.EACCES)))
        for name in names:
            if (folder / name).is_dir():
                reason = IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
                raise unwritable(folder / name, reason)
    except OSError as error:
        raise unwritable(folder, error) from error


def made_folder(folder: Path) -> Path:
    """Return a folder, which is made if it is not there.

    Raises
    ------
    InputError
        It cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(folder, error) from error
    return folder
