"""From YAML to a config: defaults, cross checks, and messages that help."""

import math
from pathlib import Path

import pytest

from cardiosurf.config import ConfigError, load, load_text
from cardiosurf.errors import InputError
from cardiosurf.geometry.regions import All, Box, BoxLimits, Not, Polar

CONFIGS = sorted((Path(__file__).parents[2] / "configs").glob("*.yaml"))

PLANE = """\
geometry: {kind: plane}
tissue:
  patches:
    - name: block
      region: {box: {x: [-50, 50]}}
      anisotropy: {x: 10}
    - name: scar
      region: {all: [{patch: block}, {not: {patch: block}}]}
      excitable: false
stimulus:
  - {shape: edge, edge: right}
time: {end: 1000}
targets:
  - {name: block, region: {patch: block}}
"""


def message(text: str) -> str:
    with pytest.raises(InputError) as caught:
        load_text(text, "a.yaml")
    return str(caught.value)


def changed(old: str, new: str) -> str:
    assert old in PLANE
    return PLANE.replace(old, new)


def test_defaults_are_those_of_the_brief():
    config = load_text(PLANE, "some/file name.yaml").config
    assert config.name == "file-name"
    assert (config.mesh.edge_length, config.mesh.order, config.mesh.mass) == ("auto", 1, "blended")
    assert config.accuracy == 0.005
    assert config.kinetics.model == "rogers_mcculloch"
    assert config.record.frames_every == 10.0
    assert config.geometry.x == (-100.0, 100.0)
    assert config.time.scheme == "sbdf2"


def test_references_to_patches_become_their_regions():
    config = load_text(PLANE).config
    box = Box(BoxLimits(x=(-50.0, 50.0)))
    assert config.targets[0].region == box
    assert config.tissue.patches[1].region == All((box, Not(box)))


def test_kinetics_constants_do_not_need_the_model():
    config = load_text(PLANE + "kinetics: {c2: 0.05}\n").config
    assert (config.kinetics.model, config.kinetics.c2) == ("rogers_mcculloch", 0.05)


def test_frames_can_be_switched_off():
    assert load_text(PLANE + "record: {frames_every: null}\n").config.record.frames_every is None


@pytest.mark.parametrize(
    ("written", "radians"),
    [
        ("pi", math.pi),
        ("-pi/4", -math.pi / 4),
        ("-3*pi/4", -3 * math.pi / 4),
        ("0.5 * pi", math.pi / 2),
        ("pi*3/2", 1.5 * math.pi),
        ("45 deg", math.pi / 4),
        ("-22.5deg", -math.pi / 8),
        ("90°", math.pi / 2),
        ("(1 + 2)*pi/4", 0.75 * math.pi),
        ("1.25", 1.25),
    ],
)
def test_angles_are_read_as_people_write_them(written, radians):
    text = f"""\
geometry: {{kind: sphere}}
stimulus: [{{shape: point, centre: [0, 0, 50]}}]
time: {{end: 10}}
targets: [{{name: t, region: {{polar: {{phi: [{written}, 7]}}}}}}]
"""
    region = load_text(text).config.targets[0].region
    assert isinstance(region, Polar)
    assert region.polar.phi[0] == pytest.approx(radians, rel=1e-15)


@pytest.mark.parametrize("written", ["tau", "pi/0", "__import__('os')", "pi/4 deg", "2^pi", "--pi"])
def test_what_is_no_angle_is_refused(written):
    says = message(
        f"""\
geometry: {{kind: sphere}}
stimulus: [{{shape: point, centre: [0, 0, 50]}}]
time: {{end: 10}}
targets: [{{name: t, region: {{polar: {{phi: ["{written}", 7]}}}}}}]
"""
    )
    assert "a.yaml:4: targets.t.region.polar.phi.0" in says
    assert "45 deg" in says


# what is written, and what the message must say: where, the value, what is allowed, the hint
MISTAKES = [
    (changed("plane", "plan"), ["a.yaml:1: geometry.kind", "'plan'", "'plane'?", "sphere"]),
    (changed("kind: plane", "x: [0, 1]"), ["a.yaml:1: geometry.kind", "missing", "t_domain"]),
    (changed("{kind: plane}", "plane"), ["a.yaml:1: geometry", "'plane'", "try: kind: plane"]),
    (changed("plane}", "plane, x: [3, 1]}"), ["a.yaml:1: geometry.x", "[3.0, 1.0]"]),
    (changed("plane}", "plane, x: [3]}"), ["a.yaml:1: geometry.x", "has 1 item", "[low, high]"]),
    (changed("plane}", "plane, y: [1, 2, 3]}"), ["geometry.y", "[1, 2, 3] has 3 items"]),
    (changed("kind: plane", "kind: vein, tip_radius: 200"), ["a.yaml:1: geometry.tip_radius"]),
    (changed("10}", "-10}"), ["a.yaml:6: tissue.patches.block.anisotropy.x", "-10 is not above 0"]),
    (changed("{x: 10}", "ten"), ["a.yaml:6: tissue.patches.block.anisotropy", "'ten'", "a number"]),
    (changed("{x: 10}", "{X: 10}"), ["block.anisotropy.X", "no axis 'X'", "'x'?", "x, y"]),
    (changed("{x: 10}", "{theta: 10}"), ["anisotropy.theta", "a plane has no axis", "x, y"]),
    (changed("{x: 10}", "{x: .nan}"), ["a.yaml:6", "block.anisotropy.x", ".nan is not a finite"]),
    (
        changed("{x: 10}", "2\n      frame_scaling: 2"),
        ["a.yaml:4: tissue.patches.block: ", "anisotropy and frame_scaling are both given"],
    ),
    (
        changed("anisotropy", "anisotropi"),
        ["a.yaml:6", "'anisotropi'", "did you mean 'anisotropy'"],
    ),
    (changed("box", "boks"), ["a.yaml:5", "word 'boks'", "did you mean 'box'?", "half_space"]),
    (
        changed("{box: {x: [-50, 50]}}", "{box: {}, ball: {}}"),
        ["a.yaml:5: tissue.patches.block.region", "box, ball", "{all: [{box: ...}, {ball: ...}]}"],
    ),
    (changed("{box: {x: [-50, 50]}}", "7"), ["a.yaml:5", "7 is not a region", "polar"]),
    (changed("{box: {x: [-50, 50]}}", "{all: []}"), ["region.all", "[] has 0 items", "at least 1"]),
    (changed("{x: [-50", "{w: [-50"), ["block.region.box.w", "unknown key 'w'", "x, y, z"]),
    (changed("[-50, 50]", "[50, -50]"), ["block.region.box.x", "[50, -50]", "low to high"]),
    (
        changed("{box: {x: [-50, 50]}}", "{surface: vien}"),
        ["a.yaml:5: tissue.patches.block.region.surface", "no part 'vien'", "allowed: plane"],
    ),
    (
        changed("{box: {x: [-50, 50]}}", "{polar: {phi: [0, 1]}}"),
        ["block.region.polar", "a plane has no angles", "box"],
    ),
    (
        changed("{all: [{patch: block}", "{all: [{patch: blok}"),
        ["a.yaml:8: tissue.patches.scar.region.all.0.patch", "'blok'", "did you mean 'block'?"],
    ),
    (
        changed("{not: {patch: block}}", "{not: {patch: scar}}"),
        ["scar.region.all.1.not.patch", "'scar' is not before this one", "allowed: block"],
    ),
    (changed("region: {patch: block}}", "region: {patch: bar}}"), ["a.yaml:14", "block, scar"]),
    (changed("name: scar", "name: block"), ["a.yaml:7: tissue.patches.1.name", "patches.0"]),
    (changed("name: scar", "name: a.b"), ["tissue.patches.1.name", "'a.b'", "letters"]),
    (changed("name: scar", "name: '1'"), ["tissue.patches.1.name", "index"]),
    (changed("excitable: false", "excitable: no"), ["a.yaml:9", "'no'", "true or", "try: false"]),
    (changed("edge: right", "edge: rigth"), ["a.yaml:11: stimulus.0.edge", "'right'?", "bottom"]),
    (changed("shape: edge, ", ""), ["a.yaml:11: stimulus.0.shape", "missing", "point, edge"]),
    (changed(", edge: right", ""), ["a.yaml:11: stimulus.0.edge", "key 'edge' is missing"]),
    (changed("right}", "right, at: 1000}"), ["stimulus.0.at", "1000 tu", "time.end (1000)"]),
    (
        changed("right}", "right, train: {count: 9, interval: 200}}"),
        ["a.yaml:11: stimulus.0.at", "last beat comes at 1600 tu", "time.end: 2600"],
    ),
    (changed("right}", "right, duration: 2}"), ["a.yaml:11: stimulus.0.duration", "strength"]),
    (
        changed("right}", "right, train: {count: 1000000000, interval: 1}}"),
        ["a.yaml:11: stimulus.0.train.count", "1000000000 is above 10000", "from 1 to 10000"],
    ),
    (changed("right}", "right, train: 5}"), ["stimulus.0.train", "5 is not a mapping", "count"]),
    (
        changed("  - {shape: edge, edge: right}", "  []"),
        ["stimulus", "[] has 0 items", "at least 1"],
    ),
    (
        changed("{end: 1000}", "{end: '1000'}"),
        ["a.yaml:12: time.end", "'1000'", "remove the quotes"],
    ),
    (changed("{end: 1000}", "{end: true}"), ["a.yaml:12: time.end", "true is not a number"]),
    (changed("{end: 1000}", "{end: .inf}"), ["a.yaml:12: time.end", ".inf is not a finite"]),
    (changed("{end: 1000}", "{end: 1" + "0" * 500 + "}"), ["a.yaml:12: time.end", "finite"]),
    (
        changed("{end: 1000}", "{}"),
        ["a.yaml:12: time.end", "missing", "a number from 1e-06 to 1e+07"],
    ),
    (changed("{end: 1000}", "{end: 9, step: fast}"), ["time.step", "'fast'", "or auto"]),
    (changed("{end: 1000}", "{end: 9, step: 10}"), ["time.step", "10 tu", "9 tu", "step: auto"]),
    (changed("{end: 1000}", "{end: 9, scheme: sbdf}"), ["time.scheme", "'sbdf2'?", "cnab2"]),
    (changed("time: {end: 1000}\n", ""), ["a.yaml: time: key 'time' is missing", "end, step"]),
    (changed("targets", "target"), ["a.yaml:13: target", "did you mean 'targets'?", "geometry"]),
    (PLANE + "mesh: {edge_length: -2}\n", ["a.yaml:15: mesh.edge_length", "-2", "from 0.1 to 50"]),
    (PLANE + "mesh: {edge_length: 99}\n", ["mesh.edge_length", "99 is above 50"]),
    (PLANE + "mesh: {order: 2}\n", ["mesh.order", "2 is not allowed", "allowed: 1"]),
    (PLANE + "kinetics: {model: rogers}\n", ["kinetics.model", "'rogers_mcculloch'?"]),
    (PLANE + "kinetics: {model: 3}\n", ["kinetics.model", "unknown model 3", "fitzhugh_nagumo"]),
    (PLANE + "name: ../up\n", ["a.yaml:15: name", "'../up'", "100 letters, digits"]),
    (PLANE + "record: {probes: [{name: a, at: [0, 0]}]}\n", ["record.probes.a.at", "3 numbers"]),
]


@pytest.mark.parametrize(("text", "says"), MISTAKES, ids=[" ".join(s) for _, s in MISTAKES])
def test_a_message_names_place_value_allowed_and_hint(text, says):
    given = message(text)
    for words in says:
        assert words in given
    # one mistake, one message
    assert "problems" not in given


def test_all_mistakes_of_a_file_come_together_in_its_order():
    text = changed("plane", "plan").replace("10}", "-1}").replace("{end: 1000}", "{stop: 3}")
    with pytest.raises(ConfigError) as caught:
        load_text(text, "a.yaml")
    places = [problem.where for problem in caught.value.problems]
    assert places == [
        "a.yaml:1: geometry.kind",
        "a.yaml:6: tissue.patches.block.anisotropy.x",
        "a.yaml:12: time.end",
        "a.yaml:12: time.stop",
    ]
    assert str(caught.value).startswith("a.yaml: 4 problems\n")


def test_very_many_mistakes_are_cut_off():
    many = "\n".join(f"  - {{name: p{i}, region: {{box: {i}}}}}" for i in range(14))
    text = message(PLANE.partition("targets")[0] + "targets:\n" + many)
    assert "14 problems" in text
    assert "... and 4 more" in text
    assert text.count("allowed:") == 10


def test_errors_of_later_steps_are_given_file_and_line(tmp_path):
    file = tmp_path / "a.yaml"
    file.write_text(PLANE)
    loaded = load(file, ["tissue.patches.block.anisotropy.x=4"])
    for where, expected in {
        "tissue.patches.block": f"{file}:4: tissue.patches.block",
        "tissue.patches.scar.region": f"{file}:8: tissue.patches.scar.region",
        "stimulus.0.centre": f"{file}:11: stimulus.0.centre",
        "mesh.edge_length": f"{file}: mesh.edge_length",
        "tissue.patches.block.anisotropy.x": "--set tissue.patches.block.anisotropy.x=4",
        "": "",
        "runs/a": "runs/a",
    }.items():
        with pytest.raises(InputError) as caught, loaded.naming_lines():
            raise InputError(where, "wrong")
        assert caught.value.where == expected


@pytest.mark.parametrize("file", CONFIGS, ids=lambda path: path.name)
def test_shipped_configs_load(file):
    assert load(file).config.targets
