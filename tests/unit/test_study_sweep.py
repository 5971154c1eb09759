"""Sweeps: configs first, then runs, one row each, and the map of their verdicts."""

import csv
import io
import json

import numpy as np
import pytest
from matplotlib.collections import PathCollection
from study_strips import SCENARIO, WALL, write_scenario

from cardiosurf.config import load
from cardiosurf.config.scenario_file import read_scenario
from cardiosurf.report.phase_diagram import STYLES, phase_diagram
from cardiosurf.report.sweep_table import columns_of, csv_text, sweep_lines
from cardiosurf.report.table import table_lines
from cardiosurf.study import batch
from cardiosurf.study.job import Done
from cardiosurf.study.sweep import SweepResult, sweep

ROW = {"case": None, "verdict": "block", "reentry": "none", "quiescent_at": None, "seconds": 1.0}


@pytest.fixture
def swept(tmp_path):
    """Return a function that sweeps a scenario from its text, in one folder."""

    def run(text=SCENARIO, **options):
        return sweep(read_scenario(write_scenario(tmp_path / "in", text)), tmp_path, **options)

    return run


def result_of(rows, *varied):
    """A sweep with these rows, of runs that nobody made."""
    filled = tuple(ROW | row for row in rows)
    done = tuple(Done("one", {}, "", None, 1.0, {}, reused=False) for _ in rows)
    return SweepResult("one", varied, filled, done, 2.0)


def test_every_point_has_its_config_its_run_and_its_row(swept, tmp_path):
    result = swept()
    assert result.exit_code == 0
    assert [row["point"] for row in result.rows] == [
        "free_edge_length-4",
        "free_edge_length-5",
        "walled_edge_length-4",
        "walled_edge_length-5",
    ]
    assert [row["verdict"] for row in result.rows] == ["conduction", "conduction", "block", "block"]
    assert [row["edge_length"] for row in result.rows] == [4, 5, 4, 5]
    for row in result.rows:
        # what stands in the file is what was run
        loaded = load(tmp_path / "cases" / f"{row['point']}.yaml")
        assert loaded.config.mesh.edge_length == row["mesh.edge_length"]
        assert loaded.sha256 in {done.verdict["config_sha256"] for done in result.done}


def test_a_rerun_does_what_is_missing_or_changed(swept, tmp_path, monkeypatch):
    swept()
    ran, run_job = [], batch.run_job
    monkeypatch.setattr(
        batch, "run_job", lambda job, execution: ran.append(job.name) or run_job(job, execution)
    )
    assert all(done.reused for done in swept().done)
    assert ran == []
    result = swept(SCENARIO.replace("[4, 5]", "[4, 6]"))
    assert ran == ["free_edge_length-6", "walled_edge_length-6"]
    assert [done.reused for done in result.done] == [True, False, True, False]
    # configs of points that are no more are gone, files of others stay
    assert not (tmp_path / "cases" / "free_edge_length-5.yaml").exists()
    (tmp_path / "cases" / "mine.yaml").write_text("")
    ran.clear()
    swept(SCENARIO.replace("[4, 5]", "[4, 6]"), fresh=True)
    assert len(ran) == 4
    assert (tmp_path / "cases" / "mine.yaml").exists()


def test_a_failed_run_has_a_row_that_says_so(swept):
    text = SCENARIO.replace("[4, 5]", "[5]").replace(f"tissue: {WALL}", "time.step: 300")
    result = swept(text)
    assert result.exit_code == 3
    fine, failed = result.rows
    assert (fine["error"], failed["verdict"]) == (None, None)
    assert "300" in failed["error"]
    lines = sweep_lines(result)
    assert any(line.endswith("failed:") for line in lines)
    table = list(csv.DictReader(io.StringIO(csv_text(result))))
    assert [row["verdict"] for row in table] == ["conduction", ""]
    assert table[1]["far.verdict"] == ""


def test_the_csv_has_one_row_a_run_and_every_number_to_ten_digits(swept):
    result = swept()
    table = list(csv.DictReader(io.StringIO(csv_text(result))))
    assert list(table[0]) == columns_of(result)
    assert [float(row["mesh.edge_length"]) for row in table] == [4, 5, 4, 5]
    for row, found in zip(table, result.rows, strict=True):
        first = found["far.first_activation"]
        written = row["far.first_activation"]
        assert written == "" if first is None else float(written) == pytest.approx(first, rel=1e-9)
        assert row["captured"] == "true"


def test_lists_and_mappings_are_json_in_the_csv():
    result = result_of([{"region": {"box": {"x": [0, 1]}}}], "region")
    (row,) = csv.DictReader(io.StringIO(csv_text(result)))
    assert json.loads(row["region"]) == {"box": {"x": [0, 1]}}


def test_rows_have_what_is_varied_and_what_was_found(swept):
    result = swept()
    names = list(result.rows[0])
    assert names[:4] == ["point", "case", "mesh.edge_length", "verdict"]
    for name in ("far.route", "reentry", "quiescent_at", "end", "step", "seconds"):
        assert name in names


def markers(figure):
    """The places of the markers in each panel, by colour."""
    found = []
    for axes in figure.axes:
        by_colour = {}
        for marks in axes.collections:
            # the cells of a map lie under its markers
            if isinstance(marks, PathCollection):
                offsets = np.asarray(marks.get_offsets())
                colour = tuple(np.round(marks.get_facecolor()[0][:3], 3))
                by_colour[colour] = sorted(map(tuple, offsets.tolist()))
        found.append(by_colour)
    return found


def colour_of(verdict):
    return tuple(round(int(STYLES[verdict][0][i : i + 2], 16) / 255, 3) for i in (1, 3, 5))


def test_two_keys_make_a_map():
    rows = [
        {"a.b": a, "c": c, "verdict": "block" if a * c > 3 else "conduction"}
        for a in (1, 2, 4)
        for c in (1, 2)
    ]
    (panel,) = markers(phase_diagram(result_of(rows, "a.b", "c")))
    assert panel[colour_of("block")] == [(2, 2), (4, 1), (4, 2)]
    assert panel[colour_of("conduction")] == [(1, 1), (1, 2), (2, 1)]


def test_one_key_makes_a_line_and_words_stand_side_by_side():
    rows = [{"mass": word, "verdict": "partial"} for word in ("lumped", "blended")]
    figure = phase_diagram(result_of(rows, "mass"))
    (panel,) = markers(figure)
    assert panel == {colour_of("partial"): [(0, 0), (1, 0)]}
    labels = [label.get_text() for label in figure.axes[0].get_xticklabels()]
    assert labels == ["lumped", "blended"]


def test_a_third_key_makes_panels_and_too_many_are_told():
    rows = [{"a": a, "b": b, "c": c} for a in (1, 2) for b in (1, 2) for c in range(14)]
    figure = phase_diagram(result_of(rows, "a", "b", "c"))
    titles = [axes.get_title() for axes in figure.axes if axes.get_title()]
    assert titles == [f"c = {c}" for c in range(12)]
    assert "12 of 14 panels" in figure.get_suptitle()
    # a key with one value spans nothing
    fixed = phase_diagram(result_of([row | {"b": 1} for row in rows], "a", "b", "c"))
    assert [axes.get_ylabel() for axes in fixed.axes] == ["c"]


def test_runs_that_failed_are_on_the_map():
    (panel,) = markers(phase_diagram(result_of([{"a": 1, "verdict": None}, {"a": 2}], "a")))
    assert panel[colour_of("failed")] == [(1, 0)]


def test_tables_have_numbers_to_the_right():
    lines = table_lines(["case", "s"], [["one", "0.5"], ["twelve", "12.0"]])
    assert lines == ["case       s", "------  ----", "one      0.5", "twelve  12.0"]
    assert table_lines(["a"], []) == ["a", "-"]
