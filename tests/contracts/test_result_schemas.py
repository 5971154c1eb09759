"""What has a published schema: it is one, and what the commands really write meets it."""

import json

import jsonschema
import pytest

from cardiosurf.cli.inspect import SCHEMAS
from cardiosurf.cli.main import main

STRIP = """\
name: strip
geometry: {kind: plane, x: [0, 80], y: [0, 20]}
mesh: {edge_length: 4}
tissue: {patches: [{name: band, region: {box: {x: [40, 50]}}, anisotropy: {x: 2}}]}
stimulus: [{shape: edge, edge: left}]
time: {end: 600}
record: {frames_every: 50, probes: [{name: middle, at: [40, 5, 0]}]}
targets: [{name: far, region: {box: {x: [60, 80]}}}]
"""
# a rotor, small and coarse: its circuit, tracks and rims are all there
ROTOR = """\
name: rotor
geometry: {kind: plane, x: [-30, 30], y: [-30, 30]}
mesh: {edge_length: 5}
stimulus:
  - {shape: edge, edge: left}
  - {shape: region, region: {box: {y: [-30, 0]}}, at: 400}
time: {end: 2600}
record: {frames_every: 20, probes: [{name: corner, at: [25, 25, 0]}]}
"""
WRITTEN_BY_HAND = {"config", "scenario"}
SCENARIO = """\
name: strips
base: strip.yaml
cases:
  - {name: free, expect: {verdict: conduction}}
  - name: walled
    set: {tissue.patches: [{name: wall, region: {box: {x: [25, 55]}}, excitable: false}]}
    published: block
    expect: {verdict: block, far: block}
pairs: [{name: both, forward: free, backward: walled, target: far, expect: unidirectional}]
"""
COMMANDS = {
    "verdict": ("analyze", "{strip}", "--json"),
    "threshold": (
        *("threshold", "{folder}/strip.yaml", "--vary", "time.end", "--between", "250", "450"),
        *("--edges", "6,5,4", "--scan", "2", "--tolerance", "60", "-o", "{folder}/search"),
        "--json",
    ),
    "check": ("check", "{folder}/scenario.yaml", "-o", "{folder}/checked", "--json"),
    "prediction": ("predict", "{folder}/strip.yaml", "-o", "{folder}/predicted", "--json"),
    "discrete": ("discrete", "{folder}/strip.yaml", "--json"),
    "stop": ("discrete", "sc-ii", "--json"),
    "reentry": ("analyze", "{rotor}", "--reentry", "--json"),
    "acceleration": ("analyze", "{strip}", "--acceleration", "--json"),
}
"""The command that prints each result."""

every_schema = pytest.mark.parametrize("name", SCHEMAS)


@pytest.fixture(scope="module")
def places(tmp_path_factory):
    folder = tmp_path_factory.mktemp("schemas")
    made = {"folder": str(folder)}
    (folder / "scenario.yaml").write_text(SCENARIO)
    for name, text in (("strip", STRIP), ("rotor", ROTOR)):
        (folder / f"{name}.yaml").write_text(text)
        made[name] = str(folder / name)
        assert main(["run", str(folder / f"{name}.yaml"), "-o", made[name]]) == 0
    return made


def printed(capsys, *words):
    capsys.readouterr()
    assert main([str(word) for word in words]) == 0
    return json.loads(capsys.readouterr().out)


@every_schema
def test_it_is_a_schema_with_a_versioned_name(name, capsys):
    schema = printed(capsys, "schema", name)
    jsonschema.Draft202012Validator.check_schema(schema)
    assert schema["$id"] == f"cardiosurf/{name}/1"
    assert schema["properties"]


def test_every_result_has_a_command_here():
    assert set(COMMANDS) == set(SCHEMAS) - WRITTEN_BY_HAND


@pytest.mark.parametrize("name", COMMANDS)
def test_what_is_really_written_meets_it(name, places, capsys):
    schema = printed(capsys, "schema", name)
    data = printed(capsys, *(word.format(**places) for word in COMMANDS[name]))
    validator = jsonschema.Draft202012Validator(schema)
    validator.validate(data)
    assert next(iter(data)) == "schema"
    assert data["schema"] == schema["$id"]
    # no key may be missing and none is beside it
    assert sorted(data) == schema["required"]
    assert not validator.is_valid(data | {"more": 1})
    assert not validator.is_valid({key: data[key] for key in list(data)[:-1]})


def test_the_rotor_has_all_that_reentry_may_hold(places, capsys):
    data = printed(capsys, *(word.format(**places) for word in COMMANDS["reentry"]))
    assert data["circuit"]["encloses"]["turns"] in (-1, 1)
    assert data["phases"]["tracks"][0]["core"]["radius"] > 0.0
    assert data["phases"]["rims"][0]["length"] == pytest.approx(240.0)
