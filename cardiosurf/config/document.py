"""A config as it was written: plain data, and where each value of it comes from."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from cardiosurf.errors import InputError

KeyPath: TypeAlias = tuple[str | int, ...]
_LONGEST_INDEX = 10


@dataclass(frozen=True)
class Document:
    """The data of one config file, with ``--set`` options laid over it.

    Attributes
    ----------
    file : str
        The file's path, as the user wrote it.
    data : dict
        Mappings, lists and scalars.
    lines : mapping of KeyPath to int
        The line of each key and list item, counted from 1.
    options : mapping of KeyPath to str
        What gave the values that are not the file's own: the ``--set`` option as it was written,
        or the place in a scenario.
    """

    file: str
    data: dict[str, Any]
    lines: Mapping[KeyPath, int]
    options: Mapping[KeyPath, str]

    def where(self, path: KeyPath) -> str:
        """Return the place of a value for a message: file, line and key path, or the option."""
        for length in range(len(path), 0, -1):
            option = self.options.get(path[:length])
            if option is not None:
                inner = f" ({self.spelled(path)})" if length < len(path) else ""
                return f"{option}{inner}"
            if path[:length] in self.lines:
                return f"{self.file}:{self.lines[path[:length]]}: {self.spelled(path)}"
        return f"{self.file}: {self.spelled(path)}" if path else self.file

    def line(self, path: KeyPath) -> int:
        """Return the line of a value, of the nearest thing around it, or 0."""
        for length in range(len(path), 0, -1):
            if path[:length] in self.lines:
                return self.lines[path[:length]]
        return 0

    def spelled(self, path: KeyPath) -> str:
        """Return a key path with dots, list items by their ``name`` where they have one."""
        words: list[str] = []
        value: Any = self.data
        for key in path:
            names = dict(names_in(value)) if isinstance(value, list) else {}
            name = names.get(key) if isinstance(key, int) else None
            # two items of one name, or a name with a dot, go by their index
            unique = name is not None and "." not in name and list(names.values()).count(name) == 1
            words.append(name if unique and name is not None else str(key))
            value = _item(value, key)
        return ".".join(words)

    def find(self, dotted: str) -> KeyPath:
        """Return as much of a dotted key path as the data has."""
        path: list[str | int] = []
        value: Any = self.data
        for word in dotted.split("."):
            key = key_in(value, word)
            if key is None:
                break
            path.append(key)
            value = _item(value, key)
        return tuple(path)

    def value_at(self, dotted: str) -> object:
        """Return the value at a dotted key path, None if the data do not have it."""
        path = self.find(dotted)
        return _at(self.data, path) if len(path) == len(dotted.split(".")) else None

    def placed(self, error: InputError) -> InputError:
        """Return the error with file and line (or option) before the key path it names."""
        # the mesher speaks of "region tissue.patches.block"
        named = error.where.removeprefix("region ")
        path = self.find(named)
        inner = (*path, "region")
        if named != error.where and path and self.spelled(path) == named:
            value = _item(_at(self.data, path), "region")
            if value is not None:
                written = json.dumps(value, ensure_ascii=False).replace('"', "")
                problem = f"{written:.80}: {error.problem}"
                return InputError(self.where(inner), problem, error.allowed, error.hint)
        if not path:
            where = f"{self.file}: {error.where}" if error.where else self.file
            return InputError(where, error.problem, error.allowed, error.hint)
        where = self.where(path)
        beyond = named.split(".")[len(path) :]
        if beyond and not where.startswith(tuple(self.options.values())):
            where = ".".join([where, *beyond])
        return InputError(where, error.problem, error.allowed, error.hint)


def key_in(value: object, word: str) -> str | int | None:
    """Return the key of ``value`` that ``word`` stands for: a key, an index or an item's name."""
    if isinstance(value, dict):
        return word if word in value else None
    if isinstance(value, list):
        if is_index(word):
            return int(word) if len(word) < _LONGEST_INDEX and int(word) < len(value) else None
        return next((number for number, name in names_in(value) if name == word), None)
    return None


def is_index(word: str) -> bool:
    """Tell whether a word is the index of a list item."""
    # other scripts' digits, and superscripts, are letters of a name
    return word.isascii() and word.isdigit()


def names_in(items: Iterable[object]) -> list[tuple[int, str]]:
    """Return index and ``name`` of every list item that has one."""
    return [
        (number, item["name"])
        for number, item in enumerate(items)
        if isinstance(item, dict) and isinstance(item.get("name"), str)
    ]


def _at(value: object, path: KeyPath) -> object:
    for key in path:
        value = _item(value, key)
    return value


def _item(value: object, key: str | int) -> object:
    if isinstance(value, dict):
        return value.get(key)
    if isinstance(value, list) and isinstance(key, int) and key < len(value):
        return value[key]
    return None
