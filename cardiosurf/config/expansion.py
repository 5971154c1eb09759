"""The points that a scenario's sweep consists of."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from cardiosurf.config.document import KeyPath, is_index
from cardiosurf.config.expectation import Problem
from cardiosurf.config.keys import fields_of
from cardiosurf.config.scenario import LatinHypercube, Link, Scenario
from cardiosurf.config.sections import LONGEST_NAME, Config
from cardiosurf.spelling import did_you_mean

MOST_POINTS = 10_000
_AXES = frozenset({"x", "y", "z", "theta", "phi"})


@dataclass(frozen=True)
class Point:
    """One point of a sweep.

    Attributes
    ----------
    name : str
        What it is called, from what is varied; a file-name-safe word.
    values : mapping
        What is varied, by key path or parameter.
    settings : mapping
        The same by key path alone, parameters resolved.
    """

    name: str
    values: Mapping[str, Any]
    settings: Mapping[str, Any]


def varied(scenario: Scenario) -> tuple[str, ...]:
    """Return what a scenario varies, in its order: grid, lists, latin hypercube."""
    sampled = scenario.latin_hypercube.ranges if scenario.latin_hypercube else {}
    return tuple(dict.fromkeys([*scenario.grid, *scenario.lists, *sampled]))


def expand(scenario: Scenario) -> list[Point]:
    """Return all points: the grid's values with the lists' rows with the samples.

    Parameters
    ----------
    scenario : Scenario
        One that ``expansion_problems`` finds nothing wrong with; without anything to vary it has
        one point, the base itself.
    """
    names = short_names(varied(scenario))
    rows = [
        [dict(zip(scenario.grid, row, strict=True)) for row in product(*scenario.grid.values())],
        [
            dict(zip(scenario.lists, row, strict=True))
            for row in zip(*scenario.lists.values(), strict=True)
        ]
        or [{}],
        samples(scenario.latin_hypercube) if scenario.latin_hypercube else [{}],
    ]
    every = [one | two | three for one, two, three in product(*rows)]
    spelled = [_spelled(values, names) for values in every]
    unique = len(set(spelled)) == len(every) and max(map(len, spelled)) <= LONGEST_NAME
    return [
        Point(
            name if unique else f"point-{number:04d}",
            values,
            dict(_settings(values, scenario.parameters)),
        )
        for number, (name, values) in enumerate(zip(spelled, every, strict=True))
    ]


def samples(section: LatinHypercube) -> list[dict[str, float]]:
    """Return the samples of a latin hypercube.

        x_i = low + (high - low) (p_i + w_i) / count,

    p a permutation of 0 ... count - 1 and w uniform in [0, 1), for each range by itself.

    Parameters
    ----------
    section : LatinHypercube
        Ranges, count and seed.

    Notes
    -----
    McKay, Beckman & Conover, Technometrics 21:239, 1979.
    """
    source = np.random.default_rng(section.seed)
    columns = {}
    for key, (low, high) in section.ranges.items():
        places = source.permutation(section.count) + source.random(section.count)
        columns[key] = low + (high - low) * places / section.count
    return [
        {key: float(column[number]) for key, column in columns.items()}
        for number in range(section.count)
    ]


def expansion_problems(scenario: Scenario) -> Iterator[Problem]:
    """Yield what keeps a scenario from being expanded; paths lead there from its top."""
    sampled = scenario.latin_hypercube.ranges if scenario.latin_hypercube else {}
    sections: list[tuple[KeyPath, Mapping[str, Any]]] = [
        (("grid",), scenario.grid),
        (("lists",), scenario.lists),
        (("latin_hypercube", "ranges"), sampled),
    ]
    seen: dict[str, str] = {}
    for path, section in sections:
        for key, values in section.items():
            if key in seen:
                twice = f"{key!r} is varied by {seen[key]} already"
                yield Problem((*path, key), twice, "each key once")
            seen[key] = ".".join(map(str, path))
            yield from _key_problems((*path, key), key, values, scenario)
    for key, (low, high) in sampled.items():
        if low >= high:
            range_ = f"[{low:g}, {high:g}] is no range"
            yield Problem(("latin_hypercube", "ranges", key), range_, "[low, high], low < high")
    lengths = {key: len(values) for key, values in scenario.lists.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{key} has {length}" for key, length in lengths.items())
        yield Problem(("lists",), f"lists of different lengths: {told}", "lists of one length")
        return
    count = int(np.prod([len(values) for values in scenario.grid.values()], dtype=float))
    count *= next(iter(lengths.values()), 1)
    count *= scenario.latin_hypercube.count if scenario.latin_hypercube else 1
    if count > MOST_POINTS:
        yield Problem((sections[0][0]), f"{count} points", f"at most {MOST_POINTS} points")


def short_names(keys: Sequence[str]) -> dict[str, str]:
    """Return a short name for each key path: as many of its last words as tell it from the others.

    Examples
    --------
    >>> short_names(["tissue.patches.strip.anisotropy", "stimulus.0.centre.1"])
    {'tissue.patches.strip.anisotropy': 'anisotropy', 'stimulus.0.centre.1': 'centre.1'}
    """
    return {key: _tail(key, [other for other in keys if other != key]) for key in keys}


def _tail(key: str, others: Sequence[str]) -> str:
    words = key.split(".")
    for count in range(1, len(words) + 1):
        tail = words[-count:]
        alone = not any(other.split(".")[-count:] == tail for other in others)
        # an index or an axis says little by itself
        if alone and not (is_index(tail[0]) or tail[0] in _AXES):
            return ".".join(tail)
    return key


def _spelled(values: Mapping[str, Any], names: Mapping[str, str]) -> str:
    """Return the name of a point."""
    words = [f"{names[key]}-{_written(value)}" for key, value in values.items()]
    return re.sub(r"[^A-Za-z0-9_.-]+", "-", "_".join(words)).strip("-._") or "base"


def _written(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.10g}"
    return str(value)


def _settings(
    values: Mapping[str, Any], parameters: Mapping[str, Mapping[str, float | Link]]
) -> Iterator[tuple[str, Any]]:
    """Yield key path and value of everything that a point sets."""
    for key, value in values.items():
        if key not in parameters:
            yield key, value
            continue
        for path, given in parameters[key].items():
            link = given if isinstance(given, Link) else Link(factor=given)
            yield path, link.factor * value + link.offset


def _key_problems(
    path: KeyPath, key: str, values: Sequence[Any], scenario: Scenario
) -> Iterator[Problem]:
    if key in scenario.parameters:
        wrong = [v for v in values if isinstance(v, bool) or not isinstance(v, int | float)]
        if wrong:
            yield Problem(path, f"{wrong[0]!r} is not a number", "numbers: it is a parameter")
    elif "." not in key and key not in fields_of(Config):
        guess = did_you_mean(key, scenario.parameters)
        problem = f"{key!r} is neither a key path nor a parameter" + (f", {guess}" if guess else "")
        known = ", ".join(scenario.parameters)
        yield Problem(
            path,
            problem,
            f"key paths of a config{f', or {known}' if known else ''}",
            f"parameters: {{{key}: {{tissue.patches.NAME.anisotropy: 1}}}}",
        )
