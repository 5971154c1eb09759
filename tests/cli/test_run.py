"""Whole runs through the command line, on a plane small enough for a second each."""

import errno
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import h5py
import jsonschema
import numpy as np
import pytest

from cardiosurf.analysis.verdict import verdict_schema
from cardiosurf.cli.main import main
from cardiosurf.recording.observers import Frames
from cardiosurf.recording.steady_file import SteadyFile
from cardiosurf.study import simulation
from cardiosurf.study.lock import locked

STRIP = """\
name: strip
geometry: {kind: plane, x: [0, 80], y: [0, 10]}
mesh: {edge_length: 2.5}
stimulus:
  - {shape: edge, edge: left}
time: {end: 900, step: 1}
record:
  frames_every: 50
  probes: [{name: middle, at: [40, 5, 0]}]
targets:
  - {name: far, region: {box: {x: [60, 80]}}}
"""
QUICK = ("--set", "mesh.edge_length=5", "--set", "time.step=3")


@pytest.fixture
def strip(tmp_path):
    path = tmp_path / "strip.yaml"
    path.write_text(STRIP)
    return path


@dataclass(frozen=True)
class Done:
    """What a command left: its exit code and what it printed."""

    returncode: int
    stdout: str
    stderr: str


@pytest.fixture
def cardiosurf(capfd):
    """Return a function that runs a command line in this process."""

    def command(*words):
        capfd.readouterr()
        code = main([str(word) for word in words])
        return Done(code, *capfd.readouterr())

    return command


def test_a_run_writes_a_verdict_that_meets_the_schema(strip, tmp_path, cardiosurf):
    done = cardiosurf("run", strip, "-o", tmp_path / "out", "--json")
    assert done.returncode == 0, done.stderr
    verdict = json.loads(done.stdout)
    jsonschema.Draft202012Validator(verdict_schema()).validate(verdict)
    assert verdict == json.loads((tmp_path / "out" / "verdict.json").read_text())
    assert verdict["verdict"] == "conduction"
    (far,) = verdict["targets"]
    assert far["route"] == "direct"
    assert far["activated_fraction"] == 1.0
    # the wave starts at the stimulus' edge, 4 su in, and runs at 0.2123 su/tu (PHYSICS); it takes
    # some tens of su to get up to speed, so the whole way is allowed 5 %
    assert far["first_activation"] == pytest.approx((60 - 4) / 0.2123, rel=0.05)
    assert verdict["quiescent_at"] == verdict["end"] < 900
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "recording.h5",
        "recording.xdmf",
        "recording_maps.xdmf",
        "config.yaml",
        "verdict.json",
    }


def test_the_summary_is_readable_and_quiet(strip, tmp_path, cardiosurf):
    done = cardiosurf("run", strip, "-o", tmp_path / "out", *QUICK)
    assert done.returncode == 0
    assert done.stdout.startswith("strip: CONDUCTION\n")
    assert "100.0% activated" in done.stdout
    assert str(tmp_path / "out") in done.stdout
    # not a terminal: no progress bar, no control characters
    assert done.stderr == ""
    assert "\x1b" not in done.stdout


def test_the_resolved_config_is_the_same_run(strip, tmp_path, cardiosurf):
    first = cardiosurf("run", strip, "-o", tmp_path / "one", "--json", *QUICK)
    again = cardiosurf("run", tmp_path / "one" / "config.yaml", "-o", tmp_path / "two", "--json")
    assert json.loads(first.stdout) == json.loads(again.stdout)


def test_analyze_says_what_run_said(strip, tmp_path, cardiosurf):
    ran = cardiosurf("run", strip, "-o", tmp_path / "out", "--json", *QUICK)
    for place in (tmp_path / "out", tmp_path / "out" / "recording.h5"):
        analyzed = cardiosurf("analyze", place, "--json")
        assert json.loads(analyzed.stdout) == json.loads(ran.stdout)


def test_the_printed_kinetics_capture_nothing(strip, tmp_path, cardiosurf):
    done = cardiosurf(
        "run", strip, "-o", tmp_path / "out", "--set", "kinetics.model=fitzhugh_nagumo"
    )
    assert done.returncode == 0
    assert "NO CAPTURE" in done.stdout
    assert "note: the stimulus started no wave" in done.stdout


def test_a_stimulus_too_weak_is_no_capture_and_not_block(strip, tmp_path, cardiosurf):
    done = cardiosurf(
        "run", strip, "-o", tmp_path / "out", "--json", "--set", "stimulus.0.amplitude=0.1"
    )
    verdict = json.loads(done.stdout)
    assert verdict["captured"] is False
    assert verdict["verdict"] == "no_capture"
    assert verdict["notes"]


def test_a_scar_across_the_strip_blocks(strip, tmp_path, cardiosurf):
    scar = "{patches: [{name: scar, region: {box: {x: [30, 50]}}, excitable: false}]}"
    done = cardiosurf("run", strip, "-o", tmp_path / "out", "--json", "--set", f"tissue={scar}")
    verdict = json.loads(done.stdout)
    assert verdict["verdict"] == "block"
    assert verdict["targets"][0]["activated_fraction"] == 0.0
    assert verdict["targets"][0]["route"] is None


def test_a_run_beyond_rest_knows_when_rest_began(strip, tmp_path, cardiosurf):
    assert cardiosurf("run", strip, "-o", tmp_path / "one", *QUICK).returncode == 0
    beyond = ("--set", "time.stop_at_rest=false")
    assert cardiosurf("run", strip, "-o", tmp_path / "two", *QUICK, *beyond).returncode == 0
    with (
        h5py.File(tmp_path / "one/recording.h5") as one,
        h5py.File(tmp_path / "two/recording.h5") as two,
    ):
        assert one.attrs["quiescent_at"] == one.attrs["end_time"] < 900
        assert two.attrs["end_time"] == 900
        # the same march, step for step
        assert two.attrs["quiescent_at"] == one.attrs["quiescent_at"]


def test_a_step_too_long_for_its_accuracy_is_noted(strip, tmp_path, cardiosurf):
    done = cardiosurf("run", strip, "-o", tmp_path / "out", "--set", "time.step=5", "--json")
    # C (rate dt)^2 = 0.0285 (0.2262 * 5)^2 = 3.6 %
    assert "off by about 3.6%" in json.loads(done.stdout)["notes"][0]


def test_a_finished_run_is_not_replaced_unasked(strip, tmp_path, cardiosurf):
    out = tmp_path / "out"
    assert cardiosurf("run", strip, "-o", out, *QUICK).returncode == 0
    before = (out / "recording.h5").read_bytes()
    refused = cardiosurf("run", strip, "-o", out, *QUICK)
    assert refused.returncode == 2
    assert "holds a finished run" in refused.stderr
    assert "--overwrite" in refused.stderr
    assert (out / "recording.h5").read_bytes() == before
    assert cardiosurf("run", strip, "-o", out, *QUICK, "--overwrite").returncode == 0


@pytest.mark.parametrize(
    "overrides",
    [
        ("time.step=60",),
        ("time.step=6",),
        # a current that drives u far beyond the model
        ("stimulus.0.duration=20", "stimulus.0.strength=50", "time.step=5"),
    ],
)
def test_blow_up_is_named_at_its_step_and_leaves_nothing(strip, tmp_path, cardiosurf, overrides):
    out = tmp_path / "out"
    words = [word for override in overrides for word in ("--set", override)]
    done = cardiosurf("run", strip, "-o", out, *words)
    assert done.returncode == 3
    assert "at step" in done.stderr
    assert "time.step" in done.stderr
    assert "Traceback" not in done.stderr
    assert not out.exists()


def test_a_failed_rerun_leaves_the_finished_run(strip, tmp_path, cardiosurf):
    out = tmp_path / "out"
    assert cardiosurf("run", strip, "-o", out).returncode == 0
    assert (
        cardiosurf("run", strip, "-o", out, "--overwrite", "--set", "time.step=60").returncode == 3
    )
    assert json.loads((out / "verdict.json").read_text())["verdict"] == "conduction"
    assert not (out / ".partial").exists()


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The folder of a quick run that nothing disturbed."""
    folder = tmp_path_factory.mktemp("whole")
    (folder / "strip.yaml").write_text(STRIP)
    assert main(["run", str(folder / "strip.yaml"), "-o", str(folder / "run"), *QUICK]) == 0
    return folder / "run"


def send_at_the_first(monkeypatch, owner, verb, number=signal.SIGINT):
    """Have a method send this process a signal when it is first called."""
    original = getattr(owner, verb)

    def sending(*arguments):
        monkeypatch.setattr(owner, verb, original)
        os.kill(os.getpid(), number)
        return original(*arguments)

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


def test_the_config_is_not_replaced_by_its_own_run(tmp_path, cardiosurf):
    mine = tmp_path / "config.yaml"
    mine.write_text(STRIP)
    for words in ((), ("--overwrite",), ("--resume",)):
        refused = cardiosurf("run", mine, "-o", tmp_path, *QUICK, *words)
        assert refused.returncode == 2
        assert f"{mine}: is in the way" in refused.stderr
    assert mine.read_text() == STRIP
    assert [path.name for path in tmp_path.iterdir()] == ["config.yaml"]


def test_a_folder_that_another_run_works_in(strip, tmp_path, cardiosurf):
    with locked(tmp_path / "out" / ".partial"):
        refused = cardiosurf("run", strip, "-o", tmp_path / "out", *QUICK)
    assert refused.returncode == 2
    assert "another run is working in this folder" in refused.stderr


def test_resume_with_nothing_to_resume_says_so_and_starts(strip, tmp_path, cardiosurf):
    out = tmp_path / "out"
    done = cardiosurf("run", strip, "-o", out, *QUICK, "--resume")
    assert done.returncode == 0
    assert done.stderr == f"nothing to resume in {out}: starting from the beginning\n"
    refused = cardiosurf("run", strip, "-o", out, *QUICK, "--resume")
    assert "holds a finished run" in refused.stderr
    assert "nothing to resume" not in refused.stderr


def test_a_target_in_scar_is_refused_before_the_march(strip, tmp_path, cardiosurf, monkeypatch):
    monkeypatch.setattr(simulation, "march", None)
    scar = "tissue={patches: [{name: scar, region: {box: {x: [50, 80]}}, excitable: false}]}"
    refused = cardiosurf("run", strip, "-o", tmp_path / "out", *QUICK, "--set", scar)
    assert refused.returncode == 2
    # the line of the target in STRIP
    assert f"{strip}:11: targets.far.region: the target lies wholly" in refused.stderr
    assert not (tmp_path / "out").exists()


LONG = ("--set", "mesh.edge_length=1.5", "--set", "time.step=0.25")


def interrupted(strip, out, number):
    """Start a run of several seconds, stop it by a signal after its first steps."""
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
    time.sleep(0.3)
    process.send_signal(number)
    _, stderr = process.communicate(timeout=60)
    return process.returncode, stderr


def test_sigterm_stops_a_run_as_ctrl_c_does(strip, tmp_path):
    code, stderr = interrupted(strip, tmp_path / "out", signal.SIGTERM)
    assert code == 130, stderr
    assert "--resume" in stderr
    assert (tmp_path / "out" / ".partial" / "checkpoint.npz").exists()


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


def test_a_killed_run_leaves_no_result_and_can_be_started_again(strip, tmp_path, cardiosurf):
    out = tmp_path / "out"
    interrupted(strip, out, signal.SIGKILL)
    assert not (out / "verdict.json").exists()
    assert not (out / "recording.h5").exists()
    assert cardiosurf("run", strip, "-o", out, *QUICK).returncode == 0


def test_an_unwritable_folder(strip, tmp_path, cardiosurf):
    blocker = tmp_path / "file"
    blocker.write_text("not a folder")
    done = cardiosurf("run", strip, "-o", blocker / "out")
    assert done.returncode == 2
    assert "cannot be written" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_full_disk_while_the_recording_is_written(strip, tmp_path, monkeypatch, capsys):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "replace", full)
    code = main(["run", str(strip), "-o", str(tmp_path / "out")])
    monkeypatch.undo()
    assert code == 2
    assert "No space left on device" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
