import resource
import signal
import subprocess
import sys
from dataclasses import replace

import h5py
import numpy as np
import pytest
from recording_samples import sample_recording

from cardiosurf.errors import InputError
from cardiosurf.recording import frame_sets
from cardiosurf.recording.hdf5 import read_recording, write_recording
from cardiosurf.recording.layout import DATASETS, SCHEMA
from cardiosurf.recording.recording import Events, FrameSeries, ProbeTraces


def leaves(value):
    """Every array, text and number inside a nested value; meta, which has no order, as it is."""
    if isinstance(value, dict):
        return [leaf for key in value for leaf in (key, *leaves(value[key]))]
    if isinstance(value, tuple):
        return [leaf for item in value for leaf in leaves(item)]
    if hasattr(value, "__dataclass_fields__"):
        fields = [name for name in value.__dataclass_fields__ if name != "meta"]
        return [leaf for name in fields for leaf in leaves(getattr(value, name))]
    return [value]


def assert_same(one, other):
    pairs = list(zip(leaves(one), leaves(other), strict=True))
    assert len(pairs) > 20
    for a, b in pairs:
        if isinstance(a, np.ndarray):
            assert a.dtype == b.dtype
            assert np.array_equal(a, b)
        else:
            assert type(a) is type(b)
            assert a == b
    assert one.meta == other.meta


def test_frames_stay_in_the_file_until_they_are_used(tmp_path):
    recording = sample_recording()
    write_recording(tmp_path / "recording.h5", recording)
    read = read_recording(tmp_path / "recording.h5")
    assert isinstance(read.frames.u, np.memmap)
    # the file may be replaced while it is mapped: what was read stays
    other = replace(recording, frames=FrameSeries.none(recording.node_count))
    write_recording(tmp_path / "recording.h5", other)
    assert np.array_equal(read.frames.u, recording.frames.u)
    assert np.array_equal(read.frames.v, recording.frames.v)
    assert read_recording(tmp_path / "recording.h5").frames.u.shape == other.frames.u.shape


def test_round_trip_gives_back_every_bit(tmp_path):
    recording = sample_recording()
    write_recording(tmp_path / "recording.h5", recording)
    assert_same(recording, read_recording(tmp_path / "recording.h5"))


def test_round_trip_of_a_run_with_nothing_to_tell(tmp_path):
    sample = sample_recording()
    nothing = Events(np.zeros(0, dtype=np.int64), np.zeros(0))
    recording = replace(
        sample,
        tissue=replace(sample.tissue, names=()),
        surface=replace(sample.surface, edges={}, regions={}),
        targets={},
        pulses=(),
        activations=nothing,
        repolarisations=nothing,
        frames=FrameSeries.none(sample.node_count),
        probes=ProbeTraces.none(),
    )
    write_recording(tmp_path / "recording.h5", recording)
    found = read_recording(tmp_path / "recording.h5")
    assert_same(recording, found)
    assert np.isnan(found.first_activation).all()


def test_frames_are_left_out_on_request(tmp_path):
    write_recording(tmp_path / "r.h5", sample_recording())
    assert read_recording(tmp_path / "r.h5", with_frames=False).frames.u.shape == (0, 49)


def test_frames_larger_than_a_slab_are_written_in_several(tmp_path, monkeypatch):
    monkeypatch.setattr(frame_sets, "SLAB", 2 * 4 * 49)
    recording = sample_recording()
    assert len(recording.frames.u) == 3
    write_recording(tmp_path / "r.h5", recording)
    assert np.array_equal(read_recording(tmp_path / "r.h5").frames.u, recording.frames.u)
    with h5py.File(tmp_path / "r.h5") as file:
        assert np.array_equal(file["frames/by_time/v_00002"], recording.frames.v[2])


def test_the_file_tells_units_and_meaning_of_every_dataset(tmp_path):
    write_recording(tmp_path / "r.h5", sample_recording())
    with h5py.File(tmp_path / "r.h5") as file:
        assert file.attrs["schema"] == SCHEMA
        assert file.attrs["complete"]
        for name, entry in DATASETS.items():
            assert file[name].attrs["units"] == entry.units
            assert file[name].attrs["description"] == entry.description
        found = []
        file.visititems(
            lambda name, item: found.append(name) if isinstance(item, h5py.Dataset) else None
        )
        assert {name for name in found if "by_time" not in name} == set(DATASETS)
        # one frame after another, as they are: nothing to unpack
        assert file["frames/u"].chunks is None
        assert file["frames/u"].dtype == np.float32
        assert file["tissue/d11"][()].tolist() == [
            4.0 if inside else 1.0 for inside in sample_recording().patches["strip"]
        ]
        assert file["activation/first"].attrs["units"] == "tu"


def test_maps_follow_from_the_events():
    recording = replace(
        sample_recording(),
        activations=Events(np.array([3, 5, 3]), np.array([1.0, 2.0, 9.0])),
        repolarisations=Events(np.array([3, 5]), np.array([4.5, 8.0])),
    )
    assert recording.first_activation[[3, 5]].tolist() == [1.0, 2.0]
    assert recording.last_activation[[3, 5]].tolist() == [9.0, 2.0]
    assert recording.action_potential_duration[[3, 5]].tolist() == [3.5, 6.0]
    assert recording.activation_count[[0, 3, 5]].tolist() == [0, 2, 1]
    assert np.isnan(recording.first_activation).sum() == recording.node_count - 2
    assert np.isnan(recording.action_potential_duration[0])


def spoil(path, change):
    write_recording(path, sample_recording())
    with h5py.File(path, "r+") as file:
        change(file)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda file: file.attrs.__setitem__("schema", "cardiosurf/recording/9"), "recording/9"),
        (lambda file: file.attrs.__delitem__("schema"), "no recording of cardiosurf"),
        (lambda file: file.attrs.__setitem__("complete", False), "not complete"),
        (lambda file: file.__delitem__("activation/times"), "lacks something"),
        (lambda file: file.__delitem__("meta"), "lacks something"),
        (lambda file: file.attrs.__delitem__("end_time"), "lacks something"),
    ],
)
def test_what_is_no_complete_recording_is_refused(tmp_path, change, message):
    spoil(tmp_path / "r.h5", change)
    with pytest.raises(InputError, match=message) as caught:
        read_recording(tmp_path / "r.h5")
    assert str(tmp_path / "r.h5") in str(caught.value)


def swap(name, value):
    """Return a change that puts something else in the place of a dataset."""

    def change(file):
        del file[name]
        file[name] = value

    return change


@pytest.mark.parametrize(
    "change",
    [
        swap("mesh/parts", np.zeros(1)),  # TypeError: no text
        swap("targets/names", np.bytes_(b"\xff\xfe")),  # not UTF-8
        swap("config/text", np.array([b"\xff\xfe"])),
        swap("targets/triangles", np.zeros((3, 2))),
        swap("mesh/axes", np.bytes_(b"xy")),
        swap("activation/nodes", np.array([10**6])),
        swap("activation/times", np.zeros(1)),
        swap("mesh/triangles", np.array([[0, 1, -1]])),
        swap("tissue/tensor", np.zeros((1, 3, 3))),
        swap("pulses/times", 1.0),
        lambda file: (file.__delitem__("probes"), file.create_dataset("probes", data=1.0)),
        lambda file: (file.__delitem__("meta"), file.create_dataset("meta", data=1.0)),
        lambda file: (file.__delitem__("mesh/net"), file.create_group("mesh/net")),
        lambda file: file.attrs.__setitem__("end_time", "late"),
    ],
)
def test_a_damaged_recording_is_refused(tmp_path, change):
    spoil(tmp_path / "r.h5", change)
    with pytest.raises(InputError, match=r"cannot be read as HDF5|lacks something") as caught:
        read_recording(tmp_path / "r.h5")
    assert "run the config again" in str(caught.value)


def test_what_is_no_hdf5_file_is_refused(tmp_path):
    (tmp_path / "r.h5").write_text("name: not a recording\n")
    with pytest.raises(InputError, match="cannot be read as HDF5"):
        read_recording(tmp_path / "r.h5")
    with pytest.raises(InputError, match="no such file"):
        read_recording(tmp_path / "none.h5")


def test_a_truncated_recording_is_refused(tmp_path):
    write_recording(tmp_path / "r.h5", sample_recording())
    content = (tmp_path / "r.h5").read_bytes()
    (tmp_path / "r.h5").write_bytes(content[: len(content) // 2])
    with pytest.raises(InputError, match="cannot be read as HDF5"):
        read_recording(tmp_path / "r.h5")


def test_a_write_that_fails_leaves_the_old_file_and_no_partial_one(tmp_path):
    path = tmp_path / "r.h5"
    write_recording(path, sample_recording("old"))
    with pytest.raises(TypeError):
        write_recording(path, replace(sample_recording("new"), meta={"bad": object()}))
    assert [entry.name for entry in tmp_path.iterdir()] == ["r.h5"]
    assert read_recording(path).name == "old"


def test_an_unwritable_folder_is_refused(tmp_path):
    with pytest.raises(InputError, match="cannot be written"):
        write_recording(tmp_path / "nowhere" / "r.h5", sample_recording())


WRITE = """
import os, resource, signal, sys
from pathlib import Path
sys.path.insert(0, {tests!r})
from recording_samples import sample_recording
from cardiosurf.errors import InputError
from cardiosurf.recording import hdf5
"""


def run(code, tests):
    program = WRITE.format(tests=str(tests)) + code
    return subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, timeout=60
    )


def test_a_full_disk_ends_with_an_error_and_leaves_nothing(tmp_path, request):
    # files may grow to 20 kB here: the write fails in the middle, as on a full disk
    code = f"""
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
try:
    hdf5.write_recording(Path({str(tmp_path / "r.h5")!r}), sample_recording())
except InputError as error:
    print(error)
"""
    done = run(code, request.path.parent)
    assert "cannot be written" in done.stdout, done.stderr
    assert list(tmp_path.iterdir()) == []
    assert resource.getrlimit(resource.RLIMIT_FSIZE)[0] != 20000


def test_a_process_killed_in_mid_write_leaves_no_recording(tmp_path, request):
    code = f"""
hdf5.write_meta = lambda group, meta: os.kill(os.getpid(), signal.SIGKILL)
hdf5.write_recording(Path({str(tmp_path / "r.h5")!r}), sample_recording())
"""
    done = run(code, request.path.parent)
    assert done.returncode == -signal.SIGKILL
    assert [entry.name for entry in tmp_path.iterdir()] == ["r.h5.partial"]
    with pytest.raises(InputError):
        read_recording(tmp_path / "r.h5.partial")
    write_recording(tmp_path / "r.h5", sample_recording())
    assert [entry.name for entry in tmp_path.iterdir()] == ["r.h5"]
