import errno
import os
import signal
import threading

import numpy as np
import pytest
from recording_samples import sample_recording

from cardiosurf.recording.hdf5 import read_recording, write_recording
from cardiosurf.recording.signals import held_signals, stopped_by_signals
from cardiosurf.recording.steady_file import SteadyFile
from cardiosurf.recording.whole_file import unwritable

BOTH = [signal.SIGINT, signal.SIGTERM]


def hold(*deeds):
    """Do some things while signals are held; return what was done."""
    with held_signals() as held:
        for deed in deeds:
            deed(held)


def send(number):
    return lambda held: os.kill(os.getpid(), number)


@pytest.mark.parametrize("number", BOTH)
def test_held_signals_interrupt_after_the_block(number):
    before = [signal.getsignal(number) for number in BOTH]
    done = []
    with pytest.raises(KeyboardInterrupt):
        hold(send(number), done.append)
    assert len(done) == 1
    assert [signal.getsignal(number) for number in BOTH] == before
    hold(done.append)


def test_an_error_goes_before_a_held_signal():
    with pytest.raises(ZeroDivisionError):
        hold(send(signal.SIGINT), lambda held: 1 / 0)


def test_a_held_signal_can_be_heeded_earlier():
    done = []
    with pytest.raises(KeyboardInterrupt):
        hold(lambda held: held.heed(), done.append, send(signal.SIGINT), lambda held: held.heed())
    assert len(done) == 1
    with pytest.raises(KeyboardInterrupt):
        hold(send(signal.SIGINT), lambda held: held.heed(), done.append)
    assert len(done) == 1


def test_other_threads_hold_nothing():
    seen = []

    def work():
        with held_signals(), stopped_by_signals(lambda: None):
            seen.append(signal.getsignal(signal.SIGINT))

    before = signal.getsignal(signal.SIGINT)
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == [before]


@pytest.mark.parametrize("number", BOTH)
@pytest.mark.parametrize("call", [1, 5, 40])
def test_a_signal_inside_a_callback_of_hdf5_leaves_a_whole_file_or_none(
    tmp_path, monkeypatch, number, call
):
    calls = []
    write = SteadyFile.write

    def interrupted(file, data):
        calls.append(len(data))
        if len(calls) == call:
            os.kill(os.getpid(), number)
        return write(file, data)

    monkeypatch.setattr(SteadyFile, "write", interrupted)
    path = tmp_path / "r.h5"
    with pytest.raises(KeyboardInterrupt):
        write_recording(path, sample_recording())
    assert len(calls) >= call
    assert [entry.name for entry in tmp_path.iterdir()] in ([], ["r.h5"])
    if path.exists():
        expected = sample_recording()
        assert np.array_equal(read_recording(path).frames.u, expected.frames.u)


@pytest.mark.parametrize(
    ("number", "advice"),
    [
        (errno.ENOSPC, "free some space"),
        (errno.EDQUOT, "free some space"),
        (errno.EFBIG, "free some space"),
        (errno.EACCES, "permissions"),
        (errno.EPERM, "permissions"),
        (errno.EROFS, "permissions"),
        (errno.ENOTDIR, "in the way"),
        (errno.EEXIST, "in the way"),
        (errno.EISDIR, "in the way"),
        (errno.ENAMETOOLONG, "shorter name"),
        (errno.EIO, "another folder"),
    ],
)
def test_the_advice_fits_the_reason(tmp_path, number, advice):
    error = unwritable(tmp_path, OSError(number, os.strerror(number)))
    assert os.strerror(number) in error.problem
    assert advice in error.hint
    assert ("free some space" in error.hint) == (advice == "free some space")
