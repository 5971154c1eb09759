"""What the stimuli of a recording did: which of them captured, and where their waves would go."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.analysis.capture import has_captured
from cardiosurf.analysis.distance import distance_from
from cardiosurf.analysis.origins import triangle_gradients
from cardiosurf.analysis.waves import Waves, strongly
from cardiosurf.arrays import Floats, Mask
from cardiosurf.recording.recording import Recording
from cardiosurf.tissue.stimuli import Pulse


@dataclass(frozen=True)
class Stimulation:
    """The stimuli that captured, and the wave that they would have made undisturbed.

    Attributes
    ----------
    captured : tuple of bool
        For each pulse, in the recording's order.
    unperturbed : (n,) float
        Arrival of the waves of all pulses that captured (of all pulses if none did) on the bare
        surface, times their speed, in su.
    """

    captured: tuple[bool, ...]
    unperturbed: Floats


def conduction_speed(recording: Recording) -> float:
    """Return the median speed of the first wave outside the patches, in su/tu; 1 if there is none.

    Parameters
    ----------
    recording : Recording
        A finished run.
    """
    surface, tissue = recording.surface, recording.tissue
    outside = tissue.excitable & (tissue.patch_of < 0)
    chosen = surface.triangles[outside] if outside.any() else surface.triangles
    steepness = np.linalg.norm(
        triangle_gradients(surface.points, chosen, recording.first_activation), axis=1
    )
    steepness = steepness[np.isfinite(steepness) & (steepness > 0.0)]
    return float(1.0 / np.median(steepness)) if steepness.size else 1.0


def _per_site(pulses: tuple[Pulse, ...]) -> list[list[int]]:
    """Return the numbers of the pulses, those with the same profile together."""
    sites: dict[bytes, list[int]] = {}
    for number, pulse in enumerate(pulses):
        sites.setdefault(strongly(pulse).tobytes(), []).append(number)
    return list(sites.values())


def stimulation(recording: Recording, waves: Waves) -> Stimulation:
    """Return which stimuli captured and where their waves would go.

    Parameters
    ----------
    recording : Recording
        A finished run.
    waves : Waves
        Its activations and the pulses they go back to.
    """
    points, triangles = recording.surface.points, recording.surface.triangles
    excitable = triangles[recording.tissue.excitable]
    reacting = np.zeros(len(points), dtype=np.bool_)
    reacting[excitable.ravel()] = True
    captured = np.zeros(len(recording.pulses), dtype=np.bool_)
    sites = _per_site(recording.pulses)
    through_tissue = []
    for numbers in sites:
        source = strongly(recording.pulses[numbers[0]]) & reacting
        through_tissue.append(distance_from(points, excitable, source))
        for number in numbers:
            reached = _reached(waves, number, len(points))
            captured[number] = has_captured(reached, through_tissue[-1])
    speed = conduction_speed(recording)
    arrivals = []
    for numbers, distance in zip(sites, through_tissue, strict=True):
        took = [number for number in numbers if captured[number]]
        if took or not captured.any():
            first = min(recording.pulses[number].time for number in took or numbers)
            source = strongly(recording.pulses[numbers[0]])
            # where all tissue is excitable the bare surface is what was looked at already
            scarred = len(excitable) < len(triangles)
            bare = distance_from(points, triangles, source) if scarred else distance
            arrivals.append(first * speed + bare)
    return Stimulation(tuple(bool(took) for took in captured), np.min(arrivals, axis=0))


def _reached(waves: Waves, pulse: int, count: int) -> Mask:
    reached = np.zeros(count, dtype=np.bool_)
    reached[waves.nodes[waves.pulses == pulse]] = True
    return reached
