"""``--set a.b.c=v``: values laid over a config file."""

import copy
from typing import Any

from cardiosurf.config.document import Document, KeyPath, key_in, names_in
from cardiosurf.config.reader import parse_value
from cardiosurf.errors import InputError
from cardiosurf.spelling import did_you_mean

_FORM = "key.path=value, with list items by index or by their name"
_EXAMPLE = "--set tissue.patches.0.anisotropy=4"


def override(document: Document, option: str) -> Document:
    """Return the document with one ``--set`` option laid over it.

    Parameters
    ----------
    document : Document
        The config, as far as it is known.
    option : str
        ``key.path=value``; the value is YAML, list items go by index or by their ``name``.

    Raises
    ------
    InputError
        If the option is not of that form, or its path runs into something that has no keys.
        Keys that no section has are refused when the config is decoded.
    """
    dotted, equals, text = option.partition("=")
    words = dotted.strip().split(".")
    name = f"--set {option}"
    if not equals or not all(words):
        raise InputError(name, "is not of the form key.path=value", _FORM, _EXAMPLE)
    return lay(document, dotted.strip(), parse_value(text, name), name)


def lay(document: Document, dotted: str, value: Any, label: str) -> Document:
    """Return the document with one value laid over it.

    Parameters
    ----------
    document : Document
        The config, as far as it is known.
    dotted : str
        The key path, list items by index or by their ``name``.
    value : plain data
        What goes there.
    label : str
        What messages about the value begin with: the option, or the place in a scenario.

    Raises
    ------
    InputError
        If the path runs into something that has no keys.
    """
    words = dotted.split(".")
    if not all(words):
        raise InputError(label, f"{dotted!r} is no key path", "words with dots between them")
    data = copy.deepcopy(document.data)
    path, created = _lay(data, words, value, label)
    below = len(path)
    lines = {key: line for key, line in document.lines.items() if key[:below] != path}
    options = {key: set_by for key, set_by in document.options.items() if key[:below] != path}
    options |= dict.fromkeys([*created, path], label)
    return Document(document.file, data, lines, options)


def _lay(
    data: dict[str, Any], words: list[str], value: Any, name: str
) -> tuple[KeyPath, list[KeyPath]]:
    """Set the value in ``data``; return its path and the paths of mappings made on the way."""
    path: list[str | int] = []
    created: list[KeyPath] = []
    inside: Any = data
    for word in words[:-1]:
        key = _key(inside, word, path, name)
        path.append(key)
        if isinstance(inside, dict) and inside.get(key) is None:
            inside[key] = {}
            created.append(tuple(path))
        inside = inside[key]
    key = _key(inside, words[-1], path, name)
    inside[key] = value
    return (*path, key), created


def _key(inside: Any, word: str, path: list[str | int], name: str) -> str | int:
    """Return the key or index that ``word`` stands for in a mapping or list."""
    if isinstance(inside, dict):
        return word
    here = ".".join(map(str, path))
    if not isinstance(inside, list):
        raise InputError(
            name,
            f"{here} is {inside!r}, which has no key {word!r}",
            _FORM,
            f"--set {here}={{{word}: ...}}",
        )
    key = key_in(inside, word)
    if key is not None:
        return key
    names = [known for _, known in names_in(inside)]
    guess = did_you_mean(word, names)
    count = len(inside)
    indices = "it is empty" if not count else "0" if count == 1 else f"0 to {count - 1}"
    raise InputError(
        name,
        f"{here} has no item {word!r}" + (f", {guess}" if guess else ""),
        ", ".join([*names, indices]),
        "" if count else f"--set '{here}=[{{...}}]' gives the whole list",
    )
