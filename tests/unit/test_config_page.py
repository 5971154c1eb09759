"""What scenarios say of the paper's figures and of critical values."""

from pathlib import Path

import pytest

from cardiosurf.config.page import Figure
from cardiosurf.config.scenario_file import read_scenario
from cardiosurf.errors import InputError

BASE = """\
geometry: {kind: plane, x: [0, 80], y: [0, 10]}
stimulus: [{shape: edge, edge: left}]
time: {end: 900}
"""
GOOD = """\
name: strips
base: base.yaml
cases:
  - name: one
    figures: [{label: fig1, times: [19.5, 22], unit: 10, view: [20, -30]}]
searches:
  - {name: critical, cases: [one], vary: tissue.diffusivity, between: [1, 2]}
"""


@pytest.mark.parametrize(
    ("times", "unit", "every"),
    [
        ((300.0, 500.0), 1.0, 100.0),
        ((750.0, 850.0), 1.0, 50.0),
        # section 6 prints T = 195, 225, 250, 300 and counts 10 tu
        ((195.0, 225.0, 250.0, 300.0), 10.0, 50.0),
        ((0.5, 0.75), 1.0, 0.25),
        ((0.0, 400.0), 1.0, 400.0),
    ],
)
def test_frames_are_as_rare_as_the_times_allow(times, unit, every):
    figure = Figure(label="a", times=times, unit=unit)
    assert figure.every == every
    assert all(moment / every == round(moment / every) for moment in figure.moments)


def read(folder: Path, text: str):
    (folder / "base.yaml").write_text(BASE)
    path = folder / "scenario.yaml"
    path.write_text(text)
    return read_scenario(path)


def test_figures_and_searches_are_read(tmp_path):
    scenario = read(tmp_path, GOOD).scenario
    (figure,) = scenario.cases[0].figures
    assert figure.moments == (195.0, 220.0)
    assert figure.view == (20.0, -30.0)
    (search,) = scenario.searches
    assert (search.of, search.edges, search.against) == ("conduction", (), None)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("cases: [one]", "cases: [on]", "did you mean 'one'?"),
        ("cases: [one]", "cases: []", "searches.critical.cases"),
        ("times: [19.5, 22]", "times: []", "figures"),
        ("times: [19.5, 22]", "times: [-1]", "figures"),
        ("label: fig1", "lable: fig1", "did you mean 'label'?"),
    ],
)
def test_what_is_wrong_is_named(tmp_path, old, new, said):
    with pytest.raises(InputError) as caught:
        read(tmp_path, GOOD.replace(old, new))
    assert said in str(caught.value)
