"""The command ``cardiosurf``."""

import fcntl
import os
import signal
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

import click

from cardiosurf import __version__
from cardiosurf.cli.errors import end
from cardiosurf.spelling import did_you_mean

# command -> module and attribute; the modules import what they need inside the commands, so that
# --help stays quick
_COMMANDS = {
    "run": "cardiosurf.cli.run:run",
    "validate": "cardiosurf.cli.inspect:validate",
    "mesh": "cardiosurf.cli.inspect:mesh",
    "schema": "cardiosurf.cli.inspect:schema",
    "analyze": "cardiosurf.cli.run:analyze",
    "plot": "cardiosurf.cli.view:plot",
    "check": "cardiosurf.cli.study:check",
    "sweep": "cardiosurf.cli.study:sweep",
    "threshold": "cardiosurf.cli.threshold:threshold",
    "predict": "cardiosurf.cli.predict:predict",
    "reproduce": "cardiosurf.cli.reproduce:reproduce",
    "discrete": "cardiosurf.cli.discrete:discrete",
}

_EPILOG = """
\b
Examples:
  cardiosurf run configs/t_domain.yaml
  cardiosurf run configs/plane_block.yaml --set tissue.patches.block.anisotropy.x=4
  cardiosurf validate configs/*.yaml
  cardiosurf plot runs/t-domain-head-on
  cardiosurf check scenarios

\b
Exit codes: 0 done, 1 verdicts differ from what was expected, 2 bad input,
3 numerical failure, 130 interrupted (a run can be resumed).
"""


class LazyGroup(click.Group):
    """A group that imports a command's module when the command is asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the commands in the order of a user's work."""
        return list(_COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import and return a command, None if there is none of that name."""
        if cmd_name not in _COMMANDS:
            return None
        module, attribute = _COMMANDS[cmd_name].split(":")
        command = getattr(import_module(module), attribute)
        if not isinstance(command, click.Command):
            msg = f"{module}:{attribute} is not a command"
            raise TypeError(msg)
        # docstrings with a backslash are raw; click's mark for "do not wrap" is the character
        command.help = (command.help or "").replace("\\b\n", "\b\n")
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command that the arguments begin with; suggest the nearest if there is none."""
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            guess = did_you_mean(args[0], _COMMANDS)
            if not guess:
                raise
            raise click.UsageError(f"{error.message} {guess.capitalize()}", ctx) from None


@click.group(
    cls=LazyGroup, epilog=_EPILOG, context_settings={"help_option_names": ["-h", "--help"]}
)
@click.version_option(__version__, prog_name="cardiosurf")
def cli() -> None:
    """Excitation waves on curved, anisotropic cardiac tissue.

    From a YAML config to a checkable verdict: does the wave get through, or is it blocked?
    """


def _heed_signals() -> None:
    """Let Ctrl-C and SIGTERM end the process in order, wherever it is.

    A process that a script starts in the background inherits an ignored Ctrl-C.
    """
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)


def _open_closed_output() -> None:
    """Let a command whose stdout or stderr is closed run on, its words unread."""
    for name, number in (("stdout", 1), ("stderr", 2)):
        if getattr(sys, name) is None or not _is_writable(number):
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115


def _is_writable(number: int) -> bool:
    try:
        return fcntl.fcntl(number, fcntl.F_GETFL) & os.O_ACCMODE != os.O_RDONLY
    except OSError:
        return False


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code.

    Parameters
    ----------
    arguments : sequence of str, optional
        The command line after the program's name; that of the process by default.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    if arguments is None:
        _heed_signals()
        _open_closed_output()
    try:
        with cli.make_context("cardiosurf", words) as context:
            cli.invoke(context)
        sys.stdout.flush()
    except BaseException as error:
        return end(error)
    return 0


if __name__ == "__main__":
    sys.exit(main())
