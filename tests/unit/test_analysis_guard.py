"""The convergence check: what agrees, what does not, and what the verdict says of it."""

import json

import jsonschema
import pytest

from cardiosurf.analysis.block import TargetFinding
from cardiosurf.analysis.guard import guard_finding, guard_run, guarded
from cardiosurf.analysis.reentry import ReentryFinding
from cardiosurf.analysis.verdict import GuardRun, GuardTarget, Verdict, verdict_schema

VERDICT = Verdict(
    name="t-domain",
    config_sha256="0" * 64,
    captured=True,
    verdict="conduction",
    targets=(TargetFinding("left", "conduction", 1.0, 1100.0, 1400.0, "direct", 0.9),),
    reentry=ReentryFinding("none", 1, None),
    quiescent_at=1700.0,
    end=1700.0,
)


def run(time, verdict="conduction", *, edge=2.5, reentry="none"):
    return GuardRun(edge, 1.2, verdict, reentry, {"left": GuardTarget(verdict, time)})


def test_what_is_compared_is_read_off_the_verdict():
    assert guard_run(VERDICT.to_json(), 2.5, 1.2) == run(1100.0)


def test_equal_verdicts_and_times_within_the_accuracy_are_converged():
    found = guard_finding([run(1100.0), run(1104.0), run(1097.0)], accuracy=0.005)
    assert (found.agree, found.converged, found.lat_tolerance) == (True, "yes", 0.005)
    assert found.lat_shift == pytest.approx(4.0 / 1100.0)
    assert guarded(VERDICT, found).notes == ()


def test_times_beyond_the_accuracy_are_not_converged():
    found = guard_finding([run(1100.0), run(1104.0), run(1090.0)], accuracy=0.005)
    assert (found.agree, found.converged) == (True, "no")
    assert found.lat_shift == pytest.approx(10.0 / 1100.0)
    (note,) = guarded(VERDICT, found).notes
    assert "move by 0.91%" in note


def test_times_count_from_the_first_stimulus():
    # 4 tu of 100 that the wave travelled, not of 1100
    found = guard_finding([run(1100.0), run(1104.0)], accuracy=0.005, start=1000.0)
    assert found.lat_shift == pytest.approx(0.04)
    assert found.converged == "no"


def test_another_verdict_is_not_converged_and_named():
    found = guard_finding([run(1100.0), run(None, "block", edge=1.67), run(1101.0)], accuracy=0.005)
    assert (found.agree, found.converged) == (False, "no")
    (note,) = guarded(VERDICT, found).notes
    assert "with edges of 1.67 su" in note
    assert "left block" in note


def test_a_blocked_wave_may_creep_over_the_rim_or_not():
    found = guard_finding([run(None, "block"), run(300.0, "block")], accuracy=0.005)
    assert (found.agree, found.lat_shift, found.converged) == (True, None, "yes")


def test_another_reentry_is_noted_and_no_part_of_the_check():
    found = guard_finding([run(1100.0), run(1100.0, reentry="transient")], accuracy=0.005)
    assert found.converged == "yes"
    (note,) = guarded(VERDICT, found).notes
    assert "reentry is transient" in note


def test_a_guarded_verdict_meets_the_published_schema():
    found = guard_finding([run(1100.0), run(1104.0), run(None, "block")], accuracy=0.005)
    data = json.loads(json.dumps(guarded(VERDICT, found).to_json()))
    validator = jsonschema.Draft202012Validator(verdict_schema())
    validator.validate(data)
    assert [one["verdict"] for one in data["guard"]["tried"]] == ["conduction"] * 2 + ["block"]
    assert not validator.is_valid({**data, "guard": {**data["guard"], "converged": "maybe"}})
