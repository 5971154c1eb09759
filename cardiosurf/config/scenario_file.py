"""From a scenario file to its cases and points, each a checked config."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cardiosurf.analysis.targets import WHOLE_TISSUE
from cardiosurf.config.decode import ConfigError, decode
from cardiosurf.config.document import Document, KeyPath
from cardiosurf.config.expansion import Point, expand, expansion_problems
from cardiosurf.config.expectation import Expectation, Reader
from cardiosurf.config.loader import Loaded, load_document
from cardiosurf.config.overrides import lay
from cardiosurf.config.page import Search
from cardiosurf.config.reader import read_document
from cardiosurf.config.scenario import SCENARIO_KEYS, Case, Fast, Pair, Scenario
from cardiosurf.errors import InputError
from cardiosurf.spelling import did_you_mean

WITHOUT_FRAMES: Mapping[str, Any] = {"record.frames_every": None}
"""Laid over all runs of a scenario: no verdict is read off frames, and they take most room."""


@dataclass(frozen=True)
class ReadyCase:
    """A case that can be run.

    Attributes
    ----------
    case : Case
        As it stands in the file.
    loaded : Loaded
        Its config.
    expected : tuple of Expectation
        What its findings are compared with.
    coarsened : bool
        Whether it is run as ``check --fast`` does, at other settings than its own.
    """

    case: Case
    loaded: Loaded
    expected: tuple[Expectation, ...]
    coarsened: bool


@dataclass(frozen=True)
class ReadyPoint:
    """A point of a sweep that can be run: of which case (None: the base itself), and its config."""

    case: Case | None
    point: Point
    loaded: Loaded

    @property
    def name(self) -> str:
        """What it is called: a file-name-safe word."""
        return self.point.name if self.case is None else f"{self.case.name}_{self.point.name}"


@dataclass(frozen=True)
class ScenarioFile:
    """A scenario as it was read.

    Attributes
    ----------
    path : Path
        Its file.
    scenario : Scenario
        Its sections.
    document : Document
        Its data, to name lines in messages.
    base : Document
        The config that its cases begin with.
    """

    path: Path
    scenario: Scenario
    document: Document
    base: Document

    def cases(self, *, fast: bool = False) -> tuple[ReadyCase, ...]:
        """Return all cases, ready to be run.

        Parameters
        ----------
        fast : bool
            Whether to lay what ``fast`` says over them.

        Raises
        ------
        InputError
            With file, line and key of everything that is wrong with a case.
        """
        return tuple(
            self._case(number, case, fast=fast) for number, case in enumerate(self.scenario.cases)
        )

    def points(self) -> tuple[ReadyPoint, ...]:
        """Return all points of the sweep, of each case or of the base, ready to be run.

        Raises
        ------
        InputError
            With file, line and key of everything that is wrong, also if nothing is varied.
        """
        if not self.scenario.sweeps:
            raise InputError(
                str(self.path),
                "this scenario varies nothing",
                "one of the keys grid, lists, latin_hypercube",
                "grid: {tissue.patches.NAME.anisotropy: [4, 6, 8, 10]}",
            )
        cases: Sequence[Case | None] = self.scenario.cases or (None,)
        points = expand(self.scenario)
        return tuple(
            self._point(number, case, point)
            for number, case in enumerate(cases)
            for point in points
        )

    def _case(self, number: int, case: Case, *, fast: bool) -> ReadyCase:
        document = self._laid(self.base, self.scenario.set, ("set",))
        document = self._laid(document, case.set, ("cases", number, "set"))
        coarser: tuple[Fast, KeyPath] | None = None
        if fast and case.fast is not None:
            coarser = case.fast, ("cases", number, "fast", "set")
        elif fast and self.scenario.fast is not None:
            coarser = self.scenario.fast, ("fast", "set")
        if coarser is not None:
            document = self._laid(document, coarser[0].set, coarser[1])
        document = self._laid(document, WITHOUT_FRAMES, ())
        loaded = load_document(document)
        expected = self._expected(number, case, loaded)
        return ReadyCase(case, loaded, expected, coarser is not None)

    def _point(self, number: int, case: Case | None, point: Point) -> ReadyPoint:
        document = self._laid(self.base, self.scenario.set, ("set",))
        if case is not None:
            document = self._laid(document, case.set, ("cases", number, "set"))
        by_key = {key: self._place_of(key) for key in point.values}
        for key, value in point.settings.items():
            path = by_key.get(key) or self._linked(key)
            label = f"{self.document.where(path)} in the point {point.name}"
            document = lay(document, key, value, label)
        document = self._laid(document, WITHOUT_FRAMES, ())
        return ReadyPoint(case, point, load_document(document))

    def _laid(self, document: Document, settings: Mapping[str, Any], path: KeyPath) -> Document:
        """Return a config's document with settings over it; messages name their lines."""
        for key, value in settings.items():
            document = lay(document, key, value, self.document.where((*path, key)))
        return document

    def _place_of(self, key: str) -> KeyPath:
        """Return where the file varies a key."""
        places: tuple[KeyPath, ...] = (("grid",), ("lists",), ("latin_hypercube", "ranges"))
        found = [(*place, key) for place in places if (*place, key) in self.document.lines]
        return found[0] if found else ()

    def _linked(self, key: str) -> KeyPath:
        """Return where the file has a key follow a parameter."""
        for name, links in self.scenario.parameters.items():
            if key in links:
                return ("parameters", name, key)
        return ()

    def _expected(self, number: int, case: Case, loaded: Loaded) -> tuple[Expectation, ...]:
        targets = [target.name for target in loaded.config.targets] or [WHOLE_TISSUE]
        probes = [probe.name for probe in loaded.config.record.probes]
        expected, wrong = Reader(targets, probes, case.tolerance).read(case.expect)
        problems = [
            InputError(
                self.document.where(("cases", number, "expect", *one.path)),
                one.problem,
                one.allowed,
                one.hint,
            )
            for one in wrong
        ]
        problems += self._pair_problems(case, targets)
        if problems:
            raise ConfigError(str(self.path), problems)
        return tuple(expected)

    def _pair_problems(self, case: Case, targets: Sequence[str]) -> Iterator[InputError]:
        """Yield an error for each target of a pair that its case does not have."""
        for number, pair in enumerate(self.scenario.pairs):
            for key, of_case, target in _ways(pair):
                if of_case == case.name and target not in targets:
                    guess = did_you_mean(target, targets)
                    problem = f"case {case.name!r} has no target {target!r}"
                    problem += f", {guess}" if guess else ""
                    where = self.document.where(("pairs", number, key))
                    yield InputError(where, problem, ", ".join(targets))


def read_scenario(path: Path) -> ScenarioFile:
    """Read a scenario file and the config that it begins with.

    Parameters
    ----------
    path : Path
        A YAML file.

    Raises
    ------
    InputError
        With file, line and key of everything that is wrong. What is wrong with a case or a point
        is found when it is made ready.
    """
    document = read_document(str(path), SCENARIO_KEYS)
    if not is_scenario(document.data) and "geometry" in document.data:
        raise InputError(
            str(path),
            "is a config, not a scenario",
            "a scenario: a mapping with at least the keys name and base",
            f"cardiosurf run {path}",
        )
    scenario = decode(document, Scenario)
    problems = [
        *(
            InputError(document.where(one.path), one.problem, one.allowed, one.hint)
            for one in expansion_problems(scenario)
        ),
        *_name_problems(document, scenario),
    ]
    if problems:
        raise ConfigError(str(path), problems)
    # a path in messages reads best as the user would write it
    base = path.parent / scenario.base
    if not base.is_file():
        raise InputError(
            document.where(("base",)), f"no such file: {base}", "a config, seen from this folder"
        )
    return ScenarioFile(path, scenario, document, read_document(str(base)))


def is_scenario(data: Mapping[str, Any]) -> bool:
    """Tell whether a file's data are meant as a scenario, not as a config."""
    return "base" in data or ("cases" in data and "geometry" not in data)


def scenario_paths(given: Sequence[Path]) -> list[Path]:
    """Return the scenario files that files and folders stand for, each once.

    Raises
    ------
    InputError
        A folder holds no YAML file.
    """
    found: dict[Path, None] = {}
    for path in given:
        if not path.is_dir():
            found[path] = None
            continue
        inside = sorted(one for one in path.iterdir() if one.suffix in {".yaml", ".yml"})
        if not inside:
            raise InputError(str(path), "this folder holds no scenario", "a folder of YAML files")
        found |= dict.fromkeys(inside)
    return list(found)


def _ways(pair: Pair) -> tuple[tuple[str, str, str], tuple[str, str, str]]:
    """Return for each direction of a pair: the key that names its target, its case, its target."""
    back = pair.target if pair.backward_target is None else pair.backward_target
    key = "target" if pair.backward_target is None else "backward_target"
    return ("target", pair.forward, pair.target), (key, pair.backward, back)


def _name_problems(document: Document, scenario: Scenario) -> Iterator[InputError]:
    """Yield an error for names that are there twice, and for cases that are named and not there."""
    sections: dict[str, Sequence[Case | Pair | Search]] = {
        "cases": scenario.cases,
        "pairs": scenario.pairs,
        "searches": scenario.searches,
    }
    for section, items in sections.items():
        seen: set[str] = set()
        for number, item in enumerate(items):
            if item.name in seen:
                where = document.where((section, number, "name"))
                yield InputError(where, f"{item.name!r} is there twice", "names that differ")
            seen.add(item.name)
    cases = [case.name for case in scenario.cases]
    for path, name in _named_cases(scenario):
        if name not in cases:
            guess = did_you_mean(name, cases)
            problem = f"there is no case {name!r}" + (f", {guess}" if guess else "")
            yield InputError(
                document.where(path), problem, ", ".join(cases) or "there are no cases"
            )


def _named_cases(scenario: Scenario) -> Iterator[tuple[KeyPath, str]]:
    """Yield the cases that pairs and searches name, and where they do."""
    for number, pair in enumerate(scenario.pairs):
        yield ("pairs", number, "forward"), pair.forward
        yield ("pairs", number, "backward"), pair.backward
    for number, search in enumerate(scenario.searches):
        for place, name in enumerate(search.cases):
            yield ("searches", number, "cases", place), name
