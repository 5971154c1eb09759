import json

import jsonschema
import numpy as np
import pytest

from cardiosurf.analysis.block import TargetFinding
from cardiosurf.analysis.capture import captured
from cardiosurf.analysis.reentry import ReentryFinding, reentry_finding
from cardiosurf.analysis.verdict import Verdict, verdict_schema, whole_verdict
from cardiosurf.recording.recording import Events

NODES = 400


def periodic(beats, cycle, spread=0.0):
    """Return activations of every node once a cycle, with a phase that runs over the nodes."""
    node = np.tile(np.arange(NODES), beats)
    time = np.repeat(np.arange(beats) * cycle, NODES) + spread * np.tile(np.arange(NODES), beats)
    order = np.argsort(time, kind="stable")
    return Events(node[order], time[order])


def finding(events, *, beats=1, end=1000.0, active=False):
    return reentry_finding(
        events,
        np.ones(NODES),
        beats=beats,
        end=end,
        active_at_end=np.full(NODES, active),
    )


def test_one_wave_is_no_reentry():
    found = finding(periodic(1, 0.0, spread=1.0))
    assert found == ReentryFinding("none", 1, None)


def test_a_wave_that_comes_back_and_goes_on_is_sustained_with_its_cycle():
    found = finding(periodic(5, 210.0, spread=0.5), end=1100.0, active=True)
    assert found.verdict == "sustained"
    assert found.max_activations == 5
    assert found.cycle_length == pytest.approx(210.0)


def test_a_wave_that_came_back_and_died_is_transient():
    assert finding(periodic(3, 210.0), end=2000.0).verdict == "transient"


def test_paced_beats_are_not_reentry():
    assert finding(periodic(4, 300.0), beats=4).verdict == "none"
    assert finding(periodic(5, 300.0), beats=4).verdict == "transient"


def test_flicker_of_a_few_vertices_is_not_reentry():
    once = periodic(1, 0.0)
    events = Events(np.r_[once.nodes, [3, 4, 5]], np.r_[once.times, [40.0, 41.0, 42.0]])
    assert finding(events).verdict == "none"


def test_no_activation_at_all():
    empty = Events(np.empty(0, dtype=np.int64), np.empty(0))
    assert finding(empty) == ReentryFinding("none", 0, None)


def test_capture_needs_a_wave_that_leaves_the_stimulus():
    distance = np.linspace(0.0, 200.0, 201)
    lat = np.where(distance <= 14.0, 5.0 * distance, np.nan)
    assert not captured(lat, distance)
    assert captured(np.where(distance <= 25.0, distance, np.nan), distance)
    assert not captured(np.full(201, np.nan), distance)


def test_capture_on_a_small_surface():
    distance = np.linspace(0.0, 30.0, 31)
    assert captured(distance.copy(), distance)
    assert not captured(np.where(distance < 10.0, distance, np.nan), distance)


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
    assert not validator.is_valid({k: v for k, v in data.items() if k != "captured"})
