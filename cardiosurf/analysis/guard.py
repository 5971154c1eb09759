"""Whether a verdict is converged: runs on a finer mesh and with smaller steps beside it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from cardiosurf.analysis.verdict import GuardFinding, GuardRun, GuardTarget, Verdict


def guard_run(verdict: Mapping[str, Any], edge_length: float, step: float) -> GuardRun:
    """Return what the convergence check compares of a run.

    Parameters
    ----------
    verdict : mapping
        Its verdict, as it stands in verdict.json.
    edge_length, step : float
        Its mesh, in su, and its longest step, in tu.
    """
    return GuardRun(
        edge_length,
        step,
        verdict["verdict"],
        verdict["reentry"]["verdict"],
        {
            target["name"]: GuardTarget(target["verdict"], target["first_activation"])
            for target in verdict["targets"]
        },
    )


def guard_finding(
    tried: Sequence[GuardRun], *, accuracy: float, start: float = 0.0
) -> GuardFinding:
    """Compare runs with the first of them.

    They agree when the whole verdict and that of each target are the same; they are converged when
    besides no target's first activation t moves by more than accuracy (t - start).

    Parameters
    ----------
    tried : sequence of GuardRun
        The run itself, then the refined ones.
    accuracy : float
        Relative error of LAT that the config asks for.
    start : float
        Time of the first stimulus, in tu.
    """
    itself, *refined = tried
    agree = all(_verdicts(run) == _verdicts(itself) for run in refined)
    shift = max((shift for run in refined for shift in _shifts(itself, run, start)), default=None)
    converged = agree and (shift is None or shift <= accuracy)
    return GuardFinding(tuple(tried), agree, shift, accuracy, "yes" if converged else "no")


def guarded(verdict: Verdict, finding: GuardFinding) -> Verdict:
    """Return a verdict with its convergence check, and a note where it is not converged.

    Parameters
    ----------
    verdict : Verdict
        The verdict of the run itself.
    finding : GuardFinding
        The check.
    """
    notes = (*verdict.notes, *_notes(finding))
    return replace(verdict, guard=finding, notes=notes)


def _verdicts(run: GuardRun) -> tuple[str, dict[str, str]]:
    return run.verdict, {name: target.verdict for name, target in run.targets.items()}


def _shifts(itself: GuardRun, run: GuardRun, start: float) -> Iterator[float]:
    """Yield the relative shift of each target that was activated in both runs."""
    for name, target in itself.targets.items():
        one, other = target.first_activation, run.targets[name].first_activation
        # a blocked wave may or may not creep over a target's rim
        if one is not None and other is not None:
            yield abs(other - one) / max(one - start, abs(one) * 1e-9, 1e-9)


def _notes(finding: GuardFinding) -> Iterator[str]:
    itself, *refined = finding.tried
    for run in refined:
        mesh = f"edges of {run.edge_length:g} su and steps of {run.step:g} tu"
        if _verdicts(run) != _verdicts(itself):
            found = ", ".join(f"{name} {target.verdict}" for name, target in run.targets.items())
            yield (
                f"not converged: with {mesh} the verdict is {run.verdict} ({found});"
                " cardiosurf threshold tells how near the change is"
            )
        elif run.reentry != itself.reentry:
            yield f"with {mesh} reentry is {run.reentry}, which is no part of the check"
    if finding.agree and finding.converged == "no" and finding.lat_shift is not None:
        yield (
            f"not converged: the verdicts agree, but first activations move by"
            f" {finding.lat_shift:.2%}, more than the accuracy of {finding.lat_tolerance:.2%};"
            " a smaller mesh.edge_length, or a larger accuracy"
        )
