"""Command lines in this process, on a small strip."""

from dataclasses import dataclass

import pytest
from strip_runs import QUICK, STRIP

from cardiosurf.cli.main import main


@pytest.fixture
def strip(tmp_path):
    path = tmp_path / "strip.yaml"
    path.write_text(STRIP)
    return path


@dataclass(frozen=True)
class Done:
    """What a command left: its exit code and what it printed."""

    returncode: int
    stdout: str
    stderr: str


@pytest.fixture
def cardiosurf(capfd):
    """Return a function that runs a command line in this process."""

    def command(*words):
        capfd.readouterr()
        code = main([str(word) for word in words])
        return Done(code, *capfd.readouterr())

    return command


@pytest.fixture(scope="session")
def whole(tmp_path_factory):
    """The folder of a quick run that nothing disturbed."""
    folder = tmp_path_factory.mktemp("whole")
    (folder / "strip.yaml").write_text(STRIP)
    assert main(["run", str(folder / "strip.yaml"), "-o", str(folder / "run"), *QUICK]) == 0
    return folder / "run"
