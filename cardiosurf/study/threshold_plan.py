"""What a threshold search looks for, between which values, and on which meshes."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from cardiosurf.config import Loaded, overlay
from cardiosurf.errors import InputError
from cardiosurf.study.critical import Search
from cardiosurf.study.edges import edge_of
from cardiosurf.study.extrapolation import LEVELS
from cardiosurf.study.question import Question
from cardiosurf.study.steps import step_of
from cardiosurf.study.threshold_result import Level

RATIO = math.sqrt(2.0)
CLOSEST_RATIO = 1.1
"""Values on edges closer than this differ by less than their brackets."""
FIXED = ("mesh.edge_length", "time.step", "record.frames_every")
"""Keys that a search sets itself."""
_INDEX = re.compile(r"\[\s*(\w+)\s*\]")


@dataclass(frozen=True)
class Plan:
    """What is looked for, and on which meshes.

    Attributes
    ----------
    loaded : Loaded
        The config.
    vary : str
        The key path of the number that is varied, as ``--set`` spells it.
    search : Search
        Between which values, and how closely.
    levels : tuple of Level
        Edge lengths and steps, the coarsest first.
    question : Question
        What is asked of each run.
    """

    loaded: Loaded
    vary: str
    search: Search
    levels: tuple[Level, ...]
    question: Question

    def at(self, level: Level, value: float) -> Loaded:
        """Return the config of one run.

        Raises
        ------
        InputError
            If the key does not take the value.
        """
        try:
            return overlay(
                self.loaded,
                [
                    f"mesh.edge_length={level.edge_length!r}",
                    f"time.step={level.step!r}",
                    "record.frames_every=null",
                    f"{self.vary}={float(value)!r}",
                ],
            )
        except InputError as error:
            raise _of_vary(error, self.vary) from None


def plan_levels(loaded: Loaded, edges: Sequence[float] = ()) -> tuple[Level, ...]:
    """Return the meshes of a search, and the step on each.

    Without ``edges`` they are sqrt(2), 1 and 1/sqrt(2) times the config's; a level finer where the
    shape is too small for the first. The coarsest mesh takes the config's step and finer ones
    proportionally smaller ones, so that the errors of space and time fall together and one
    extrapolation takes care of both.

    Parameters
    ----------
    loaded : Loaded
        The config.
    edges : sequence of float
        Edge lengths, in su, in any order.

    Raises
    ------
    InputError
        If there are fewer than three edges, or two of them are nearly the same.
    """
    config = loaded.config
    if edges:
        sizes = sorted((float(edge) for edge in edges), reverse=True)
        _check_edges(sizes)
    else:
        usual = edge_of(config).edge_length
        first = usual * RATIO
        if not _fits(loaded, first):
            first = usual
        sizes = [float(f"{first / RATIO**number:.3g}") for number in range(LEVELS)]
    step = step_of(config)
    return tuple(Level(edge, float(f"{step * edge / sizes[0]:.4g}")) for edge in sizes)


def key_path(vary: str) -> str:
    """Return a key path with dots: ``stimulus[0].centre[1]`` is ``stimulus.0.centre.1``.

    Raises
    ------
    InputError
        If the path is empty, or the search sets this key itself.
    """
    path = _INDEX.sub(r".\1", vary.strip())
    if not path or "=" in path or not all(path.split(".")):
        raise InputError(
            f"--vary {vary}",
            "is not a key path",
            "a.b.c, with list items by index or by their name",
            "--vary tissue.patches.0.anisotropy",
        )
    if path in FIXED:
        hint = "--edges sets the meshes, and steps go with them" if path in FIXED[:2] else ""
        raise InputError(f"--vary {vary}", "the search sets this key itself", "another key", hint)
    return path


def plan_search(
    between: tuple[float, float], tolerance: float | None, *, scan: int, workers: int
) -> Search:
    """Return where to look, with a tolerance of 1/400 of the interval unless one is given.

    Raises
    ------
    InputError
        If the interval is empty or not finite, or the tolerance does not fit it.
    """
    low, high = sorted(between)
    given = f"--between {between[0]:g} {between[1]:g}"
    if not (math.isfinite(low) and math.isfinite(high)):
        raise InputError(given, "is not finite", "two numbers")
    if low == high:
        raise InputError(given, "nothing lies between a number and itself", "two different numbers")
    width = high - low
    tolerance = width / 400.0 if tolerance is None else tolerance
    if not 0.0 < 2.0 * tolerance < width:
        raise InputError(
            f"--tolerance {tolerance:g}",
            f"does not fit an interval of {width:g}",
            f"a number above 0 and below {width / 2.0:g}",
        )
    return Search(low, high, tolerance, scan=scan, parallel=workers)


def _of_vary(error: InputError, vary: str) -> InputError:
    """Return an error about a value that the search set, in terms of its options."""
    option = f"--set {vary}="
    if not error.where.startswith(option):
        return error
    if "whole number" in error.allowed:
        return InputError(
            f"--vary {vary}",
            "takes whole numbers only, between which nothing can be bisected",
            "a key that takes any number",
            "cardiosurf sweep runs through whole numbers",
        )
    where = error.where.replace(option, f"--vary {vary}, at ", 1)
    return InputError(where, error.problem, error.allowed, error.hint.replace("--set", "--vary"))


def _check_edges(sizes: Sequence[float]) -> None:
    given = f"--edges {','.join(f'{size:g}' for size in sizes)}"
    if len(sizes) < LEVELS:
        raise InputError(
            given,
            f"an error bar takes {LEVELS} meshes at least",
            "three edge lengths or more",
            f"--edges {sizes[0]:g},{sizes[0] / RATIO:.3g},{sizes[0] / 2.0:.3g}",
        )
    for coarser, finer in pairwise(sizes):
        if coarser < CLOSEST_RATIO * finer:
            raise InputError(
                given,
                f"{coarser:g} and {finer:g} are too close to tell how the value converges",
                f"neighbours that differ by a factor of {CLOSEST_RATIO} at least",
            )


def _fits(loaded: Loaded, edge: float) -> bool:
    """Return whether a shape is large enough for a mesh."""
    try:
        overlay(loaded, [f"mesh.edge_length={edge!r}"])
    except InputError:
        return False
    return True
