import json

import jsonschema
import numpy as np
import pytest

from cardiosurf.analysis.block import TargetFinding
from cardiosurf.analysis.capture import has_captured
from cardiosurf.analysis.reentry import ReentryFinding, reentry_finding
from cardiosurf.analysis.verdict import Verdict, verdict_schema, whole_verdict
from cardiosurf.analysis.waves import Waves

NODES = 400


def activations(beats, cycle, *, same_beat):
    """Return activations of every node once a cycle, of one beat or each of its own."""
    nodes = np.repeat(np.arange(NODES), beats)
    times = np.tile(np.arange(beats) * cycle, NODES) + 0.5 * nodes
    beat = np.zeros(len(nodes), dtype=int) if same_beat else np.tile(np.arange(beats), NODES)
    return Waves(nodes, times, beat, beat)


def finding(waves, *, end=1000.0, active=False):
    return reentry_finding(waves, np.ones(NODES), end=end, active=active)


def test_one_wave_is_no_reentry():
    found = finding(activations(1, 0.0, same_beat=True))
    assert found == ReentryFinding("none", 1, None, activated_shares=(0.0, 1.0))


def test_a_wave_that_comes_back_and_goes_on_is_sustained_with_its_cycle():
    found = finding(activations(5, 210.0, same_beat=True), end=1100.0, active=True)
    # node 399 begins at 199.5 and is activated four times more
    shares = (0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    assert found == ReentryFinding("sustained", 5, 210.0, 0.0, 199.5 + 4 * 210.0, shares)


def test_a_wave_that_came_back_and_died_is_transient():
    assert finding(activations(3, 210.0, same_beat=True), end=2000.0).verdict == "transient"


def test_paced_beats_are_not_reentry():
    found = finding(activations(4, 300.0, same_beat=False))
    assert (found.verdict, found.max_activations) == ("none", 4)
    assert (found.cycle_length, found.last_reactivation) == (None, None)


def test_the_cycle_leaves_out_pacing_intervals():
    # beats 0 and 1 are paced 300 apart; the second comes back twice, 250 apart
    nodes = np.repeat(np.arange(NODES), 4)
    times = np.tile([0.0, 300.0, 550.0, 800.0], NODES)
    beats = np.tile([0, 1, 1, 1], NODES)
    found = finding(Waves(nodes, times, beats, beats), active=True)
    assert (found.cycle_length, found.cycle_length_spread) == (250.0, 0.0)
    assert (found.max_activations, found.last_reactivation) == (4, 800.0)


def test_a_few_vertices_are_not_reentry():
    # 3 of 400 vertices are less than 1 % of the area
    once = activations(1, 0.0, same_beat=True)
    nodes, times = np.r_[once.nodes, [3, 4, 5]], np.r_[once.times, [400.0, 401.0, 402.0]]
    zeros = np.zeros(len(nodes), dtype=int)
    assert finding(Waves(nodes, times, zeros, zeros)).verdict == "none"


def test_no_activation_at_all():
    nothing = np.empty(0, dtype=int)
    found = finding(Waves(nothing, np.empty(0), nothing, nothing))
    assert found == ReentryFinding("none", 0, None, activated_shares=(1.0,))


def test_capture_needs_a_wave_that_leaves_the_stimulus():
    distance = np.linspace(0.0, 200.0, 201)
    assert not has_captured(distance <= 14.0, distance)
    assert has_captured(distance <= 25.0, distance)
    assert not has_captured(distance < 0.0, distance)


def test_capture_on_little_excitable_tissue():
    # an island of 30 su: half of it is enough; what cannot be reached says nothing
    distance = np.r_[np.linspace(0.0, 30.0, 31), np.full(50, np.inf)]
    assert has_captured(distance <= 30.0, distance)
    assert not has_captured(distance < 10.0, distance)
    assert not has_captured(np.isinf(distance), distance)


def target(verdict):
    return TargetFinding("left", verdict, 0.5, None, None, None, None)


NONE = ReentryFinding("none", 1, None)


@pytest.mark.parametrize(
    ("is_captured", "targets", "reentry", "expected"),
    [
        (False, ("block",), NONE, "no_capture"),
        (True, ("block", "conduction"), NONE, "block"),
        (True, ("partial", "conduction"), NONE, "partial"),
        (True, ("partial", "block"), NONE, "block"),
        (True, ("conduction",), NONE, "conduction"),
        (True, ("block",), ReentryFinding("sustained", 9, 250.0), "reentry"),
        (True, ("conduction",), ReentryFinding("transient", 2, 250.0), "conduction"),
    ],
)
def test_the_whole_verdict_is_the_worst(is_captured, targets, reentry, expected):
    assert whole_verdict(is_captured, tuple(target(v) for v in targets), reentry) == expected


def test_verdict_json_meets_its_published_schema():
    verdict = Verdict(
        name="t-domain-head-on",
        config_sha256="0" * 64,
        captured=True,
        verdict="block",
        targets=(target("block"),),
        reentry=NONE,
        quiescent_at=1050.0,
        end=1050.0,
    )
    data = json.loads(json.dumps(verdict.to_json()))
    validator = jsonschema.Draft202012Validator(verdict_schema())
    validator.validate(data)
    assert next(iter(data)) == "schema"
    assert data["schema"] == "cardiosurf/verdict/1"
    assert not validator.is_valid({**data, "verdict": "maybe"})
    assert not validator.is_valid({**data, "colour": "red"})
    assert data["guard"] is None
    assert not validator.is_valid({**data, "guard": True})
    assert not validator.is_valid({k: v for k, v in data.items() if k != "captured"})
