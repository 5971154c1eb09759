"""Recording in, verdict out."""

import numpy as np

from cardiosurf.analysis.block import TargetFinding, target_finding
from cardiosurf.analysis.capture import captured
from cardiosurf.analysis.distance import distance_from
from cardiosurf.analysis.reentry import ReentryFinding, reentry_finding
from cardiosurf.analysis.route import Map
from cardiosurf.analysis.verdict import NO_CAPTURE_ADVICE, Verdict, whole_verdict
from cardiosurf.arrays import Floats, Mask
from cardiosurf.errors import InputError
from cardiosurf.recording.recording import Recording

TRUSTED_LAT_ERROR = 0.005
"""Relative LAT error of the time step above which a verdict carries a warning."""

WHOLE_TISSUE = "tissue"
"""Name of the target that stands in where a config has none."""


def stimulated(recording: Recording) -> Mask:
    """Return the vertices where the first stimulus is at least half as strong as at its strongest.

    Parameters
    ----------
    recording : Recording
        A recording with at least one pulse.

    Returns
    -------
    (n,) bool
        Over all pulses that begin at the time of the first one.
    """
    first = min(pulse.time for pulse in recording.pulses)
    profiles = [pulse.profile for pulse in recording.pulses if pulse.time == first]
    strong: Mask = np.any([profile >= 0.5 * profile.max() for profile in profiles], axis=0)
    return strong


def excitable_vertex_areas(recording: Recording) -> Floats:
    """Return the excitable area that belongs to each vertex, (n,), in su^2."""
    surface, excitable = recording.surface, recording.tissue.excitable
    shares = np.repeat(surface.areas()[excitable] / 3.0, 3)
    areas: Floats = np.bincount(
        surface.triangles[excitable].ravel(), weights=shares, minlength=recording.node_count
    ).astype(np.float64)
    return areas


def judge_recording(recording: Recording) -> Verdict:
    """Return the verdict of a recording (docs/verdict.md).

    Parameters
    ----------
    recording : Recording
        A finished run.

    Raises
    ------
    InputError
        If a target has no excitable tissue at all.
    """
    surface, tissue = recording.surface, recording.tissue
    areas = surface.areas()
    unperturbed = distance_from(surface.points, surface.triangles, stimulated(recording))
    activation = Map(
        surface.points,
        surface.triangles,
        tissue.tensor,
        recording.first_activation,
        unperturbed,
    )
    masks = dict(recording.targets) or {WHOLE_TISSUE: np.ones(len(areas), dtype=np.bool_)}
    targets = []
    for name, mask in masks.items():
        inside = mask & tissue.excitable
        if not inside.any():
            raise InputError(
                f"targets.{name}",
                "the target lies wholly in tissue that is not excitable",
                "a target with excitable tissue",
                "move the target, or set excitable: true on the patch it lies in",
            )
        targets.append(target_finding(name, activation, inside, areas))
    ended_up = recording.activation_count - recording.repolarisations.count(recording.node_count)
    reentry = reentry_finding(
        recording.activations,
        excitable_vertex_areas(recording),
        beats=len({pulse.time for pulse in recording.pulses}),
        end=recording.end_time,
        active_at_end=ended_up > 0,
    )
    has_left = captured(activation.lat, unperturbed)
    at_rest = recording.stop_reason == "rest"
    return Verdict(
        name=recording.name,
        config_sha256=recording.config_sha256,
        captured=has_left,
        verdict=whole_verdict(has_left, tuple(targets), reentry),
        targets=tuple(targets),
        reentry=reentry,
        quiescent_at=recording.end_time if at_rest else None,
        end=recording.end_time,
        notes=_notes(has_left, recording, tuple(targets), reentry),
    )


def _notes(
    has_left: bool,
    recording: Recording,
    targets: tuple[TargetFinding, ...],
    reentry: ReentryFinding,
) -> tuple[str, ...]:
    """Return what a reader should know before believing the verdict."""
    notes = []
    error = recording.meta.get("lat_error", 0.0)
    if error > TRUSTED_LAT_ERROR:
        notes.append(
            f"steps of {recording.meta['step']:g} tu put LAT off by about {error:.1%}, and may turn"
            " a verdict; use time.step: auto"
        )
    if not has_left:
        return (*notes, NO_CAPTURE_ADVICE)
    waiting = [target.name for target in targets if target.verdict != "conduction"]
    if recording.stop_reason == "end" and waiting:
        notes.append(
            f"the run ended at {recording.end_time:g} tu with tissue still active, so what is not"
            f" activated in {', '.join(waiting)} may still be; raise time.end"
        )
    if reentry.verdict == "sustained":
        notes.append(
            f"reentry was still going on at the end, {recording.end_time:g} tu; a larger time.end"
            " tells whether it dies out"
        )
    return tuple(notes)
