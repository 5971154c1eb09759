"""Whole runs through the command line, on a plane small enough for a second each."""

import json

import h5py
import jsonschema
import pytest
from strip_runs import QUICK, STRIP

from cardiosurf.analysis.verdict import verdict_schema
from cardiosurf.study import simulation
from cardiosurf.study.lock import locked


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


def test_an_unwritable_folder(strip, tmp_path, cardiosurf):
    blocker = tmp_path / "file"
    blocker.write_text("not a folder")
    done = cardiosurf("run", strip, "-o", blocker / "out")
    assert done.returncode == 2
    assert "cannot be written" in done.stderr
    assert "Traceback" not in done.stderr
