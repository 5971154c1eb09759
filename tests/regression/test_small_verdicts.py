"""Verdicts on planes small enough for every day, whose answers can be worked out by hand."""

import pytest

from cardiosurf.config import load
from cardiosurf.study.simulation import simulate

STRIP = """\
name: strip
geometry: {kind: plane, x: [0, 160], y: [0, 60]}
mesh: {edge_length: 3}
stimulus: [{shape: edge, edge: left}]
time: {end: 2500}
record: {frames_every: null}
targets: [{name: far, region: {box: {x: [120, 140]}}}]
"""
SPEED = 0.2123  # planar pulse, su/tu


@pytest.fixture
def judge(tmp_path):
    """Return a function that runs the strip with overrides and returns its verdict."""

    def run(*overrides):
        path = tmp_path / "strip.yaml"
        path.write_text(STRIP)
        return simulate(load(path, overrides), tmp_path / "run").verdict

    return run


def test_a_free_strip_conducts(judge):
    verdict = judge()
    (far,) = verdict.targets
    assert (verdict.verdict, far.route, verdict.reentry.verdict) == ("conduction", "direct", "none")
    # the front starts 4 su in; getting up to speed costs it some tens of tu
    assert far.first_activation == pytest.approx((120 - 4) / SPEED, rel=0.04)


def test_a_wall_of_scar_blocks(judge):
    verdict = judge(
        "tissue={patches: [{name: wall, excitable: false, region: {box: {x: [60, 90]}}}]}"
    )
    assert verdict.verdict == "block"
    assert verdict.targets[0].activated_fraction == 0.0
    assert verdict.quiescent_at is not None


def test_a_gap_in_the_wall_conducts(judge):
    verdict = judge(
        "tissue={patches: [{name: wall, excitable: false,"
        " region: {box: {x: [60, 90], y: [25, 60]}}}]}"
    )
    assert verdict.verdict == "conduction"


def test_a_target_that_is_reached_from_behind_only_is_indirect(judge):
    # a pocket that opens to the right only: walls to its left and below it
    wall = (
        "tissue={patches: [{name: wall, excitable: false, region:"
        " {any: [{box: {x: [80, 95], y: [50, 120]}}, {box: {x: [80, 130], y: [40, 55]}}]}}]}"
    )
    pocket = "targets.far.region={box: {x: [100, 120], y: [60, 120]}}"
    verdict = judge("geometry.y=[0, 120]", wall, pocket)
    (far,) = verdict.targets
    assert far.verdict == "conduction"
    assert far.route == "indirect"


def test_an_island_in_scar_is_captured(judge):
    verdict = judge(
        "tissue={patches: [{name: scar, excitable: false,"
        " region: {not: {ball: {centre: [80, 30, 0], radius: 24}}}}]}",
        "stimulus=[{shape: point, centre: [80, 30, 0]}]",
        "targets=[]",
    )
    assert verdict.captured
    assert verdict.targets[0].activated_fraction > 0.5


def test_two_stimuli_that_fail_capture_nothing(judge):
    weak = "shape: point, amplitude: 0.8, radius: 5"
    verdict = judge(
        f"stimulus=[{{{weak}, centre: [10, 30, 0]}}, {{{weak}, centre: [150, 30, 0], at: 50}}]"
    )
    assert verdict.verdict == "no_capture"


def test_the_entrance_belongs_to_the_stimulus_that_captured(judge):
    verdict = judge(
        "stimulus=[{shape: point, centre: [150, 30, 0], amplitude: 0.3},"
        " {shape: edge, edge: left, at: 20}]"
    )
    assert verdict.targets[0].route == "direct"


def test_of_two_waves_the_nearer_one_counts(judge):
    verdict = judge("stimulus=[{shape: edge, edge: left}, {shape: edge, edge: right, at: 10}]")
    (far,) = verdict.targets
    assert far.route == "direct"
    assert far.first_activation == pytest.approx(10 + (20 - 4) / SPEED, rel=0.2)


def test_a_current_that_fires_again_is_no_reentry(judge):
    verdict = judge("stimulus=[{shape: edge, edge: left, duration: 2400, strength: 0.02}]")
    assert verdict.reentry.max_activations > 1
    assert verdict.reentry.verdict == "none"


def test_a_run_that_ends_early_does_not_blame_the_stimulus(judge):
    verdict = judge("time.end=40")
    assert verdict.captured
    assert verdict.quiescent_at is None
    assert "raise time.end" in verdict.notes[0]


def test_waiting_after_rest_changes_nothing(judge, tmp_path):
    stopped = judge()
    path = tmp_path / "strip.yaml"
    waited = simulate(load(path, ["time.stop_at_rest=false"]), tmp_path / "waited").verdict
    # the tail of the run only differs in when it ends
    assert waited.quiescent_at == pytest.approx(stopped.quiescent_at, abs=1.6)
    assert waited.targets == stopped.targets
    assert waited.notes == ()


@pytest.mark.slow
def test_a_rotor_is_sustained_reentry_whatever_paced_it(tmp_path):
    # S1 from the left wall, then a premature train in a corner: a rotor about the corner's rim
    path = tmp_path / "rotor.yaml"
    path.write_text(
        STRIP.replace("x: [0, 160], y: [0, 60]", "x: [0, 200], y: [0, 200]").replace(
            "[{shape: edge, edge: left}]",
            "[{shape: edge, edge: left}, {shape: region, at: 500,"
            " region: {box: {x: [0, 100], y: [0, 100]}}, train: {count: 4, interval: 20}}]",
        )
    )
    verdict = simulate(load(path, ["time.end=5000"]), tmp_path / "run").verdict
    assert verdict.verdict == "reentry"
    assert verdict.reentry.verdict == "sustained"
    # as read off the activations of single vertices: 2123, 3557, 4992
    assert verdict.reentry.cycle_length == pytest.approx(1434, rel=0.02)
