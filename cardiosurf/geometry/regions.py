"""Regions of a surface: the words that patches, stimuli, targets and probes share.

A region is one of box, ball, half_space, surface, patch, polar, all, any, not. Each class has a
single field, named as the YAML key.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, TypeAlias

from pydantic import AfterValidator, Discriminator, Field, Tag

from cardiosurf.geometry.angles import Angle
from cardiosurf.sections import SMALLEST, Coordinate, Positive, Section, Worded, word_of


def _increasing(limits: tuple[float, float]) -> tuple[float, float]:
    """Refuse a range that does not go from low to high."""
    if not limits[0] < limits[1]:
        msg = "does not go from low to high"
        raise ValueError(msg)
    return limits


def _nonzero(normal: tuple[float, float, float]) -> tuple[float, float, float]:
    """Refuse a normal without a direction."""
    if max(map(abs, normal)) < SMALLEST:
        msg = f"has no direction: no component is as large as {SMALLEST:g}"
        raise ValueError(msg)
    return normal


Range: TypeAlias = Annotated[tuple[Coordinate, Coordinate], AfterValidator(_increasing)]
AngleRange: TypeAlias = Annotated[tuple[Angle, Angle], AfterValidator(_increasing)]
Vector: TypeAlias = tuple[Coordinate, Coordinate, Coordinate]
Direction: TypeAlias = Annotated[Vector, AfterValidator(_nonzero)]


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

    normal: Direction
    offset: Coordinate = 0.0


@dataclass(frozen=True)
class PolarLimits(Section):
    """Ranges of the net angles theta and phi, in radians; phi may run past pi, theta on a torus."""

    theta: AngleRange | None = None
    phi: AngleRange | None = None


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
    """Ranges of theta and phi on a part that has them (vein, sphere, torus, body)."""

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


Region: TypeAlias = Annotated[
    Annotated[Box, Tag("(box)")]
    | Annotated[Ball, Tag("(ball)")]
    | Annotated[HalfSpace, Tag("(half_space)")]
    | Annotated[Part, Tag("(surface)")]
    | Annotated[PatchReference, Tag("(patch)")]
    | Annotated[Polar, Tag("(polar)")]
    | Annotated[All, Tag("(all)")]
    | Annotated[AnyOf, Tag("(any)")]
    | Annotated[Not, Tag("(not)")],
    Discriminator(word_of),
    Worded("a region", "{box: {x: [0, 10]}}", joined=True),
]


def resolve(region: Region, patches: Mapping[str, Region]) -> Region:
    """Return ``region`` with every patch reference replaced by that patch's region.

    Parameters
    ----------
    region : Region
        A region that may refer to patches by name.
    patches : mapping of str to Region
        The regions of the patches, themselves resolved.

    Raises
    ------
    KeyError
        If a patch is referred to that is not in ``patches``; its argument is the name.
    """
    match region:
        case PatchReference(patch=name):
            return patches[name]
        case All(all=parts):
            return All(tuple(resolve(part, patches) for part in parts))
        case AnyOf(any=parts):
            return AnyOf(tuple(resolve(part, patches) for part in parts))
        case Not(not_=part):
            return Not(resolve(part, patches))
        case _:
            return region
