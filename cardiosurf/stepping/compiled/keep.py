"""Where the machine code is kept, and how functions are compiled."""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba

_Function = TypeVar("_Function", bound=Callable[..., Any])

# what is compiled into the loops; numba itself looks only at the file that a function stands in
_SOURCES = ("stepping", "stepping/compiled", "kinetics", "analysis/compiled")


def _digest() -> str:
    """Return a short hash of all sources that the machine code is made of."""
    package = Path(__file__).parents[2]
    found = hashlib.sha256(numba.__version__.encode())
    for folder in _SOURCES:
        for path in sorted((package / folder).glob("*.py")):
            found.update(path.read_bytes())
    return found.hexdigest()[:16]


def _keep_in_users_cache() -> bool:
    """Choose a folder for the machine code and return whether it can be written to.

    NUMBA_CACHE_DIR has the first word. A folder for each version of the sources: code of another
    version is never taken.
    """
    if "NUMBA_CACHE_DIR" in os.environ:
        folder = Path(os.environ["NUMBA_CACHE_DIR"])
    else:
        base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        folder = Path(base) / "cardiosurf" / f"compiled-{_digest()}"
        # set by name: the annotations of numba do not know its settings
        vars(numba.config)["CACHE_DIR"] = str(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK)


KEPT = _keep_in_users_cache()

# a dict, as numba's annotations do not know all of its options
_OPTIONS: dict[str, Any] = {
    # sums may be reordered and products fused, but infinite numbers and NaN stay what they are
    "fastmath": {"contract", "reassoc", "nsz", "arcp"},
    "error_model": "numpy",
    "boundscheck": False,
    "no_cfunc_wrapper": True,
}
# Python never calls it, and what it would need for that takes as long to compile as the rest
_NO_WRAPPER: dict[str, Any] = {"no_cpython_wrapper": True}


def compiled(function: _Function) -> _Function:
    """Have a function compiled when it is first called, and its machine code kept if possible."""
    jitted: _Function = numba.njit(cache=KEPT, nogil=True, **_OPTIONS)(function)
    return jitted


def inlined(function: _Function) -> _Function:
    """Have a function written out in those that call it, before they are compiled."""
    jitted: _Function = numba.njit(inline="always", **_OPTIONS, **_NO_WRAPPER)(function)
    return jitted


def apart(function: _Function) -> _Function:
    """Have a function compiled by itself, for those that call it.

    It takes a fifth of a second more than ``inlined``, but its arguments are known to be apart.
    """
    jitted: _Function = numba.njit(**_OPTIONS, **_NO_WRAPPER)(function)
    return jitted
