"""The numbers and texts of ``meta`` in a recording's file."""

from collections.abc import Mapping
from typing import Any

import h5py
import numpy as np
from h5py import h5a, h5s, h5t

_TEXT = h5t.py_create(h5py.string_dtype(), logical=True)
_ONE = h5s.create(h5s.SCALAR)


def describe(dataset: h5py.Dataset, units: str, description: str) -> None:
    """Give a new dataset its two attributes, past h5py's upper level, which takes longer."""
    for name, text in ((b"units", units), (b"description", description)):
        attribute = h5a.create(dataset.id, name, _TEXT, _ONE)
        attribute.write(np.array(text, dtype=h5py.string_dtype()))


def write_meta(group: h5py.Group, meta: Mapping[str, Any]) -> None:
    """Write numbers and texts as attributes, and mappings as groups with attributes."""
    for name, value in meta.items():
        if isinstance(value, Mapping):
            write_meta(group.create_group(name), value)
        else:
            group.attrs[name] = h5py.Empty("f8") if value is None else value


def read_meta(group: h5py.Group) -> Mapping[str, Any]:
    """Return what ``write_meta`` wrote."""
    values = {name: _plain(value) for name, value in group.attrs.items()}
    return values | {name: read_meta(inner) for name, inner in group.items()}


def _plain(value: Any) -> Any:
    """Return an attribute as the Python value that was written."""
    if isinstance(value, h5py.Empty):
        return None
    return value.item() if isinstance(value, np.generic) else value
