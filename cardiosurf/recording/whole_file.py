"""Files that appear whole or not at all."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cardiosurf.errors import InputError


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give a path beside ``path`` to write to, and rename it to ``path`` once it is complete.

    Whatever goes wrong inside the ``with`` block, the unfinished file is removed and ``path`` is
    left as it was. A killed process leaves at most ``<name>.partial``, which nothing reads and the
    next write replaces.

    Parameters
    ----------
    path : Path
        The file to write; its folder must exist.

    Raises
    ------
    InputError
        The folder cannot be written to, or the disk is full.
    """
    partial = path.with_name(path.name + ".partial")
    try:
        partial.unlink(missing_ok=True)
        yield partial
        with partial.open("rb") as written:
            os.fsync(written.fileno())
        partial.replace(path)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise unwritable(path, error) from error
    except BaseException:
        partial.unlink(missing_ok=True)
        raise


def unwritable(path: Path, error: OSError) -> InputError:
    """Return the error that says why ``path`` cannot be written."""
    return InputError(
        where=str(path),
        problem=f"cannot be written: {error.strerror or error}",
        allowed="a folder that can be written to, on a disk with room",
        hint="free some space, or give another folder with -o",
    )
