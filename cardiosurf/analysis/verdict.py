"""The verdict of a run: what a recording says about conduction, block and reentry."""

from dataclasses import asdict, dataclass
from typing import Any, Literal

from cardiosurf.analysis.block import TargetFinding, TargetVerdict
from cardiosurf.analysis.reentry import ReentryFinding, ReentryVerdict
from cardiosurf.json_schema import result_schema

SCHEMA: Literal["cardiosurf/verdict/1"] = "cardiosurf/verdict/1"

WholeVerdict = Literal["no_capture", "reentry", "block", "partial", "conduction"]

NO_CAPTURE_ADVICE = (
    "the stimulus started no wave: raise its amplitude, radius or duration, or check the kinetics"
    " (fitzhugh_nagumo with the printed constants carries no wave at all)"
)


@dataclass(frozen=True)
class GuardTarget:
    """What a guarded run found of one target.

    Attributes
    ----------
    verdict : str
        conduction, block or partial.
    first_activation : float or None
        First LAT in the activated part, in tu.
    """

    verdict: TargetVerdict
    first_activation: float | None


@dataclass(frozen=True)
class GuardRun:
    """One of the runs that a convergence check compares.

    Attributes
    ----------
    edge_length, step : float
        The mesh, in su, and the longest step, in tu.
    verdict : str
        The whole verdict.
    reentry : str
        That of reentry alone.
    targets : mapping of str to GuardTarget
        What happened to each target.
    """

    edge_length: float
    step: float
    verdict: WholeVerdict
    reentry: ReentryVerdict
    targets: dict[str, GuardTarget]


@dataclass(frozen=True)
class GuardFinding:
    """Whether a verdict stays when mesh and step are refined.

    Attributes
    ----------
    tried : tuple of GuardRun
        The runs that are compared: the run itself, that on a finer mesh, that with smaller steps.
    agree : bool
        Whether the whole verdict and that of every target are the same in all of them.
    lat_shift : float or None
        The largest relative shift of a target's first activation against the run itself, counted
        from the first stimulus; None: no target was activated.
    lat_tolerance : float
        What it may be: the config's ``accuracy``.
    converged : str
        ``yes``: the verdicts agree and so do the times; ``no`` otherwise.
    """

    tried: tuple[GuardRun, ...]
    agree: bool
    lat_shift: float | None
    lat_tolerance: float
    converged: Literal["yes", "no"]


@dataclass(frozen=True)
class Verdict:
    """The verdict of one run, as it stands in verdict.json.

    Attributes
    ----------
    schema : str
        The version of this layout.
    name : str
        The run's name.
    config_sha256 : str
        Hash of the resolved config.
    captured : bool
        Whether the stimulus started a wave.
    verdict : str
        ``no_capture``, ``reentry`` (sustained), or the targets' worst: block, partial, conduction.
    targets : tuple of TargetFinding
        What happened to each target.
    reentry : ReentryFinding
        Whether activation came back.
    quiescent_at : float or None
        When all tissue was at rest, in tu; None: it was not by the end.
    end : float
        When the run ended, in tu.
    guard : GuardFinding or None
        Whether it is converged; None: not asked for.
    notes : tuple of str
        Advice and warnings for the reader.
    """

    name: str
    config_sha256: str
    captured: bool
    verdict: WholeVerdict
    targets: tuple[TargetFinding, ...]
    reentry: ReentryFinding
    quiescent_at: float | None
    end: float
    guard: GuardFinding | None = None
    notes: tuple[str, ...] = ()
    schema: Literal["cardiosurf/verdict/1"] = SCHEMA

    def to_json(self) -> dict[str, Any]:
        """Return the verdict as plain JSON data, ``schema`` first."""
        data = asdict(self)
        return {"schema": data.pop("schema"), **data}


def whole_verdict(
    captured: bool, targets: tuple[TargetFinding, ...], reentry: ReentryFinding
) -> WholeVerdict:
    """Return the verdict over all targets: no_capture, reentry, or the targets' worst.

    Only sustained reentry decides it: a wave that came back and died leaves the question whether
    the targets conduct, and stands in ``reentry`` beside the answer.

    Parameters
    ----------
    captured : bool
        Whether the stimulus started a wave.
    targets : tuple of TargetFinding
        What happened to each target.
    reentry : ReentryFinding
        Whether activation came back.
    """
    if not captured:
        return "no_capture"
    if reentry.verdict == "sustained":
        return "reentry"
    found = {target.verdict for target in targets}
    for verdict in ("block", "partial"):
        if verdict in found:
            return verdict
    return "conduction"


def verdict_schema() -> dict[str, Any]:
    """Return the JSON Schema of verdict.json; every key is always there, and no other."""
    return result_schema(Verdict, SCHEMA)
