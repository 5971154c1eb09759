"""check and sweep: exit codes, files, and what is left when they are stopped."""

import csv
import json
import os
import signal
import subprocess
import sys
import time
from xml.etree import ElementTree as ET

import pytest

from cardiosurf.study import simulation

SCENARIO = """\
name: strips
base: strip.yaml
set: {mesh.edge_length: 5, time.step: 3}
cases:
  - {name: free, expect: {verdict: conduction}}
  - name: walled
    set: {tissue: {patches: [{name: w, region: {box: {x: [25, 55]}}, excitable: false}]}}
    expect: {verdict: block}
grid: {time.end: [800, 900]}
"""


@pytest.fixture
def scenario(tmp_path, strip):
    path = tmp_path / "scenario.yaml"
    path.write_text(SCENARIO)
    return path


@pytest.fixture
def out(tmp_path):
    return tmp_path / "out"


def check(cardiosurf, scenario, out, *more):
    return cardiosurf("check", scenario, "-o", out, "--workers", 1, *more)


def test_check_ends_with_0_when_all_is_as_expected(scenario, out, cardiosurf):
    done = check(cardiosurf, scenario, out)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "2 cases: 2 as expected" in done.stdout
    assert "1/2  strips/" in done.stderr
    assert {path.name for path in out.iterdir()} == {
        "check.json",
        "junit.xml",
        "history.json",
        "runs",
    }
    found = json.loads((out / "check.json").read_text())
    assert [case["status"] for case in found["cases"]] == ["agrees", "agrees"]
    assert ET.parse(out / "junit.xml").getroot().get("tests") == "2"  # noqa: S314 - our own
    # a run kept for its verdict keeps no frames
    assert not list(out.glob("runs/*/recording.xdmf"))


def test_check_ends_with_1_on_a_flipped_verdict(scenario, out, cardiosurf):
    scenario.write_text(SCENARIO.replace("{verdict: block}", "{verdict: conduction}"))
    done = check(cardiosurf, scenario, out)
    assert done.returncode == 1
    assert "strips / walled: differs from what is expected" in done.stdout
    assert "expected conduction, found block" in done.stdout
    assert json.loads((out / "check.json").read_text())["agrees"] is False


def test_check_ends_with_3_when_a_run_breaks_down(scenario, out, cardiosurf):
    scenario.write_text(SCENARIO.replace("{name: free,", "{name: free, set: {time.step: 300},"))
    done = check(cardiosurf, scenario, out)
    assert done.returncode == 3
    assert "strips / free: broke down" in done.stdout
    assert "Traceback" not in done.stderr


WRONG = [
    ("base: strip.yaml", "base: strp.yaml", "no such file"),
    ("time.step: 3", "time.stpe: 3", "did you mean 'step'?"),
    ("cases:", "case:", "did you mean 'cases'?"),
]
NOT_EXPECTED = ("verdict: block", "verdict: blocked", "did you mean 'block'?")


@pytest.mark.parametrize(
    ("command", "change"),
    [("check", NOT_EXPECTED), *((name, one) for name in ("check", "sweep") for one in WRONG)],
)
def test_a_wrong_scenario_ends_with_2_before_anything_is_written(
    scenario, out, cardiosurf, command, change
):
    old, new, says = change
    scenario.write_text(SCENARIO.replace(old, new))
    done = cardiosurf(command, scenario, "-o", out)
    assert done.returncode == 2
    assert f"{scenario}:" in done.stderr
    assert says in done.stderr
    assert not out.exists()


def test_a_folder_that_cannot_be_written_to_ends_with_2(scenario, tmp_path, cardiosurf):
    (tmp_path / "file").write_text("")
    for command in ("check", "sweep"):
        done = cardiosurf(command, scenario, "-o", tmp_path / "file" / "out")
        assert done.returncode == 2
        assert "cannot be written" in done.stderr


def test_a_second_check_reuses_all_and_json_is_what_is_written(
    scenario, out, cardiosurf, monkeypatch
):
    check(cardiosurf, scenario, out)
    monkeypatch.setattr(simulation, "march", None)
    done = check(cardiosurf, scenario, out, "--json")
    assert done.returncode == 0
    assert json.loads(done.stdout) == json.loads((out / "check.json").read_text())
    assert all(case["reused"] for case in json.loads(done.stdout)["cases"])


def test_a_stopped_check_writes_no_result_and_goes_on(scenario, out, cardiosurf, monkeypatch):
    marched, march, judge = [], simulation.march, simulation.judge_recording

    def counted(*arguments, **more):
        marched.append(1)
        return march(*arguments, **more)

    def stopped(recording):
        monkeypatch.setattr(simulation, "judge_recording", judge)
        os.kill(os.getpid(), signal.SIGINT)
        return judge(recording)

    monkeypatch.setattr(simulation, "march", counted)
    monkeypatch.setattr(simulation, "judge_recording", stopped)
    done = check(cardiosurf, scenario, out)
    assert done.returncode == 130
    assert "the same command goes on" in done.stderr
    assert [path.name for path in out.iterdir()] == ["runs"]
    assert check(cardiosurf, scenario, out).returncode == 0
    # the run that was stopped after its march had only its files to write
    assert len(marched) == 2


LONG = SCENARIO.replace("edge_length: 5, time.step: 3", "edge_length: 0.3, time.step: 0.01")


@pytest.mark.slow
def test_sigterm_stops_all_workers_in_order(scenario, out):
    scenario.write_text(LONG)
    process = subprocess.Popen(
        [sys.executable, "-m", "cardiosurf", "check", scenario, "-o", out, "--workers", "2"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    deadline = time.monotonic() + 60
    while len(list(out.glob("runs/*/.partial/lock"))) < 2 and time.monotonic() < deadline:
        time.sleep(0.02)
    time.sleep(1.5)
    process.send_signal(signal.SIGTERM)
    _, stderr = process.communicate(timeout=60)
    assert process.returncode == 130, stderr
    assert "Traceback" not in stderr
    assert not (out / "check.json").exists()
    assert len(list(out.glob("runs/*/.partial/checkpoint.npz"))) == 2
    # nobody of its session is left: the last to go is what cleans up after the workers
    while time.monotonic() < deadline:
        try:
            os.killpg(process.pid, 0)
        except ProcessLookupError:
            break
        time.sleep(0.05)
    with pytest.raises(ProcessLookupError):
        os.killpg(process.pid, 0)


def test_a_check_of_scenarios_without_cases_compares_nothing(scenario, out, cardiosurf):
    scenario.write_text("name: none\nbase: strip.yaml\ngrid: {time.end: [800]}\n")
    done = check(cardiosurf, scenario, out)
    assert done.returncode == 0
    assert "0 cases: nothing to compare" in done.stdout


def test_sweep_writes_configs_table_and_map(scenario, out, cardiosurf, monkeypatch):
    done = cardiosurf("sweep", scenario, "-o", out, "--workers", 1)
    assert done.returncode == 0, done.stderr
    assert "4 runs, 0 reused" in done.stdout
    assert len(list((out / "cases").glob("*.yaml"))) == 4
    with (out / "results.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["verdict"] for row in rows] == ["conduction"] * 2 + ["block"] * 2
    assert [float(row["time.end"]) for row in rows] == [800, 900, 800, 900]
    assert (out / "phase_diagram.png").read_bytes()[:4] == b"\x89PNG"
    table = (out / "results.csv").read_bytes()
    monkeypatch.setattr(simulation, "march", None)
    again = cardiosurf("sweep", scenario, "-o", out, "--json")
    assert again.returncode == 0, again.stderr
    assert len(json.loads(again.stdout)) == 4
    assert (out / "results.csv").read_bytes() == table
    # what was written can be run by itself
    monkeypatch.undo()
    config = out / "cases" / "free_end-800.yaml"
    assert cardiosurf("validate", config).returncode == 0


def test_sweep_wants_something_to_vary(scenario, out, cardiosurf):
    scenario.write_text("name: none\nbase: strip.yaml\n")
    done = cardiosurf("sweep", scenario, "-o", out)
    assert done.returncode == 2
    assert "varies nothing" in done.stderr
    assert not out.exists()


def test_validate_takes_scenarios_too(scenario, strip, cardiosurf):
    done = cardiosurf("validate", scenario, strip)
    assert done.returncode == 0
    assert "strips: scenario, 2 cases, 4 points" in done.stdout
    assert cardiosurf("validate", "--mesh", scenario).returncode == 0
    changed = cardiosurf("validate", scenario, "--set", "time.end=3")
    assert changed.returncode == 2
    assert "--set changes configs only" in changed.stderr
    scenario.write_text(SCENARIO.replace("[25, 55]", "[125, 155]"))
    assert cardiosurf("validate", "--mesh", scenario).returncode == 2


def test_the_schema_of_scenarios_is_printed(cardiosurf):
    done = cardiosurf("schema", "scenario")
    assert json.loads(done.stdout)["$id"] == "cardiosurf/scenario/1"
