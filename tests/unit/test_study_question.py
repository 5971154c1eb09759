"""What a search asks of a run, and on which meshes it asks."""

import pytest

from cardiosurf.config import load_text
from cardiosurf.errors import InputError
from cardiosurf.report.threshold_lines import with_error
from cardiosurf.study.question import QUESTIONS, Question, parse_question
from cardiosurf.study.threshold_plan import key_path, plan_levels, plan_search

CONFIG = """\
geometry: {kind: plane, x: [0, 80], y: [0, 80]}
mesh: {edge_length: 2.5}
stimulus: [{shape: edge, edge: left}]
time: {end: 900}
"""


def verdict(**given):
    targets = [
        {"name": "block", "verdict": "partial", "route": "indirect"},
        {"name": "core", "verdict": "block", "route": None},
        {"name": "rest", "verdict": "conduction", "route": "direct"},
    ]
    return {
        "captured": True,
        "verdict": "block",
        "targets": targets,
        "reentry": {"verdict": "transient"},
        "quiescent_at": 800.0,
        **given,
    }


@pytest.mark.parametrize(
    ("asked", "answer"),
    [
        ("conduction", "no conduction"),
        ("conduction:rest", "conduction"),
        ("conduction:block", "no conduction"),
        ("verdict", "block"),
        ("reentry", "transient"),
        ("target:block", "partial"),
        ("target:core", "block"),
        ("route:block", "indirect"),
        ("route:core", "not activated"),
    ],
)
def test_the_answer_is_read_off_the_verdict(asked, answer):
    question = parse_question(asked, ["block", "core", "rest"])
    assert question.answer(verdict()) == answer
    assert str(question) == asked


@pytest.mark.parametrize("word", QUESTIONS)
def test_a_stimulus_that_starts_no_wave_answers_nothing_else(word):
    assert Question(word, "rest").answer(verdict(captured=False)) == "no_capture"


def test_what_a_longer_run_may_change_is_open():
    running = verdict(quiescent_at=None)
    assert Question("conduction").is_open(running)
    assert not Question("conduction").is_open(verdict())
    # what was activated stays so
    assert not Question("conduction", "rest").is_open(running)


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ("conducts", "did you mean 'conduction'?"),
        ("target:cor", "did you mean 'core'?"),
        ("target", "which target?"),
        ("reentry:core", "takes no target"),
    ],
)
def test_what_cannot_be_asked(asked, says):
    with pytest.raises(InputError, match="--of") as caught:
        parse_question(asked, ["block", "core"])
    assert says in str(caught.value)


def test_meshes_lie_around_that_of_the_config_and_steps_go_with_them():
    levels = plan_levels(load_text(CONFIG))
    assert [level.edge_length for level in levels] == [3.54, 2.5, 1.77]
    # auto is 1.2 at an accuracy of 0.5 % (docs/numerics.md), on the coarsest
    assert [level.step for level in levels] == [1.2, 0.8475, 0.6]


def test_given_edges_are_sorted():
    levels = plan_levels(load_text(CONFIG), [2.0, 4.0, 1.0])
    assert [(level.edge_length, level.step) for level in levels] == [(4, 1.2), (2, 0.6), (1, 0.3)]


def test_meshes_are_finer_where_the_shape_is_too_small():
    small = CONFIG.replace("[0, 80], y: [0, 80]", "[0, 80], y: [0, 6]").replace("2.5", "5")
    assert [level.edge_length for level in plan_levels(load_text(small))] == [5, 3.54, 2.5]


def test_key_paths_in_either_spelling():
    assert key_path("stimulus[0].centre[1]") == key_path("stimulus.0.centre.1")
    assert key_path(" tissue.patches[scar].diffusivity ") == "tissue.patches.scar.diffusivity"


def test_the_tolerance_goes_with_the_interval():
    search = plan_search((10.0, 6.0), None, scan=9, workers=2)
    assert (search.low, search.high, search.tolerance) == (6.0, 10.0, 0.01)


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (7.83817, 0.0312, "7.838 +- 0.032"),
        (7.5, 0.25, "7.50 +- 0.25"),
        (103.2, 12.1, "103 +- 13"),
        (9.0, 0.0, "9 +- 0"),
    ],
)
def test_a_value_has_the_digits_that_its_error_allows(value, error, text):
    assert with_error(value, error) == text
