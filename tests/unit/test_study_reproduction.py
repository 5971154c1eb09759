"""What is missing is run and kept; what is there is not run again."""

import json

import pytest
from study_strips import BASE, write_scenario

from cardiosurf.config.scenario_file import read_scenario
from cardiosurf.errors import InputError
from cardiosurf.report.kept import Kept
from cardiosurf.report.reproduction_images import update_images
from cardiosurf.study.reproduction import Work, bring_up_to_date
from cardiosurf.study.results import SCHEMA, Results

# a plane wave of 0.2123 su/tu reaches x = 60 after 283 tu and x = 80 after 377, so that a run of
# 450 tu conducts and one of 250 does not
WIDE = BASE.replace("y: [0, 10]", "y: [0, 30]")
SCENARIO = """\
name: strips
base: base.yaml
cases:
  - name: free
    expect: {verdict: conduction}
    figures: [{label: fig1, times: [100, 200]}]
  - name: loaded
    set: {tissue: {patches: [{name: band, region: {box: {x: [40, 50]}}, anisotropy: {x: 2}}]}}
    expect: {verdict: conduction}
searches:
  - {name: critical, cases: [loaded], vary: time.end, between: [250, 450], tolerance: 30,
     edges: [5, 4, 3], against: geometry.x.1, axis: "length [su]", entrance: band}
"""


def updated(tmp_path, text=SCENARIO):
    """Bring everything up to date; return the results and what was said to have been made."""
    file = read_scenario(write_scenario(tmp_path / "in", text, WIDE))
    results, said = Results(tmp_path / "results"), []
    work = Work(results, tmp_path / "runs", 1, said.append)
    bring_up_to_date([file], work)
    update_images(Kept.read([file], results.folder), tmp_path / "images", work)
    return results, said


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("made")
    return folder, *updated(folder)


@pytest.mark.slow
def test_all_that_was_asked_is_kept(made):
    _, results, _ = made
    assert list(results.read("cases")) == ["strips/free", "strips/loaded"]
    free = results.read("cases")["strips/free"]
    assert (free["verdict"]["verdict"], len(free["guard"]["tried"])) == ("conduction", 3)
    # nothing of this machine or this call
    assert not {"run", "reused", "change"} & set(free)


@pytest.mark.slow
def test_the_critical_end_is_when_the_wave_comes_to_the_far_end(made):
    _, results, _ = made
    entry = results.read("thresholds")["strips/critical/loaded"]
    (change,) = entry["changes"]
    assert (change["below"], change["above"]) == ("no conduction", "conduction")
    # 95 % of the target, x = 79: 372 tu less what the band and the coarse mesh make faster
    assert change["value"] == pytest.approx(360.0, abs=40.0)
    assert entry["against"] == 80.0
    assert isinstance(entry["runs"], int)


@pytest.mark.slow
def test_the_front_before_the_band_is_plane(made):
    _, results, _ = made
    (piece,) = results.read("entrances")["strips/critical/loaded"]["pieces"]
    assert piece["length"] == pytest.approx(30.0)
    angles = [angle for angle in piece["angle"] if angle is not None]
    assert angles
    # a plane wave meets the band's edge at a right angle, and is not curved
    assert max(map(abs, angles)) < 0.05
    assert max(abs(k) for k in piece["curvature"] if k is not None) < 0.005


@pytest.mark.slow
def test_images_are_drawn(made):
    folder, results, _ = made
    drawn = {path.name for path in (folder / "images").iterdir()}
    assert drawn == {
        "strips_free_fig1.png",
        "critical.png",
        "strips_critical_entrance.png",
    }
    assert set(results.read("figures")) == {
        "strips/free/fig1",
        "critical",
        "strips/critical/entrance",
    }


@pytest.mark.slow
def test_a_second_call_makes_nothing(made):
    folder, results, said = made
    before = {path: path.read_bytes() for path in results.folder.iterdir()}
    assert said
    assert updated(folder)[1] == []
    assert {path: path.read_bytes() for path in results.folder.iterdir()} == before


@pytest.mark.slow
def test_what_was_changed_is_made_again_and_nothing_else(tmp_path, made):
    folder, _, _ = made
    # a copy of the results, without the runs
    target = tmp_path / "results"
    target.mkdir()
    for path in (folder / "results").iterdir():
        (target / path.name).write_bytes(path.read_bytes())
    images = tmp_path / "images"
    images.mkdir()
    for path in (folder / "images").iterdir():
        (images / path.name).write_bytes(path.read_bytes())
    changed = SCENARIO.replace("times: [100, 200]", "times: [150]")
    assert updated(tmp_path, changed)[1] == ["strips/free/fig1: drawn"]


def test_what_the_scenario_has_no_more_is_dropped(tmp_path):
    results = Results(tmp_path / "results")
    results.keep("cases", "strips/gone", {"asked": "x"})
    results.keep("cases", "other/one", {"asked": "x"})
    text = SCENARIO[: SCENARIO.index("  - name: loaded")]
    text = text.replace("    figures: [{label: fig1, times: [100, 200]}]\n", "")
    updated(tmp_path, text)
    assert list(results.read("cases")) == ["other/one", "strips/free"]


def test_a_number_that_is_none_is_named(tmp_path):
    text = SCENARIO.replace("against: geometry.x.1", "against: geometry.kind")
    with pytest.raises(InputError, match=r"geometry\.kind is no number in loaded"):
        updated(tmp_path, text)


@pytest.mark.parametrize("text", ["[]", "{", json.dumps({"schema": SCHEMA + "0"})])
def test_a_file_that_holds_no_results_is_refused(tmp_path, text):
    (tmp_path / "cases.json").write_text(text)
    with pytest.raises(InputError, match=r"cases\.json"):
        Results(tmp_path).read("cases")
