"""A scenario: one scientific question, the cases that answer it, and what is expected of them."""

from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, TypeAlias

from annotated_types import Interval, MinLen
from pydantic import Field

from cardiosurf.config.page import Figure, Search
from cardiosurf.config.schema import schema_of
from cardiosurf.config.sections import Name
from cardiosurf.sections import Section

SCHEMA_ID = "cardiosurf/scenario/1"
SCENARIO_KEYS = "name and base"

PairVerdict = Literal["unidirectional", "bidirectional block", "bidirectional conduction"]

Number: TypeAlias = Annotated[float, Interval(ge=-1e9, le=1e9)]
Settings: TypeAlias = Annotated[
    dict[str, Any],
    Field(description="values by the key paths of a config, as --set takes them"),
]
Tolerance: TypeAlias = Annotated[
    float | str,
    Field(description='how far a number may be off: itself a number, or a percentage ("1 %")'),
]
Values: TypeAlias = Annotated[tuple[Any, ...], MinLen(1)]


@dataclass(frozen=True)
class Fast(Section):
    """How a case is run by ``check --fast``: as coarse as leaves its converged verdict.

    Attributes
    ----------
    set : mapping
        Values laid over the case, by key path; usually ``mesh.edge_length``.
    """

    set: Settings = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Case(Section):
    """One run of a scenario.

    Attributes
    ----------
    name : str
        What the case is called.
    set : mapping
        What distinguishes it from the base config, by key path.
    published : str
        What was published about it, in words.
    expect : mapping
        What is found, by the keys of a verdict: ``verdict``, ``reentry``, ``quiescent_at``,
        ``lat`` of a probe, a target's name, ... A number is compared within its tolerance, given
        as {value, tolerance} or for the whole case.
    note : str
        Why what is found is not what was published, and the like.
    tolerance : number or text
        Tolerance of the numbers in ``expect`` that have none of their own.
    fast : Fast
        How ``check --fast`` runs this case, where it differs from the scenario's.
    figures : tuple of Figure
        The paper's figures of it, for the reproduction page.
    """

    name: Name
    set: Settings = field(default_factory=dict)
    published: str = ""
    expect: dict[str, Any] = field(default_factory=dict)
    note: str = ""
    tolerance: Tolerance | None = None
    fast: Fast | None = None
    figures: tuple[Figure, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Thresholds(Section):
    """Critical values of the two directions of a pair, where they are known.

    Attributes
    ----------
    key : str
        Key path of what they are critical values of.
    forward, backward : float
        The values at which the answer of each direction changes.
    """

    key: str
    forward: Number | None = None
    backward: Number | None = None


@dataclass(frozen=True, kw_only=True)
class Pair(Section):
    """Two cases that pace one tissue from two sites.

    Attributes
    ----------
    name : str
        What the pair is called.
    forward, backward : str
        Names of the two cases.
    target : str
        The target that is to be reached; in the way back another one may be meant.
    backward_target : str
        The target of the way back, where it is another one.
    published : str
        What was published about it, in words.
    expect : str
        ``unidirectional``, ``bidirectional block`` or ``bidirectional conduction``.
    note : str
        Words for the reader.
    thresholds : Thresholds
        Critical values; the margins to them are reported.
    """

    name: Name
    forward: str
    backward: str
    target: str
    backward_target: str | None = None
    published: str = ""
    expect: PairVerdict | None = None
    note: str = ""
    thresholds: Thresholds | None = None


@dataclass(frozen=True)
class Link(Section):
    """How a key follows a parameter: factor times its value plus offset."""

    factor: Number = 1.0
    offset: Number = 0.0


@dataclass(frozen=True, kw_only=True)
class LatinHypercube(Section):
    """Samples of which each of ``count`` equal parts of every range holds one.

    Attributes
    ----------
    count : int
        How many.
    seed : int
        Of the random numbers; the same seed gives the same samples.
    ranges : mapping of str to [low, high]
        What is varied, by key path or parameter.
    """

    count: Annotated[int, Interval(ge=1, le=10_000)]
    seed: Annotated[int, Interval(ge=0, le=2**32 - 1)] = 0
    ranges: dict[str, tuple[Number, Number]]


@dataclass(frozen=True, kw_only=True)
class Scenario(Section):
    """One scientific question.

    Attributes
    ----------
    name : str
        What the scenario is called.
    source : str
        Where it was published.
    question : str
        What is asked.
    answer : str
        What was found, in words, for the reproduction page.
    base : str
        The config that all cases begin with, seen from the scenario's folder.
    set : mapping
        Values laid over the base for all cases and all points of a sweep, by key path.
    cases : tuple of Case
        The runs that answer it; ``check`` compares them. Without any, ``sweep`` varies the base.
    pairs : tuple of Pair
        Cases that are two directions of one way.
    searches : tuple of Search
        Critical values that the reproduction page is to have.
    fast : Fast
        How ``check --fast`` runs the cases; without it, at their own resolution.
    parameters : mapping
        Names for what moves several keys at once: each key with its factor, or {factor, offset}.
    grid : mapping of str to list
        What ``sweep`` varies, every value with every other, by key path or parameter.
    lists : mapping of str to list
        What it varies together: the first values, the second ones, ...
    latin_hypercube : LatinHypercube
        What it samples.
    """

    name: Name
    source: str = ""
    question: str = ""
    answer: str = ""
    base: str
    set: Settings = field(default_factory=dict)
    cases: tuple[Case, ...] = ()
    pairs: tuple[Pair, ...] = ()
    searches: tuple[Search, ...] = ()
    fast: Fast | None = None
    parameters: dict[str, dict[str, Number | Link]] = field(default_factory=dict)
    grid: dict[str, Values] = field(default_factory=dict)
    lists: dict[str, Values] = field(default_factory=dict)
    latin_hypercube: LatinHypercube | None = None

    @property
    def sweeps(self) -> bool:
        """Whether there is something to vary."""
        return bool(self.grid or self.lists or self.latin_hypercube)

    @property
    def on_page(self) -> bool:
        """Whether the reproduction page takes its cases: what a sweep varies is no claim."""
        return bool(self.cases) and not self.sweeps


def scenario_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a scenario file."""
    return schema_of(Scenario, SCHEMA_ID, "cardiosurf scenario")
