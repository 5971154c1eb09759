"""In what two configs differ."""

from collections.abc import Iterator
from typing import Any

from cardiosurf.config.decode import show
from cardiosurf.config.document import names_in
from cardiosurf.config.reader import parse_document

NOTHING = "nothing"


def config_differences(before: str, now: str) -> list[str]:
    """Return in which keys two configs differ, as ``key: before -> now``.

    Parameters
    ----------
    before, now : str
        Resolved configs as YAML (``Loaded.text``).

    Examples
    --------
    >>> config_differences("mesh: {edge_length: 2}", "mesh: {edge_length: 1.5}")
    ['mesh.edge_length: 2 -> 1.5']
    """
    old = dict(_leaves(parse_document(before, "before").data, ()))
    new = dict(_leaves(parse_document(now, "now").data, ()))
    return [
        f"{'.'.join(key)}: {_shown(old, key)} -> {_shown(new, key)}"
        for key in dict.fromkeys([*old, *new])
        if _shown(old, key) != _shown(new, key)
    ]


def _leaves(value: Any, path: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield every value with its key path; list items by their name, lists of numbers whole."""
    if isinstance(value, dict) and value:
        for key, item in value.items():
            yield from _leaves(item, (*path, str(key)))
    elif isinstance(value, list) and any(isinstance(item, dict | list) for item in value):
        names = dict(names_in(value))
        for number, item in enumerate(value):
            yield from _leaves(item, (*path, names.get(number, str(number))))
    else:
        yield path, value


def _shown(leaves: dict[tuple[str, ...], Any], key: tuple[str, ...]) -> str:
    return show(leaves[key]) if key in leaves else NOTHING
