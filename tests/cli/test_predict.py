"""The command predict."""

import json

import meshio
import numpy as np
import pytest

PATCH = "tissue={patches: [{name: block, region: {box: {x: [30, 50]}}, anisotropy: {x: 4}}]}"


def test_it_prints_and_writes_what_is_predicted(cardiosurf, strip, tmp_path):
    done = cardiosurf("predict", strip, "--set", PATCH, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "patch block: entrance 10 su" in done.stdout
    written = json.loads((tmp_path / "out/prediction.json").read_text())
    assert written["schema"] == "cardiosurf/prediction/1"
    # head on to 4: the root of it
    assert written["patches"][0]["flux_ratio"] == pytest.approx(2.0, rel=1e-3)
    assert (tmp_path / "out/prediction.png").read_bytes()[:4] == b"\x89PNG"
    assert sorted(one.name for one in (tmp_path / "out").iterdir()) == [
        "prediction.json",
        "prediction.png",
        "prediction.vtu",
    ]
    # a plane wave that meets fibres along its way head on: both terms are derivatives along the
    # front, of which there are none; of_spread is what it meets: d log d/dx, up to
    # 2 (2 ln 9/12) (sqrt 4 - 1)/(sqrt 4 + 1) of an edge of 10 to 90 % over 12 su
    maps = meshio.read(tmp_path / "out/prediction.vtu")
    assert np.nanmax(maps.point_data["arrival without patches [tu]"]) == pytest.approx(
        written["last_undisturbed"]
    )
    terms = {name.split()[0]: values[0] for name, values in maps.cell_data.items()}
    assert np.nanmax(np.abs(terms["of_change"])) < 0.01
    assert np.nanmax(terms["of_spread"]) > 0.05


def test_json_is_what_is_written(cardiosurf, strip, tmp_path):
    done = cardiosurf("predict", strip, "--set", PATCH, "-o", tmp_path / "out", "--json")
    assert json.loads(done.stdout) == json.loads((tmp_path / "out/prediction.json").read_text())


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--set", "kinetics={model: fitzhugh_nagumo}"), "carries no wave"),
        (("--set", "tissue.patches.none.anisotropy=2"), "tissue.patches"),
        (("--set", PATCH, "--width", "1"), "at least 2 edge lengths"),
        (("--width", "0"), "--width"),
        (("--set", PATCH, "--width", "inf"), "at most the surface's own width"),
        (("--set", PATCH, "--width", "1e300"), "at most the surface's own width"),
        (("--set", "stimulus=[{shape: edge, edge: left, amplitude: 0.3}]"), "no front starts"),
    ],
)
def test_what_is_wrong_is_said(cardiosurf, strip, tmp_path, words, said):
    done = cardiosurf("predict", strip, *words, "-o", tmp_path / "out")
    assert done.returncode == 2
    assert said in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", ["prediction.json", "prediction.vtu", "prediction.png"])
def test_a_folder_in_the_way_of_one_file_keeps_all_from_being_written(
    cardiosurf, strip, tmp_path, name
):
    (tmp_path / "out" / name).mkdir(parents=True)
    done = cardiosurf("predict", strip, "-o", tmp_path / "out")
    assert done.returncode == 2
    assert f"{name}: cannot be written" in done.stderr
    assert [one.name for one in (tmp_path / "out").iterdir()] == [name]


def test_a_file_in_the_way_is_named(cardiosurf, strip, tmp_path):
    (tmp_path / "out").write_text("mine")
    done = cardiosurf("predict", strip, "-o", tmp_path / "out")
    assert (done.returncode, (tmp_path / "out").read_text()) == (2, "mine")
    assert "cannot be written" in done.stderr
