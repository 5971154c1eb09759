"""What a check found: a table for the terminal, JSON for programs."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from cardiosurf.analysis.block import TargetFinding
from cardiosurf.config.expectation import Plain
from cardiosurf.report.summary import target_line
from cardiosurf.report.table import table_lines
from cardiosurf.study.check import CaseResult, CheckResult
from cardiosurf.study.check_schema import SCHEMA
from cardiosurf.study.outcome import Compared
from cardiosurf.study.pairs import PairResult
from cardiosurf.study.results import case_json

_HEADS = (
    "",
    "scenario",
    "case",
    "published",
    "expected",
    "found",
    "agree",
    "converged",
    "edge",
    "s",
)
_MARKS = {"agrees": "", "differs": "DIFFERS", "failed": "FAILED"}


def check_lines(result: CheckResult) -> list[str]:
    """Return a check as lines of text: a table, what differs and why, and how it ended.

    Parameters
    ----------
    result : CheckResult
        The check.
    """
    lines = table_lines(_HEADS, [_row(case) for case in result.cases])
    if result.pairs:
        lines += ["", *_pair_lines(result.pairs)]
    for case in result.cases:
        if case.status != "agrees":
            lines += ["", *difference_lines(case)]
        if case.converged not in {None, "yes"}:
            lines += ["", *_guard_lines(case)]
    return [*lines, "", _ending(result)]


def difference_lines(case: CaseResult) -> list[str]:
    """Return what is wrong with a case, and what has changed since it last agreed.

    Parameters
    ----------
    case : CaseResult
        A case that differs or failed.
    """
    title = f"{case.scenario} / {case.case}"
    verdict = case.done.verdict
    if verdict is None:
        words = "broke down" if case.done.kind == "numerical" else "could not be run"
        return [f"{title}: {words}", *(f"  {line}" for line in case.done.error.splitlines())]
    wrong = [one for one in case.compared if not one.agrees]
    width = max(len(one.key) for one in wrong)
    lines = [f"{title}: differs from what is expected"]
    lines += [
        f"  {one.key:{width}}  expected {_expected(one)}, found {_shown(one.found)}"
        for one in wrong
    ]
    targets = [TargetFinding(**target) for target in verdict["targets"]]
    room = max(len(target.name) for target in targets)
    lines += [f"  {target_line(target, room)}" for target in targets]
    return [*lines, *_change_lines(case)]


def check_json(result: CheckResult) -> dict[str, Any]:
    """Return a check as plain JSON data.

    Parameters
    ----------
    result : CheckResult
        The check.
    """
    return {
        "schema": SCHEMA,
        "agrees": result.exit_code == 0,
        "seconds": result.seconds,
        "cases": [case_json(case) for case in result.cases],
        "pairs": [asdict(pair) for pair in result.pairs],
    }


def _row(case: CaseResult) -> tuple[str, ...]:
    by_key = {one.key: one for one in case.compared}
    whole = by_key.get("verdict")
    verdict = case.done.verdict
    right = sum(one.agrees for one in case.compared)
    seconds = f"{case.done.seconds:.1f}"
    edge = case.done.meta.get("edge_length")
    return (
        _MARKS[case.status],
        case.scenario,
        case.case,
        case.published or "-",
        str(whole.wanted) if whole else "-",
        str(verdict["verdict"]) if verdict else "-",
        f"{right} of {len(case.compared)}",
        case.converged or "-",
        f"{edge:g}" if edge else "-",
        seconds,
    )


def _pair_lines(pairs: tuple[PairResult, ...]) -> list[str]:
    heads = ("", "scenario", "pair", "published", "expected", "found", "forward", "backward")
    rows = [
        (
            "" if pair.agrees else "DIFFERS",
            pair.scenario,
            pair.name,
            pair.published or "-",
            pair.expected or "-",
            pair.verdict or "-",
            _percent(pair.margins["forward"]),
            _percent(pair.margins["backward"]),
        )
        for pair in pairs
    ]
    lines = table_lines(heads, rows)
    if any(value is not None for pair in pairs for value in pair.margins.values()):
        lines.append("forward, backward: how far above the critical value of that direction")
    return lines


def _guard_lines(case: CaseResult) -> Iterator[str]:
    """Yield why a case is not converged."""
    if case.guarded is None:
        return
    yield f"{case.scenario} / {case.case}: not converged"
    finding, failure = case.guarded.finding, case.guarded.failure
    if failure is not None:
        yield from (f"  {line}" for line in [failure.name, *failure.error.splitlines()])
    if finding is None:
        return
    for one in finding.tried:
        yield f"  edge {one.edge_length:g} su, step {one.step:g} tu: {one.verdict}"
    if finding.lat_shift is not None:
        yield f"  first activations shift by {finding.lat_shift:.2%} ({finding.lat_tolerance:.2%})"


def _change_lines(case: CaseResult) -> Iterator[str]:
    if case.change is None:
        return
    yield "  since it last agreed:"
    for line in case.change.findings:
        yield f"    {line}"
    if case.change.config:
        yield "  the config was changed:"
        for line in case.change.config:
            yield f"    {line}"
    else:
        yield "  the config is the same: the program has changed"


def _ending(result: CheckResult) -> str:
    words = {"agrees": "as expected", "differs": "not as expected", "failed": "failed"}
    counts = Counter(str(case.status) for case in result.cases)
    reused = sum(case.done.reused for case in result.cases)
    cases = f"{len(result.cases)} case{'s' * (len(result.cases) != 1)}"
    text = ", ".join(f"{counts[status]} {word}" for status, word in words.items() if counts[status])
    return f"{cases}: {text or 'nothing to compare'} ({reused} reused, {result.seconds:.1f} s)"


def _expected(one: Compared) -> str:
    within = f" +- {one.tolerance:.4g}" if one.tolerance else ""
    return f"{_shown(one.wanted)}{within}"


def _shown(value: Plain) -> str:
    if value is None:
        return "none"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{value:+.1%}"
