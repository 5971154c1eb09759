"""The config's ``record`` section: what a run writes down."""

from dataclasses import dataclass

from cardiosurf.sections import Positive, Section


@dataclass(frozen=True)
class ProbeSection(Section):
    """A place where u and v are recorded at every step.

    Parameters
    ----------
    name : str
        How plots and analyses call it.
    at : 3 floats
        Position in su; the nearest point of the surface is taken.
    """

    name: str
    at: tuple[float, float, float]


@dataclass(frozen=True)
class RecordSection(Section):
    """What is recorded besides activation and repolarisation times, which always are.

    Parameters
    ----------
    frames_every : float or None
        Time between two stored frames of u and v, in tu; None stores no frames.
    probes : tuple of ProbeSection
        Places where u and v are recorded at every step.
    checkpoint_every : float
        Wall time between two checkpoints, in seconds.
    """

    frames_every: Positive | None = 10.0
    probes: tuple[ProbeSection, ...] = ()
    checkpoint_every: Positive = 60.0
