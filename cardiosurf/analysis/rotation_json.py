"""A reentry analysis as JSON data: cardiosurf/reentry/1 (docs/reentry.md)."""

from dataclasses import asdict, dataclass
from typing import Any, Literal, TypeAlias

from cardiosurf.analysis.circuit import Circuit
from cardiosurf.analysis.cycles import CycleLength, ProbeCycles
from cardiosurf.analysis.enclosure import Enclosure
from cardiosurf.analysis.phase import Centre
from cardiosurf.analysis.reentry import ReentryFinding
from cardiosurf.analysis.rotation import SCHEMA, Phases, ReentryAnalysis, RimFinding
from cardiosurf.analysis.tracks import Track
from cardiosurf.arrays import Floats
from cardiosurf.json_schema import result_schema

DIGITS = 4
"""Places and times are written to so many decimals: far below an edge length and a step."""

Point: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True)
class CircuitData:
    """The closed path that the wave runs round; lengths in su, times in tu."""

    period: float
    length: float
    speed: float
    gap: float
    encloses: Enclosure | None
    times: tuple[float, ...]
    points: tuple[Point, ...]


@dataclass(frozen=True)
class CoreData:
    """The circle that a tip runs on in its last cycle, in su."""

    centre: Point
    radius: float


@dataclass(frozen=True)
class TrackData:
    """A phase singularity from birth to death; lengths in su, times in tu."""

    chirality: int
    born: float
    died: float | None
    lifetime: float
    path_length: float
    core: CoreData
    times: tuple[float, ...]
    points: tuple[Point, ...]


@dataclass(frozen=True)
class PhasesData:
    """What the frames say."""

    centre: Centre
    frames: int
    most_singularities: int
    rotors: int
    rims: tuple[RimFinding, ...]
    tracks: tuple[TrackData, ...]


@dataclass(frozen=True)
class ReentryData:
    """All that ``cardiosurf analyze --reentry --json`` prints."""

    name: str
    reentry: ReentryFinding
    cycle_length: CycleLength
    recent_cycle_length: CycleLength
    probes: tuple[ProbeCycles, ...]
    circuit: CircuitData | None
    phases: PhasesData | None
    schema: Literal["cardiosurf/reentry/1"] = SCHEMA


def reentry_json(analysis: ReentryAnalysis) -> dict[str, Any]:
    """Return an analysis as plain JSON data, ``schema`` first.

    Parameters
    ----------
    analysis : ReentryAnalysis
        What to write.
    """
    phases = analysis.phases
    data = asdict(
        ReentryData(
            name=analysis.name,
            reentry=analysis.reentry,
            cycle_length=analysis.cycle_length,
            recent_cycle_length=analysis.recent_cycle_length,
            probes=analysis.probes,
            circuit=None if analysis.circuit is None else _circuit(analysis.circuit),
            phases=None if phases is None else _phases(phases, analysis.cycle_length.median),
        )
    )
    return {"schema": data.pop("schema"), **data}


def reentry_schema() -> dict[str, Any]:
    """Return the JSON Schema of a reentry analysis; every key is always there, and no other."""
    return result_schema(ReentryData, SCHEMA)


def _circuit(circuit: Circuit) -> CircuitData:
    return CircuitData(
        period=circuit.period,
        length=circuit.length,
        speed=circuit.speed,
        gap=circuit.gap,
        encloses=circuit.enclosure,
        times=_rounded(circuit.times),
        points=_rounded(circuit.points),
    )


def _phases(phases: Phases, cycle: float | None) -> PhasesData:
    return PhasesData(
        centre=phases.centre,
        frames=phases.frames,
        most_singularities=phases.most,
        rotors=len(phases.rotors(cycle)),
        rims=phases.rims,
        tracks=tuple(_track(track, cycle) for track in phases.tracks),
    )


def _track(track: Track, cycle: float | None) -> TrackData:
    middle, radius = track.core(track.lifetime + 1.0 if cycle is None else cycle)
    return TrackData(
        chirality=track.chirality,
        born=track.born,
        died=track.died,
        lifetime=track.lifetime,
        path_length=track.path_length,
        core=CoreData(_rounded(middle), radius),
        times=_rounded(track.times),
        points=_rounded(track.points),
    )


def _rounded(values: Floats) -> Any:
    return values.round(DIGITS).tolist()
