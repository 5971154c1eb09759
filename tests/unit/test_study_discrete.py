"""The study of Appendix B's units: kept results, the page's table, and what is asked again."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cardiosurf.errors import InputError
from cardiosurf.report.critical_section import MISSING
from cardiosurf.report.discrete_study import BEGIN, END, study_table, with_table
from cardiosurf.study.discrete_questions import QUESTIONS, Asked, Played, Question
from cardiosurf.study.discrete_study import Study, update
from cardiosurf.study.results import Results

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs/theory.md"
BY_NAME = {question.name: question for question in QUESTIONS}


@pytest.fixture(scope="module")
def kept():
    return Study(ROOT, Results(ROOT / "docs/results"), ROOT / "runs/none")


def simulated(kept, name):
    (change,) = kept.entries()[name]["simulated"]["changes"]
    return change["value"], change["error"]


def test_the_table_on_the_page_is_that_of_the_kept_results(kept):
    page = PAGE.read_text()
    lines = study_table(kept)
    assert with_table(page, lines) == page
    assert not any(MISSING in line for line in lines)


def test_every_kept_result_answers_what_is_asked_now(kept):
    assert [name for name, entry in kept.entries().items() if entry is None] == []
    assert set(kept.results.read("discrete")) == set(BY_NAME)


def test_the_simulated_face_is_the_jump_that_a_straight_front_passes(kept):
    value, error = simulated(kept, "face")
    # marches along a line, known to 0.2 %: docs/theory.md, analysis/critical_jump.py
    assert value == pytest.approx(7.49, abs=error + 0.015)


def test_the_strands_two_walls_hold_its_width_between_them(kept):
    # an excitable wall helps, a passive one loads, both by a part of an edge
    helped, loaded = (
        kept.entries()[name]["simulated"]["changes"][0]["levels"]
        for name in ("strand", "strand-passive-wall")
    )
    for one, other in zip(helped, loaded, strict=True):
        assert one["high"] < other["low"]
    # of first order, so that lines to edge 0 meet; brackets of +-0.02 move each by 0.03
    ends = [
        np.polyfit(
            [one["edge_length"] for one in levels],
            [0.5 * (one["low"] + one["high"]) for one in levels],
            1,
        )[1]
        for levels in (helped, loaded)
    ]
    assert ends[0] == pytest.approx(ends[1], abs=0.06)


def test_the_units_answers_are_those_by_hand(kept):
    entries = kept.entries()
    for word, n_max in (("3", 3.0), ("2.75", 2.75)):
        packed = entries["face-packed"]["units"][word]["value"]
        assert packed == pytest.approx((4.0 * n_max**2 - 1.0) / 3.0, abs=2e-3)
        # triangles: N_max^2 where links lie along x, more where they do not
        for search in entries["face"]["units"][word]["searches"]:
            assert all(one["high"] > n_max**2 for one in search["changes"])
        assert not any(one["changes"] for one in entries["face-speed"]["units"][word]["searches"])


def test_what_is_there_is_not_asked_again_and_what_was_changed_is(tmp_path):
    said = []
    study = Study(ROOT, Results(tmp_path / "results"), tmp_path / "runs", said.append)
    small = replace(BY_NAME["sphere-north"], units=Played("sphere/north", 8.0))
    update(study, [small])
    # the registry asks it on edges of 3.5: this answer is another one's, and asked again
    assert said == ["sphere-north: asked"]
    entry = study.results.read("discrete")["sphere-north"]
    assert entry["simulated"] is None
    assert set(entry["units"]["3"]["targets"]) == {"block"}
    assert study.entries()["sphere-north"] is None
    study.results.keep(
        "discrete", "sphere-north", entry | {"asked": study.asked(BY_NAME["sphere-north"])}
    )
    update(study, [BY_NAME["sphere-north"]])
    assert said == ["sphere-north: asked"]


def test_a_case_that_is_not_there_is_named(tmp_path):
    study = Study(ROOT, Results(tmp_path), tmp_path)
    asked = Question("x", "x", "face", Played("sphere/east"))
    with pytest.raises(InputError, match="sphere/east"):
        study.asked(asked)


def test_a_page_without_a_place_is_refused():
    assert with_table(f"a\n{BEGIN}\nold\n{END}\nb", ["new"]) == f"a\n{BEGIN}\n\nnew\n\n{END}\nb"
    for page in ("", BEGIN, f"{END} {BEGIN}"):
        with pytest.raises(InputError, match="no place for the table"):
            with_table(page, ["new"])


@pytest.mark.slow
def test_the_disc_is_found_again(tmp_path, kept):
    study = Study(ROOT, Results(tmp_path / "results"), tmp_path / "runs")
    update(study, [BY_NAME["disc"]])
    entry = study.results.read("discrete")["disc"]
    (change,) = entry["simulated"]["changes"]
    value, error = simulated(kept, "disc")
    assert change["value"] == pytest.approx(value, abs=error)
    assert entry["units"] == kept.entries()["disc"]["units"]


@pytest.mark.parametrize(
    "name", [one.name for one in QUESTIONS if isinstance(one.simulated, Asked)]
)
def test_configs_of_the_study_are_shipped(name, kept):
    asked = BY_NAME[name].simulated
    loaded = kept.config(asked.config, asked.set)
    value = loaded.document.value_at(asked.vary)
    assert asked.between[0] < value < asked.between[1]
