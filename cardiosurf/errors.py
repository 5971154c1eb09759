"""What can go wrong, and the exit code that it ends with.

Every error says where it is, what was given, what is allowed and what to try.
A blocked wave is a finding and never an error.
"""

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
