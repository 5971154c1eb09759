"""A verdict in one line, for below a figure's title."""

from cardiosurf.analysis.block import TargetFinding
from cardiosurf.analysis.verdict import Verdict


def verdict_caption(verdict: Verdict) -> str:
    """Return the verdict and what happened to each target, in one line."""
    line = f"verdict: {verdict.verdict.replace('_', ' ')}"
    targets = "; ".join(_target(target) for target in verdict.targets)
    line = f"{line} ({targets})" if targets else line
    # a wave that came back and died does not decide the verdict, but the picture shows it
    return (
        line if verdict.reentry.verdict == "none" else f"{line}; {verdict.reentry.verdict} reentry"
    )


def _target(target: TargetFinding) -> str:
    route = f", {target.route}" if target.route else ""
    activated = 100 * target.activated_fraction
    return f"{target.name}: {target.verdict}{route}, {activated:.3g} % activated"
