"""Scenario files: what they mean, and what is said of wrong ones."""

import json
from pathlib import Path

import jsonschema
import pytest

from cardiosurf.config.difference import config_differences
from cardiosurf.config.reader import read_document
from cardiosurf.config.scenario import scenario_schema
from cardiosurf.config.scenario_file import read_scenario, scenario_paths
from cardiosurf.errors import InputError

SHIPPED = scenario_paths([Path(__file__).parents[2] / "scenarios"])
VALIDATOR = jsonschema.Draft202012Validator(scenario_schema())
BASE = """\
name: strip
geometry: {kind: plane, x: [0, 80], y: [0, 10]}
mesh: {edge_length: 2.5}
stimulus: [{shape: edge, edge: left}]
time: {end: 900}
record: {probes: [{name: middle, at: [40, 5, 0]}]}
targets: [{name: far, region: {box: {x: [60, 80]}}}]
"""
GOOD = """\
name: strips
base: base.yaml
set: {time.end: 800}
fast: {set: {mesh.edge_length: 5}}
cases:
  - name: one
    expect: {verdict: conduction}
  - name: two
    set: {time.end: 700, targets.far.region.box.x.0: 70}
    expect: {far: block}
    fast: {set: {mesh.edge_length: 4}}
pairs:
  - {name: both, forward: one, backward: two, target: far, expect: unidirectional}
grid: {time.step: [1, 2]}
"""


@pytest.fixture
def read(tmp_path):
    """Return a function that reads a scenario from its text."""
    (tmp_path / "base.yaml").write_text(BASE)

    def from_text(text):
        path = tmp_path / "scenario.yaml"
        path.write_text(text)
        return read_scenario(path)

    return from_text


def test_settings_lie_over_each_other(read):
    one, two = read(GOOD).cases()
    assert (one.loaded.config.time.end, two.loaded.config.time.end) == (800, 700)
    assert two.loaded.config.targets[0].region.box.x == (70, 80)
    # no verdict is read off frames
    assert one.loaded.config.record.frames_every is None
    assert [case.loaded.config.mesh.edge_length for case in (one, two)] == [2.5, 2.5]
    assert not one.coarsened


def test_fast_lies_over_the_cases_and_a_case_may_have_its_own(read):
    cases = read(GOOD).cases(fast=True)
    assert [case.loaded.config.mesh.edge_length for case in cases] == [5, 4]
    assert all(case.coarsened for case in cases)
    unstated = read(GOOD.replace("fast: {set: {mesh.edge_length: 5}}\n", "")).cases(fast=True)
    assert unstated[0].loaded.config.mesh.edge_length == 2.5
    assert [case.coarsened for case in unstated] == [False, True]


def test_each_case_is_swept(read):
    points = read(GOOD).points()
    assert [point.name for point in points] == [
        "one_step-1",
        "one_step-2",
        "two_step-1",
        "two_step-2",
    ]
    assert [point.loaded.config.time.step for point in points] == [1, 2, 1, 2]
    assert [point.loaded.config.time.end for point in points] == [800, 800, 700, 700]


@pytest.mark.parametrize(
    ("old", "new", "line", "says"),
    [
        ("base: base.yaml", "base: bse.yaml", 2, "no such file"),
        ("base: base.yaml", "bas: base.yaml", 2, "did you mean 'base'?"),
        ("set: {time.end: 800}", "set: {time.ned: 800}", 3, "did you mean 'end'?"),
        ("{time.end: 700", "{time.end: soon", 9, "'soon' is not a number"),
        ("targets.far.", "targets.fra.", 9, "did you mean 'far'?"),
        ("name: two", "name: one", 8, "'one' is there twice"),
        ("{far: block}", "{fra: block}", 10, "did you mean 'far'?"),
        ("{mesh.edge_length: 4}", "{mesh.edge_length: -4}", 11, "-4 is not above 0"),
        ("backward: two", "backward: tow", 13, "did you mean 'two'?"),
        ("target: far", "target: fra", 13, "did you mean 'far'?"),
        ("expect: unidirectional", "expect: both", 13, "'both' is not allowed"),
        ("[1, 2]", "[]", 14, "has 0 items"),
        ("[1, 2]", "[1, -2]", 14, "-2 is not above 0"),
    ],
)
def test_a_mistake_is_named_with_file_and_line(read, tmp_path, old, new, line, says):
    assert old in GOOD
    with pytest.raises(InputError) as caught:  # noqa: PT012 - reading is done in steps
        file = read(GOOD.replace(old, new))
        file.cases(fast=True)
        file.points()
    first = str(caught.value)
    assert f"{tmp_path / 'scenario.yaml'}:{line}: " in first
    assert says in first
    assert "allowed:" in first


def test_a_config_is_no_scenario(tmp_path, read):
    with pytest.raises(InputError, match="is a config, not a scenario"):
        read(BASE)
    with pytest.raises(InputError, match="varies nothing"):
        read(GOOD.replace("grid: {time.step: [1, 2]}", "")).points()


def test_folders_and_files_are_taken_once(tmp_path):
    for name in ("b.yaml", "a.yml", "notes.txt"):
        (tmp_path / name).write_text("")
    found = scenario_paths([tmp_path / "b.yaml", tmp_path])
    assert [path.name for path in found] == ["b.yaml", "a.yml"]
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="holds no scenario"):
        scenario_paths([tmp_path / "empty"])


@pytest.mark.parametrize("path", SHIPPED, ids=[path.stem for path in SHIPPED])
def test_the_schema_accepts_the_shipped_scenarios(path):
    VALIDATOR.validate(read_document(str(path)).data)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("base: base.yaml", "bas: base.yaml"),
        ("name: two", "nam: two"),
        ("expect: unidirectional", "expect: both"),
        ("[1, 2]", "[]"),
        ("set: {time.end: 800}", "set: [time.end]"),
    ],
)
def test_the_schema_refuses_what_the_reader_refuses(read, tmp_path, old, new):
    (tmp_path / "one.yaml").write_text(GOOD)
    VALIDATOR.validate(read_document(str(tmp_path / "one.yaml")).data)
    (tmp_path / "one.yaml").write_text(GOOD.replace(old, new))
    with pytest.raises(jsonschema.ValidationError):
        VALIDATOR.validate(read_document(str(tmp_path / "one.yaml")).data)


def test_the_schema_is_json_and_published_with_descriptions():
    schema = scenario_schema()
    assert json.loads(json.dumps(schema)) == schema
    assert "question" in schema["properties"]
    assert "check --fast" in schema["properties"]["fast"]["description"]


def test_differences_are_told_key_by_key(read):
    one, two = (case.loaded.text for case in read(GOOD).cases())
    assert config_differences(one, two) == [
        "time.end: 800.0 -> 700.0",
        "targets.far.region.box.x: [60.0, 80.0] -> [70.0, 80.0]",
    ]
    assert config_differences("a: {b: 1}", "c: [1]") == [
        "a.b: 1 -> nothing",
        "c: nothing -> [1]",
    ]
