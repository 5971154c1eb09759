"""What Appendix B's units and the simulation are both asked, and where the answers come from."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from cardiosurf.discrete.packings import face_limit, narrowest_strand, smallest_disc
from cardiosurf.discrete.play import Rule

N_MAX = (3.0, 2.75)
"""The paper's number, and one fitted to the simulated face: its square is the critical factor."""


@dataclass(frozen=True)
class Asked:
    """A critical value of a config.

    Attributes
    ----------
    config : str
        Path of the config from the project's folder, or ``scenario/case`` of ``scenarios/``.
    vary : str
        The number that is varied.
    between : pair of float
        Where to look.
    tolerance : float
        Half width of a bracket.
    edges : tuple of float
        The meshes, in su; for the simulation three, from which it is extrapolated.
    set : tuple of str
        Changes of the config, as ``--set`` takes them.
    """

    config: str
    vary: str
    between: tuple[float, float]
    tolerance: float
    edges: tuple[float, ...]
    set: tuple[str, ...] = ()


@dataclass(frozen=True)
class Kept:
    """An answer of the simulation that is kept already.

    Attributes
    ----------
    kind : str
        ``cases`` or ``thresholds``.
    name : str
        Its name there.
    """

    kind: Literal["cases", "thresholds"]
    name: str


@dataclass(frozen=True)
class Played:
    """A game on the surface of a case.

    Attributes
    ----------
    case : str
        ``scenario/case``.
    edge : float
        Edge length, in su.
    """

    case: str
    edge: float = 3.5


@dataclass(frozen=True)
class Packed:
    """A question about the packing.

    Attributes
    ----------
    answer : callable
        Its answer for a rule.
    unit : str
        What the answer counts.
    """

    answer: Callable[[Rule], float]
    unit: str


@dataclass(frozen=True)
class Question:
    """A question to both.

    Attributes
    ----------
    name : str
        What its result is kept under.
    words : str
        How the table asks it.
    simulated : Asked, Kept or str
        Where the simulation's answer comes from; a str: another question's.
    units : Asked, Played or Packed
        What is asked of the units.
    loads : bool
        Whether anisotropy is a load for the units, or only makes them faster.
    """

    name: str
    words: str
    simulated: Asked | Kept | str
    units: Asked | Played | Packed
    loads: bool = True


_FACE = ("configs/discrete/face.yaml", "tissue.patches.half.anisotropy.x")
_STRIP = "tissue.patches.strip.anisotropy"
_COARSE = (3.5, 2.5, 1.75)


def _site(name: str, words: str, case: str) -> Question:
    """Return the critical value of the T-domain's strip from a site."""
    units = Asked(f"t-domain/{case}", _STRIP, (6.0, 11.0), 0.05, (3.5, 2.5))
    return Question(name, words, Kept("thresholds", f"t-domain/critical-anisotropy/{case}"), units)


def _case(name: str, words: str, case: str) -> Question:
    return Question(name, words, Kept("cases", case), Played(case))


QUESTIONS: tuple[Question, ...] = (
    Question(
        "face",
        "square face of a half plane of anisotropy s, triangles: blocked from s =",
        Asked(*_FACE, (4.0, 12.0), 0.01, (1.0, 0.7, 0.5)),
        Asked(*_FACE, (4.0, 16.0), 0.05, _COARSE),
    ),
    Question(
        "face-speed",
        "the same, anisotropy as `speed`",
        "face",
        Asked(*_FACE, (4.0, 100.0), 1.0, _COARSE),
        loads=False,
    ),
    Question(
        "face-packed",
        "the same, packing with rows along the face",
        "face",
        Packed(face_limit, "s"),
    ),
    _site("t-domain-head-on", "T-domain, strip, from (0, 100, 0): blocked from", "head-on"),
    _site("t-domain-oblique", "T-domain, strip, from (0, 100, 80): blocked from", "oblique"),
    _case("plane-4", "plane, block of 4", "plane/anisotropy-4"),
    _case("plane-8", "plane, block of 8", "plane/anisotropy-8"),
    _case("plane-10", "plane, block of 10", "plane/anisotropy-10"),
    _case("sphere-north", "sphere, north", "sphere/north"),
    _case("sphere-south", "sphere, south", "sphere/south"),
    Question(
        "disc",
        "smallest disc of u = 1 that spreads: radius [su], units in it",
        Asked(
            "configs/discrete/disc.yaml",
            "stimulus.0.region.ball.radius",
            (3.0, 12.0),
            0.02,
            (2.0, 1.4, 1.0),
        ),
        Packed(smallest_disc, "units"),
    ),
    Question(
        "strand",
        "strand that excites a half plane: half width [su], rows of units in it",
        Asked(
            "configs/discrete/strand.yaml",
            "tissue.patches.wall.region.box.y.0",
            (4.0, 14.0),
            0.02,
            (1.4, 1.0, 0.7, 0.5),
        ),
        Packed(narrowest_strand, "rows"),
    ),
    Question(
        "strand-passive-wall",
        "the same, wall passive instead of excitable",
        Asked(
            "configs/discrete/strand.yaml",
            "tissue.patches.wall.region.box.y.0",
            (4.0, 14.0),
            0.02,
            (1.4, 1.0, 0.7, 0.5),
            ("tissue.patches.wall.excitable=false",),
        ),
        Packed(narrowest_strand, "rows"),
    ),
    _case("torus-phi", "torus, phi 8", "torus/phi"),
    _case("torus-both", "torus, both 8", "torus/both"),
    _case("pv-phi", "vein, phi 8", "pulmonary-vein/circumferential"),
    _case("pv-theta", "vein, theta 8", "pulmonary-vein/longitudinal"),
    _case("atrium-normal", "atrium, strips of d = 16", "atrium/normal"),
    _case("atrium-reentry", "atrium, strips of d = 9", "atrium/reentry"),
)
"""All of them, in the order of the table."""
