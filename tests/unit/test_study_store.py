import hashlib
import json

import pytest
from study_strips import BASE

from cardiosurf.config import load_text
from cardiosurf.study import store
from cardiosurf.study.store import (
    NUMERIC,
    RunStore,
    finished_run,
    forget,
    note_begun,
    note_finished,
    read_record,
    run_key,
)

STRIP = load_text(BASE)
VERDICT = json.dumps({"schema": "cardiosurf/verdict/1", "verdict": "block"})


@pytest.fixture
def finished(tmp_path):
    """The folder of a finished run that the store knows."""
    folder = RunStore(tmp_path / "runs").folder_of(STRIP)
    folder.mkdir(parents=True)
    (folder / "verdict.json").write_text(VERDICT)
    note_finished(folder, run_key(STRIP), 2.5, {"step": 1.2})
    return folder


def test_a_finished_run_is_found_by_its_config(tmp_path, finished):
    runs = RunStore(tmp_path / "runs")
    assert finished.name == run_key(STRIP)[:16]
    assert runs.finished(STRIP) == json.loads(VERDICT)
    _, record = finished_run(finished, run_key(STRIP))
    assert (record.seconds, record.meta) == (2.5, {"step": 1.2})
    assert runs.finished(load_text(BASE.replace("step: 3", "step: 2"))) is None


def test_the_key_covers_config_and_program(monkeypatch):
    before = run_key(STRIP)
    assert run_key(load_text(BASE)) == before
    assert run_key(load_text(BASE.replace("x: [0, 80]", "x: [0, 81]"))) != before
    monkeypatch.setattr(store, "_program", lambda: "another")
    assert run_key(STRIP) == hashlib.sha256(f"another {STRIP.sha256}".encode()).hexdigest()
    assert run_key(STRIP) != before


def test_the_program_is_what_computes_and_judges(tmp_path, monkeypatch):
    for name in ("geometry/plane.py", "analysis/block.py", "cli/main.py", "study/setup.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("")
    (tmp_path / "__init__.py").write_text("")
    monkeypatch.setattr(store.cardiosurf, "__file__", str(tmp_path / "__init__.py"))
    monkeypatch.setattr(store, "NUMERIC", ("geometry", "analysis", "study/setup.py"))

    def hash_with(name, text):
        (tmp_path / name).write_text(text)
        return store._program.__wrapped__()

    first = hash_with("cli/main.py", "")
    assert hash_with("cli/main.py", "# told otherwise") == first
    assert hash_with("analysis/block.py", "# judged otherwise") != first
    assert hash_with("analysis/block.py", "") == first
    assert hash_with("study/setup.py", "# set up otherwise") != first


def test_everything_that_is_listed_as_numeric_is_there():
    root = store.Path(str(store.cardiosurf.__file__)).parent
    assert all((root / name).exists() for name in NUMERIC)


@pytest.mark.parametrize(
    "damage",
    [
        lambda folder: (folder / "verdict.json").write_text(VERDICT.replace("block", "partial")),
        lambda folder: (folder / "verdict.json").unlink(),
        lambda folder: (folder / "run.json").write_text("{"),
        lambda folder: (folder / "run.json").write_text("[]"),
        lambda folder: (folder / "run.json").unlink(),
        lambda folder: note_begun(folder, run_key(STRIP)),
    ],
)
def test_a_run_that_is_not_the_noted_one_counts_as_none(tmp_path, finished, damage):
    damage(finished)
    assert RunStore(tmp_path / "runs").finished(STRIP) is None


def test_what_came_to_nothing_is_forgotten_and_what_is_there_is_not(tmp_path, finished):
    begun = tmp_path / "begun"
    note_begun(begun, "key")
    assert read_record(begun).seconds is None
    forget(begun)
    assert not begun.exists()
    forget(finished)
    assert read_record(finished).seconds == 2.5
