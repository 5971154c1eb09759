"""Exceptions to a message on stderr and an exit code.

0 done, 1 verdicts differ from what was expected, 2 bad input, 3 numerical failure,
70 a mistake in cardiosurf itself, 130 interrupted, 141 nobody reads the output any more.
"""

import errno
import os
import sys
import traceback

import click

from cardiosurf.errors import CardiosurfError, InputError, NumericalError

INTERRUPTED = 130
BROKEN_PIPE = 141
INTERNAL = 70

_UNUSABLE = {
    errno.ENOSPC: ("the disk is full", "free some space, or write elsewhere with -o"),
    errno.EDQUOT: ("the disk quota is used up", "free some space, or write elsewhere with -o"),
    errno.EACCES: ("permission denied", "write elsewhere with -o, or change the permissions"),
    errno.EPERM: ("permission denied", "write elsewhere with -o, or change the permissions"),
    errno.EROFS: ("the file system is read-only", "write elsewhere with -o"),
    errno.ENOTDIR: ("a part of the path is a file, not a folder", "another path"),
    errno.ENAMETOOLONG: ("the name is too long", "a shorter name"),
    errno.ELOOP: ("the links of the path run in a circle", "another path"),
    errno.EFBIG: ("the file would be larger than the limit set for files", "raise ulimit -f"),
    errno.EIO: ("the disk reports a fault", "another disk, with -o"),
    errno.EISDIR: ("is a folder", "the path of a file"),
    errno.ENOENT: ("no such file or folder", "make the folder first, or check the spelling"),
}


def end(error: BaseException) -> int:
    """Say on stderr what went wrong and return the exit code that it ends with.

    Parameters
    ----------
    error : BaseException
        What a command raised.
    """
    if isinstance(error, click.exceptions.Exit):
        return error.exit_code
    if isinstance(error, click.ClickException):
        error.show()
        return error.exit_code
    if isinstance(error, click.Abort | KeyboardInterrupt):
        say("interrupted")
        return INTERRUPTED
    if isinstance(error, BrokenPipeError):
        _forget_output()
        return BROKEN_PIPE
    known = _known(error)
    if known is not None:
        say(f"error: {known}")
        return known.exit_code
    traceback.print_exception(error)
    say("error: this is a mistake in cardiosurf; please report it with the lines above")
    return INTERNAL


def _known(error: BaseException) -> CardiosurfError | None:
    """Return the error in cardiosurf's own words, None if nobody foresaw it."""
    if isinstance(error, CardiosurfError):
        return error
    if isinstance(error, MemoryError):
        return NumericalError("there is not enough memory", "a larger mesh.edge_length")
    if isinstance(error, OSError) and error.errno in _UNUSABLE:
        problem, hint = _UNUSABLE[error.errno]
        return InputError(str(error.filename or "output"), problem, "", hint)
    return None


def say(message: str) -> None:
    """Write a message to stderr."""
    click.echo(message, err=True)


def _forget_output() -> None:
    """Keep Python from complaining again when it flushes stdout at its end."""
    try:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except (OSError, ValueError):
        sys.stdout = sys.__stdout__
