"""Surfaces kept on disk: a batch of runs on one mesh makes it once and reads it back."""

import hashlib
import json
import os
import platform
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from secrets import token_hex
from time import time
from typing import Any

import numpy as np
import scipy

import cardiosurf.geometry
from cardiosurf.geometry import AnyShape, Surface, build_surface
from cardiosurf.geometry.regions import Region

SWITCH, FOLDER = "CARDIOSURF_CACHE", "CARDIOSURF_CACHE_DIR"
"""Environment variables: ``off`` switches the cache off; a folder other than the user's."""

_LAYOUT = 1
_ROOM = 10**9
_ABANDONED = 3600.0
_ARRAYS = ("points", "triangles", "part_of", "frame", "net")
_GROUPS = ("edges", "regions")


def surface_of(shape: AnyShape, edge_length: float, regions: Mapping[str, Region]) -> Surface:
    """Return what ``build_surface`` returns, read back if it was built before.

    Surfaces lie in the user's cache folder, under a hash of all that they follow from: shape, edge
    length, regions, the code that makes them and the versions of NumPy and SciPy. Whatever is
    wrong with the cache, the surface is built.

    Parameters
    ----------
    shape : AnyShape
        One of ``SHAPES``.
    edge_length : float
        Usual length of the mesh edges, in su.
    regions : mapping of str to Region
        Regions by name, patch references already resolved.

    Raises
    ------
    InputError
        What ``build_surface`` raises.
    """
    file = _file_of(shape, edge_length, regions)
    if file is None:
        return build_surface(shape, edge_length, regions)
    surface = _found(file, regions)
    if surface is None:
        surface = build_surface(shape, edge_length, regions)
        _keep(file, surface)
    return surface


def cache_folder() -> Path | None:
    """Return where surfaces are kept, None if the cache is switched off or has no place."""
    if os.environ.get(SWITCH, "").strip().lower() == "off":
        return None
    if given := os.environ.get(FOLDER, ""):
        return Path(given)
    caches = Path(os.environ.get("XDG_CACHE_HOME", ""))
    try:
        # the XDG specification has relative paths ignored
        caches = caches if caches.is_absolute() else Path.home() / ".cache"
    except RuntimeError:
        return None
    return caches / "cardiosurf" / "surfaces"


def _file_of(shape: AnyShape, edge_length: float, regions: Mapping[str, Region]) -> Path | None:
    """Return the file of a surface, named by the hash of all that the surface follows from."""
    folder = cache_folder()
    if folder is None:
        return None
    # sections write out all their fields, numbers to the last digit
    asked = repr((shape, float(edge_length), list(regions.items())))
    try:
        return folder / f"{hashlib.sha256(f'{_code()} {asked}'.encode()).hexdigest()}.npz"
    except OSError:
        # a package that is not a folder of files
        return None


@cache
def _code() -> str:
    """Return the hash of the code that makes surfaces, and of this file's layout."""
    found = hashlib.sha256(
        f"{_LAYOUT} {np.__version__} {scipy.__version__} {platform.machine()}".encode()
    )
    for file in sorted(Path(str(cardiosurf.geometry.__file__)).parent.rglob("*.py")):
        found.update(file.name.encode() + b"\0" + file.read_bytes() + b"\0")
    return found.hexdigest()


def _found(file: Path, regions: Mapping[str, Region]) -> Surface | None:
    try:
        surface = _read(file, regions)
        # the files used last are kept longest
        os.utime(file)
    except Exception:  # there are many ways to spoil a file, and one remedy
        return None
    return surface


def _keep(file: Path, surface: Surface) -> None:
    # a surface that cannot be kept is built again
    with suppress(Exception):
        _write(file, surface)
        _tidy(file.parent)


def _write(file: Path, surface: Surface) -> None:
    """Write a surface beside its place, and move it there when it is whole."""
    file.parent.mkdir(parents=True, exist_ok=True)
    names = {
        "parts": surface.parts,
        "axes": surface.axes,
        **{group: list(getattr(surface, group)) for group in _GROUPS},
    }
    arrays: dict[str, Any] = {name: getattr(surface, name) for name in _ARRAYS}
    for group in _GROUPS:
        for number, array in enumerate(getattr(surface, group).values()):
            arrays[f"{group}.{number}"] = array
    # its own name, so that processes that make the same surface do not meet
    partial = file.with_suffix(f".{token_hex(8)}.partial")
    try:
        with partial.open("xb") as out:
            np.savez(out, names=np.array(json.dumps(names)), **arrays)
        partial.replace(file)
    finally:
        partial.unlink(missing_ok=True)


def _read(file: Path, regions: Mapping[str, Region]) -> Surface | None:
    """Return the surface in a file, None if it is not what was written; damage raises anything."""
    with np.load(file, allow_pickle=False) as stored:
        names = json.loads(str(stored["names"]))
        arrays: dict[str, Any] = {name: stored[name] for name in _ARRAYS}
        for group in _GROUPS:
            listed = enumerate(names[group])
            arrays[group] = {name: stored[f"{group}.{number}"] for number, name in listed}
    parts, axes = tuple(names["parts"]), tuple((one, other) for one, other in names["axes"])
    surface = Surface(parts=parts, axes=axes, **arrays)
    return surface if _sound(surface, regions) else None


def _sound(surface: Surface, regions: Mapping[str, Region]) -> bool:
    """Return whether the arrays fit each other."""
    n, m = len(surface.points), len(surface.triangles)
    pairs = list(surface.edges.values())
    return (
        all(
            array.shape == shape and array.dtype == kind
            for array, shape, kind in (
                (surface.points, (n, 3), np.float64),
                (surface.triangles, (m, 3), np.int64),
                (surface.part_of, (m,), np.int64),
                (surface.frame, (m, 2, 3), np.float64),
                (surface.net, (m, 2), np.float64),
                *((mask, (m,), np.bool_) for mask in surface.regions.values()),
                *((pair, (len(pair), 2), np.int64) for pair in pairs),
            )
        )
        and list(surface.regions) == list(regions)
        and all(one.min() >= 0 and one.max() < n for one in (surface.triangles, *pairs))
        and surface.part_of.min() >= 0
        and surface.part_of.max() < len(surface.parts) == len(surface.axes)
    )


def _tidy(folder: Path) -> None:
    """Remove what killed processes left, and the surfaces not used for longest beyond the room."""
    total = 0
    files = [(one, one.stat()) for one in folder.iterdir() if one.suffix in (".npz", ".partial")]
    for file, stat in sorted(files, key=lambda pair: pair[1].st_mtime, reverse=True):
        if file.suffix == ".partial":
            if stat.st_mtime < time() - _ABANDONED:
                file.unlink(missing_ok=True)
            continue
        total += stat.st_size
        if total > _ROOM:
            file.unlink(missing_ok=True)
