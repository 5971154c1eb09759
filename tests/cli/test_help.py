"""The front door: help, version, misspelt words, and how quickly it opens."""

import subprocess
import sys

import pytest

from cardiosurf import __version__
from cardiosurf.cli.main import cli, main

COMMANDS = [
    *("run", "validate", "mesh", "schema", "analyze", "plot", "check", "sweep", "threshold"),
    "predict",
    "reproduce",
    "discrete",
]
HEAVY = ["numpy", "scipy", "skfem", "h5py", "matplotlib", "pydantic", "yaml", "meshio", "rich"]


def said(capsys, *arguments: str) -> tuple[int, str]:
    code = main(arguments)
    captured = capsys.readouterr()
    return code, captured.out + captured.err


@pytest.mark.parametrize("option", ["-h", "--help"])
def test_help_lists_every_command_with_its_purpose(option, capsys):
    code, text = said(capsys, option)
    assert code == 0
    listed = text.split("Commands:\n")[1].split("\n\n")[0].splitlines()
    assert [line.split()[0] for line in listed] == COMMANDS
    # a short help that click had to cut says too little
    assert not any(line.endswith("...") for line in listed)
    assert "cardiosurf run configs/t_domain.yaml\n" in text


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_explains_itself(command, capsys):
    code, text = said(capsys, command, "-h")
    assert code == 0
    assert text.startswith(f"Usage: cardiosurf {command} ")
    assert "\\b" not in text


def test_version(capsys):
    assert said(capsys, "--version") == (0, f"cardiosurf, version {__version__}\n")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["validat", "a.yaml"], "Did you mean 'validate'?"),
        (["rnu"], "Did you mean 'run'?"),
        (["zzz"], "No such command 'zzz'."),
        (["mesh", "--ouput", "a.vtu"], "--output"),
        (["mesh"], "Missing argument 'CONFIG'"),
        (["schema", "verdit"], "'scenario', 'verdict', 'threshold'"),
    ],
)
def test_misspelt_words_end_with_exit_code_2_and_a_suggestion(arguments, says, capsys):
    code, text = said(capsys, *arguments)
    assert code == 2
    assert says in text
    assert "--help" in text


def test_help_imports_nothing_heavy():
    program = (
        "import sys; from cardiosurf.cli.main import main; main(['--help']);"
        f"print('heavy:', [name for name in {HEAVY} if name in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    # what it takes is measured by make bench; without these it cannot be much
    assert "heavy: []" in done.stdout


def test_every_command_has_a_purpose_in_one_line():
    with cli.make_context("cardiosurf", ["--help"], resilient_parsing=True) as context:
        for name in cli.list_commands(context):
            command = cli.get_command(context, name)
            assert command is not None
            assert (command.help or "").splitlines()[0].endswith(".")
