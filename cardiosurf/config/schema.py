"""The JSON Schema of a config, for editors."""

import inspect
import re
from collections.abc import Iterator
from typing import Any

from cardiosurf.config.decode import adapter_of
from cardiosurf.config.keys import choice_of, fields_of, items_of, section_of
from cardiosurf.config.sections import Config

SCHEMA_ID = "cardiosurf/config/1"
_HEADING = re.compile(r"\n(?:Attributes|Parameters)\n-+\n")
_FIELD = re.compile(r"^(\w[\w, ]*) : .*$")


def config_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a config file.

    Keys carry the descriptions of the sections' docstrings, so that an editor shows them.
    """
    return schema_of(Config, SCHEMA_ID, "cardiosurf config")


def schema_of(root: type, identity: str, title: str) -> dict[str, Any]:
    """Return the JSON Schema of a file.

    Parameters
    ----------
    root : type
        The section that the whole file is.
    identity : str
        Its ``$id``: name and version.
    title : str
        What an editor calls it.
    """
    schema = adapter_of(root).json_schema(by_alias=True, mode="validation")
    classes = {section.__name__: section for section in _sections(root, set())}
    for name, definition in schema.get("$defs", {}).items():
        _document(definition, classes.get(name))
    _document(schema, root)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": identity,
        **schema,
        "title": title,
    }


def _document(definition: dict[str, Any], section: type | None) -> None:
    """Describe a section and its keys with the words of its docstring."""
    if section is None:
        return
    text = inspect.getdoc(section) or ""
    definition["description"] = " ".join(_HEADING.split(text)[0].split())
    for key, words in _described_fields(text).items():
        if key in definition.get("properties", {}):
            definition["properties"][key].setdefault("description", words)


def _described_fields(text: str) -> dict[str, str]:
    """Return the descriptions of the fields in a numpydoc docstring."""
    described: dict[str, str] = {}
    names: list[str] = []
    for line in text.splitlines():
        heading = _FIELD.match(line)
        if heading:
            names = [name.strip() for name in heading[1].split(",")]
        elif line.startswith("    "):
            for name in names:
                described[name] = f"{described.get(name, '')} {line.strip()}".strip()
        else:
            names = []
    return described


def _sections(annotation: Any, seen: set[type]) -> Iterator[type]:
    """Yield every section class that can be reached from a type."""
    section = section_of(annotation)
    choice = choice_of(annotation)
    if section is not None:
        if section in seen:
            return
        seen.add(section)
        yield section
        inner = list(fields_of(section).values())
    elif choice is not None:
        inner = list(choice.members.values())
    else:
        inner = list(items_of(annotation))
    for child in inner:
        yield from _sections(child, seen)
