"""The reproduction page: every claim of the paper beside what is found, from kept results."""

from collections.abc import Iterator
from typing import Any

from cardiosurf.config.page import Figure
from cardiosurf.config.scenario_file import ScenarioFile
from cardiosurf.report.critical_section import MISSING, critical_words, search_section
from cardiosurf.report.kept import Kept, Row
from cardiosurf.report.markdown import image_file, table
from cardiosurf.study.pairs import judge_pair

HEAD = """\
# Reproduction of the paper's experiments

Written by `make reproduction` from `scenarios/` and `docs/results/`; changes by hand are lost. A
result answers the config that it was found for: where that has changed since, the page says
*not run yet* until the next `make reproduction`, which runs what is missing.
"""
CLAIMS = """\
## All claims

*found* is the whole verdict, in brackets the targets' with the route by which they were activated.
*agrees*: with what the scenario expects of this program, which need not be what was published.
*converged*: repeated on a mesh 1.5 times as fine and with half the step, the verdicts and the first
activations stay ([the guard](verdict.md)). *edges* are those of the run and of its repetition, *s*
is the wall time of the run alone, on one core; kernels that had to be compiled first are in it.
"""


def reproduction_page(kept: Kept, images: str) -> str:
    """Return the page as Markdown.

    Parameters
    ----------
    kept : Kept
        What it is made from.
    images : str
        The folder of the images, seen from the page.
    """
    lines = [HEAD, CLAIMS, *_claims(kept), ""]
    lines += _pairs(kept)
    for group in kept.searches:
        lines += search_section(group, images)
    for file in kept.files:
        lines += _scenario(kept, file, images)
    return "\n".join(lines).rstrip() + "\n"


def _claims(kept: Kept) -> list[str]:
    heads = (
        "id",
        "where in the paper",
        "published",
        "found",
        "agrees",
        "critical value",
        "converged",
        "edges [su]",
        "s",
    )
    return table(heads, [_claim(kept, row) for row in kept.cases])


def _claim(kept: Kept, row: Row) -> list[str]:
    case, entry = row.wanted.ready.case, row.entry
    source = row.wanted.file.scenario.source
    first = [row.wanted.name, source or "-", case.published or "-"]
    critical = "; ".join(critical_words(one) for one in kept.thresholds_of(row.wanted)) or "-"
    if entry is None:
        return [*first, MISSING, "-", critical, "-", "-", "-"]
    if entry["verdict"] is None:
        return [*first, f"failed: {entry['error']['kind']}", "no", critical, "-", "-", "-"]
    right = sum(one["agrees"] for one in entry["compared"])
    agrees = "yes" if right == len(entry["compared"]) else f"{right} of {len(entry['compared'])}"
    edges = [entry["edge_length"], *_guard_edges(entry)]
    return [
        *first,
        found_words(entry["verdict"]),
        agrees,
        critical,
        entry["converged"] or "not asked",
        ", ".join(f"{edge:.3g}" for edge in dict.fromkeys(edges)),
        f"{entry['seconds']:.1f}",
    ]


def found_words(verdict: dict[str, Any]) -> str:
    """Return a verdict in a few words.

    Parameters
    ----------
    verdict : mapping
        verdict.json of a run.
    """
    whole = str(verdict["verdict"]).replace("_", " ")
    parts = []
    for target in verdict["targets"]:
        route = f", {target['route']}" if target["route"] else ""
        if target["verdict"] != whole or route:
            parts.append(f"{target['name']}: {target['verdict']}{route}")
    if verdict["reentry"]["verdict"] != "none" and whole != "reentry":
        parts.append(f"{verdict['reentry']['verdict']} reentry")
    if whole == "reentry" and verdict["reentry"]["cycle_length"] is not None:
        parts.append(f"cycle length {verdict['reentry']['cycle_length']:.0f} tu")
    return f"{whole} ({'; '.join(parts)})" if parts and whole != "no capture" else whole


def _guard_edges(entry: dict[str, Any]) -> Iterator[float]:
    for one in (entry["guard"] or {"tried": []})["tried"]:
        yield one["edge_length"]


def _pairs(kept: Kept) -> list[str]:
    rows = []
    for file in kept.files:
        own = {row.wanted.ready.case.name: row for row in kept.cases_of(file)}
        verdicts = {name: (row.entry or {}).get("verdict") for name, row in own.items()}
        configs = {name: row.wanted.ready.loaded for name, row in own.items()}
        for pair in file.scenario.pairs:
            found = judge_pair(file.scenario.name, pair, verdicts, configs)
            margins = [found.margins[way] for way in ("forward", "backward")]
            rows.append(
                [
                    f"{found.scenario}/{found.name}",
                    f"{pair.forward}, {pair.backward}",
                    found.published or "-",
                    found.verdict or MISSING,
                    *("-" if margin is None else f"{100 * margin:+.1f} %" for margin in margins),
                ]
            )
    if not rows:
        return []
    heads = ("pair", "cases", "published", "found", "first", "second")
    text = (
        "Two pacing sites of one tissue, and how far its value lies above the critical one of each:"
    )
    return [text, "", *table(heads, rows), ""]


def _scenario(kept: Kept, file: ScenarioFile, images: str) -> list[str]:
    """Return the section of a scenario: its question, and the paper's figures of its cases."""
    scenario = file.scenario
    source = f"({scenario.source})" if scenario.source else ""
    about = " ".join(part for part in (scenario.question, source) if part)
    lines = [f"## {scenario.name}", "", *([about, ""] if about else [])]
    if scenario.answer and not scenario.searches:
        lines += [scenario.answer, ""]
    for row in kept.cases_of(file):
        case = row.wanted.ready.case
        figures = [(one, figure) for one, figure in kept.figures if _is_of(one, row)]
        if not (figures or case.note):
            continue
        found = MISSING if row.entry is None else _outcome(row.entry)
        lines += [
            f"**{case.name}**: published: {case.published or '-'}; found: {found}. {case.note}"
        ]
        lines[-1] = lines[-1].strip()
        lines.append("")
        for one, figure in figures:
            lines += _figure(one, figure, images)
    return lines


def _is_of(figure: Row, case: Row) -> bool:
    same_file = figure.wanted.file is case.wanted.file
    return same_file and figure.wanted.ready.case.name == case.wanted.ready.case.name


def _outcome(entry: dict[str, Any]) -> str:
    if entry["verdict"] is None:
        return f"failed ({entry['error']['kind']})"
    return found_words(entry["verdict"])


def _figure(row: Row, figure: Figure, images: str) -> list[str]:
    """Return a figure of the paper: our image, what the paper says, and what is seen."""
    times = ", ".join(f"{time:g}" for time in figure.times)
    unit = "" if figure.unit == 1.0 else f" (one T is {figure.unit:g} tu)"
    about = f"Figure `{figure.label}`, T = {times}{unit}."
    shown = f" Published: {figure.shown}." if figure.shown else ""
    seen = f" Seen: {figure.seen}" if figure.seen else " Not looked at yet."
    if row.entry is None:
        return [f"{about}{shown} *Not drawn yet.*", ""]
    image = image_file(images, row.wanted.name)
    return [f"![{figure.label}]({image})", "", f"{about}{shown}{seen}", ""]
