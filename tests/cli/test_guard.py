"""``run --guard``: a verdict that stays on a finer mesh, and one that does not."""

import json

import pytest

from cardiosurf.study import guard

GAP = """\
name: gap
geometry: {kind: plane, x: [0, 60], y: [0, 10]}
mesh: {edge_length: 1.5}
tissue:
  patches:
    - {name: scar, region: {box: {x: [25, 33.5]}}, excitable: false}
stimulus:
  - {shape: edge, edge: left}
time: {end: 700, step: 1}
targets:
  - {name: far, region: {box: {x: [45, 60]}}}
"""
NARROW = ("--set", "tissue.patches.scar.region.box.x.1=27")
COARSE = ("--set", "mesh.edge_length=5", "--set", "time.step=2")


@pytest.fixture
def gap(tmp_path):
    path = tmp_path / "gap.yaml"
    path.write_text(GAP)
    return path


def test_a_converged_verdict_says_so_and_is_not_made_twice(gap, tmp_path, cardiosurf, monkeypatch):
    out = tmp_path / "out"
    done = cardiosurf("run", gap, *NARROW, "--guard", "-o", out, "--json")
    assert done.returncode == 0, done.stderr
    verdict = json.loads(done.stdout)
    assert verdict == json.loads((out / "verdict.json").read_text())
    found = verdict["guard"]
    assert (verdict["verdict"], found["agree"], found["converged"]) == ("conduction", True, "yes")
    assert [(one["edge_length"], one["step"]) for one in found["tried"]] == [
        (1.5, 1.0),
        (1.0, 1.0),
        (1.5, 0.5),
    ]
    assert found["lat_shift"] <= found["lat_tolerance"] == 0.005
    assert not [note for note in verdict["notes"] if "converged" in note]

    def run_again(*arguments, **options):
        raise AssertionError

    monkeypatch.setattr(guard, "simulate", run_again)
    again = cardiosurf("run", gap, *NARROW, "--guard", "-o", out)
    assert again.returncode == 0
    assert "  converged: same verdicts" in again.stdout
    assert json.loads((out / "verdict.json").read_text()) == verdict


def test_a_verdict_that_the_mesh_made_is_not_converged(gap, tmp_path, cardiosurf):
    # the widest gap that a wave jumps is 8.28 (test_threshold), on edges of 5 it is above 8.5
    out = tmp_path / "out"
    done = cardiosurf("run", gap, *COARSE, "--guard", "-o", out)
    assert done.returncode == 0
    assert done.stdout.startswith("gap: CONDUCTION\n")
    assert "NOT converged: verdicts differ" in done.stdout
    assert "with edges of 3.33333 su and steps of 2 tu the verdict is block" in done.stdout
    found = json.loads((out / "verdict.json").read_text())["guard"]
    assert (found["agree"], found["converged"]) == (False, "no")
    assert found["tried"][1]["targets"] == {"far": {"verdict": "block", "first_activation": None}}


def test_a_finished_run_of_another_config_is_still_not_replaced(gap, tmp_path, cardiosurf):
    out = tmp_path / "out"
    assert cardiosurf("run", gap, *COARSE, "-o", out).returncode == 0
    refused = cardiosurf("run", gap, *COARSE, *NARROW, "--guard", "-o", out)
    assert refused.returncode == 2
    assert "holds a finished run" in refused.stderr


def test_a_guard_that_was_stopped_goes_on(gap, tmp_path, cardiosurf, monkeypatch):
    out = tmp_path / "out"
    original = guard.guard

    def stop(*arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(guard, "guard", stop)
    stopped = cardiosurf("run", gap, *COARSE, "--guard", "-o", out)
    assert stopped.returncode == 130
    assert "its guard goes on when called again" in stopped.stderr
    assert json.loads((out / "verdict.json").read_text())["guard"] is None
    monkeypatch.setattr(guard, "guard", original)
    assert cardiosurf("run", gap, *COARSE, "--guard", "-o", out).returncode == 0
    assert json.loads((out / "verdict.json").read_text())["guard"]["converged"] == "no"


def test_a_mesh_that_cannot_be_finer_is_named(gap, tmp_path, cardiosurf):
    small = ("--set", "geometry={kind: plane, x: [0, 2], y: [0, 1]}", "--set", "tissue={}")
    small += ("--set", "targets=[]", "--set", "mesh.edge_length=0.12", "--set", "time.end=5")
    done = cardiosurf("run", gap, *small, "--guard", "-o", tmp_path / "out")
    assert done.returncode == 2
    assert "mesh.edge_length=0.08" in done.stderr
