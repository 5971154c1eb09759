import shutil

import meshio
import numpy as np
import pytest
from meshio.xdmf import TimeSeriesReader
from recording_samples import sample_recording

from cardiosurf.recording.hdf5 import write_recording
from cardiosurf.recording.recording import FrameSeries
from cardiosurf.recording.xdmf import write_xdmf


@pytest.fixture
def moved(tmp_path):
    """A folder with recording and XDMF files that was moved after they were written."""
    (tmp_path / "first").mkdir()
    write_recording(tmp_path / "first" / "recording.h5", sample_recording())
    written = write_xdmf(tmp_path / "first" / "recording.h5")
    assert [path.name for path in written] == ["recording.xdmf", "recording_maps.xdmf"]
    shutil.move(tmp_path / "first", tmp_path / "second")
    return tmp_path / "second"


def test_frames_read_back_as_a_time_series(moved):
    recording = sample_recording()
    with TimeSeriesReader(moved / "recording.xdmf") as reader:
        points, cells = reader.read_points_cells()
        assert np.array_equal(points, recording.surface.points)
        assert cells[0].type == "triangle"
        assert np.array_equal(cells[0].data, recording.surface.triangles)
        assert reader.num_steps == 3
        for index, expected in enumerate(recording.frames.times):
            time, nodal, cellwise = reader.read_data(index)
            assert time == expected
            assert np.array_equal(nodal["u"], recording.frames.u[index])
            assert np.array_equal(nodal["v"], recording.frames.v[index])
            assert np.array_equal(nodal["LAT [tu]"], recording.first_activation, equal_nan=True)
            assert np.array_equal(cellwise["patch"][0], recording.tissue.patch_of)


def test_maps_read_back_as_a_mesh(moved):
    recording = sample_recording()
    mesh = meshio.read(moved / "recording_maps.xdmf")
    assert np.array_equal(mesh.points, recording.surface.points)
    assert np.array_equal(mesh.cells_dict["triangle"], recording.surface.triangles)
    nodal, cellwise = mesh.point_data, mesh.cell_data
    assert np.array_equal(nodal["LAT [tu]"], recording.first_activation, equal_nan=True)
    assert np.array_equal(nodal["activations"], recording.activation_count)
    assert np.array_equal(cellwise["part"][0], recording.surface.part_of)
    assert np.array_equal(cellwise["d11 [su^2 per tu]"][0], recording.tissue.tensor[:, 0, 0])
    assert np.array_equal(cellwise["d22 [su^2 per tu]"][0], recording.tissue.tensor[:, 1, 1])
    # the strip's diffusivity is four times as large along x
    along_x = np.outer(recording.patches["strip"], [1.0, 0.0, 0.0])
    assert np.array_equal(np.abs(cellwise["fibre"][0]), along_x)


def test_the_files_are_small_and_name_the_recording_relatively(moved):
    text = (moved / "recording.xdmf").read_text()
    assert "recording.h5:/frames/by_time/u_00002" in text
    assert "/first" not in text.replace("activation/first", "").replace("repolarisation/first", "")
    # the views store nothing twice
    assert (moved / "recording.xdmf").stat().st_size < 20_000


def test_a_recording_without_frames_has_maps_only(tmp_path):
    recording = sample_recording()
    object.__setattr__(recording, "frames", FrameSeries.none(recording.node_count))
    write_recording(tmp_path / "run.h5", recording)
    assert write_xdmf(tmp_path / "run.h5") == (tmp_path / "run_maps.xdmf",)
