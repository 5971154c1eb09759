"""A verdict in a few lines for the terminal."""

from collections.abc import Mapping
from typing import Any

from cardiosurf.analysis.block import TargetFinding
from cardiosurf.analysis.verdict import GuardFinding, Verdict


def verdict_lines(verdict: Verdict) -> list[str]:
    """Return a verdict as lines of text.

    Parameters
    ----------
    verdict : Verdict
        The verdict.
    """
    lines = [f"{verdict.name}: {verdict.verdict.upper().replace('_', ' ')}"]
    if verdict.captured:
        width = max(len(target.name) for target in verdict.targets)
        lines += [target_line(target, width) for target in verdict.targets]
        lines.append(_reentry_line(verdict))
    if verdict.quiescent_at is not None:
        lines.append(f"  all tissue at rest at t = {verdict.quiescent_at:.1f} tu")
    else:
        lines.append(f"  stopped at t = {verdict.end:.1f} tu, before all tissue was at rest")
    if verdict.guard is not None:
        lines.append(_guard_line(verdict.guard))
    lines += [f"  note: {note}" for note in verdict.notes]
    return lines


def _guard_line(guard: GuardFinding) -> str:
    meshes = ", ".join(f"{run.edge_length:g} su / {run.step:g} tu" for run in guard.tried)
    if not guard.agree:
        return f"  NOT converged: verdicts differ ({meshes})"
    times = "" if guard.lat_shift is None else f", first activations to {guard.lat_shift:.2%}"
    settled = "converged" if guard.converged == "yes" else "NOT converged"
    return f"  {settled}: same verdicts{times} ({meshes})"


def target_line(target: TargetFinding, width: int) -> str:
    """Return what happened to a target in one line.

    Parameters
    ----------
    target : TargetFinding
        The target.
    width : int
        Room for its name.
    """
    line = (
        f"  {target.name:{width}}  {target.verdict:10}  {target.activated_fraction:6.1%} activated"
    )
    if target.first_activation is not None:
        line += f", t = {target.first_activation:.1f} to {target.last_activation:.1f} tu"
    if target.direct_fraction is not None:
        line += f", {target.route} ({target.direct_fraction:.0%} through the entrance)"
    return line


def _reentry_line(verdict: Verdict) -> str:
    reentry = verdict.reentry
    if reentry.verdict == "none":
        return "  no reentry"
    return (
        f"  {reentry.verdict} reentry, up to {reentry.max_activations} activations,"
        f" cycle length {reentry.cycle_length:.1f} tu"
    )


def cost_line(meta: Mapping[str, Any]) -> str:
    """Return what a run took, in one line.

    Parameters
    ----------
    meta : mapping
        ``Recording.meta`` of the run.
    """
    seconds = meta["set_up_seconds"] + meta["march_seconds"]
    return (
        f"  {meta['vertices']} vertices (edge {meta['edge_length']:g} su), {meta['steps']} steps of"
        f" {meta['step']:g} tu ({meta['scheme']}, {meta['solver']}), {seconds:.1f} s"
    )
