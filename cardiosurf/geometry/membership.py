"""Which points a region holds, and where its edges are."""

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.errors import InputError
from cardiosurf.geometry.levels import BallLevel, Level
from cardiosurf.geometry.regions import (
    All,
    AnyOf,
    Ball,
    Box,
    BoxLimits,
    HalfSpace,
    Not,
    Part,
    Polar,
    PolarLimits,
    Region,
)
from cardiosurf.geometry.sheet import Sheet

# regions are closed; a point that rounding put beside an edge still belongs
_SLACK = 1e-9
_ANGLES = ("theta", "phi")
_AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def contains(region: Region, sheet: Sheet, points: Floats, part: Ints) -> Mask:
    """Return which points of the surface lie in the region, (n,).

    Parameters
    ----------
    region : Region
        A checked region.
    sheet : Sheet
        The exact surface.
    points : (n, 3) float
        Points of the surface, in su.
    part : (n,) int
        Number of each point's part.
    """
    match region:
        case All(inner):
            return np.asarray(np.all([contains(r, sheet, points, part) for r in inner], axis=0))
        case AnyOf(inner):
            return np.asarray(np.any([contains(r, sheet, points, part) for r in inner], axis=0))
        case Not(one):
            return ~contains(one, sheet, points, part)
        case Part(surface):
            return np.asarray(part == sheet.parts.index(surface))
        case Polar(angles):
            return _within_angles(sheet, points, part, angles)
    return _within(region, points)


def levels_of(region: Region, sheet: Sheet) -> list[Level]:
    """Return the levels whose zero sets hold the region's edges (part boundaries left out)."""
    found: list[Level | None] = []
    match region:
        case All(inner) | AnyOf(inner):
            found = [level for one in inner for level in levels_of(one, sheet)]
        case Not(one):
            found = [*levels_of(one, sheet)]
        case Box(limits):
            pairs = zip(_AXES, (limits.x, limits.y, limits.z), strict=True)
            found = [sheet.flat_level(axis, end) for axis, ends in pairs for end in ends or ()]
        case Ball(limits):
            found = [BallLevel(limits.centre, limits.radius)]
        case HalfSpace(limits):
            found = [sheet.flat_level(*plane(limits.normal, limits.offset))]
        case Polar(angles):
            turns = zip(_ANGLES, (angles.theta, angles.phi), strict=True)
            found = [sheet.polar_level(axis, end) for axis, ends in turns for end in ends or ()]
    return [level for level in found if level is not None]


def plane(
    normal: tuple[float, float, float], offset: float
) -> tuple[tuple[float, float, float], float]:
    """Return the half space normal . x >= offset with its normal made a unit vector.

    The normal is scaled, the offset is not: it is a distance from the origin, in su.
    """
    length = float(np.linalg.norm(normal))
    return (normal[0] / length, normal[1] / length, normal[2] / length), offset


def _within(region: Region, points: Floats) -> Mask:
    match region:
        case Box(limits):
            return _within_box(limits, points)
        case Ball(limits):
            away = np.linalg.norm(points - np.asarray(limits.centre), axis=1)
            return np.asarray(away <= limits.radius + _SLACK)
        case HalfSpace(limits):
            normal, offset = plane(limits.normal, limits.offset)
            return np.asarray(points @ np.asarray(normal) >= offset - _SLACK)
    raise InputError("region", f"{region} is not resolved", "", "replace it by the patch's region")


def _within_box(limits: BoxLimits, points: Floats) -> Mask:
    inside = np.ones(len(points), dtype=np.bool_)
    for axis, limit in enumerate((limits.x, limits.y, limits.z)):
        if limit is not None:
            inside &= points[:, axis] >= limit[0] - _SLACK
            inside &= points[:, axis] <= limit[1] + _SLACK
    return inside


def _within_angles(sheet: Sheet, points: Floats, part: Ints, limits: PolarLimits) -> Mask:
    curved = np.array([axes == _ANGLES for axes in sheet.axes])
    inside = np.asarray((part >= 0) & curved[part])
    net = sheet.net(points, part)
    # phi goes round on every shape, theta where the chart closes in its direction
    round_tube = sheet.periods is not None and sheet.periods[0] is not None
    if limits.theta is not None:
        inside &= _between(net[:, 0], limits.theta, closed=round_tube)
    if limits.phi is not None:
        inside &= _between(net[:, 1], limits.phi, closed=True)
    return inside


def _between(angle: Floats, limits: tuple[float, float], *, closed: bool) -> Mask:
    low, high = limits
    if closed:
        past = np.mod(angle - low + _SLACK, 2.0 * np.pi)
        return np.asarray(past <= high - low + 2.0 * _SLACK)
    return np.asarray((angle >= low - _SLACK) & (angle <= high + _SLACK))
