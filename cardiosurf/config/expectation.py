"""What a case is expected to find, one comparison at a time."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import NoneType
from typing import Any, TypeAlias, get_args, get_type_hints

from cardiosurf.analysis.block import TargetFinding
from cardiosurf.analysis.reentry import ReentryFinding
from cardiosurf.analysis.verdict import Verdict
from cardiosurf.config.decode import show
from cardiosurf.config.document import KeyPath
from cardiosurf.config.keys import describe, words_of
from cardiosurf.spelling import did_you_mean

Plain: TypeAlias = str | float | bool | None
_PERCENT = re.compile(r"\s*(?P<number>\d+(?:\.\d*)?|\.\d+)\s*%\s*")
_WHOLE = ("verdict", "captured", "quiescent_at", "end")
_TOLERANCE = 'a number, or a percentage such as "1 %"'


@dataclass(frozen=True)
class Expectation:
    """One finding that is expected.

    Attributes
    ----------
    key : str
        Which: ``verdict``, ``reentry.cycle_length``, ``lat.PROBE``, ``TARGET.route``, ...
    wanted : text, number, bool or None
        What it should be; None: there should be none.
    tolerance : float
        How far a number may be off, in its own unit.
    """

    key: str
    wanted: Plain
    tolerance: float = 0.0

    def met_by(self, found: Plain) -> bool:
        """Return whether a finding is what is expected."""
        if _is_number(self.wanted) and _is_number(found):
            # bounds that are met to the last digit count as met
            room = self.tolerance * (1.0 + 1e-9) + 1e-12
            return abs(float(found or 0) - float(self.wanted or 0)) <= room
        return type(found) is type(self.wanted) and found == self.wanted


@dataclass(frozen=True)
class Problem:
    """What is wrong with an expectation; ``path`` leads to it from the expectations' mapping."""

    path: KeyPath
    problem: str
    allowed: str
    hint: str = ""


@dataclass(frozen=True)
class Reader:
    """Reads the expectations of a case.

    Attributes
    ----------
    targets, probes : sequence of str
        What its config names.
    tolerance : float, str or None
        Of numbers that have none of their own.
    """

    targets: Sequence[str]
    probes: Sequence[str]
    tolerance: float | str | None = None

    def read(self, expect: Mapping[str, Any]) -> tuple[list[Expectation], list[Problem]]:
        """Return what is expected, and everything that is wrong with it."""
        found = list(self._all(expect))
        good = [one for one in found if isinstance(one, Expectation)]
        return good, [one for one in found if isinstance(one, Problem)]

    def _all(self, expect: Mapping[str, Any]) -> Iterator[Expectation | Problem]:
        whole = get_type_hints(Verdict)
        for key, value in expect.items():
            if key == "cycle_length":
                types = get_type_hints(ReentryFinding)
                yield self._one((key,), "reentry.cycle_length", value, types["cycle_length"])
            elif key in _WHOLE:
                yield self._one((key,), key, value, whole[key])
            elif key == "reentry":
                yield from self._section(key, value, ReentryFinding)
            elif key == "lat":
                yield from self._lat(value)
            elif key in self.targets:
                yield from self._section(key, value, TargetFinding)
            else:
                known = [*_WHOLE, "reentry", "cycle_length", "lat", *self.targets]
                yield _unknown((key,), key, known)

    def _section(
        self, key: str, value: Any, finding: type[TargetFinding] | type[ReentryFinding]
    ) -> Iterator[Expectation | Problem]:
        types = {
            name: kind
            for name, kind in get_type_hints(finding).items()
            if name != "name" and (words_of(kind) or _number_in(kind))
        }
        # a word stands for the verdict
        given = value if isinstance(value, dict) else {"verdict": value}
        for name, inner in given.items():
            path = (key, name) if isinstance(value, dict) else (key,)
            if name in types:
                yield self._one(path, f"{key}.{name}", inner, types[name])
            else:
                yield _unknown(path, name, list(types))

    def _lat(self, value: Any) -> Iterator[Expectation | Problem]:
        if not isinstance(value, dict):
            allowed = "a mapping from probes to their LAT"
            yield Problem(("lat",), f"{show(value)} is not a mapping", allowed)
            return
        for probe, inner in value.items():
            if probe in self.probes:
                yield self._one(("lat", probe), f"lat.{probe}", inner, float | None)
            else:
                yield _unknown(("lat", probe), probe, self.probes)

    def _one(self, path: KeyPath, key: str, value: Any, kind: Any) -> Expectation | Problem:
        """Return one expectation, or what is wrong with it."""
        words = words_of(kind)
        own: Any = None
        if isinstance(value, dict):
            own = value.get("tolerance")
            if set(value) != {"value", "tolerance"} or words:
                return Problem(path, f"{show(value)} is not understood", _allowed(kind))
            value = value["value"]
        if not _fits(value, kind, words):
            guess = did_you_mean(value, words) if isinstance(value, str) else ""
            wrong = f"{show(value)} is not allowed" + (f", {guess}" if guess else "")
            return Problem(path, wrong, _allowed(kind))
        if not _is_number(value):
            return Expectation(key, value)
        given = own if own is not None else self.tolerance
        if given is None:
            hint = f'{path[-1]}: {{value: {show(value)}, tolerance: "1 %"}}'
            return Problem(path, f"the number {show(value)} has no tolerance", _TOLERANCE, hint)
        tolerance = parse_tolerance(given, float(value))
        if tolerance is None:
            return Problem(path, f"{show(given)} is not a tolerance", _TOLERANCE)
        return Expectation(key, value, tolerance)


def parse_tolerance(given: Any, value: float) -> float | None:
    """Return the tolerance that a number or a percentage of ``value`` stands for; None: neither.

    Examples
    --------
    >>> parse_tolerance("2 %", 50.0)
    1.0
    """
    if _is_number(given):
        return float(given) if given >= 0 else None
    percent = _PERCENT.fullmatch(given) if isinstance(given, str) else None
    return None if percent is None else abs(value) * float(percent["number"]) / 100.0


def _fits(value: Any, kind: Any, words: Sequence[str]) -> bool:
    if value is None:
        return NoneType in get_args(kind)
    if isinstance(value, bool):
        return kind is bool
    return value in words if words else _is_number(value) and _number_in(kind)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _number_in(kind: Any) -> bool:
    return bool({int, float} & {kind, *get_args(kind)})


def _allowed(kind: Any) -> str:
    text = describe(kind)
    return f"{text}, or {{value, tolerance}}" if _number_in(kind) else text


def _unknown(path: KeyPath, word: str, known: Sequence[str]) -> Problem:
    guess = did_you_mean(word, known)
    problem = f"unknown key {word!r}" + (f", {guess}" if guess else "")
    return Problem(path, problem, ", ".join(known) or "nothing: the config names none")
