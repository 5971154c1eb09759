"""Files that appear whole or not at all."""

import pytest

from cardiosurf.errors import InputError
from cardiosurf.recording.whole_file import check_folder, whole_file, whole_files


def test_a_path_below_a_file_is_named(tmp_path):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(InputError, match="Not a directory"), whole_file(tmp_path / "file/x") as x:
        x.write_text("1")
    with pytest.raises(InputError, match="Not a directory"):
        check_folder(tmp_path / "file/x/y")


def test_files_that_belong_together_appear_together(tmp_path):
    with whole_files(tmp_path / "new/out", ("a", "b")) as staged:
        (staged / "a").write_text("1")
        assert not (tmp_path / "new/out/a").exists()
        (staged / "b").write_text("2")
    assert {one.name: one.read_text() for one in (tmp_path / "new/out").iterdir()} == {
        "a": "1",
        "b": "2",
    }


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError])
def test_what_is_cut_short_leaves_all_as_it_was(tmp_path, error):
    def cut_short(folder):
        with whole_files(folder, ("a", "b")) as staged:
            (staged / "a").write_text("after")
            raise error

    (tmp_path / "old").mkdir()
    (tmp_path / "old/a").write_text("before")
    for name in ("old", "new"):
        with pytest.raises(error):
            cut_short(tmp_path / name)
    assert [one.name for one in tmp_path.iterdir()] == ["old"]
    assert [one.name for one in (tmp_path / "old").iterdir()] == ["a"]
    assert (tmp_path / "old/a").read_text() == "before"
