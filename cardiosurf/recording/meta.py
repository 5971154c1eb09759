"""Where and with what a recording was made, and how the file says so."""

import platform
import sys
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import version
from typing import Any

import h5py
import numpy as np

PACKAGES = ("cardiosurf", "numpy", "scipy", "scikit-fem", "h5py")


def provenance() -> Mapping[str, str | Mapping[str, str]]:
    """Return the versions of what computed this, the platform and the time, for ``meta``."""
    return {
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "platform": f"{platform.system()} {platform.release()} {platform.machine()}",
        "versions": {"python": sys.version.split()[0]} | {name: version(name) for name in PACKAGES},
    }


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
