"""Appendix B's units against the simulation: what is missing is asked, and the table is written.

Run as ``python -m cardiosurf.report.discrete_study .`` in the project's folder (``make discrete``):
results are kept in ``docs/results/discrete.json``, the table stands in ``docs/theory.md``.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cardiosurf.errors import InputError, given_words, told_on_stderr
from cardiosurf.recording.whole_file import whole_file
from cardiosurf.report.critical_section import MISSING, change_words
from cardiosurf.report.markdown import table
from cardiosurf.report.reproduction import found_words
from cardiosurf.study.discrete_questions import N_MAX, QUESTIONS, Asked, Kept, Question
from cardiosurf.study.discrete_study import Study, update
from cardiosurf.study.results import Entry, Results

BEGIN, END = "<!-- discrete study: written by make discrete -->", "<!-- end of discrete study -->"
"""What stands around the table on the page."""
WORST = ("block", "partial", "conduction")


def study_table(study: Study) -> list[str]:
    """Return the table of all questions as lines of Markdown, from kept results alone.

    Parameters
    ----------
    study : Study
        Where they are kept.
    """
    entries = study.entries()
    heads = ("question", "simulated", *(f"units, N_max = {n_max:g}" for n_max in N_MAX))
    rows = [
        [one.words, _simulated(study, one, entries), *_units(one, entries[one.name])]
        for one in QUESTIONS
    ]
    return table(heads, rows)


def with_table(page: str, lines: Sequence[str]) -> str:
    """Return a page with the table in its place.

    Parameters
    ----------
    page : str
        The page's text.
    lines : sequence of str
        The table.

    Raises
    ------
    InputError
        The page has no place for it.
    """
    before, begin, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not (begin and end):
        raise InputError("page", "has no place for the table", f"a page with {BEGIN} and {END}")
    return "\n".join([f"{before}{BEGIN}", "", *lines, "", f"{END}{after}"])


def _simulated(study: Study, question: Question, entries: Mapping[str, Entry | None]) -> str:
    """Return the simulation's answer in a few words."""
    source = question.simulated
    if isinstance(source, str):
        other = next(one for one in QUESTIONS if one.name == source)
        return _simulated(study, other, entries)
    if isinstance(source, Kept):
        kept = study.results.read(source.kind).get(source.name)
        if kept is None:
            return MISSING
        return change_words(kept) if source.kind == "thresholds" else found_words(kept["verdict"])
    entry = entries[question.name]
    return MISSING if entry is None else change_words(entry["simulated"])


def _units(question: Question, entry: Entry | None) -> list[str]:
    """Return the units' answers in a few words, one for each N_max."""
    if entry is None:
        return [MISSING] * len(N_MAX)
    answers = [entry["units"][f"{n_max:g}"] for n_max in N_MAX]
    if isinstance(question.units, Asked):
        return [_critical(question.units, answer["searches"]) for answer in answers]
    return [_packed(one) if "value" in one else _played(one) for one in answers]


def _packed(answer: Mapping[str, Any]) -> str:
    value = f"{answer['value']:.4g}"
    return f"s = {value}" if answer["unit"] == "s" else _number(value, answer["unit"])


def _number(value: str | int, of: str) -> str:
    """Return a number of things, whose word ends in s unless it is one."""
    return f"{value} {of.removesuffix('s') if str(value) == '1' else of}"


def _played(answer: Mapping[str, Any]) -> str:
    """Return what became of the targets, and what else there is to say of a game."""
    targets: dict[str, str] = answer["targets"]
    worst = next(one for one in WORST if one in targets.values())
    words = worst
    if len(set(targets.values())) > 1:
        words = ", ".join(f"{name}: {verdict}" for name, verdict in targets.items())
    more = []
    if answer["failures"]:
        more.append(f"{_number(answer['failures'], 'units')} charged in vain")
    if answer["most_activations"] > 1:
        more.append("reentry" if answer["ended"] else "reentry, still going")
    return f"{words} ({'; '.join(more)})" if more else words


def _critical(asked: Asked, searches: Sequence[Mapping[str, Any]]) -> str:
    """Return the critical values on each mesh."""
    found = [
        " and ".join(f"{0.5 * (one['low'] + one['high']):.1f}" for one in search["changes"])
        for search in searches
    ]
    if not any(found):
        return f"never (up to {asked.between[1]:g})"
    edges = ", ".join(f"{search['edge']:g}" for search in searches)
    return f"{', '.join(one or 'never' for one in found)} (edges {edges})"


def main(root: Path) -> None:
    """Bring results and page up to date.

    Parameters
    ----------
    root : Path
        The project's folder.
    """

    def say(line: str) -> None:
        sys.stderr.write(f"{line}\n")

    study = Study(root, Results(root / "docs/results"), root / "runs/discrete", say)
    update(study)
    page = root / "docs/theory.md"
    text = with_table(page.read_text(encoding="utf-8"), study_table(study))
    with whole_file(page) as partial:
        partial.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    with told_on_stderr():
        main(Path(*given_words(1, "the project's FOLDER")))
