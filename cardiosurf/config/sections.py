"""The whole config: one frozen dataclass whose fields are the YAML keys."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias

from annotated_types import Interval, MinLen
from pydantic import Field

from cardiosurf.analysis.targets import Target
from cardiosurf.config.accuracy import LONGEST_EDGE, SHORTEST_EDGE, Accuracy
from cardiosurf.config.unions import keyed_union
from cardiosurf.geometry import SHAPES, AnyShape
from cardiosurf.geometry.regions import Region
from cardiosurf.kinetics import KINETICS, AnyKinetics
from cardiosurf.kinetics.rogers_mcculloch import RogersMcCulloch
from cardiosurf.recording.sections import RecordSection
from cardiosurf.sections import Section
from cardiosurf.stepping.controls import TimeSection
from cardiosurf.tissue.patches import TissueSection, patch_key
from cardiosurf.tissue.stimuli import STIMULI, RegionStimulus, Stimulus, stimulus_key

# A type checker sees the plain unions; pydantic is told which key chooses among the classes.
if TYPE_CHECKING:
    Geometry: TypeAlias = AnyShape
    Kinetics: TypeAlias = AnyKinetics
    AnyStimulus: TypeAlias = Stimulus
else:
    Geometry = keyed_union("kind", SHAPES)
    Kinetics = keyed_union("model", KINETICS, default="rogers_mcculloch")
    AnyStimulus = keyed_union("shape", STIMULI)

LONGEST_NAME = 100
NAME_PATTERN = r"^[A-Za-z0-9][A-Za-z0-9_.-]*$"
Name: TypeAlias = Annotated[
    str,
    Field(
        pattern=NAME_PATTERN,
        max_length=LONGEST_NAME,
        description=f"at most {LONGEST_NAME} letters, digits, _, . and -, "
        "beginning with a letter or digit",
    ),
]


EdgeLength: TypeAlias = Annotated[float, Interval(ge=SHORTEST_EDGE, le=LONGEST_EDGE)]


@dataclass(frozen=True)
class MeshSection(Section):
    """How finely the surface is divided into triangles.

    Attributes
    ----------
    edge_length : float or "auto"
        Target length of the triangles' edges, in su; fronts are about 12 su wide. ``auto`` is the
        longest that the accuracy allows.
    order : int
        Polynomial order of the elements.
    mass : str
        Mass matrix: ``blended`` is the mean of ``lumped`` and ``consistent``, which cancels the
        leading error of the front speed.
    """

    edge_length: EdgeLength | Literal["auto"] = "auto"
    order: Literal[1] = 1
    mass: Literal["blended", "lumped", "consistent"] = "blended"


@dataclass(frozen=True, kw_only=True)
class Config(Section):
    """One simulation.

    Attributes
    ----------
    name : str
        What the run is called; a file-name-safe word. The file's name without suffix by default.
    accuracy : float
        Relative error of LAT that ``auto`` edges and steps stay below: 0.005, or 0.5 %.
    geometry : shape
        The surface, by its ``kind``.
    mesh : MeshSection
        How finely it is divided.
    kinetics : model
        The reaction, by its ``model``.
    tissue : TissueSection
        Diffusivity and patches.
    stimulus : tuple of stimuli
        What starts the wave, each by its ``shape``.
    time : TimeSection
        How long and how the equations are marched.
    record : RecordSection
        What is written down besides the activation times.
    targets : tuple of Target
        The regions that the verdict is about.
    """

    name: Name = "simulation"
    accuracy: Accuracy = 0.005
    geometry: Geometry
    mesh: MeshSection = field(default_factory=MeshSection)
    kinetics: Kinetics = field(default_factory=RogersMcCulloch)
    tissue: TissueSection = field(default_factory=TissueSection)
    stimulus: Annotated[tuple[AnyStimulus, ...], MinLen(1)]
    time: TimeSection
    record: RecordSection = field(default_factory=RecordSection)
    targets: tuple[Target, ...] = ()


def target_key(name: str) -> str:
    """Return the name under which a surface resolves the region of target ``name``."""
    return f"targets.{name}"


def regions_of(config: Config) -> dict[str, Region]:
    """Return every region that the mesh has to resolve, by its key path in the config.

    The keys are those of ``Surface.regions``: ``patch_key(name)``, ``target_key(name)`` and
    ``stimulus_key(number)``.
    """
    regions = {patch_key(patch.name): patch.region for patch in config.tissue.patches}
    regions |= {target_key(target.name): target.region for target in config.targets}
    regions |= {
        stimulus_key(number): stimulus.region
        for number, stimulus in enumerate(config.stimulus)
        if isinstance(stimulus, RegionStimulus)
    }
    return regions
