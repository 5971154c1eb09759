"""A reentry analysis as JSON data: cardiosurf/reentry/1 (docs/reentry.md)."""

from dataclasses import asdict
from typing import Any

from cardiosurf.analysis.circuit import Circuit
from cardiosurf.analysis.rotation import SCHEMA, Phases, ReentryAnalysis
from cardiosurf.analysis.tracks import Track
from cardiosurf.arrays import Floats

DIGITS = 4
"""Places and times are written to so many decimals: far below an edge length and a step."""


def reentry_json(analysis: ReentryAnalysis) -> dict[str, Any]:
    """Return an analysis as plain JSON data, ``schema`` first.

    Parameters
    ----------
    analysis : ReentryAnalysis
        What to write.
    """
    cycle, phases = analysis.cycle_length.median, analysis.phases
    return {
        "schema": SCHEMA,
        "name": analysis.name,
        "reentry": asdict(analysis.reentry),
        "cycle_length": asdict(analysis.cycle_length),
        "recent_cycle_length": asdict(analysis.recent_cycle_length),
        "probes": [asdict(probe) for probe in analysis.probes],
        "circuit": None if analysis.circuit is None else _circuit(analysis.circuit),
        "phases": None if phases is None else _phases(phases, cycle),
    }


def _circuit(circuit: Circuit) -> dict[str, Any]:
    around = circuit.enclosure
    return {
        "period": circuit.period,
        "length": circuit.length,
        "speed": circuit.speed,
        "gap": circuit.gap,
        "encloses": None if around is None else asdict(around),
        "times": _rounded(circuit.times),
        "points": _rounded(circuit.points),
    }


def _phases(phases: Phases, cycle: float | None) -> dict[str, Any]:
    return {
        "centre": asdict(phases.centre),
        "frames": phases.frames,
        "most_singularities": phases.most,
        "rotors": len(phases.rotors(cycle)),
        "rims": [asdict(rim) for rim in phases.rims],
        "tracks": [_track(track, cycle) for track in phases.tracks],
    }


def _track(track: Track, cycle: float | None) -> dict[str, Any]:
    middle, radius = track.core(track.lifetime + 1.0 if cycle is None else cycle)
    return {
        "chirality": track.chirality,
        "born": track.born,
        "died": track.died,
        "lifetime": track.lifetime,
        "path_length": track.path_length,
        "core": {"centre": _rounded(middle), "radius": radius},
        "times": _rounded(track.times),
        "points": _rounded(track.points),
    }


def _rounded(values: Floats) -> Any:
    return values.round(DIGITS).tolist()
