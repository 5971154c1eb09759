"""Regions of a surface: the words that patches, stimuli, targets and probes share.

A region is one of box, ball, half_space, surface, patch, polar, all, any, not. Each class has a
single field, named as the YAML key.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, TypeAlias

from pydantic import Field

from cardiosurf.sections import Positive, Section

Range: TypeAlias = tuple[float, float]
Vector: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True)
class BoxLimits(Section):
    """Limits of a box, in su; an axis left out is not limited."""

    x: Range | None = None
    y: Range | None = None
    z: Range | None = None


@dataclass(frozen=True)
class BallLimits(Section):
    """A ball in space: all points within ``radius`` of ``centre``, in su."""

    centre: Vector
    radius: Positive


@dataclass(frozen=True)
class HalfSpaceLimits(Section):
    """The side that ``normal`` points to: normal . x >= offset (normal is made a unit vector)."""

    normal: Vector
    offset: float = 0.0


@dataclass(frozen=True)
class PolarLimits(Section):
    """Ranges of the net angles theta and phi, in radians; phi may run past pi."""

    theta: Range | None = None
    phi: Range | None = None


@dataclass(frozen=True)
class Box(Section):
    """An axis-aligned box."""

    box: BoxLimits


@dataclass(frozen=True)
class Ball(Section):
    """A ball."""

    ball: BallLimits


@dataclass(frozen=True)
class HalfSpace(Section):
    """A half space."""

    half_space: HalfSpaceLimits


@dataclass(frozen=True)
class Part(Section):
    """A named part of the shape."""

    surface: str


@dataclass(frozen=True)
class PatchReference(Section):
    """The region of a patch, by the patch's name; the loader replaces it by that region."""

    patch: str


@dataclass(frozen=True)
class Polar(Section):
    """Ranges of theta and phi on a part that has them (vein, sphere)."""

    polar: PolarLimits


@dataclass(frozen=True)
class All(Section):
    """The intersection of regions."""

    all: Annotated[tuple[Region, ...], Field(min_length=1)]


@dataclass(frozen=True)
class AnyOf(Section):
    """The union of regions."""

    any: Annotated[tuple[Region, ...], Field(min_length=1)]


@dataclass(frozen=True)
class Not(Section):
    """The complement of a region."""

    not_: Annotated[Region, Field(alias="not")]


Region: TypeAlias = (
    "Box | Ball | HalfSpace | Part | PatchReference | Polar | All | AnyOf | Not"
)
