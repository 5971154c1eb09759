"""Runs that are interrupted or find the disk full: nothing half-written, and nothing lost."""

import errno
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from strip_runs import QUICK

from cardiosurf.cli.main import main
from cardiosurf.recording.observers import Frames
from cardiosurf.recording.steady_file import SteadyFile
from cardiosurf.study import simulation


def send_at_the_first(monkeypatch, owner, verb, number=signal.SIGINT):
    """Have a method send this process a signal when it is first called."""
    original = getattr(owner, verb)

    def sending(*arguments, **options):
        monkeypatch.setattr(owner, verb, original)
        os.kill(os.getpid(), number)
        return original(*arguments, **options)

    monkeypatch.setattr(owner, verb, sending)


def same_recordings(one, other):
    with h5py.File(one / "recording.h5") as a, h5py.File(other / "recording.h5") as b:
        for name in ("activation/times", "activation/nodes", "frames/u", "probes/u"):
            np.testing.assert_array_equal(a[name][()], b[name][()])
        for name in ("end_time", "stop_reason", "quiescent_at"):
            assert a.attrs[name] == b.attrs[name]


@pytest.mark.parametrize(
    "moment",
    [
        # the end of the march, when no step is left to be finished
        (Frames, "finalize", signal.SIGTERM),
        # between the march and the files
        (simulation, "judge_recording", signal.SIGINT),
        # inside a callback of HDF5, where an exception would crash the process
        (SteadyFile, "write", signal.SIGINT),
        (simulation, "write_xdmf", signal.SIGINT),
    ],
)
def test_a_run_stopped_after_its_march_has_only_its_files_to_write(
    strip, tmp_path, cardiosurf, monkeypatch, moment, whole
):
    out = tmp_path / "out"
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    send_at_the_first(monkeypatch, *moment)
    stopped = cardiosurf("run", strip, "-o", out, *QUICK)
    assert stopped.returncode == 130
    assert f"go on with: --resume -o {out}" in stopped.stderr
    assert [path.name for path in out.iterdir()] == [".partial"]
    monkeypatch.setattr(simulation, "march", None)
    assert cardiosurf("run", strip, "-o", out, *QUICK, "--resume").returncode == 0
    same_recordings(out, whole)
    signal.signal(signal.SIGTERM, before)


def test_a_stopped_replacement_of_a_finished_run_goes_on_with_resume(
    strip, tmp_path, cardiosurf, monkeypatch, whole
):
    out = shutil.copytree(whole, tmp_path / "out")
    old = (out / "recording.h5").read_bytes()
    send_at_the_first(monkeypatch, SteadyFile, "write")
    changed = (*QUICK, "--set", "record.frames_every=null")
    assert cardiosurf("run", strip, "-o", out, *changed, "--overwrite").returncode == 130
    assert (out / "recording.h5").read_bytes() == old
    assert json.loads((out / "verdict.json").read_text())["verdict"] == "conduction"
    assert cardiosurf("run", strip, "-o", out, *changed, "--resume").returncode == 0
    assert (out / "recording.h5").read_bytes() != old
    # the run before had frames
    assert not (out / "recording.xdmf").exists()


@pytest.mark.parametrize("name", ["recording.h5", "verdict.json"])
def test_a_full_disk_leaves_the_finished_run_and_the_march(
    strip, tmp_path, cardiosurf, monkeypatch, name, whole
):
    out = shutil.copytree(whole, tmp_path / "out")
    old = {path.name: path.read_bytes() for path in out.iterdir()}
    replace = Path.replace

    def full(path, target):
        if target.name == name:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return replace(path, target)

    monkeypatch.setattr(Path, "replace", full)
    failed = cardiosurf("run", strip, "-o", out, *QUICK, "--overwrite")
    assert failed.returncode == 2
    assert "No space left on device" in failed.stderr
    assert "then go on with --resume" in failed.stderr
    assert {path.name: path.read_bytes() for path in out.iterdir() if path.is_file()} == old
    monkeypatch.setattr(Path, "replace", replace)
    monkeypatch.setattr(simulation, "march", None)
    assert cardiosurf("run", strip, "-o", out, *QUICK, "--resume").returncode == 0
    assert not (out / ".partial").exists()


LONG = ("--set", "mesh.edge_length=0.4", "--set", "time.step=0.04")


def interrupted(strip, out, number):
    """Start a run of several seconds, stop it by a signal after its first steps.

    With nothing kept it would compile before its first step, which takes most of the minute that
    it is given on a busy machine: ``whole`` has its machine code kept.
    """
    process = subprocess.Popen(
        [sys.executable, "-m", "cardiosurf", "run", str(strip), "-o", str(out), *LONG],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    spool = out / ".partial" / "frames.bin"
    deadline = time.monotonic() + 60
    while not (spool.exists() and spool.stat().st_size) and time.monotonic() < deadline:
        time.sleep(0.02)
    time.sleep(0.1)
    process.send_signal(number)
    _, stderr = process.communicate(timeout=60)
    return process.returncode, stderr


@pytest.mark.usefixtures("whole")
def test_sigterm_stops_a_run_as_ctrl_c_does(strip, tmp_path):
    code, stderr = interrupted(strip, tmp_path / "out", signal.SIGTERM)
    assert code == 130, stderr
    assert "--resume" in stderr
    assert (tmp_path / "out" / ".partial" / "checkpoint.npz").exists()


@pytest.mark.usefixtures("whole")
def test_a_stopped_run_is_marked_and_resumes_to_the_same_result(strip, tmp_path, cardiosurf):
    out = tmp_path / "out"
    code, stderr = interrupted(strip, out, signal.SIGINT)
    assert code == 130, stderr
    assert "--resume" in stderr
    assert "Traceback" not in stderr
    assert [path.name for path in out.iterdir()] == [".partial"]

    unasked = cardiosurf("run", strip, "-o", out, *LONG)
    assert unasked.returncode == 2
    assert "unfinished run" in unasked.stderr

    other = cardiosurf("run", strip, "-o", out, "--resume", "--set", "time.step=0.5")
    assert other.returncode == 2
    assert "another config" in other.stderr
    assert (out / ".partial" / "checkpoint.npz").exists()

    assert cardiosurf("run", strip, "-o", out, "--resume", *LONG).returncode == 0
    assert not (out / ".partial").exists()
    whole = tmp_path / "whole"
    assert cardiosurf("run", strip, "-o", whole, *LONG).returncode == 0
    same_recordings(out, whole)


@pytest.mark.usefixtures("whole")
def test_a_killed_run_leaves_no_result_and_can_be_started_again(strip, tmp_path, cardiosurf):
    out = tmp_path / "out"
    interrupted(strip, out, signal.SIGKILL)
    assert not (out / "verdict.json").exists()
    assert not (out / "recording.h5").exists()
    assert cardiosurf("run", strip, "-o", out, *QUICK).returncode == 0


def test_a_full_disk_while_the_recording_is_written(strip, tmp_path, monkeypatch, capsys):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "replace", full)
    code = main(["run", str(strip), "-o", str(tmp_path / "out")])
    monkeypatch.undo()
    assert code == 2
    assert "No space left on device" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
