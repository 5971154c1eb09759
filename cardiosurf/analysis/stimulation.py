"""What the stimuli of a recording did: which of them captured, and where their waves would go."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.analysis.capture import has_captured, is_far_out
from cardiosurf.analysis.eikonal import distance_from
from cardiosurf.analysis.neighbours import pieces
from cardiosurf.analysis.origins import triangle_gradients
from cardiosurf.analysis.sources import Sources
from cardiosurf.analysis.waves import Waves, strongly
from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.recording.recording import Recording
from cardiosurf.tissue.stimuli import Pulse


@dataclass(frozen=True)
class Stimulation:
    """The stimuli that captured, and the wave that they would have made undisturbed.

    Attributes
    ----------
    captured : tuple of bool
        For each pulse, in the recording's order.
    points, triangles : (n, 3) float, (m, 3) int
        The bare surface.
    sources : Sources
        Where the waves of all pulses that captured start (of all pulses if none did), and how far a
        wave would have come when they do, in su.
    """

    captured: tuple[bool, ...]
    points: Floats
    triangles: Ints
    sources: Sources

    def unperturbed(self) -> Floats:
        """Return the arrival of these waves on the bare surface, times their speed, (n,), in su."""
        return distance_from(self.points, self.triangles, self.sources)


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
    """Return which stimuli captured and where their waves would start.

    Parameters
    ----------
    recording : Recording
        A finished run.
    waves : Waves
        Its activations and the pulses they go back to.
    """
    points, triangles = recording.surface.points, recording.surface.triangles
    captured = _captured(recording, waves)
    speed = conduction_speed(recording)
    starts = np.full(len(points), np.inf)
    for numbers in _per_site(recording.pulses):
        took = [number for number in numbers if captured[number]]
        if took or not captured.any():
            first = min(recording.pulses[number].time for number in took or numbers)
            source = strongly(recording.pulses[numbers[0]])
            starts[source] = np.minimum(starts[source], first * speed)
    sources = np.flatnonzero(np.isfinite(starts))
    return Stimulation(
        tuple(bool(took) for took in captured),
        points,
        triangles,
        Sources.at(sources, starts[sources]),
    )


def _captured(recording: Recording, waves: Waves) -> Mask:
    """Return which pulses sent off a wave, (p,)."""
    points = recording.surface.points
    excitable = recording.surface.triangles[recording.tissue.excitable]
    piece = pieces(excitable, len(points))
    captured = np.zeros(len(recording.pulses), dtype=np.bool_)
    for numbers in _per_site(recording.pulses):
        source = np.isin(np.arange(len(points)), excitable)
        source &= strongly(recording.pulses[numbers[0]])
        connected = np.isin(piece, piece[source])
        distance = None
        for number in numbers:
            reached = _reached(waves, number, len(points)) & connected
            captured[number] = is_far_out(points, reached, source)
            if reached.any() and not captured[number]:
                # the way through the tissue may be longer, or all of the tissue be near
                if distance is None:
                    sources = Sources.at(np.flatnonzero(source))
                    distance = distance_from(points, excitable, sources)
                captured[number] = has_captured(reached, distance)
    return captured


def _reached(waves: Waves, pulse: int, count: int) -> Mask:
    reached = np.zeros(count, dtype=np.bool_)
    reached[waves.nodes[waves.pulses == pulse]] = True
    return reached
