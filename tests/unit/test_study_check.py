"""Comparison, pairs, history, and the check as a whole."""

import json
from dataclasses import replace
from xml.etree import ElementTree as ET

import pytest
from study_strips import BASE, SCENARIO, WALL, write_scenario

from cardiosurf.config import load_text
from cardiosurf.config.expectation import Expectation
from cardiosurf.config.scenario import Pair, Thresholds
from cardiosurf.config.scenario_file import read_scenario
from cardiosurf.errors import InputError, NumericalError
from cardiosurf.report.check_report import check_json, check_lines
from cardiosurf.report.junit import junit_xml
from cardiosurf.study import batch
from cardiosurf.study.batch import Job, run_batch
from cardiosurf.study.check import How, check
from cardiosurf.study.history import NAME, Past, change_since, read_history, write_history
from cardiosurf.study.job import failed, run_job
from cardiosurf.study.outcome import compare, findings_of, probe_lats
from cardiosurf.study.pairs import judge_pair

VERDICT = {
    "verdict": "block",
    "captured": True,
    "quiescent_at": None,
    "end": 900.0,
    "targets": [{"name": "left", "verdict": "block", "activated_fraction": 0.1, "route": None}],
    "reentry": {"verdict": "none", "max_activations": 1, "cycle_length": None},
    "guard": None,
    "notes": [],
}
PAIR = Pair(name="both", forward="one", backward="two", target="left")


@pytest.fixture
def checked(tmp_path):
    """Return a function that checks a scenario from its text, in one folder."""

    def run(text=SCENARIO, base=BASE):
        return check([read_scenario(write_scenario(tmp_path / "in", text, base))], tmp_path / "out")

    return run


def test_findings_go_by_dotted_keys():
    assert findings_of(VERDICT) == {
        "verdict": "block",
        "captured": True,
        "quiescent_at": None,
        "end": 900.0,
        "left.verdict": "block",
        "left.activated_fraction": 0.1,
        "left.route": None,
        "reentry.verdict": "none",
        "reentry.max_activations": 1,
        "reentry.cycle_length": None,
    }


def test_comparison_keeps_what_was_wanted_beside_what_was_found():
    wanted = [Expectation("left.activated_fraction", 0.2, 0.05), Expectation("left.route", None)]
    wrong, right = compare(wanted, findings_of(VERDICT))
    assert (wrong.key, wrong.wanted, wrong.found) == ("left.activated_fraction", 0.2, 0.1)
    assert (wrong.agrees, right.agrees) == (False, True)


@pytest.mark.parametrize(
    ("forward", "backward", "verdict", "passing"),
    [
        ("conduction", "block", "unidirectional", ("one",)),
        ("block", "conduction", "unidirectional", ("two",)),
        ("block", "partial", "bidirectional block", ()),
        ("conduction", "conduction", "bidirectional conduction", ("one", "two")),
    ],
)
def test_a_pair_passes_in_one_direction_in_both_or_in_none(forward, backward, verdict, passing):
    loaded = load_text(BASE)
    verdicts = {
        case: {"targets": [{"name": "left", "verdict": found}]}
        for case, found in (("one", forward), ("two", backward))
    }
    result = judge_pair("s", PAIR, verdicts, {"one": loaded, "two": loaded})
    assert (result.verdict, result.passing, result.agrees) == (verdict, passing, True)
    assert result.margins == {"forward": None, "backward": None}
    expecting = replace(PAIR, expect="unidirectional")
    agrees = judge_pair("s", expecting, verdicts, {"one": loaded, "two": loaded}).agrees
    assert agrees is (verdict == "unidirectional")


def test_a_pair_with_a_failed_run_has_no_verdict_and_agrees_with_none():
    loaded = load_text(BASE)
    verdicts = {"one": None, "two": VERDICT}
    pair = replace(PAIR, expect="bidirectional block")
    result = judge_pair("s", pair, verdicts, {"one": loaded, "two": loaded})
    assert (result.verdict, result.agrees) == (None, False)


@pytest.mark.parametrize("written", ["8", "{x: 8, y: 8}"])
def test_margins_are_relative_to_the_critical_value(written):
    patch = f"tissue: {{patches: [{{name: s, region: {{box: {{}}}}, anisotropy: {written}}}]}}\n"
    loaded = load_text(BASE + patch.replace("{box: {}}", "{box: {x: [0, 9]}}"))
    key = "tissue.patches.s.anisotropy"
    pair = replace(PAIR, thresholds=Thresholds(key=key, forward=10.0, backward=6.4))
    result = judge_pair("s", pair, {"one": VERDICT, "two": VERDICT}, {"one": loaded, "two": loaded})
    assert result.margins == pytest.approx({"forward": -0.2, "backward": 0.25})
    none = replace(pair, thresholds=Thresholds(key=key, forward=10.0))
    margins = judge_pair(
        "s", none, {"one": VERDICT, "two": VERDICT}, {"one": loaded, "two": loaded}
    )
    assert margins.margins == pytest.approx({"forward": -0.2, "backward": None})


def test_the_lat_at_a_probe_is_when_the_front_comes_by(tmp_path):
    loaded = load_text(BASE.replace("edge_length: 5", "edge_length: 2.5").replace("3}", "1}"))
    run_batch([Job("one", loaded, tmp_path)])
    found = probe_lats(tmp_path)["lat.middle"]
    # the front starts 4 su in and runs 0.2123 su/tu; getting up to speed costs some tens of tu
    assert found == pytest.approx((40 - 4) / 0.2123, rel=0.1)
    behind = "tissue: " + WALL.replace("[25, 55]", "[15, 80]") + "\n"
    run_batch([Job("two", load_text(BASE.replace("[60, 80]", "[0, 10]") + behind), tmp_path / "w")])
    assert probe_lats(tmp_path / "w") == {"lat.middle": None}


def test_history_tells_what_changed(tmp_path):
    past = Past({"verdict": "block", "left.first_activation": 3.0}, BASE, 2.0)
    write_history(tmp_path, {"s/one": past})
    assert read_history(tmp_path) == {"s/one": past}
    now = {"verdict": "conduction", "left.first_activation": 3.0}
    change = change_since(past, now, BASE.replace("step: 3", "step: 2"))
    assert change.findings == ("verdict: block -> conduction",)
    assert change.config == ("time.step: 3 -> 2",)
    (tmp_path / NAME).write_text("[]")
    assert read_history(tmp_path) == {}


def test_everything_as_expected(checked):
    result = checked()
    assert result.exit_code == 0
    assert [case.status for case in result.cases] == ["agrees", "agrees"]
    assert result.pairs[0].verdict == "unidirectional"
    text = "\n".join(check_lines(result))
    assert "2 cases: 2 as expected (0 reused" in text
    assert "DIFFERS" not in text
    assert json.loads(json.dumps(check_json(result)))["agrees"] is True


def test_a_flipped_verdict_is_shown_with_what_changed(checked):
    checked()
    result = checked(SCENARIO.replace(WALL, WALL.replace("[25, 55]", "[25, 26]")))
    assert result.exit_code == 1
    (free, walled) = result.cases
    assert (free.status, walled.status) == ("agrees", "differs")
    assert walled.change is not None
    assert "verdict: block -> conduction" in walled.change.findings
    assert "tissue.patches.wall.region.box.x: [25.0, 55.0] -> [25.0, 26.0]" in walled.change.config
    text = "\n".join(check_lines(result))
    assert "strips / walled: differs from what is expected" in text
    assert "expected block, found conduction" in text
    assert "the config was changed:" in text
    # the pair no longer blocks in one direction
    assert not result.pairs[0].agrees


def test_a_run_that_breaks_down_is_told_and_the_others_are_compared(checked):
    result = checked(SCENARIO.replace(f"tissue: {WALL}", "time.step: 300"))
    assert result.exit_code == 3
    assert [case.status for case in result.cases] == ["agrees", "failed"]
    assert "strips / walled: broke down" in check_lines(result)


def test_junit_is_well_formed_and_counts(checked):
    broken = SCENARIO.replace("  - name: free", "  - name: free\n    set: {time.step: 300}")
    result = checked(broken.replace("verdict: block, far: block", "verdict: conduction"))
    root = ET.fromstring(junit_xml(result))  # noqa: S314 - it is our own
    assert root.tag == "testsuites"
    counts = {name: root.get(name) for name in ("tests", "failures", "errors")}
    # two cases and a pair: one broke down, one is not as expected, and so the pair
    assert counts == {"tests": "3", "failures": "2", "errors": "1"}
    (suite,) = root
    assert [test.get("name") for test in suite] == ["free", "walled", "both"]
    assert [test[0].tag for test in suite] == ["error", "failure", "failure"]
    assert suite[1][0].get("message") == "strips / walled: differs from what is expected"
    assert "found block" in suite[1][0].text


def test_junit_holds_any_text():
    from cardiosurf.report.junit import _clean  # noqa: PLC0415

    assert _clean("a\x00b\x1b<&>\ud800 ä") == "a?b?<&>? ä"


def test_a_guarded_check_says_which_cases_are_converged(tmp_path):
    file = read_scenario(write_scenario(tmp_path / "in"))
    result = check([file], tmp_path / "out", how=How(guard=True))
    free, walled = result.cases
    assert (free.converged, walled.converged) == ("no", "yes")
    tried = free.guarded.finding.tried
    assert [(run.edge_length, run.step) for run in tried] == [
        (5.0, 3.0),
        (pytest.approx(5 / 1.5, rel=1e-5), 3.0),
        (5.0, 1.5),
    ]
    # steps of 3 tu are known to put LAT off by more than a per cent
    assert free.guarded.finding.lat_shift > 0.005
    lines = check_lines(result)
    assert "strips / free: not converged" in lines
    assert any("edge 3.33333 su" in line for line in lines)
    # not converged is no failure
    assert result.exit_code == 0
    data = check_json(result)["cases"]
    assert [case["converged"] for case in data] == ["no", "yes"]
    assert data[1]["guard"]["agree"] is True


def test_a_repetition_that_fails_is_told(tmp_path, monkeypatch):
    def failing(job, execution):
        if job.name.endswith("smaller-step"):
            return failed(job.name, NumericalError("u is not finite"), 0.1)
        return run_job(job, execution)

    monkeypatch.setattr(batch, "run_job", failing)
    file = read_scenario(write_scenario(tmp_path / "in"))
    result = check([file], tmp_path / "out", how=How(guard=True))
    assert [case.converged for case in result.cases] == ["failed", "failed"]
    assert "  strips/free smaller-step" in check_lines(result)
    # its own verdict is there and is the expected one
    assert result.exit_code == 0


def test_two_scenarios_of_one_name_are_refused(tmp_path):
    file = read_scenario(write_scenario(tmp_path / "in"))
    with pytest.raises(InputError, match="is also the name of"):
        check([file, file], tmp_path / "out")
    assert not (tmp_path / "out").exists()
