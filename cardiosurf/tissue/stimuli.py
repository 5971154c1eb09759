"""Stimuli: the config sections, and the pulses made from them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Literal, TypeAlias

from annotated_types import Interval

from cardiosurf.arrays import Floats
from cardiosurf.errors import InputError
from cardiosurf.geometry.regions import Region, Vector
from cardiosurf.geometry.surface import Surface
from cardiosurf.sections import Amplitude, Instant, Positive, Section, Span, Strength
from cardiosurf.tissue.profiles import disc_profile, edge_profile, region_profile

Beats: TypeAlias = Annotated[int, Interval(ge=1, le=10_000)]


@dataclass(frozen=True)
class Train(Section):
    """``count`` beats, ``interval`` tu apart."""

    count: Beats
    interval: Positive


@dataclass(frozen=True)
class S1S2(Section):
    """``s1_count`` beats ``s1_interval`` tu apart, then one more ``s2_interval`` tu after the last.

    Attributes
    ----------
    s1_count : int
        Number of conditioning beats S1.
    s1_interval : float
        Time between them, in tu.
    s2_interval : float
        Coupling interval of the premature beat S2, in tu.
    """

    s1_count: Beats
    s1_interval: Positive
    s2_interval: Positive


@dataclass(frozen=True, kw_only=True)
class Timing(Section):
    """When and how strongly a stimulus acts; every shape of stimulus has these keys.

    Attributes
    ----------
    at : float
        Time of the first beat, in tu.
    duration : float
        Without it u is set at once, u <- max(u, profile); with it the profile is a current of
        this many tu.
    strength : float
        Current where the profile is 1, added to u_t, in 1/tu; goes with ``duration``.
    amplitude : float
        Value of u where the profile is 1; for a stimulus without ``duration``.
    train, s1s2 : Train, S1S2
        More beats than one; at most one of them.
    """

    at: Instant = 0.0
    duration: Span | None = None
    strength: Strength | None = None
    amplitude: Amplitude = 1.0
    train: Train | None = None
    s1s2: S1S2 | None = None


@dataclass(frozen=True, kw_only=True)
class PointStimulus(Timing):
    """A disc about the surface point nearest to ``centre``: exp(-r^2 / (2 radius^2)), r < radius.

    With the default radius this is the author's exp(-r^2/200) for r < 10, else 0.

    Attributes
    ----------
    centre : (3,) float
        A point on the surface or nearer to it than ``radius``, in su.
    radius : float
        Radius of the disc, in su.
    """

    shape: Literal["point"] = "point"
    centre: Vector
    radius: Positive = 10.0


@dataclass(frozen=True, kw_only=True)
class EdgeStimulus(Timing):
    """A plane wave from an open edge: 1/(1 + exp((s - position)/width)), s = distance to the edge.

    Attributes
    ----------
    edge : str
        Name of the open edge.
    position : float
        Distance from the edge at which the profile is one half, in su.
    width : float
        Width of the transition, in su.
    """

    shape: Literal["edge"] = "edge"
    edge: str
    position: Positive = 4.0
    width: Positive = 0.1


@dataclass(frozen=True, kw_only=True)
class RegionStimulus(Timing):
    """A region, with profile 1 on all its triangles and 0 elsewhere."""

    shape: Literal["region"] = "region"
    region: Region


Stimulus: TypeAlias = PointStimulus | EdgeStimulus | RegionStimulus

STIMULI: dict[str, type[Stimulus]] = {
    "point": PointStimulus,
    "edge": EdgeStimulus,
    "region": RegionStimulus,
}


@dataclass(frozen=True)
class Pulse:
    """One beat of a stimulus.

    Attributes
    ----------
    time : float
        When it begins, in tu.
    duration : float
        In tu; 0 sets u at once, u <- max(u, profile).
    profile : (n,) float
        The value of u to set, or with a duration the current added to u_t in 1/tu, a vertex: the
        mean over its hat function.
    label : str
        The stimulus and the beat, for messages and the recording.
    """

    time: float
    duration: float
    profile: Floats
    label: str


def stimulus_key(number: int) -> str:
    """Return the name under which a surface resolves the region of stimulus ``number``."""
    return f"stimulus.{number}"


def beat_times(stimulus: Stimulus) -> tuple[float, ...]:
    """Return the times of all beats of a stimulus, in tu."""
    if stimulus.train is not None:
        train = stimulus.train
        return tuple(stimulus.at + beat * train.interval for beat in range(train.count))
    if stimulus.s1s2 is not None:
        pacing = stimulus.s1s2
        first = [stimulus.at + beat * pacing.s1_interval for beat in range(pacing.s1_count)]
        return (*first, first[-1] + pacing.s2_interval)
    return (stimulus.at,)


def check_timing(stimulus: Stimulus, where: str) -> None:
    """Refuse keys of one stimulus that contradict each other.

    Parameters
    ----------
    stimulus : Stimulus
        The stimulus.
    where : str
        Its key path, for the message.

    Raises
    ------
    InputError
        If ``duration`` and ``strength`` are not given together, if ``amplitude`` is given beside
        them, if ``train`` and ``s1s2`` are both given, or if beats overlap.
    """
    if stimulus.train is not None and stimulus.s1s2 is not None:
        raise InputError(where, "train and s1s2 are both given", "one of them, or neither")
    if stimulus.duration is None:
        if stimulus.strength is not None:
            raise InputError(
                f"{where}.strength",
                f"strength {stimulus.strength:g} is given without a duration",
                "strength and duration together (a current), or amplitude alone (u set at once)",
                "add duration: 2",
            )
        return
    if stimulus.strength is None or stimulus.amplitude != 1.0:
        raise InputError(
            f"{where}.duration",
            f"a stimulus with a duration ({stimulus.duration:g} tu) is a current and needs a "
            "strength; amplitude has no meaning for it",
            "duration and strength together, without amplitude",
            "add strength: 0.5",
        )
    times = beat_times(stimulus)
    gaps = [later - earlier for earlier, later in pairwise(times)]
    if gaps and min(gaps) < stimulus.duration:
        raise InputError(
            f"{where}.duration",
            f"beats {min(gaps):g} tu apart overlap: each lasts {stimulus.duration:g} tu",
            f"a duration of at most {min(gaps):g}",
        )


def build_pulses(surface: Surface, stimuli: Sequence[Stimulus]) -> tuple[Pulse, ...]:
    """Return every beat of every stimulus, sorted by time.

    Parameters
    ----------
    surface : Surface
        The surface; its ``regions`` hold region stimuli under ``stimulus_key(number)``.
    stimuli : sequence of Stimulus
        The sections, in the config's order.

    Raises
    ------
    InputError
        If a centre is farther from the surface than its radius, an edge is unknown, a region is
        empty, or the keys of a stimulus contradict each other.
    """
    pulses: list[Pulse] = []
    for number, stimulus in enumerate(stimuli):
        key = stimulus_key(number)
        check_timing(stimulus, key)
        profile = _profile(surface, stimulus, key)
        height = stimulus.amplitude if stimulus.strength is None else stimulus.strength
        times = beat_times(stimulus)
        for beat, time in enumerate(times):
            label = key if len(times) == 1 else f"{key} beat {beat + 1}"
            pulses.append(Pulse(time, stimulus.duration or 0.0, height * profile, label))
    return tuple(sorted(pulses, key=lambda pulse: pulse.time))


def _profile(surface: Surface, stimulus: Stimulus, key: str) -> Floats:
    """Return the profile of a stimulus, between 0 and 1, (n,)."""
    match stimulus:
        case PointStimulus(centre=centre, radius=radius):
            return disc_profile(surface, centre, radius, key)
        case EdgeStimulus(edge=edge, position=position, width=width):
            return edge_profile(surface, edge, position, width, key)
        case RegionStimulus():
            return region_profile(surface, key)
