"""What make runs as modules ends in words too, not in a traceback."""

import subprocess
import sys

import pytest


@pytest.mark.parametrize(
    ("module", "words", "said"),
    [
        ("report.theory_figures", (), "allowed: FOLDER"),
        ("report.roc_figure", ("none.csv", "."), "none.csv: cannot be read"),
        ("report.roc_figure", ("other.csv", "."), "has no column 'captured'"),
        ("report.discrete_study", (), "allowed: the project's FOLDER"),
        ("report.discrete_study", (".",), "face.yaml: no such file"),
        ("study.predictors", ("a",), "SCENARIO RESULTS COARSER_RESULTS TABLE PATCH"),
    ],
)
def test_wrong_words_are_named(tmp_path, module, words, said):
    (tmp_path / "other.csv").write_text("a,b\n1,2\n")
    done = subprocess.run(
        [sys.executable, "-m", f"cardiosurf.{module}", *words],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.startswith("error: ")
    assert said in done.stderr
    assert "Traceback" not in done.stderr
    assert [one.name for one in tmp_path.iterdir()] == ["other.csv"]
