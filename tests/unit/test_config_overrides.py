"""``--set``: what it reaches, and what it says when it does not."""

import pytest

from cardiosurf.config import load, overlay
from cardiosurf.errors import InputError

TEXT = """\
name: a
geometry: {kind: plane}
kinetics: {model: rogers_mcculloch, a: 0.1}
tissue:
  patches:
    - {name: block, region: {box: {x: [-50, 50]}}, anisotropy: {x: 10}}
    - {name: scar, region: {box: {x: [60, 70]}}, excitable: false}
stimulus:
  - {shape: point, centre: [0, 80, 0]}
time: {end: 1000}
"""


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.yaml").write_text(TEXT)
    return "a.yaml"


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("tissue.patches.block.anisotropy.x=4", lambda c: c.tissue.patches[0].anisotropy["x"] == 4),
        ("tissue.patches.0.anisotropy.y=3", lambda c: c.tissue.patches[0].anisotropy["y"] == 3),
        ("tissue.patches.block.anisotropy=4", lambda c: c.tissue.patches[0].anisotropy == 4.0),
        ("tissue.patches.scar.excitable=true", lambda c: c.tissue.patches[1].excitable),
        ("stimulus.0.centre=[0,100,80]", lambda c: c.stimulus[0].centre == (0.0, 100.0, 80.0)),
        ("stimulus.0.centre.1=7", lambda c: c.stimulus[0].centre == (0.0, 7.0, 0.0)),
        ("mesh.edge_length=1e1", lambda c: c.mesh.edge_length == 10.0),
        ("record.frames_every=null", lambda c: c.record.frames_every is None),
        ("tissue.diffusivity = 2", lambda c: c.tissue.diffusivity == 2.0),
        ("name=b=c", None),
        ("targets=[{name: t, region: {patch: block}}]", lambda c: c.targets[0].name == "t"),
    ],
)
def test_what_can_be_set(file, option, value):
    if value is None:
        with pytest.raises(InputError, match="'b=c'"):
            load(file, [option])
    else:
        assert value(load(file, [option]).config)


def test_setting_the_model_keeps_the_other_keys(file):
    kinetics = load(file, ["kinetics.model=fitzhugh_nagumo"]).config.kinetics
    assert (kinetics.model, kinetics.a) == ("fitzhugh_nagumo", 0.1)


def test_later_options_win(file):
    options = ["mesh={edge_length: 4}", "mesh.edge_length=5", "mesh.mass=lumped"]
    mesh = load(file, options).config.mesh
    assert (mesh.edge_length, mesh.mass) == (5.0, "lumped")


def test_laying_over_a_loaded_config_is_loading_with_the_options(file):
    first, then = ["mesh.edge_length=4", "mesh.mass=lumped"], ["mesh.edge_length=5"]
    assert overlay(load(file, first), then).sha256 == load(file, [*first, *then]).sha256
    with pytest.raises(InputError, match="did you mean 'edge_length'"):
        overlay(load(file), ["mesh.edge_lenght=4"])


def test_a_set_config_is_the_config_written_out(file, tmp_path):
    by_option = load(file, ["tissue.patches.block.anisotropy.x=4"])
    (tmp_path / "b.yaml").write_text(TEXT.replace("{x: 10}", "{x: 4}"))
    assert load("b.yaml").sha256 == by_option.sha256
    assert by_option.sha256 != load(file).sha256


@pytest.mark.parametrize(
    ("option", "says"),
    [
        (
            "tissue.patches.block.anisotropy.x=-4",
            ["--set tissue.patches.block.anisotropy.x=-4: -4 is not above 0"],
        ),
        (
            "tissue.patches.blok.anisotropy=4",
            ["no item 'blok'", "'block'?", "block, scar, 0 to 1"],
        ),
        ("tissue.patches.2.anisotropy=4", ["tissue.patches has no item '2'", "0 to 1"]),
        ("stimulus.1.at=4", ["stimulus has no item '1'", "allowed: 0"]),
        ("tissue.pathces.block=4", ["--set tissue.pathces.block=4", "'patches'?", "diffusivity"]),
        ("mesh.edge_lenght=4", ["--set mesh.edge_lenght=4", "'edge_length'?", "mass"]),
        ("time.end.x=4", ["time.end is 1000, which has no key 'x'"]),
        ("tissue.patches.block", ["--set tissue.patches.block: is not", "key.path=value"]),
        ("=4", ["not of the form"]),
        ("a..b=4", ["not of the form"]),
        ("mesh.edge_length=[4", ["--set mesh.edge_length=[4", "'[4' is not YAML", "quotes"]),
        ("mesh.edge_length=!!python/name:os.system x", ["--set mesh.edge_length", "refused"]),
        ("mesh={edge_length: -1}", ["--set mesh={edge_length: -1} (mesh.edge_length)", "-1"]),
        ("kinetics.model=fitzhug", ["--set kinetics.model=fitzhug", "'fitzhugh_nagumo'?"]),
        ("tissue.patches.block.region.box.x=[50,-50]", ["--set", "low to high"]),
        ("mesh.edge_length=", ["--set mesh.edge_length=", "null is not a number"]),
        ("mesh.edge_length={a: 1, a: 2}", ["--set mesh.edge_length", "twice"]),
        ("targets.left.region=4", ["--set targets.left.region=4", "is not a list"]),
    ],
)
def test_what_cannot_be_set_and_why(file, option, says):
    with pytest.raises(InputError) as caught:
        load(file, [option])
    for words in says:
        assert words in str(caught.value)


def test_the_file_is_blamed_for_what_the_file_says(file, tmp_path):
    (tmp_path / "a.yaml").write_text(TEXT.replace("{end: 1000}", "{end: -1}"))
    with pytest.raises(InputError) as caught:
        load(file, ["mesh.edge_length=3"])
    assert caught.value.where == "a.yaml:10: time.end"
