import io
import os
import signal
from dataclasses import replace

import numpy as np
import pytest
from recording_samples import recorded, recorders, square_surface

from cardiosurf.errors import InputError
from cardiosurf.fem.operators import assemble
from cardiosurf.kinetics import RogersMcCulloch
from cardiosurf.recording.checkpoint import (
    CheckpointWriter,
    read_conclusion,
    restore_checkpoint,
)
from cardiosurf.recording.signals import stopped_by_signals
from cardiosurf.stepping.controls import TimeSection, decide
from cardiosurf.stepping.march import march
from cardiosurf.stepping.walk import Problem
from cardiosurf.tissue.stimuli import Pulse

SURFACE = square_surface(count=20)
KINETICS = RogersMcCulloch()


def problem():
    """A plane wave at 0, and a second pulse in its tail."""
    x, y, _ = SURFACE.points.T
    tensor = np.broadcast_to(np.diag([1.0, 1.0, 0.0]), (len(SURFACE.triangles), 3, 3))
    excitable = np.ones(len(SURFACE.triangles), dtype=bool)
    operators = assemble(SURFACE.points, SURFACE.triangles, tensor.copy(), excitable)
    pulses = (
        Pulse(0.0, 0.0, (x < 10).astype(float), "stimulus.0"),
        Pulse(250.0, 0.0, (y < 10).astype(float), "stimulus.1"),
    )
    return Problem(operators, KINETICS, pulses)


class Interrupter:
    """An observer that does something at the first moment at or beyond a time."""

    def __init__(self, time, deed):
        self.time, self.deed, self.done = time, deed, False

    def initialize(self, moment):
        pass

    def handle(self, moment):
        if moment.time >= self.time and not self.done:
            self.done = True
            self.deed()

    finalize = initialize


def controls(end=320.0):
    return decide(TimeSection(end=end, step=2.0), KINETICS, problem().operators)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    observers = recorders(tmp_path_factory.mktemp("whole"), SURFACE)
    march(problem(), controls(), list(observers.values()))
    return recorded(observers)


@pytest.mark.parametrize("when", [2.0, 121.0, 250.0, 318.0])
def test_a_run_stopped_by_ctrl_c_goes_on_bit_for_bit(tmp_path, whole, when):
    path = tmp_path / "checkpoint.npz"
    first = recorders(tmp_path, SURFACE)
    writer = CheckpointWriter(path, 1e9, first, "hash")
    stopper = Interrupter(when, lambda: os.kill(os.getpid(), signal.SIGINT))
    with stopped_by_signals(writer.stop), pytest.raises(KeyboardInterrupt):
        march(problem(), controls(), [*first.values(), stopper, writer])
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler

    second = recorders(tmp_path, SURFACE)
    start = restore_checkpoint(path, second, "hash")
    assert start.time == pytest.approx(when, abs=2.0)
    march(problem(), controls(), list(second.values()), start=start)
    for expected, found in zip(whole, recorded(second), strict=True):
        assert len(expected) > 10
        assert np.array_equal(expected, found)


def test_a_run_killed_after_a_checkpoint_goes_on_bit_for_bit(tmp_path, whole):
    path = tmp_path / "checkpoint.npz"
    first = recorders(tmp_path, SURFACE)
    writer = CheckpointWriter(path, 1e9, first, "hash")

    def due():
        writer._written_at = -np.inf

    def die():
        raise MemoryError

    observers = [*first.values(), Interrupter(100, due), writer, Interrupter(155, die)]
    with pytest.raises(MemoryError):
        march(problem(), controls(), observers)
    second = recorders(tmp_path, SURFACE)
    start = restore_checkpoint(path, second, "hash")
    assert start.time == 100.0
    march(problem(), controls(), list(second.values()), start=start)
    for expected, found in zip(whole, recorded(second), strict=True):
        assert np.array_equal(expected, found)
    assert [entry.name for entry in tmp_path.iterdir() if entry.suffix == ".partial"] == []


def test_a_checkpoint_is_due_by_wall_time_and_removed_on_request(tmp_path):
    path = tmp_path / "checkpoint.npz"
    observers = recorders(tmp_path, SURFACE)
    patient = CheckpointWriter(path, 1e9, observers, "hash")
    march(problem(), controls(10.0), [*observers.values(), patient])
    assert not path.exists()
    observers = recorders(tmp_path, SURFACE)
    eager = CheckpointWriter(path, 1e-9, observers, "hash")
    march(problem(), controls(10.0), [*observers.values(), eager])
    assert path.exists()
    eager.remove()
    assert not path.exists()


def test_checkpoints_of_another_run_and_other_files_are_refused(tmp_path):
    path = tmp_path / "checkpoint.npz"
    observers = recorders(tmp_path, SURFACE)
    writer = CheckpointWriter(path, 1e-9, observers, "one")
    march(problem(), controls(10.0), [*observers.values(), writer])
    with pytest.raises(InputError, match="another config"):
        restore_checkpoint(path, recorders(tmp_path, SURFACE), "other")
    path.write_bytes(path.read_bytes()[:500])
    with pytest.raises(InputError, match="cannot be read as a checkpoint"):
        restore_checkpoint(path, recorders(tmp_path, SURFACE), "one")
    with pytest.raises(InputError, match="cannot be read as a checkpoint"):
        restore_checkpoint(tmp_path / "none.npz", recorders(tmp_path, SURFACE), "one")


def bare(array):
    """The bytes of a file that holds one array instead of an archive."""
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


@pytest.mark.parametrize(
    "content",
    [b"", bare(np.zeros(3)), b"PK\x03\x04 and no more", b"\x93NUMPY", b"name: text\n"],
)
def test_a_file_of_another_kind_is_no_checkpoint(tmp_path, content):
    path = tmp_path / "checkpoint.npz"
    path.write_bytes(content)
    for read in (
        lambda: restore_checkpoint(path, recorders(tmp_path, SURFACE), "one"),
        lambda: read_conclusion(path),
    ):
        with pytest.raises(InputError, match="cannot be read as a checkpoint"):
            read()


@pytest.mark.parametrize(
    "spoilt", ["march/position", "march/states", "activation/up", "frames/count", "identity"]
)
def test_a_checkpoint_that_lacks_something_is_refused(tmp_path, spoilt):
    path = tmp_path / "checkpoint.npz"
    observers = recorders(tmp_path, SURFACE)
    writer = CheckpointWriter(path, 1e-9, observers, "one")
    march(problem(), controls(4.0), [*observers.values(), writer])
    with np.load(path) as file:
        kept = {name: file[name] for name in file.files if name != spoilt}
    assert restore_checkpoint(path, recorders(tmp_path, SURFACE), "one").time == 4.0
    np.savez(path, **kept)
    with pytest.raises(InputError, match="checkpoint") as caught:
        restore_checkpoint(path, recorders(tmp_path, SURFACE), "one")
    assert "--overwrite" in str(caught.value)
    np.savez(path, **kept, **{spoilt: np.zeros((0, 0, 0))})
    with pytest.raises(InputError, match="checkpoint"):
        restore_checkpoint(path, recorders(tmp_path, SURFACE), "one")


def test_a_march_that_is_over_says_so_in_its_checkpoint(tmp_path):
    path = tmp_path / "checkpoint.npz"
    observers = recorders(tmp_path, SURFACE)
    writer = CheckpointWriter(path, 1e-9, observers, "one")
    march(problem(), controls(10.0), [*observers.values(), writer])
    assert read_conclusion(path) is None
    writer.conclude({"end_time": 10.0, "reason": "end", "steps": np.int64(5)})
    assert read_conclusion(path) == {"end_time": 10.0, "reason": "end", "steps": 5}
    second = recorders(tmp_path, SURFACE)
    assert restore_checkpoint(path, second, "one").time == 10.0
    for expected, found in zip(recorded(observers), recorded(second), strict=True):
        assert np.array_equal(expected, found)


def test_a_full_disk_keeps_the_checkpoint_before(tmp_path, monkeypatch):
    path = tmp_path / "checkpoint.npz"
    observers = recorders(tmp_path, SURFACE)
    writer = CheckpointWriter(path, 1e-9, observers, "hash")
    march(problem(), controls(10.0), [*observers.values(), writer])
    kept = path.read_bytes()

    def full(*args, **arrays):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    with pytest.raises(InputError, match="No space left"):
        march(
            problem(),
            replace(controls(), end=20.0),
            [*recorders(tmp_path, SURFACE).values(), writer],
        )
    assert path.read_bytes() == kept
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["checkpoint.npz", "frames.spool"]
