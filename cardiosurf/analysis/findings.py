"""Recording in, verdict out."""

import numpy as np

from cardiosurf.analysis.block import TargetFinding, target_finding
from cardiosurf.analysis.reentry import ReentryFinding, reentry_finding
from cardiosurf.analysis.route import Map
from cardiosurf.analysis.stimulation import stimulation
from cardiosurf.analysis.targets import WHOLE_TISSUE
from cardiosurf.analysis.verdict import NO_CAPTURE_ADVICE, Verdict, whole_verdict
from cardiosurf.analysis.waves import trace_waves
from cardiosurf.arrays import Floats, Mask
from cardiosurf.recording.recording import Recording


def excitable_vertex_areas(recording: Recording) -> Floats:
    """Return the excitable area that belongs to each vertex, (n,), in su^2."""
    excitable, areas = recording.tissue.excitable, recording.surface.areas()
    return np.bincount(
        recording.surface.triangles[excitable].ravel(),
        weights=np.repeat(areas[excitable] / 3.0, 3),
        minlength=recording.node_count,
    ).astype(np.float64)


def still_active(recording: Recording) -> bool:
    """Return whether any tissue was above u = 0.5 when the run ended."""
    repolarised = recording.repolarisations.count(recording.node_count)
    return bool((recording.activation_count > repolarised).any() and recording.quiescent_at is None)


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
    active = still_active(recording)
    reentry = reentry_finding(
        waves, excitable_vertex_areas(recording), end=recording.end_time, active=active
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
    meta = recording.meta
    accuracy = meta.get("accuracy", 0.005)
    notes = []
    error = meta.get("lat_error", 0.0)
    if error > accuracy:
        notes.append(
            f"steps of {meta['step']:g} tu put LAT off by about {error:.1%}, and may turn"
            " a verdict; use time.step: auto"
        )
    error = meta.get("edge_lat_error", 0.0)
    # the rule for edges bounds the worst of the cases it was measured on, most are thrice as good
    if error > 2.0 * accuracy:
        notes.append(
            f"edges of {meta['edge_length']:g} su put LAT off by up to {error:.1%}, and may turn"
            " a verdict; use mesh.edge_length: auto"
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
