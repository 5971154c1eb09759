"""A config back to YAML, always in the same words."""

import dataclasses
from typing import Any

import yaml

from cardiosurf.config.core_schema import CoreDumper
from cardiosurf.config.keys import yaml_name
from cardiosurf.config.sections import Config

# what tells the kinds of a section apart is read first
_FIRST = ("kind", "model", "shape")


def dump_config(config: Config) -> str:
    """Return the config as canonical YAML, with every default written out.

    Equal configs give equal text, and the text decodes to an equal config.
    """
    # the pure-Python dumper is used on purpose: libyaml breaks long lines in other places
    return yaml.dump(
        _plain(config),
        Dumper=CoreDumper,
        sort_keys=False,
        default_flow_style=None,
        allow_unicode=True,
        width=100,
    )


def _plain(value: Any) -> Any:
    """Return sections as mappings, tuples as lists; optional keys not given are left out."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = sorted(dataclasses.fields(value), key=lambda field: field.name not in _FIRST)
        return {
            yaml_name(field.name): _plain(getattr(value, field.name))
            for field in fields
            if getattr(value, field.name) is not None or field.default is not None
        }
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return value
