"""reproduce: exit codes, files, and the page without any run."""

import json

import pytest

SCENARIO = """\
name: strips
base: strip.yaml
set: {mesh.edge_length: 5, time.step: 3}
cases:
  - {name: free, published: conduction, expect: {verdict: conduction}}
"""


@pytest.fixture
def reproduce(tmp_path, strip, cardiosurf):
    """Return a function that writes a scenario and brings its page up to date."""

    def command(text, *more):
        scenario = tmp_path / "scenario.yaml"
        scenario.write_text(text)
        folders = ("--results", tmp_path / "results", "--page", tmp_path / "page.md")
        return cardiosurf(
            "reproduce", scenario, *folders, "-o", tmp_path / "out", "--workers", 1, *more
        )

    return command


def test_the_page_alone_runs_nothing(reproduce, tmp_path):
    done = reproduce(SCENARIO, "--only", "page")
    assert done.returncode == 0, done.stderr
    assert "| strips/free | - | conduction | not run yet |" in (tmp_path / "page.md").read_text()
    assert not (tmp_path / "out").exists()
    assert not (tmp_path / "results").exists()


def test_what_is_missing_is_run_once(reproduce, tmp_path):
    done = reproduce(SCENARIO)
    assert done.returncode == 0, done.stderr
    assert "strips/free: conduction" in done.stderr
    entries = json.loads((tmp_path / "results/cases.json").read_text())["entries"]
    assert entries["strips/free"]["converged"] in {"yes", "no"}
    again = reproduce(SCENARIO)
    assert "strips/free" not in again.stderr
    page = (tmp_path / "page.md").read_text()
    assert "| strips/free | - | conduction | conduction (far: conduction, " in page


def test_a_wrong_scenario_ends_with_2_and_nothing_is_written(reproduce, tmp_path):
    done = reproduce(SCENARIO + "searches: [{name: a, cases: [fre], vary: b, between: [1, 2]}]\n")
    assert done.returncode == 2
    assert "did you mean 'free'?" in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "page.md").exists()


def test_a_search_that_cannot_be_made_is_found_before_anything_is_run(reproduce, tmp_path):
    search = "searches: [{name: a, cases: [free], vary: time.end, between: [2, 2]}]\n"
    done = reproduce(SCENARIO + search)
    assert done.returncode == 2
    assert "nothing lies between a number and itself" in done.stderr
    assert not (tmp_path / "out/runs").exists()
