"""cardiosurf discrete: what it prints, and what it refuses."""

import json

import pytest

from cardiosurf.cli.main import main


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


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--n-max", "0"], "--n-max: 0 is not a positive number"),
        (["--refractory", "nan"], "--refractory: nan is not a positive number"),
        (["--set", "stimulus.0.at=5"], "no unit is excited at time 0"),
    ],
)
def test_what_is_refused(strip, capsys, words, said):
    assert main(["discrete", str(strip), *words]) == 2
    assert said in capsys.readouterr().err
