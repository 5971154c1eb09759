"""Recording in, verdict out."""

import numpy as np

from cardiosurf.analysis.block import TargetFinding, target_finding
from cardiosurf.analysis.reentry import ReentryFinding, reentry_finding
from cardiosurf.analysis.route import FRONT_WIDTH, Map
from cardiosurf.analysis.stimulation import stimulation
from cardiosurf.analysis.verdict import NO_CAPTURE_ADVICE, Verdict, whole_verdict
from cardiosurf.analysis.waves import trace_waves
from cardiosurf.arrays import Floats, Mask
from cardiosurf.recording.recording import Recording

TRUSTED_LAT_ERROR = 0.005
"""Relative LAT error of the time step above which a verdict carries a warning."""

COARSEST_EDGES = {"blended": FRONT_WIDTH / 3.0, "lumped": FRONT_WIDTH / 8.0}
"""Edges above which the front's speed is off by more than 0.5 % (docs/numerics.md)."""

WHOLE_TISSUE = "tissue"
"""Name of the target that stands in where a config has none."""


def _excitable_vertex_areas(recording: Recording, areas: Floats) -> Floats:
    """Return the excitable area that belongs to each vertex, (n,), in su^2."""
    excitable = recording.tissue.excitable
    return np.bincount(
        recording.surface.triangles[excitable].ravel(),
        weights=np.repeat(areas[excitable] / 3.0, 3),
        minlength=recording.node_count,
    ).astype(np.float64)


def _target_masks(recording: Recording) -> dict[str, Mask]:
    """Return the excitable triangles of each target; without targets, all of them."""
    excitable = recording.tissue.excitable
    masks = {name: mask & excitable for name, mask in recording.targets.items()}
    return masks or {WHOLE_TISSUE: excitable}


def judge_recording(recording: Recording) -> Verdict:
    """Return the verdict of a recording (docs/verdict.md).

    Parameters
    ----------
    recording : Recording
        A finished run.
    """
    surface, tissue, count = recording.surface, recording.tissue, recording.node_count
    waves = trace_waves(
        recording.activations, recording.repolarisations, surface.triangles, recording.pulses, count
    )
    stimuli = stimulation(recording, waves)
    activation = Map(
        surface.points,
        surface.triangles,
        tissue.tensor,
        tissue.excitable,
        recording.first_activation,
        stimuli.unperturbed,
    )
    areas = surface.areas()
    targets = tuple(
        target_finding(name, activation, inside, areas)
        for name, inside in _target_masks(recording).items()
    )
    active = bool(
        (recording.activation_count > recording.repolarisations.count(count)).any()
        and recording.quiescent_at is None
    )
    reentry = reentry_finding(
        waves, _excitable_vertex_areas(recording, areas), end=recording.end_time, active=active
    )
    # while tissue is still active the question is open, and nothing speaks against the stimulus
    has_left = any(stimuli.captured) or active
    return Verdict(
        name=recording.name,
        config_sha256=recording.config_sha256,
        captured=has_left,
        verdict=whole_verdict(has_left, targets, reentry),
        targets=targets,
        reentry=reentry,
        quiescent_at=recording.quiescent_at,
        end=recording.end_time,
        notes=(
            *_accuracy_notes(recording),
            *_outcome_notes(recording, targets, reentry, captured=has_left),
        ),
    )


def _accuracy_notes(recording: Recording) -> list[str]:
    """Return warnings about a step or a mesh too coarse to be believed."""
    notes = []
    error = recording.meta.get("lat_error", 0.0)
    if error > TRUSTED_LAT_ERROR:
        notes.append(
            f"steps of {recording.meta['step']:g} tu put LAT off by about {error:.1%}, and may turn"
            " a verdict; use time.step: auto"
        )
    edge, mass = recording.meta.get("edge_length", 0.0), recording.meta.get("mass", "blended")
    coarsest = COARSEST_EDGES.get(mass, COARSEST_EDGES["lumped"])
    if edge > coarsest:
        notes.append(
            f"edges of {edge:g} su are coarse for a front {FRONT_WIDTH:g} su wide, and may turn a"
            f" verdict; use mesh.edge_length: {coarsest:g} or less"
        )
    return notes


def _outcome_notes(
    recording: Recording,
    targets: tuple[TargetFinding, ...],
    reentry: ReentryFinding,
    *,
    captured: bool,
) -> list[str]:
    """Return what a reader should know before believing the verdict."""
    if not captured:
        return [NO_CAPTURE_ADVICE]
    notes = []
    waiting = [target.name for target in targets if target.verdict != "conduction"]
    if recording.quiescent_at is None and waiting:
        notes.append(
            f"the run ended at {recording.end_time:g} tu before all tissue was at rest, so what is"
            f" not activated in {', '.join(waiting)} may still be; raise time.end"
        )
    if reentry.verdict == "sustained":
        notes.append(
            f"reentry was still going on at the end, {recording.end_time:g} tu; a larger time.end"
            " tells whether it dies out"
        )
    return notes
