"""A YAML file to plain data, with the line of every key; duplicate keys and tags are refused."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from cardiosurf.config.core_schema import CORE, CoreLoader, scalar
from cardiosurf.config.document import Document, KeyPath
from cardiosurf.errors import InputError
from cardiosurf.spelling import nearest

_LARGEST_FILE = 1_000_000
_DEEPEST = 40
_MOST_VALUES = 50_000
_PLAIN = "mappings, lists, text, numbers, true, false and null"
CONFIG_KEYS = "geometry, stimulus and time"
"""What every config has."""


def read_document(file: str, keys: str = CONFIG_KEYS) -> Document:
    """Read a config file, or another whose top level is a mapping.

    Parameters
    ----------
    file : str
        Path of a YAML file.
    keys : str
        The keys that a message asks for when the file is no mapping.

    Raises
    ------
    InputError
        If the file cannot be read, or is not one YAML mapping of plain values.
    """
    return parse_document(_read_text(file), file, keys)


def parse_document(text: str, file: str, keys: str = CONFIG_KEYS) -> Document:
    """Return the data of a config's text; ``file`` is what messages call it."""
    top_level = f"a mapping with at least the keys {keys}"
    try:
        node = CoreLoader(text).get_single_node()
    except yaml.MarkedYAMLError as error:
        raise _not_yaml(error, file) from None
    except yaml.YAMLError as error:
        problem = f"not YAML: {str(error).splitlines()[0]}"
        raise InputError(file, problem, "printable text in UTF-8") from None
    except RecursionError:
        raise InputError(file, "nested too deeply", f"at most {_DEEPEST} levels") from None
    if node is None:
        raise InputError(file, "the file is empty", top_level, "start from a file in configs/")
    if not isinstance(node, yaml.MappingNode):
        kind = "a list" if isinstance(node, yaml.SequenceNode) else f"the text {node.value!r:.60}"
        raise InputError(_line(file, node), f"the file holds {kind}, not a mapping", top_level)
    builder = _Builder(file)
    data: dict[str, Any] = builder.value(node, ())
    return Document(file, data, builder.lines, {})


def parse_value(text: str, option: str) -> Any:
    """Return the value of a ``--set`` option, which is written as YAML.

    Raises
    ------
    InputError
        If ``text`` is not YAML; the message names ``option``.
    """
    try:
        node = CoreLoader(text).get_single_node()
    except (yaml.YAMLError, RecursionError) as error:
        problem = getattr(error, "problem", None) or str(error).splitlines()[0]
        raise InputError(
            option,
            f"the value {text!r} is not YAML ({problem})",
            "a number, a word, [a, list] or {a: mapping}",
            "put the whole option in quotes: --set 'stimulus.0.centre=[0, 100, 0]'",
        ) from None
    return None if node is None else _Builder(option).value(node, ())


def _read_text(file: str) -> str:
    path = Path(file)
    try:
        if path.is_dir():
            names = sorted(p.name for p in path.iterdir() if p.suffix in {".yaml", ".yml"})
            hint = f"one of its files: {', '.join(names[:8])}" if names else ""
            raise InputError(file, "is a folder", "a YAML file", hint)
        size = path.stat().st_size
        if size > _LARGEST_FILE:
            problem = f"has {size / 1e6:.1f} MB, which is no config"
            raise InputError(file, problem, f"at most {_LARGEST_FILE / 1e6:.0f} MB")
        raw = path.read_bytes()
    except FileNotFoundError:
        raise _missing(path, file) from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(file, f"cannot be read: {reason}", "a readable YAML file") from None
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        raise InputError(
            f"{file}:{line}",
            f"byte 0x{raw[error.start]:02x} is not UTF-8 text",
            "a YAML file in UTF-8",
            "save the file as UTF-8; is it a config at all?",
        ) from None


def _missing(path: Path, file: str) -> InputError:
    folder = path.parent
    if not folder.is_dir():
        return InputError(file, f"no such file: there is no folder {str(folder)!r}")
    names = sorted(p.name for p in folder.iterdir() if p.suffix in {".yaml", ".yml"})
    close = nearest(path.name, names) or nearest(f"{path.name}.yaml", names)
    if close:
        return InputError(file, f"no such file, did you mean {str(folder / close)!r}?")
    place = "this folder" if str(folder) == "." else str(folder)
    if not names:
        return InputError(file, f"no such file; {place} has no YAML file")
    return InputError(file, "no such file", f"a file of {place}: {', '.join(names[:8])}")


def _not_yaml(error: yaml.MarkedYAMLError, file: str) -> InputError:
    mark = error.problem_mark or error.context_mark
    where = f"{file}:{mark.line + 1}" if mark else file
    problem = error.problem or "cannot be read"
    hint = ""
    if "'\\t'" in problem:
        problem, hint = "a tab where YAML wants spaces", "indent with spaces"
    elif "expected a single document" in (error.context or ""):
        problem, hint = "a second document begins here (---)", "one config a file"
    elif "mapping values are not allowed" in problem:
        hint = "one key a line, at the same indentation as its neighbours; quote text with ': '"
    elif error.context_mark is not None and mark is not None and error.context:
        problem += f" ({error.context} that begins on line {error.context_mark.line + 1})"
    return InputError(where, f"not YAML: {problem}", "", hint)


def _line(file: str, node: yaml.Node) -> str:
    return f"{file}:{node.start_mark.line + 1}"


def _place(file: str, node: yaml.Node, path: KeyPath) -> str:
    return ": ".join([_line(file, node), *([".".join(map(str, path))] if path else [])])


@dataclass(frozen=True)
class _Builder:
    """Turns nodes into data and notes their lines."""

    file: str
    lines: dict[KeyPath, int] = field(default_factory=dict)

    def value(self, node: yaml.Node, path: KeyPath) -> Any:
        if len(path) > _DEEPEST or len(self.lines) > _MOST_VALUES:
            what = "nested too deeply" if len(path) > _DEEPEST else "more values than a config has"
            allowed = f"at most {_DEEPEST} levels and {_MOST_VALUES} values, aliases written out"
            raise InputError(_line(self.file, node), what, allowed)
        if not node.tag.startswith(CORE) or node.tag.removeprefix(CORE) not in _KNOWN_TAGS:
            raise self._tagged(node, path)
        if isinstance(node, yaml.MappingNode):
            return self.mapping(node, path)
        if isinstance(node, yaml.SequenceNode):
            return [self._noted(item, item, (*path, i)) for i, item in enumerate(node.value)]
        self._check_text(node, path)
        return scalar(node.tag, node.value)

    def _check_text(self, node: yaml.Node, path: KeyPath) -> None:
        """Refuse half characters, which escapes in double quotes can spell."""
        if any("\ud800" <= character <= "\udfff" for character in node.value):
            raise InputError(
                _place(self.file, node, path),
                f"{node.value!r} holds half a character (a surrogate)",
                "text of whole Unicode characters",
            )

    def mapping(self, node: yaml.MappingNode, path: KeyPath) -> dict[str, Any]:
        first_line: dict[str, int] = {}
        merged: dict[str, Any] = {}
        own: dict[str, Any] = {}
        for key_node, value_node in node.value:
            if key_node.tag == CORE + "merge":
                merged |= self._merged(value_node, path)
                continue
            key = self._key(key_node, path)
            if key in first_line:
                raise InputError(
                    _place(self.file, key_node, (*path, key)),
                    f"key {key!r} is given twice, first on line {first_line[key]}",
                    "each key once",
                )
            first_line[key] = key_node.start_mark.line + 1
            own[key] = self._noted(value_node, key_node, (*path, key))
        return merged | own

    def _noted(self, node: yaml.Node, at: yaml.Node, path: KeyPath) -> Any:
        self.lines[path] = at.start_mark.line + 1
        return self.value(node, path)

    def _merged(self, node: yaml.Node, path: KeyPath) -> dict[str, Any]:
        if isinstance(node, yaml.MappingNode):
            return self.mapping(node, path)
        if isinstance(node, yaml.SequenceNode) and all(
            isinstance(item, yaml.MappingNode) for item in node.value
        ):
            merged: dict[str, Any] = {}
            for item in reversed(node.value):
                merged |= self.mapping(item, path)
            return merged
        raise InputError(_line(self.file, node), "<< merges something that is not a mapping")

    def _key(self, node: yaml.Node, path: KeyPath) -> str:
        if isinstance(node, yaml.ScalarNode) and node.tag == CORE + "str":
            self._check_text(node, path)
            return str(node.value)
        if not node.tag.startswith(CORE) or node.tag.removeprefix(CORE) not in _KNOWN_TAGS:
            raise self._tagged(node, path)
        given = repr(node.value) if isinstance(node, yaml.ScalarNode) else "a list or a mapping"
        raise InputError(
            _place(self.file, node, path), f"{given} is used as a key", "words as keys"
        )

    def _tagged(self, node: yaml.Node, path: KeyPath) -> InputError:
        tag = node.tag.replace(CORE, "!!")
        return InputError(
            _place(self.file, node, path),
            f"the tag {tag} is refused: a config is data and runs no code",
            _PLAIN,
            f"remove {tag}",
        )


_KNOWN_TAGS = frozenset({"null", "bool", "int", "float", "str", "seq", "map"})
