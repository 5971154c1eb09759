"""analyze --acceleration: what it prints and writes, and what it refuses."""

import json

import meshio
import numpy as np
import pytest

from cardiosurf.recording.hdf5 import read_recording


def test_it_writes_a_map_and_prints_what_was_measured(cardiosurf, whole, tmp_path):
    done = cardiosurf("analyze", whole, "--acceleration", "-o", tmp_path / "out")
    assert (done.returncode, done.stderr) == (0, "")
    assert "relative acceleration |n|''/|n|" in done.stdout
    assert sorted(one.name for one in (tmp_path / "out").iterdir()) == [
        "relative_acceleration.png",
        "relative_acceleration.vtu",
    ]
    assert (tmp_path / "out/relative_acceleration.png").read_bytes()[:4] == b"\x89PNG"
    mesh = meshio.read(tmp_path / "out/relative_acceleration.vtu")
    recording = read_recording(whole / "recording.h5")
    np.testing.assert_array_equal(mesh.point_data["LAT [tu]"], recording.first_activation)
    value = mesh.point_data["relative acceleration [1 per tu^2]"]
    error = mesh.point_data["relative acceleration error [1 per tu^2]"]
    # the paper's terms beside it: on an even strip nothing changes along a straight front
    (change,) = (mesh.cell_data[name][0] for name in mesh.cell_data if "of_change" in name)
    assert np.nanmax(np.abs(change)) < 1e-9
    # NaN where nothing was measured, with its error
    np.testing.assert_array_equal(np.isnan(value), np.isnan(error))


def test_numbers_as_json_by_tissue(cardiosurf, strip, tmp_path):
    patch = "tissue={patches: [{name: block, region: {box: {x: [60, 80]}}, anisotropy: {x: 2}}]}"
    words = ("--set", patch, "--set", "geometry.y=[0, 40]", "-o", tmp_path / "run")
    assert cardiosurf("run", strip, *words).returncode == 0
    done = cardiosurf("analyze", tmp_path / "run", "--acceleration", "--json")
    data = json.loads(done.stdout)
    assert [one["name"] for one in data["areas"]] == [
        "outside patches",
        "block",
        "edge of block",
    ]
    outside, _, edge = data["areas"]
    # between the stimulus and the reach of the block's edge the front is straight
    assert abs(outside["relative"]) < 1e-6
    assert outside["agree"] > 0.95
    # 9 edges of 2.5 su: 60 - 22.5 su of 40, and 12 su to each side of the edge
    assert outside["vertices"] == pytest.approx(37.5 * 40 / (2.5**2 * 0.866), rel=0.15)
    assert edge["vertices"] == pytest.approx(24 * 40 / (2.5**2 * 0.866), rel=0.15)
    # files lie beside the recording, and go with it
    assert (tmp_path / "run/relative_acceleration.vtu").exists()
    assert cardiosurf("run", strip, *words, "--overwrite").returncode == 0
    assert not (tmp_path / "run/relative_acceleration.vtu").exists()
    assert not (tmp_path / "run/relative_acceleration.png").exists()


def test_a_run_in_which_nothing_moved_is_no_error(cardiosurf, strip, tmp_path):
    words = ("--set", "stimulus.0.amplitude=0.3", "--set", "time.end=50", "-o", tmp_path / "run")
    assert cardiosurf("run", strip, *words).returncode == 0
    done = cardiosurf("analyze", tmp_path / "run", "--acceleration")
    assert (done.returncode, done.stderr) == (0, "")
    assert "nothing measured" in done.stdout
    assert "nan" not in done.stdout
    told = cardiosurf("analyze", tmp_path / "run", "--acceleration", "--json")
    assert json.loads(told.stdout, parse_constant=pytest.fail)["window"] is None


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--acceleration", "--reentry"), "one of them"),
        (("-o", "somewhere"), "-o with --acceleration only"),
    ],
)
def test_options_that_contradict_each_other(cardiosurf, whole, words, said):
    done = cardiosurf("analyze", whole, *words)
    assert done.returncode == 2
    assert said in done.stderr


def test_a_folder_in_the_way_of_one_file_keeps_all_from_being_written(cardiosurf, whole, tmp_path):
    (tmp_path / "out/relative_acceleration.png").mkdir(parents=True)
    done = cardiosurf("analyze", whole, "--acceleration", "-o", tmp_path / "out")
    assert done.returncode == 2
    assert "relative_acceleration.png: cannot be written" in done.stderr
    assert [one.name for one in (tmp_path / "out").iterdir()] == ["relative_acceleration.png"]


def test_a_file_in_the_way_is_named(cardiosurf, whole, tmp_path):
    (tmp_path / "out").write_text("mine")
    done = cardiosurf("analyze", whole, "--acceleration", "-o", tmp_path / "out")
    assert (done.returncode, (tmp_path / "out").read_text()) == (2, "mine")
    assert "cannot be written" in done.stderr
    assert "Traceback" not in done.stderr
