import json
import os
import signal
import subprocess
import sys

import pytest

from cardiosurf.errors import InputError
from cardiosurf.study.folder import FIGURES, FILES, RunFolder
from cardiosurf.study.lock import locked

FINISHED = json.dumps({"schema": "cardiosurf/verdict/1"})
DAMAGED = ["", "null", "[]", '{"schema": null}', '{"schema": "other/1"}']


def opened(path, *, overwrite=False, resume=False):
    folder = RunFolder(path)
    with folder.in_use():
        return folder.open(overwrite=overwrite, resume=resume)


def staged(path, names, text="new"):
    """An unfinished run with all its files written aside."""
    folder = RunFolder(path)
    folder.partial.mkdir(parents=True, exist_ok=True)
    folder.stage()
    for name in names:
        (folder.staged / name).write_text(text)
    return folder


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("overwrite", [False, True])
def test_a_file_that_no_run_wrote_is_never_replaced(tmp_path, name, overwrite):
    (tmp_path / name).write_text("mine")
    with pytest.raises(InputError, match="is in the way") as caught:
        opened(tmp_path, overwrite=overwrite)
    assert str(tmp_path / name) in str(caught.value)
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [(name, "mine")]


@pytest.mark.parametrize("text", DAMAGED)
def test_a_verdict_of_others_marks_no_finished_run(tmp_path, text):
    (tmp_path / "verdict.json").write_text(text)
    assert not RunFolder(tmp_path).finished
    with pytest.raises(InputError, match="is in the way"):
        opened(tmp_path, overwrite=True)


@pytest.mark.parametrize("name", FILES)
def test_a_folder_with_the_name_of_a_file_is_found_before_the_march(tmp_path, name):
    (tmp_path / "verdict.json").write_text(FINISHED)
    (tmp_path / name).unlink(missing_ok=True)
    (tmp_path / name).mkdir()
    with pytest.raises(InputError, match="a folder is in the way"):
        opened(tmp_path, overwrite=True)


def test_files_beside_a_run_do_not_matter_and_stay(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    assert opened(tmp_path) is False
    staged(tmp_path, FILES).publish()
    assert (tmp_path / "notes.txt").read_text() == "mine"
    assert {path.name for path in tmp_path.iterdir()} == {"notes.txt", *FILES}


def test_all_files_are_on_the_disk_before_the_earlier_verdict_goes(tmp_path, monkeypatch):
    (tmp_path / "verdict.json").write_text(FINISHED)
    seen = []

    def synced(path):
        seen.append((path.name, (tmp_path / "verdict.json").read_text()))

    monkeypatch.setattr("cardiosurf.study.folder.sync", synced)
    staged(tmp_path, FILES).publish()
    assert seen == [(name, FINISHED) for name in FILES]
    assert (tmp_path / "verdict.json").read_text() == "new"


def test_publishing_removes_what_the_earlier_run_left(tmp_path):
    for name in (*FILES, *FIGURES):
        (tmp_path / name).write_text("old")
    without_frames = [name for name in FILES if name != "recording.xdmf"]
    staged(tmp_path, without_frames).publish()
    assert {path.name for path in tmp_path.iterdir()} == set(without_frames)
    assert {path.read_text() for path in tmp_path.iterdir()} == {"new"}


def test_figures_in_a_folder_without_a_run_stay(tmp_path):
    (tmp_path / FIGURES[0]).write_text("mine")
    staged(tmp_path, FILES).publish()
    assert (tmp_path / FIGURES[0]).read_text() == "mine"


def test_a_signal_while_files_are_put_into_place_waits_for_the_last(tmp_path, monkeypatch):
    replace = type(tmp_path).replace

    def interrupted(path, target):
        os.kill(os.getpid(), signal.SIGTERM)
        return replace(path, target)

    folder = staged(tmp_path, FILES)
    monkeypatch.setattr(type(tmp_path), "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        folder.publish()
    assert {path.name for path in tmp_path.iterdir()} == set(FILES)


def test_a_run_killed_while_files_were_put_into_place_can_be_resumed(tmp_path):
    folder = staged(tmp_path, FILES)
    folder.checkpoint.write_text("")
    (folder.staged / "recording.h5").replace(tmp_path / "recording.h5")
    assert opened(tmp_path, resume=True) is True


def test_an_interrupted_replacement_of_a_finished_run_can_be_resumed(tmp_path):
    (tmp_path / "verdict.json").write_text(FINISHED)
    with pytest.raises(InputError, match="holds a finished run"):
        opened(tmp_path, resume=True)
    folder = RunFolder(tmp_path)
    folder.partial.mkdir()
    folder.checkpoint.write_text("")
    with pytest.raises(InputError, match="holds a finished run"):
        opened(tmp_path)
    assert opened(tmp_path, resume=True) is True
    assert folder.checkpoint.exists()
    assert opened(tmp_path, overwrite=True) is False
    assert not folder.partial.exists()


def test_a_second_run_in_a_folder_is_refused_and_harms_nothing(tmp_path):
    first = RunFolder(tmp_path / "out")
    with first.in_use():
        first.open(overwrite=False, resume=False)
        first.spool.write_text("frames")
        for words in ({}, {"overwrite": True}, {"resume": True}):
            with pytest.raises(InputError, match="another run is working in this folder"):
                opened(tmp_path / "out", **words)
        assert first.spool.read_text() == "frames"
        first.spool.unlink()
    assert not (tmp_path / "out").exists()


def test_the_lock_of_a_killed_process_is_free(tmp_path):
    code = f"""
import os, signal
from pathlib import Path
from cardiosurf.study.lock import locked
with locked(Path({str(tmp_path / "a")!r})):
    os.kill(os.getpid(), signal.SIGKILL)
"""
    done = subprocess.run([sys.executable, "-c", code], check=False, timeout=60)
    assert done.returncode == -signal.SIGKILL
    assert (tmp_path / "a" / "lock").exists()
    with locked(tmp_path / "a"):
        pass


def test_a_refused_run_leaves_no_trace(tmp_path):
    (tmp_path / "verdict.json").write_text(FINISHED)
    with pytest.raises(InputError, match="holds a finished run"):
        opened(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["verdict.json"]


def test_a_file_where_the_folder_should_be(tmp_path):
    (tmp_path / "out").write_text("mine")
    with pytest.raises(InputError, match="something of that name is in the way"):
        opened(tmp_path / "out")
    with pytest.raises(InputError, match="a shorter name"):
        opened(tmp_path / ("long" * 100))
