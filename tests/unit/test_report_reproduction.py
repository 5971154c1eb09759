"""The reproduction page from made-up results: what stands there, and what is said to be missing."""

from pathlib import Path

import pytest
from study_strips import write_scenario

from cardiosurf.config.scenario_file import read_scenario, scenario_paths
from cardiosurf.report.kept import Kept
from cardiosurf.report.reproduction import reproduction_page
from cardiosurf.study.results import ASKED, Results
from cardiosurf.study.wanted import (
    wanted_cases,
    wanted_entrances,
    wanted_figures,
    wanted_thresholds,
)

ROOT = Path(__file__).parents[2]
SCENARIO = """\
name: strips
source: "appendix Z"
question: Does it pass?
base: base.yaml
cases:
  - name: free
    published: conduction
    expect: {verdict: conduction, far: conduction}
    figures: [{label: fig9, times: [30, 50], unit: 10, shown: a wave, seen: A wave that passes.}]
  - name: walled
    set: {tissue: {patches: [{name: wall, region: {box: {x: [25, 55]}}, excitable: false}]}}
    published: block
    expect: {verdict: block}
    note: Nothing excitable is left.
pairs:
  - {name: both, forward: free, backward: walled, target: far, expect: unidirectional}
searches:
  - {name: critical, title: Critical ends, cases: [free], vary: time.end, between: [300, 900],
     against: geometry.x.1, axis: "length [su]", entrance: wall}
"""


def verdict(word, fraction):
    far = {"name": "far", "verdict": word, "activated_fraction": fraction, "route": None}
    return {
        "verdict": word,
        "captured": True,
        "quiescent_at": None,
        "end": 900.0,
        "targets": [far],
        "reentry": {"verdict": "none", "max_activations": 1, "cycle_length": None},
        "guard": None,
        "notes": [],
    }


def case_entry(asked, word, *, agrees=True):
    run = {"edge_length": 5.0, "step": 3.0, "verdict": word}
    finer = {"edge_length": 10 / 3, "step": 3.0, "verdict": word}
    return {
        ASKED: asked,
        "compared": [{"key": "verdict", "agrees": agrees}, {"key": "far", "agrees": True}],
        "converged": "yes",
        "guard": {"tried": [run, finer, run]},
        "edge_length": 5.0,
        "seconds": 0.123,
        "error": None,
        "verdict": verdict(word, 1.0),
    }


@pytest.fixture
def files(tmp_path):
    return [read_scenario(write_scenario(tmp_path / "in", SCENARIO))]


def page(files, folder):
    return reproduction_page(Kept.read(files, folder), "images")


def row(text, beginning):
    # of all tables that of the claims comes first
    line = next(line for line in text.splitlines() if line.startswith(f"| {beginning} |"))
    return [cell.strip() for cell in line.strip("|").split(" | ")]


def test_without_results_everything_is_said_to_be_missing(files, tmp_path):
    text = page(files, tmp_path / "none")
    for name in ("free", "walled"):
        assert row(text, f"strips/{name}")[3] == "not run yet"
    assert row(text, "strips/both")[3] == "not run yet"
    assert row(text, "strips/free")[5] == "not run yet"
    assert "*Not drawn yet.*" in text
    assert "![" not in text
    # no number that was not found: of edges, seconds, critical values
    assert row(text, "strips/walled")[4:] == ["-", "-", "-", "-", "-"]


def test_a_row_says_what_was_found(files, tmp_path):
    free, walled = wanted_cases(files)
    results = Results(tmp_path / "results")
    results.keep("cases", free.name, case_entry(free.asked, "conduction"))
    results.keep("cases", walled.name, case_entry(walled.asked, "block", agrees=False))
    text = page(files, results.folder)
    assert row(text, "strips/free") == [
        *("strips/free", "appendix Z", "conduction", "conduction", "yes", "not run yet"),
        *("yes", "5, 3.33", "0.1"),
    ]
    assert row(text, "strips/walled")[3:5] == ["block", "1 of 2"]
    assert row(text, "strips/both")[3] == "unidirectional"
    assert "**walled**: published: block; found: block. Nothing excitable is left." in text


def test_a_result_of_another_config_is_not_shown(files, tmp_path):
    free, _ = wanted_cases(files)
    results = Results(tmp_path / "results")
    results.keep("cases", free.name, case_entry("of something else", "conduction"))
    assert row(page(files, results.folder), "strips/free")[3] == "not run yet"


def test_a_failed_run_is_said_to_have_failed(files, tmp_path):
    free, _ = wanted_cases(files)
    results = Results(tmp_path / "results")
    entry = {"verdict": None, "error": {"kind": "numerical", "text": "u left its range"}}
    results.keep("cases", free.name, case_entry(free.asked, "block") | entry)
    assert row(page(files, results.folder), "strips/free")[3] == "failed: numerical"


def change(value, error, *, converged=True):
    levels = [
        {"edge_length": edge, "step": edge, "low": low, "high": low + 2.0}
        for edge, low in ((4.0, 480.0), (2.8, 490.0), (2.0, 495.0))
    ]
    return {
        "below": "no conduction",
        "above": "conduction",
        "value": value,
        "error": error,
        "order": 2.0,
        "order_is": "assumed",
        "converged": converged,
        "note": "not on 2",
        "levels": levels,
    }


def threshold(files, folder, *changes):
    (wanted,) = wanted_thresholds(files)
    entry = {ASKED: wanted.asked, "against": 80.0, "between": [300.0, 900.0]}
    Results(folder).keep("thresholds", wanted.name, entry | {"changes": list(changes)})
    return page(files, folder)


def test_critical_values_stand_with_their_errors(files, tmp_path):
    text = threshold(files, tmp_path / "results", change(500.12, 4.321))
    assert row(text, "strips/free")[5] == "500.1 +- 4.4"
    assert "| strips/free | 80 | 500.1 +- 4.4 | 2.0, assumed | 4: 481, 2.8: 491, 2: 496 |" in text
    assert "![critical values](images/critical.png)" in text


def test_a_critical_value_that_is_not_converged_says_so(files, tmp_path):
    text = threshold(files, tmp_path / "results", change(500.12, 4.321, converged=False))
    assert row(text, "strips/free")[5] == "500.1 +- 4.4 (not converged)"


def test_no_critical_value_is_made_up(files, tmp_path):
    text = threshold(files, tmp_path / "results", change(None, None))
    assert row(text, "strips/free")[5] == "no value (not on 2)"
    text = threshold(files, tmp_path / "results")
    assert row(text, "strips/free")[5] == "no change from 300 to 900"


def test_fronts_are_read_where_they_come_first(files, tmp_path):
    (wanted,) = wanted_entrances(files)
    piece = {
        "start": [25.0, 0.0, 0.0],
        "end": [25.0, 10.0, 0.0],
        "length": 10.0,
        "position": [0.0, 5.0, 10.0],
        "lat": [120.0, 110.0, None],
        # 10 degrees where the front comes first, which stands for half of the 10 su; 90 elsewhere
        "angle": [1.5707963, -0.1745329, None],
        "curvature": [0.03, 0.01, None],
        "speed": [0.2, 0.2, None],
    }
    never = {**piece, "end": [25.0, 9.0, 0.0], **dict.fromkeys(("lat", "angle"), [None] * 3)}
    entry = {ASKED: wanted.asked, "against": 80.0, "verdict": "block", "pieces": [piece, never]}
    results = Results(tmp_path / "results")
    results.keep("entrances", wanted.name, entry)
    text = page(files, results.folder)
    front = "(25, 0, 0) to (25, 10, 0) | 110 | -10 | 50 | 5 of 10 | +0.0100 | +0.0200"
    assert f"| 80 | block | {front} |" in text
    # the piece that no front came to has no line
    assert "(25, 9, 0)" not in text


def test_a_figure_stands_with_what_the_paper_says_and_what_is_seen(files, tmp_path):
    ((wanted, _),) = wanted_figures(files)
    results = Results(tmp_path / "results")
    results.keep("figures", wanted.name, {ASKED: wanted.asked})
    text = page(files, results.folder)
    assert "![fig9](images/strips_free_fig9.png)" in text
    assert (
        "Figure `fig9`, T = 30, 50 (one T is 10 tu). Published: a wave. Seen: A wave that passes."
        in text
    )


def test_dropped_cases_are_dropped_and_other_scenarios_stay(tmp_path):
    results = Results(tmp_path)
    results.write("cases", {"a/one": {}, "a/two": {}, "b/one": {}})
    results.prune("cases", ["a"], ["a/two"])
    assert list(results.read("cases")) == ["a/two", "b/one"]


def test_the_page_is_what_the_kept_results_give():
    files = [read_scenario(path) for path in scenario_paths([ROOT / "scenarios"])]
    text = reproduction_page(Kept.read(files, ROOT / "docs/results"), "images/reproduction")
    kept = (ROOT / "docs/reproduction.md").read_text(encoding="utf-8")
    assert text == kept, "docs/reproduction.md is out of date: make reproduction"


def test_every_image_of_the_page_is_there_and_small():
    page = (ROOT / "docs/reproduction.md").read_text(encoding="utf-8")
    shown = {part.split(")")[0] for part in page.split("](")[1:] if part.startswith("images/")}
    there = {
        path.relative_to(ROOT / "docs").as_posix(): path.stat().st_size
        for path in (ROOT / "docs/images/reproduction").iterdir()
    }
    assert shown == set(there)
    assert max(there.values()) < 150_000
    assert sum(there.values()) < 4_000_000
