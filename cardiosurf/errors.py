"""What can go wrong, and the exit code that it ends with.

Every error says where it is, what was given, what is allowed and what to try.
A blocked wave is a finding and never an error.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass


class CardiosurfError(Exception):
    """Anything cardiosurf raises on purpose; ``exit_code`` is what the command line ends with."""

    exit_code = 2


@dataclass
class InputError(CardiosurfError):
    """Something the user gave cannot be used.

    Parameters
    ----------
    where : str
        File, line and key path, or the option's name.
    problem : str
        What was given and what is wrong with it.
    allowed : str
        What would be accepted.
    hint : str
        What to try next.
    """

    where: str
    problem: str
    allowed: str = ""
    hint: str = ""
    exit_code = 2

    def __str__(self) -> str:
        """Return the four parts, one to a line."""
        lines = [f"{self.where}: {self.problem}" if self.where else self.problem]
        if self.allowed:
            lines.append(f"  allowed: {self.allowed}")
        if self.hint:
            lines.append(f"  try: {self.hint}")
        return "\n".join(lines)


@dataclass
class NumericalError(CardiosurfError):
    """The computation itself broke down (blow-up, a solver that does not converge).

    Parameters
    ----------
    problem : str
        What happened, with the time and the step at which it happened.
    hint : str
        What to try next.
    """

    problem: str
    hint: str = ""
    exit_code = 3

    def __str__(self) -> str:
        """Return the problem and, below it, the advice."""
        return self.problem + (f"\n  try: {self.hint}" if self.hint else "")


@contextmanager
def told_on_stderr() -> Iterator[None]:
    """End a module that is run by itself, as make does, as a command ends: words and exit code."""
    try:
        yield
    except CardiosurfError as error:
        sys.stderr.write(f"error: {error}\n")
        raise SystemExit(error.exit_code) from None


def given_words(count: int, names: str) -> tuple[str, ...]:
    """Return the words after a module's name.

    Parameters
    ----------
    count : int
        How many it takes.
    names : str
        What they are, for the message.

    Raises
    ------
    InputError
        There are more or fewer.
    """
    words = tuple(sys.argv[1:])
    if len(words) != count:
        raise InputError("arguments", f"{len(words)} given", names)
    return words
