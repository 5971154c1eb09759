"""Kept results as the reproduction page needs them: those that answer what is asked now."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from cardiosurf.config.page import Figure, Search
from cardiosurf.config.scenario_file import ScenarioFile
from cardiosurf.study.results import Entry, Results, current
from cardiosurf.study.wanted import (
    Wanted,
    wanted_cases,
    wanted_entrances,
    wanted_figures,
    wanted_thresholds,
)


@dataclass(frozen=True)
class Row:
    """A result that the page is to have, and its entry; None: there is none that is current."""

    wanted: Wanted
    entry: Entry | None


@dataclass(frozen=True)
class SearchRows:
    """All searches of one name, from whatever scenario.

    Attributes
    ----------
    name : str
        The searches' name.
    searches : tuple of (ScenarioFile, Search)
        Each with its scenario.
    thresholds, entrances : tuple of Row
        Their results.
    """

    name: str
    searches: tuple[tuple[ScenarioFile, Search], ...]
    thresholds: tuple[Row, ...]
    entrances: tuple[Row, ...]

    def of(self, file: ScenarioFile, rows: Sequence[Row]) -> list[Row]:
        """Return those of one scenario's rows, by what they are drawn against."""
        own = [row for row in rows if row.wanted.file is file]
        return sorted(own, key=lambda row: (row.entry or {}).get("against") or 0.0)


@dataclass(frozen=True)
class Kept:
    """All that the page is made from.

    Attributes
    ----------
    files : tuple of ScenarioFile
        The scenarios that have cases.
    cases : tuple of Row
        Their cases.
    figures : tuple of (Row, Figure)
        The paper's figures of them.
    searches : tuple of SearchRows
        Critical values and entrances.
    """

    files: tuple[ScenarioFile, ...]
    cases: tuple[Row, ...]
    figures: tuple[tuple[Row, Figure], ...]
    searches: tuple[SearchRows, ...]

    @classmethod
    def read(cls, files: Sequence[ScenarioFile], folder: Path) -> "Kept":
        """Return the current results of scenarios in a folder.

        Raises
        ------
        InputError
            A scenario is wrong, or a file of results cannot be read.
        """
        results = Results(folder)
        having = tuple(file for file in files if file.scenario.on_page)
        drawn = results.read("figures")
        return cls(
            having,
            tuple(_rows(wanted_cases(having), results.read("cases"))),
            tuple(
                (Row(one, current(drawn.get(one.name), one.asked)), figure)
                for one, figure in wanted_figures(having)
            ),
            tuple(_searches(having, results)),
        )

    def cases_of(self, file: ScenarioFile) -> list[Row]:
        """Return the cases of one scenario."""
        return [row for row in self.cases if row.wanted.file is file]

    def thresholds_of(self, case: Wanted) -> list[Row]:
        """Return the searches that begin with a case."""
        return [
            row
            for group in self.searches
            for row in group.thresholds
            if row.wanted.file is case.file and row.wanted.ready.case.name == case.ready.case.name
        ]


def _rows(wanted: Sequence[Wanted], entries: dict[str, Entry]) -> Iterator[Row]:
    for one in wanted:
        yield Row(one, current(entries.get(one.name), one.asked))


def _searches(files: Sequence[ScenarioFile], results: Results) -> Iterator[SearchRows]:
    thresholds = list(_rows(wanted_thresholds(files), results.read("thresholds")))
    entrances = list(_rows(wanted_entrances(files), results.read("entrances")))
    every = [(file, search) for file in files for search in file.scenario.searches]
    for name in dict.fromkeys(search.name for _, search in every):
        yield SearchRows(
            name,
            tuple((file, search) for file, search in every if search.name == name),
            tuple(row for row in thresholds if row.wanted.search_name == name),
            tuple(row for row in entrances if row.wanted.search_name == name),
        )
