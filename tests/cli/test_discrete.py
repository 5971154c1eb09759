"""cardiosurf discrete: what it prints, and what it refuses."""

import json

import pytest

from cardiosurf.cli.discrete import SCENARIOS
from cardiosurf.cli.main import main
from cardiosurf.discrete.stops import STOPS


def test_what_became_of_each_target(strip, capsys):
    assert main(["discrete", str(strip)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "units" in lines[0]
    assert any("conduction  100.0%" in line for line in lines)


def test_as_json(strip, capsys):
    assert main(["discrete", str(strip), "--n-max", "0.3", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["schema"] == "cardiosurf/discrete/1"
    assert found["rule"] == {"n_max": 0.3, "refractory": 30.0, "failed": "refractory"}
    # a front of triangles faces as many as it has, or half or twice as many: 0.3 excites none
    assert {target["verdict"] for target in found["targets"]} == {"block"}


def test_the_names_of_scenarios_are_those_there_are():
    assert set(SCENARIOS) == set(STOPS)


@pytest.mark.parametrize(
    ("words", "outcome"),
    [
        (("free",), "conducts"),
        # 7 targets of 2 sources, 3.5 each
        (("sg-i",), "stops"),
        (("sg-i", "--n-max", "3.6"), "conducts"),
        # T1 = 2/4 + 3 = 3.5 before T2 = 3 + 4/3, and as printed not before T2 = 2 + 3/2
        (("sc-ii",), "stops"),
        (("sc-ii", "--failed", "rest"), "conducts"),
        (("figure-f",), "conducts"),
    ],
)
def test_the_appendixs_scenarios(words, outcome, capsys):
    assert main(["discrete", *words]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].endswith(outcome)
    in_vain = [line for line in lines if line.endswith("charged in vain")]
    assert bool(in_vain) == (outcome == "stops")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--n-max", "0"], "--n-max: 0 is not a positive number"),
        (["--refractory", "nan"], "--refractory: nan is out of range"),
        # ready again before it has excited another: excited for ever, at ever the same time
        (["--refractory", "0.000001"], "allowed: 1 to 1000000"),
        (["--set", "stimulus.0.at=5"], "no unit is excited at time 0"),
        # a run says NO CAPTURE, predict that no front starts
        (["--set", "stimulus.0.amplitude=0.3"], "no unit is excited at time 0"),
    ],
)
def test_what_is_refused(strip, capsys, words, said):
    assert main(["discrete", str(strip), *words]) == 2
    assert said in capsys.readouterr().err


def test_a_scenario_takes_no_settings(capsys):
    assert main(["discrete", "sg-i", "--set", "a=1"]) == 2
    assert "sg-i is no config" in capsys.readouterr().err


def test_a_misspelt_scenario_is_told_from_a_missing_file(capsys):
    assert main(["discrete", "sg-ii"]) == 2
    said = capsys.readouterr().err
    assert "allowed: a CONFIG, or one of free, sg-i, sc-ii, figure-f" in said
    assert "did you mean 'sg-i'?" in said
