"""Every case of every scenario must still end with the verdict that stands in it."""

import json
from pathlib import Path

import pytest
import yaml

from cardiosurf.config import load
from cardiosurf.study.simulation import simulate

FOLDER = Path(__file__).parents[2] / "scenarios"


def cases():
    for path in sorted(FOLDER.glob("*.yaml")):
        scenario = yaml.safe_load(path.read_text(encoding="utf-8"))
        for case in scenario["cases"]:
            yield pytest.param(scenario, case, id=f"{scenario['name']}-{case['name']}")


@pytest.mark.slow
@pytest.mark.parametrize(("scenario", "case"), list(cases()))
def test_the_verdict_is_the_expected_one(scenario, case, tmp_path):
    overrides = [f"{key}={json.dumps(value)}" for key, value in case.get("set", {}).items()]
    loaded = load(FOLDER / scenario["base"], overrides)
    verdict = simulate(loaded, tmp_path / "run").verdict.to_json()
    found = {target["name"]: target for target in verdict["targets"]}
    for key, value in case["expect"].items():
        if key == "verdict":
            assert verdict["verdict"] == value
        elif key == "reentry":
            assert verdict["reentry"]["verdict"] == value
        else:
            assert {word: found[key][word] for word in value} == value
