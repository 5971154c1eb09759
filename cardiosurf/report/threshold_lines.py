"""The finding of a threshold search in a few lines for the terminal."""

import math
from collections.abc import Iterator

from cardiosurf.study.threshold_result import CriticalValue, RunRow, Threshold


def threshold_lines(found: Threshold) -> list[str]:
    """Return what a search found as lines of text.

    Parameters
    ----------
    found : Threshold
        The finding.
    """
    low, high = found.between
    lines = [f"{found.name}: {found.vary} from {low:g} to {high:g}, asked for {found.question}"]
    for change in found.changes:
        lines += _change_lines(change)
    if not found.changes:
        answer = found.runs[0].answer
        edges = ", ".join(f"{level.edge_length:g}" for level in found.levels)
        lines.append(f"  no change: {answer} at every value tried, on edges of {edges} su")
    lines += [f"  note: {note}" for note in found.notes]
    reused = sum(run.reused for run in found.runs)
    again = f", {reused} of them there already" if reused else ""
    lines.append(f"  {len(found.runs)} runs of {found.seconds:.0f} s together{again}")
    return lines


def run_line(row: RunRow) -> str:
    """Return one run as a line of progress.

    Parameters
    ----------
    row : RunRow
        The run.
    """
    took = "there already" if row.reused else f"{row.seconds:.1f} s"
    mesh = f"edge {row.edge_length:<5g} step {row.step:<6g}"
    return f"{mesh} value {row.value:<9.6g} {row.answer}, {took}"


def with_error(value: float, error: float) -> str:
    """Return a value and its error, both to the error's second digit.

    Examples
    --------
    >>> with_error(7.83817, 0.0312)
    '7.838 +- 0.032'
    """
    if error <= 0.0:
        return f"{value:g} +- 0"
    digits = max(0, 1 - math.floor(math.log10(error)))
    # an error is rounded up
    error = math.ceil(error * 10**digits - 1e-6) / 10**digits
    return f"{value:.{digits}f} +- {error:.{digits}f}"


def _change_lines(change: CriticalValue) -> Iterator[str]:
    kind = f"{change.below} -> {change.above}"
    if change.value is None or change.error is None:
        yield f"  {kind}: no value without three meshes in a row that have it; {change.note}"
    else:
        settled = "converged" if change.converged else "NOT converged"
        trend = "no trend left to extrapolate"
        if change.order is not None:
            trend = f"order {change.order:.1f}, {change.order_is}"
        yield (f"  {kind} at {with_error(change.value, change.error)}  ({settled}; {trend})")
        if change.note:
            yield f"    {change.note}"
    for level in change.levels:
        mesh = f"    edge {level.edge_length:<5g} step {level.step:<6g}"
        if level.low is None or level.high is None:
            yield f"{mesh} none"
        else:
            middle, half = 0.5 * (level.low + level.high), 0.5 * (level.high - level.low)
            yield f"{mesh} {with_error(middle, half)}"
