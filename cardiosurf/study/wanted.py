"""The results that the reproduction page is made from, and what each of them answers."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass

from cardiosurf.config.page import Figure, Search
from cardiosurf.config.scenario_file import ReadyCase, ScenarioFile
from cardiosurf.errors import InputError
from cardiosurf.study.results import asked_hash


@dataclass(frozen=True)
class Wanted:
    """A result that the page is made from.

    Attributes
    ----------
    name : str
        ``scenario/case`` or ``scenario/search/case``.
    file : ScenarioFile
        Its scenario.
    ready : ReadyCase
        The case.
    search : Search or None
        The search, for critical values and entrances.
    asked : str
        The hash of what is asked.
    """

    name: str
    file: ScenarioFile
    ready: ReadyCase
    search: Search | None
    asked: str

    @property
    def search_name(self) -> str | None:
        """The name of the search, None where there is none."""
        return None if self.search is None else self.search.name


def wanted_cases(files: Sequence[ScenarioFile]) -> list[Wanted]:
    """Return the cases of scenarios.

    Raises
    ------
    InputError
        A case is wrong.
    """
    return [
        Wanted(
            f"{file.scenario.name}/{ready.case.name}",
            file,
            ready,
            None,
            asked_hash(ready.loaded.sha256, [asdict(one) for one in ready.expected]),
        )
        for file in files
        for ready in file.cases()
    ]


def wanted_thresholds(files: Sequence[ScenarioFile]) -> list[Wanted]:
    """Return the critical values that scenarios look for, one for each case of a search."""
    return [
        Wanted(
            f"{file.scenario.name}/{search.name}/{ready.case.name}",
            file,
            ready,
            search,
            asked_hash(
                ready.loaded.sha256,
                [search.vary, search.between, search.tolerance, search.edges, search.of],
            ),
        )
        for file, search, ready in _searched(files)
    ]


def wanted_entrances(files: Sequence[ScenarioFile]) -> list[Wanted]:
    """Return the entrances before which the front is to be measured."""
    return [
        Wanted(
            f"{file.scenario.name}/{search.name}/{ready.case.name}",
            file,
            ready,
            search,
            asked_hash(ready.loaded.sha256, search.entrance),
        )
        for file, search, ready in _searched(files)
        if search.entrance is not None
    ]


def wanted_figures(files: Sequence[ScenarioFile]) -> list[tuple[Wanted, Figure]]:
    """Return the paper's figures of all cases."""
    return [
        (
            Wanted(
                f"{file.scenario.name}/{ready.case.name}/{figure.label}",
                file,
                ready,
                None,
                asked_hash(ready.loaded.sha256, figure.moments, figure.times, figure.view),
            ),
            figure,
        )
        for file in files
        for ready in file.cases()
        for figure in ready.case.figures
    ]


def against_of(wanted: Wanted) -> float | None:
    """Return the number of a case that its critical value is drawn against, None without one.

    Raises
    ------
    InputError
        The case has no number there.
    """
    key = None if wanted.search is None else wanted.search.against
    if key is None:
        return None
    value = wanted.ready.loaded.document.value_at(key)
    if isinstance(value, bool) or not isinstance(value, int | float):
        where = f"{wanted.file.path}: searches: against"
        raise InputError(where, f"{key} is no number in {wanted.ready.case.name}", "a number's key")
    return float(value)


def _searched(files: Sequence[ScenarioFile]) -> Iterator[tuple[ScenarioFile, Search, ReadyCase]]:
    """Yield every case of every search."""
    for file in files:
        if not file.scenario.searches:
            continue
        ready = {one.case.name: one for one in file.cases()}
        for search in file.scenario.searches:
            for name in search.cases:
                yield file, search, ready[name]
