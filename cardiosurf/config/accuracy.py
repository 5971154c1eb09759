"""How accurate a run is to be, and the mesh edges that this takes."""

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

from annotated_types import Interval
from pydantic import BeforeValidator, WithJsonSchema

from cardiosurf.stepping.step_rule import reaction_rate
from cardiosurf.tissue.patches import TissueSection, factors_of

if TYPE_CHECKING:
    from cardiosurf.config.sections import Config

SHARE = 0.5
"""The part of the accuracy that is left to the mesh; the rest is the time step's."""

# relative LAT error of edges h in isotropic tissue = A (h / sqrt(d / rate))^p, A and p by mass: the
# largest A measured on planes and spheres (docs/numerics.md)
EDGE_ERRORS = {"blended": (5e-4, 4.0), "lumped": (1.2e-2, 2.0), "consistent": (1.2e-2, 2.0)}

ACROSS = 2.2e-3
"""More of it in a wave across fibres, per (ratio - 1) rate h^2 / d: the ratio of the two
diffusivities, d the smaller one. Meshes whose triangles are equilateral whatever the tissue let
diffusion along the fibres leak into that across them."""

ACROSS_A_SHAPE = 4.0
"""How many edges a shape spans in any direction at least."""

# edges that are easily read, no two neighbours further apart than a quarter
TIDY_EDGES = (1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0)

SHORTEST_EDGE, LONGEST_EDGE = 0.1, 50.0
"""What a config may ask for, in su."""

_PERCENT = re.compile(r"(?P<number>\d+(?:\.\d*)?|\.\d+)\s*%")


def parse_accuracy(text: str) -> float:
    """Return the accuracy that a percentage stands for, as a fraction.

    Parameters
    ----------
    text : str
        ``0.5 %`` or ``0.5%``.

    Raises
    ------
    ValueError
        If ``text`` is no percentage.

    Examples
    --------
    >>> parse_accuracy("0.5 %")
    0.005
    """
    found = _PERCENT.fullmatch(text.strip())
    if found is None:
        msg = "is not an accuracy: write a percentage such as 0.5 %, or a fraction such as 0.005"
        raise ValueError(msg)
    return float(found["number"]) / 100.0


def _fraction(value: Any) -> Any:
    return parse_accuracy(value) if isinstance(value, str) else value


Accuracy: TypeAlias = Annotated[
    float,
    Interval(ge=5e-4, le=0.05),
    BeforeValidator(_fraction),
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "number", "minimum": 5e-4, "maximum": 0.05},
                {"type": "string", "pattern": r"^\s*([0-9]+(\.[0-9]*)?|\.[0-9]+)\s*%\s*$"},
            ],
            "description": "A relative error of LAT: a percentage (0.5 %) or a fraction (0.005).",
        }
    ),
]


@dataclass(frozen=True)
class EdgeChoice:
    """The length of the mesh edges, and why.

    Attributes
    ----------
    edge_length : float
        In su.
    reason : str
        One line for the record.
    lat_error : float
        Relative LAT error that the mesh is expected to cause.
    """

    edge_length: float
    reason: str
    lat_error: float


def edge_choice(config: "Config", anisotropy: float = 0.0) -> EdgeChoice:
    """Return the mesh edges of a config: those asked for, or what ``auto`` stands for.

    ``auto`` is the longest tidy edge h whose expected error is at most half the accuracy:

        A (h / sqrt(d / rate))^p + 0.0022 rate h^2 <(ratio - 1) / d>

    and of which four span the shape in any direction;
    d is the smallest diffusivity anywhere, rate that of the reaction (a front rises over
    1.3 sqrt(d / rate)), and the mean over the area of (ratio - 1) over the local smaller d.

    Parameters
    ----------
    config : Config
        A decoded config whose sections are right by themselves.
    anisotropy : float
        That mean, in tu/su^2; 0 leaves the second term out.
    """
    coefficient, order = EDGE_ERRORS[config.mesh.mass]
    rate = reaction_rate(config.kinetics)
    width = (smallest_diffusivity(config.tissue) / rate) ** 0.5

    def expected(edge: float) -> float:
        across = ACROSS * rate * edge**2 * anisotropy
        return float(coefficient * (edge / width) ** order + across)

    asked = config.mesh.edge_length
    if asked != "auto":
        return EdgeChoice(asked, f"asked for: LAT error {expected(asked):.2%}", expected(asked))
    longest = min(config.geometry.extents().values()) / ACROSS_A_SHAPE
    good = [
        edge
        for edge in tidy_edges()
        if edge <= longest and expected(edge) <= SHARE * config.accuracy
    ]
    edge = max(good, default=SHORTEST_EDGE)
    reason = f"fronts rise over {1.3 * width:.2g} su at least: LAT error {expected(edge):.2%}"
    return EdgeChoice(edge, reason, expected(edge))


def tidy_edges() -> list[float]:
    """Return all tidy edges that a config may ask for, in su."""
    every = (float(f"{edge * 10.0**power:g}") for power in (-1, 0, 1) for edge in TIDY_EDGES)
    return [edge for edge in every if SHORTEST_EDGE <= edge <= LONGEST_EDGE]


def smallest_diffusivity(section: TissueSection) -> float:
    """Return the smallest diffusivity in any direction, in su^2/tu."""
    found = [section.diffusivity]
    for patch in section.patches:
        base = section.diffusivity if patch.diffusivity is None else patch.diffusivity
        factors = factors_of(patch)
        # an axis that is not named keeps the factor 1
        given = (*factors.values(), 1.0) if isinstance(factors, dict) else (factors,)
        found += [base * factor for factor in given]
    return min(found)
