"""Which modules commands may load: a heavy one takes longer to import than the command to run."""

import subprocess
import sys

import pytest
from strip_runs import QUICK

HEAVY = {
    "h5py",
    "matplotlib",
    "meshio",
    "mpl_toolkits",
    "numba",
    "numpy",
    "pydantic",
    "rich",
    "scipy.linalg",
    "scipy.sparse",
    "scipy.spatial",
    "scipy.special",
    "skfem",
    "yaml",
}

LOADED = """
import sys
sys.argv = ["cardiosurf", *sys.argv[1:]]
from cardiosurf.cli.main import main
code = main(sys.argv[1:])
print("loaded:", *sorted(sys.modules), file=sys.stderr)
sys.exit(code)
"""


def heavy(*arguments):
    """Run a command in a process of its own; return the heavy modules that it loaded."""
    done = subprocess.run(
        [sys.executable, "-c", LOADED, *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    loaded = done.stderr.rpartition("loaded:")[2].split()
    assert "cardiosurf.cli.main" in loaded, done.stderr
    return HEAVY & set(loaded)


def test_help_loads_nothing_heavy():
    assert heavy("--help") == set()
    assert heavy("run", "--help") == set()


CONFIG = {"numpy", "pydantic", "yaml"}


@pytest.mark.parametrize(
    "command",
    ["validate", "mesh", "run", "predict", "check", "sweep", "reproduce", "discrete"],
)
def test_a_wrong_config_is_found_before_anything_is_built(tmp_path, command):
    assert heavy(command, tmp_path / "none.yaml") <= CONFIG


def test_a_wrong_config_is_found_before_a_search_begins(tmp_path):
    words = ("--vary", "tissue.diffusivity", "--between", 1, 2)
    assert heavy("threshold", tmp_path / "none.yaml", *words) <= CONFIG


def test_a_config_is_checked_without_what_builds_and_marches(strip):
    assert heavy("validate", strip) <= CONFIG
    assert heavy("schema") <= CONFIG


def test_a_scenario_is_checked_without_what_builds_and_marches(strip, tmp_path):
    scenario = tmp_path / "scenario.yaml"
    scenario.write_text(f"name: one\nbase: {strip.name}\ncases: [{{name: a}}]\n")
    assert heavy("validate", scenario) <= CONFIG
    scenario.write_text(f"name: one\nbase: {strip.name}\ncases: [{{name: a, set: {{b.c: 1}}}}]\n")
    assert heavy("check", scenario) <= CONFIG


@pytest.mark.parametrize("command", ["analyze", "plot"])
def test_a_missing_recording_is_found_before_anything_is_drawn(tmp_path, command):
    assert heavy(command, tmp_path / "none.h5") <= {"h5py", "numpy", "pydantic"}


JUDGE = {"h5py", "numpy", "pydantic"}


def test_a_recording_is_judged_without_what_made_it(whole):
    # a route takes a tree and a sparse solver, and the eikonal equation numba, which looks for yaml
    route = {"numba", "scipy.linalg", "scipy.sparse", "scipy.spatial", "scipy.special", "yaml"}
    assert heavy("analyze", whole) <= JUDGE | route


def test_a_recording_without_a_route_is_judged_without_numba(strip, tmp_path, cardiosurf):
    # nothing is to be entered where the target is all tissue, and the wave went far enough to see
    run = tmp_path / "run"
    assert cardiosurf("run", strip, "-o", run, "--set", "targets=[]", *QUICK).returncode == 0
    assert heavy("analyze", run) <= JUDGE
