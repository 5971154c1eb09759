"""YAML to plain data: what is a number, where things stand, what is refused."""

import math

import pytest

from cardiosurf.config.reader import parse_document, parse_value, read_document
from cardiosurf.errors import InputError


def values(text: str):
    return parse_document(text, "a.yaml").data


@pytest.mark.parametrize(
    ("written", "value"),
    [
        ("1e-3", 1e-3),
        ("1.5E3", 1500.0),
        ("-.5", -0.5),
        ("3.", 3.0),
        ("010", 10),
        ("0x1F", 31),
        ("0o17", 15),
        ("1_000", "1_000"),
        ("1:30", "1:30"),
        ("2001-01-01", "2001-01-01"),
        ("no", "no"),
        ("True", True),
        ("~", None),
        ("", None),
        ("'8'", "8"),
        ("pi/4", "pi/4"),
        ("-.inf", -math.inf),
        ("[0, 100, 80]", [0, 100, 80]),
        ("{x: [0, 1]}", {"x": [0, 1]}),
    ],
)
def test_scalars_follow_yaml_1_2(written, value):
    read = values(f"a: {written}")["a"]
    assert read == value
    assert type(read) is type(value)
    assert parse_value(written, "--set a") == value


def test_nan_is_read_so_that_its_key_can_be_named():
    assert math.isnan(values("a: .nan")["a"])


def test_each_value_knows_its_line():
    document = parse_document("a: 1\nb:\n  - {c: 2}\n  -\n    d: 3\n", "a.yaml")
    assert document.lines == {
        ("a",): 1,
        ("b",): 2,
        ("b", 0): 3,
        ("b", 0, "c"): 3,
        ("b", 1): 5,
        ("b", 1, "d"): 5,
    }
    assert document.where(("b", 1, "d")) == "a.yaml:5: b.1.d"


def test_anchors_and_merges_are_read():
    text = "a: &a {x: 1, y: 2}\nb: {<<: *a, y: 3}\nc: {<<: [{x: 5}, *a]}\nd: *a"
    assert values(text) == {
        "a": {"x": 1, "y": 2},
        "b": {"x": 1, "y": 3},
        "c": {"x": 5, "y": 2},
        "d": {"x": 1, "y": 2},
    }


def bomb() -> str:
    lines = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    lines += [f"a{i + 1}: &a{i + 1} [{', '.join([f'*a{i}'] * 10)}]" for i in range(9)]
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", ["a.yaml", "empty", "geometry"]),
        ("# nothing\n", ["empty"]),
        ("- a\n- b\n", ["a.yaml:1", "a list, not a mapping"]),
        ("just text\n", ["'just text'", "not a mapping"]),
        ("a: 1\nb: 2\na: 3\n", ["a.yaml:3: a", "twice", "line 1"]),
        ("t:\n  a: 1\n  a: 3\n", ["a.yaml:3: t.a", "twice", "line 2"]),
        ("a: 1\n\tb: 2\n", ["a.yaml:2", "tab", "spaces"]),
        ("a: [1, 2\nb: 3\n", ["a.yaml:2", "not YAML", "line 1"]),
        ("a: b: c\n", ["a.yaml:1", "not YAML", "one key a line"]),
        ("a: 1\n---\nb: 2\n", ["a.yaml:2", "second document"]),
        ("a: *nowhere\n", ["a.yaml:1", "nowhere"]),
        ("a: \x07\n", ["a.yaml", "not YAML"]),
        ("a: !!python/object/apply:os.system [ls]\n", ["a.yaml:1: a", "!!python/object/apply"]),
        ("!!python/object:x.Y {}\n", ["a.yaml:1", "!!python/object", "runs no code"]),
        ("a: !!timestamp 2001-01-01\n", ["a.yaml:1: a", "!!timestamp", "remove"]),
        ("a: !mine 3\n", ["a.yaml:1: a", "!mine", "runs no code"]),
        ("a: {!mine b: 3}\n", ["a.yaml:1: a", "!mine"]),
        ("a: {1: 3}\n", ["a.yaml:1: a", "'1'", "words"]),
        ("a: {[1]: 3}\n", ["a.yaml:1: a", "as a key"]),
        ("a: {<<: 3}\n", ["a.yaml:1", "not a mapping"]),
        ("a: &a [*a]\n", ["a.yaml:1", "too deeply"]),
        ("a: " + "[" * 1200, ["a.yaml", "too deeply"]),
        (bomb(), ["more values"]),
    ],
)
def test_what_is_refused_and_where(text, says):
    with pytest.raises(InputError) as caught:
        values(text)
    for words in says:
        assert words in str(caught.value)


def test_files_that_cannot_be_read(tmp_path):
    good = tmp_path / "t_domain.yaml"
    good.write_text("a: 1\n")
    assert read_document(str(good)).data == {"a": 1}
    (tmp_path / "latin.yaml").write_bytes(b"a: 1\nb: caf\xe9\n")
    (tmp_path / "large.yaml").write_bytes(b"#" * 1_000_001)
    for name, says in {
        "t_domian.yaml": ["no such file", "did you mean", "t_domain.yaml"],
        "t_domain": ["no such file", "did you mean", "t_domain.yaml"],
        "zzzz.yaml": ["no such file", "t_domain.yaml"],
        "nowhere/a.yaml": ["no such file", "no folder", "nowhere"],
        "": ["is a folder", "t_domain.yaml"],
        "latin.yaml": ["latin.yaml:2", "0xe9", "UTF-8"],
        "large.yaml": ["1.0 MB", "at most 1 MB"],
        "a\0b.yaml": ["cannot be read"],
    }.items():
        with pytest.raises(InputError) as caught:
            read_document(str(tmp_path / name) if name else str(tmp_path))
        for words in says:
            assert words in str(caught.value), name


def test_a_byte_order_mark_is_no_part_of_the_text(tmp_path):
    file = tmp_path / "bom.yaml"
    file.write_bytes(b"\xef\xbb\xbfa: 1\n")
    assert read_document(str(file)).data == {"a": 1}
