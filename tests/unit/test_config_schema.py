"""The JSON Schema agrees with the loader."""

import json
from pathlib import Path

import jsonschema
import pytest

from cardiosurf.config import config_schema, dump_config, load
from cardiosurf.config.reader import parse_document, read_document

CONFIGS = sorted((Path(__file__).parents[2] / "configs").glob("*.yaml"))
SCHEMA = config_schema()
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)

TEXT = """\
geometry: {kind: plane}
mesh: {edge_length: 2.5}
tissue:
  patches:
    - {name: block, region: {box: {x: [-50, 50], y: [-50, 50]}}, anisotropy: {x: 10}}
stimulus:
  - {shape: edge, edge: right}
time: {end: 2000}
targets:
  - {name: block, region: {patch: block}}
"""


def test_it_is_a_schema_that_editors_can_read():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    assert json.loads(json.dumps(SCHEMA)) == SCHEMA
    assert SCHEMA["required"] == ["geometry", "stimulus", "time"]


@pytest.mark.parametrize("file", CONFIGS, ids=lambda path: path.name)
def test_it_accepts_the_shipped_configs_and_their_resolved_form(file):
    VALIDATOR.validate(read_document(str(file)).data)
    VALIDATOR.validate(parse_document(dump_config(load(file).config), "resolved").data)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("kind: plane", "kind: plan"),
        ("kind: plane", "kind: sphere, x: [0, 1]"),
        ("mesh:", "meshes:"),
        ("edge_length: 2.5", "edge_length: -2.5"),
        ("edge_length: 2.5", "edge_lenght: 2.5"),
        ("anisotropy: {x: 10}", "anisotropy: {x: ten}"),
        ("box: {x: [-50, 50], y", "boks: {x: [-50, 50], y"),
        ("x: [-50, 50]", "x: [-50]"),
        ("shape: edge", "shape: point"),
        ("end: 2000", "end: soon"),
        ("{patch: block}", "{patch: block, surface: plane}"),
    ],
)
def test_it_refuses_what_the_loader_refuses(old, new):
    assert old in TEXT
    VALIDATOR.validate(parse_document(TEXT, "a").data)
    assert not VALIDATOR.is_valid(parse_document(TEXT.replace(old, new), "a").data)


@pytest.mark.parametrize(
    ("fibres", "right"),
    [
        ({"circles": {"centre": [0, 0, 0]}}, True),
        ({"circles": {"centre": [0, 0, 0], "pitch": "45 deg"}}, True),
        ({"angle": "sin(x)"}, True),
        ({"angle": 0.5}, True),
        ({"angle": ""}, False),
        ({"angle": None}, False),
        ({"circles": {"pitch": 1}}, False),
        ({"circle": {"centre": [0, 0, 0]}}, False),
        ({"angle": 0, "circles": {"centre": [0, 0, 0]}}, False),
    ],
)
def test_it_knows_fibres(fibres, right):
    data = parse_document(TEXT, "a").data
    data["tissue"]["patches"][0] |= {"fibres": fibres, "anisotropy": {"along": 8}}
    assert VALIDATOR.is_valid(data) == right


@pytest.mark.parametrize("angle", ["pi/4", "-3*pi/4", "45 deg", "-22.5deg", "0.5 * pi", 0.3])
def test_it_knows_angles(angle):
    region = {"polar": {"phi": [angle, 9]}}
    data = {
        "geometry": {"kind": "sphere"},
        "stimulus": [{"shape": "region", "region": region}],
        "time": {"end": 1},
    }
    VALIDATOR.validate(data)


def test_keys_are_described_in_the_words_of_the_docstrings():
    definitions = SCHEMA["$defs"]
    edge = definitions["MeshSection"]["properties"]["edge_length"]
    assert edge["description"].startswith("Target length of the triangles' edges, in su")
    assert "polar angle" in definitions["Sphere"]["description"]
    described = [
        key.get("description")
        for section in ("Patch", "PointStimulus", "RecordSection", "MeshSection")
        for key in definitions[section]["properties"].values()
    ]
    # all keys of these sections but the inherited ones and the discriminators say what they are
    assert sum(text is not None for text in described) >= 14
