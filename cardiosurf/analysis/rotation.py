"""Reentry in full: cycle lengths, circuit, phase singularities, and holes that waves run round."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from cardiosurf.analysis.circuit import Circuit, find_circuit
from cardiosurf.analysis.cycles import CycleLength, ProbeCycles, find_returns, probe_cycles
from cardiosurf.analysis.findings import excitable_vertex_areas, still_active
from cardiosurf.analysis.phase import Centre, phase_centre
from cardiosurf.analysis.reentry import ReentryFinding, reentry_finding
from cardiosurf.analysis.rims import Rim, find_rims, lasting, rim_chiralities
from cardiosurf.analysis.singularities import find_singularities
from cardiosurf.analysis.stimulation import conduction_speed
from cardiosurf.analysis.tracks import Track, follow
from cardiosurf.analysis.waves import FLICKER, trace_waves, usual_duration
from cardiosurf.geometry.topology import edge_lengths
from cardiosurf.recording.recording import Recording

SCHEMA: Literal["cardiosurf/reentry/1"] = "cardiosurf/reentry/1"

FASTEST = 2.0
"""A singularity may move so many times as fast as a wave along the fastest fibres."""
SLACK = 2.0
"""And so many edge lengths besides."""


@dataclass(frozen=True)
class RimFinding:
    """A rim of the excitable tissue, and whether a wave runs round the hole that it bounds.

    Attributes
    ----------
    name : str
        The open edges and passive patches along it.
    length : float
        In su.
    chirality : int
        How the wave circulates in most frames of the last cycle: 1 counterclockwise about the hole,
        -1 clockwise, 0 not at all.
    """

    name: str
    length: float
    chirality: int


@dataclass(frozen=True)
class Phases:
    """What the frames say.

    Attributes
    ----------
    centre : Centre
        The point in the plane of u and v about which the phase turns.
    frames : int
        How many frames there are.
    most : int
        The largest number of singularities in any frame.
    tracks : tuple of Track
        All singularities, followed in time, the longest life first.
    rims : tuple of RimFinding
        The rims of the excitable tissue, the longest first.
    """

    centre: Centre
    frames: int
    most: int
    tracks: tuple[Track, ...]
    rims: tuple[RimFinding, ...]

    def rotors(self, cycle: float | None) -> tuple[Track, ...]:
        """Return the tracks that live for a cycle at least; none if there is no cycle."""
        if cycle is None:
            return ()
        return tuple(track for track in self.tracks if track.lifetime >= cycle)


@dataclass(frozen=True)
class ReentryAnalysis:
    """All that a recording says about reentry.

    Attributes
    ----------
    name : str
        The run's name.
    reentry : ReentryFinding
        As in the verdict.
    cycle_length : CycleLength
        Over the whole tissue.
    recent_cycle_length : CycleLength
        Of the last cycle alone.
    probes : tuple of ProbeCycles
        Activations and cycle length at each probe.
    circuit : Circuit or None
        The closed path that the wave runs round; None if no path closes.
    phases : Phases or None
        Singularities and circulation; None without frames, or if nothing was ever excited in them.
    """

    name: str
    reentry: ReentryFinding
    cycle_length: CycleLength
    recent_cycle_length: CycleLength
    probes: tuple[ProbeCycles, ...]
    circuit: Circuit | None
    phases: Phases | None

    @property
    def rotors(self) -> tuple[Track, ...]:
        """The singularities that live for a cycle at least."""
        return () if self.phases is None else self.phases.rotors(self.cycle_length.median)


def analyse_reentry(recording: Recording) -> ReentryAnalysis:
    """Analyse reentry in a recording (docs/reentry.md).

    Parameters
    ----------
    recording : Recording
        A finished run; without its frames the singularities are left out.
    """
    surface, tissue = recording.surface, recording.tissue
    events = (recording.activations, recording.repolarisations)
    waves = trace_waves(*events, surface.triangles, recording.pulses, recording.node_count)
    returns = find_returns(waves)
    finding = reentry_finding(
        waves,
        excitable_vertex_areas(recording),
        end=recording.end_time,
        active=still_active(recording),
    )
    rims = find_rims(surface, tissue)
    again = finding.verdict != "none"
    duration = usual_duration(*events, recording.node_count)
    gap = FLICKER * duration if np.isfinite(duration) else 0.0
    last = finding.last_reactivation
    cycle = finding.cycle_length
    recent = returns if last is None or cycle is None else returns.since(last - cycle)
    return ReentryAnalysis(
        name=recording.name,
        reentry=finding,
        cycle_length=CycleLength.of(returns.cycles if again else np.empty(0)),
        recent_cycle_length=CycleLength.of(recent.cycles if again else np.empty(0)),
        probes=probe_cycles(recording.probes, surface, waves, gap),
        circuit=find_circuit(surface, tissue, waves, returns, rims) if again else None,
        phases=_phases(recording, rims, cycle),
    )


def _phases(recording: Recording, rims: tuple[Rim, ...], cycle: float | None) -> Phases | None:
    frames, surface, tissue = recording.frames, recording.surface, recording.tissue
    centre = phase_centre(frames)
    if centre is None:
        return None
    triangles = surface.triangles[tissue.excitable]
    found = find_singularities(frames, surface.points, triangles, centre)
    (number,) = np.nonzero(tissue.excitable)
    found = replace(found, triangles=number[found.triangles])
    fastest = float(np.sqrt(np.linalg.eigvalsh(tissue.tensor[tissue.excitable]).max()))
    tracks = follow(
        found,
        speed=FASTEST * fastest * conduction_speed(recording),
        slack=SLACK * float(edge_lengths(surface.points, triangles).mean()),
    )
    chiralities = rim_chiralities(frames, rims, centre)
    if cycle is not None:
        chiralities = chiralities[frames.times >= frames.times[-1] - cycle]
    about = [
        RimFinding(rim.name, rim.length, lasting(of_rim))
        for rim, of_rim in zip(rims, chiralities.T, strict=True)
    ]
    most = int(found.counts.max(initial=0))
    return Phases(centre, len(frames.times), most, tracks, tuple(about))
