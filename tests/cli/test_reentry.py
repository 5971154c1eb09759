"""What the commands say about a small rotor: S1 from the left, S2 in the lower half of a square."""

import json
from pathlib import Path

import pytest

from cardiosurf.cli.main import main

CONFIG = Path(__file__).parents[2] / "configs" / "spiral.yaml"
SMALL = (
    "geometry.x=[-30, 30]",
    "geometry.y=[-30, 30]",
    "stimulus.1.region.box.y=[-30, 0]",
    "stimulus.1.at=400",
    "targets=[]",
    "record.probes=[{name: corner, at: [25, 25, 0]}]",
    "mesh.edge_length=5",
    "time.end=2600",
)


@pytest.fixture(scope="module")
def rotor(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rotor") / "run"
    words = [word for override in SMALL for word in ("--set", override)]
    assert main(["run", str(CONFIG), "-o", str(folder), *words]) == 0
    return folder


def test_analyze_prints_the_reentry_in_full(rotor, cardiosurf):
    done = cardiosurf("analyze", rotor, "--reentry")
    assert (done.returncode, done.stderr) == (0, "")
    assert "spiral: sustained reentry, last reactivation at t = " in done.stdout
    assert "1 live for a cycle or longer" in done.stdout
    assert "clockwise round tissue alone" in done.stdout
    assert "probe corner" in done.stdout
    assert "a wave circulates counterclockwise round " in done.stdout


def test_analyze_prints_json_that_agrees_with_the_verdict(rotor, cardiosurf):
    data = json.loads(cardiosurf("analyze", rotor, "--reentry", "--json").stdout)
    verdict = json.loads(cardiosurf("analyze", rotor, "--json").stdout)
    assert data["schema"] == "cardiosurf/reentry/1"
    assert (
        data["reentry"]
        == verdict["reentry"]
        == json.loads((rotor / "verdict.json").read_text())["reentry"]
    )
    assert verdict["schema"] == "cardiosurf/verdict/1"
    assert sum(verdict["reentry"]["activated_shares"]) == pytest.approx(1.0)
    # walls close by: 748 tu at edges of 1.5 su (tests/regression/test_rotor.py)
    assert data["cycle_length"]["median"] == pytest.approx(748.0, rel=0.05)
    assert data["circuit"]["period"] == pytest.approx(748.0, rel=0.05)
    assert [track["chirality"] for track in data["phases"]["tracks"]] == [-1]


def test_plot_draws_the_circuit(rotor, tmp_path, cardiosurf):
    done = cardiosurf("plot", rotor, "-o", tmp_path / "figures", "--format", "svg")
    assert str(tmp_path / "figures" / "reentry_map.svg") in done.stdout.splitlines()
    text = (tmp_path / "figures" / "reentry_map.svg").read_text()
    assert "tip of a rotor, clockwise" in text
    assert "circuit: " in text
