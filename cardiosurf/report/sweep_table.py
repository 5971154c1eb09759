"""The rows of a sweep: a CSV file, and a table for the terminal."""

import csv
import io
import json
from typing import Any

from cardiosurf.config.expansion import short_names
from cardiosurf.report.table import table_lines
from cardiosurf.study.sweep import SweepResult


def columns_of(result: SweepResult) -> list[str]:
    """Return the columns of a sweep; those of targets in the order in which they first occur.

    Parameters
    ----------
    result : SweepResult
        The sweep.
    """
    longest = max(result.rows, key=len, default={})
    return list(dict.fromkeys([*longest, *(key for row in result.rows for key in row)]))


def csv_text(result: SweepResult) -> str:
    """Return a sweep as CSV: a head, then one row a run; what is not there is empty.

    Lists and mappings are written as JSON.

    Parameters
    ----------
    result : SweepResult
        The sweep.
    """
    out = io.StringIO()
    columns = columns_of(result)
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_cell(row.get(column)) for column in columns] for row in result.rows)
    return out.getvalue()


def sweep_lines(result: SweepResult) -> list[str]:
    """Return a sweep as lines of text.

    Parameters
    ----------
    result : SweepResult
        The sweep.
    """
    names = short_names(result.varied)
    several = len({row["case"] for row in result.rows}) > 1
    heads = [*(["case"] if several else []), *names.values(), "verdict", "reentry", "rest at", "s"]
    rows = [
        [
            *([row["case"]] if several else []),
            *(_cell(row[key]) for key in names),
            row["verdict"] or "failed",
            row["reentry"] or "-",
            "-" if row["quiescent_at"] is None else f"{row['quiescent_at']:.1f}",
            f"{row['seconds']:.1f}",
        ]
        for row in result.rows
    ]
    lines = [f"{result.name}: {len(rows)} runs", *table_lines(heads, rows)]
    failed = [done for done in result.done if done.kind is not None]
    for done in failed:
        lines += ["", f"{done.name} failed:", *(f"  {line}" for line in done.error.splitlines())]
    reused = sum(done.reused for done in result.done)
    return [*lines, "", f"{len(rows)} runs, {reused} reused, {result.seconds:.1f} s"]


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict | list | tuple):
        return json.dumps(value)
    return f"{value:.10g}" if isinstance(value, float) else str(value)
