"""Which points a region holds, where its edges are, and whether it makes sense on a shape."""

from collections.abc import Mapping
from difflib import get_close_matches

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.errors import InputError
from cardiosurf.geometry.levels import BallLevel, Level
from cardiosurf.geometry.regions import (
    All,
    AnyOf,
    Ball,
    Box,
    HalfSpace,
    Not,
    Part,
    PatchReference,
    Polar,
    Range,
    Region,
)
from cardiosurf.geometry.sheet import Sheet

# regions are closed; a point that rounding put beside an edge still belongs
_SLACK = 1e-9
_ANGLES = ("theta", "phi")


def resolve(region: Region, patches: Mapping[str, Region], where: str = "region") -> Region:
    """Return the region with every patch name replaced by that patch's region.

    Parameters
    ----------
    region : Region
        Any region.
    patches : mapping of str to Region
        The patches defined so far, already resolved: a patch may only refer to earlier ones.
    where : str
        How an error names the region.

    Raises
    ------
    InputError
        If a patch of that name has not been defined before.
    """
    match region:
        case PatchReference(patch):
            if patch not in patches:
                raise InputError(
                    where,
                    f"no patch {patch!r} has been defined before it",
                    ", ".join(patches) or "no patch comes before it",
                    _nearest(patch, tuple(patches)),
                )
            return patches[patch]
        case All(inner):
            return All(tuple(resolve(one, patches, where) for one in inner))
        case AnyOf(inner):
            return AnyOf(tuple(resolve(one, patches, where) for one in inner))
        case Not(inner):
            return Not(resolve(inner, patches, where))
        case _:
            return region


def contains(region: Region, sheet: Sheet, points: Floats, part: Ints | None = None) -> Mask:
    """Return which points (n, 3) of the surface lie in the region, (n,).

    Parameters
    ----------
    region : Region
        A checked region.
    sheet : Sheet
        The exact surface.
    points : (n, 3) float
        Points of the surface, in su.
    part : (n,) int, optional
        Number of each point's part; found from the points when left out.
    """
    if part is None:
        part = sheet.part_of(points)
    match region:
        case Box(limits):
            return _within(points, (limits.x, limits.y, limits.z))
        case Ball(limits):
            away = np.linalg.norm(points - np.asarray(limits.centre), axis=1)
            return np.asarray(away <= limits.radius + _SLACK)
        case HalfSpace(limits):
            normal = unit(limits.normal)
            return np.asarray(points @ np.asarray(normal) >= limits.offset - _SLACK)
        case Part(surface):
            return np.asarray(part == sheet.parts.index(surface))
        case Polar(limits):
            return _within_angles(sheet, points, part, (limits.theta, limits.phi))
        case All(inner):
            return np.all([contains(one, sheet, points, part) for one in inner], axis=0)
        case AnyOf(inner):
            return np.any([contains(one, sheet, points, part) for one in inner], axis=0)
        case Not(inner):
            return ~contains(inner, sheet, points, part)
    raise _unresolved("region", region)


def levels_of(region: Region, sheet: Sheet) -> list[Level]:
    """Return the levels whose zero sets hold the region's edges (part boundaries left out)."""
    match region:
        case Box(limits):
            found: list[Level | None] = []
            for axis, limit in enumerate((limits.x, limits.y, limits.z)):
                normal = (float(axis == 0), float(axis == 1), float(axis == 2))
                found += [sheet.flat_level(normal, offset) for offset in limit or ()]
            return [level for level in found if level is not None]
        case Ball(limits):
            return [BallLevel(limits.centre, limits.radius)]
        case HalfSpace(limits):
            level = sheet.flat_level(unit(limits.normal), limits.offset)
            return [] if level is None else [level]
        case Polar(limits):
            pairs = zip(_ANGLES, (limits.theta, limits.phi), strict=True)
            return [sheet.polar_level(axis, angle) for axis, ends in pairs for angle in ends or ()]
        case All(inner) | AnyOf(inner):
            return [level for one in inner for level in levels_of(one, sheet)]
        case Not(inner):
            return levels_of(inner, sheet)
    return []


def check_region(region: Region, sheet: Sheet, where: str) -> None:
    """Raise InputError if the region can mean nothing on the surface."""
    match region:
        case Box(limits):
            for axis, limit in zip("xyz", (limits.x, limits.y, limits.z), strict=True):
                _check_range(limit, f"{where}: box: {axis}")
        case HalfSpace(limits):
            if not any(limits.normal):
                raise InputError(f"{where}: half_space: normal", "all zero", "any direction")
        case Ball(limits):
            if not limits.radius > 0:
                raise InputError(f"{where}: ball: radius", f"{limits.radius}", "above 0")
        case Part(surface):
            _check_part(surface, sheet, where)
        case Polar(limits):
            _check_range(limits.theta, f"{where}: polar: theta")
            _check_range(limits.phi, f"{where}: polar: phi")
            if _ANGLES not in sheet.axes:
                raise InputError(
                    where, "polar, but no part has theta and phi", "box, ball, half_space, surface"
                )
        case All(inner) | AnyOf(inner):
            for one in inner:
                check_region(one, sheet, where)
        case Not(inner):
            check_region(inner, sheet, where)
        case PatchReference():
            raise _unresolved(where, region)
    _check_polar_parts(region, sheet, where)


def unit(normal: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return the normal with length 1."""
    length = float(np.linalg.norm(normal))
    return (normal[0] / length, normal[1] / length, normal[2] / length)


def _within(points: Floats, limits: tuple[Range | None, Range | None, Range | None]) -> Mask:
    inside = np.ones(len(points), dtype=bool)
    for axis, limit in enumerate(limits):
        if limit is not None:
            inside &= points[:, axis] >= limit[0] - _SLACK
            inside &= points[:, axis] <= limit[1] + _SLACK
    return inside


def _within_angles(
    sheet: Sheet, points: Floats, part: Ints, limits: tuple[Range | None, Range | None]
) -> Mask:
    theta, phi = limits
    curved = np.array([axes == _ANGLES for axes in sheet.axes])
    inside = (part >= 0) & curved[part]
    net = sheet.net(points, part)
    if theta is not None:
        inside &= (net[:, 0] >= theta[0] - _SLACK) & (net[:, 0] <= theta[1] + _SLACK)
    if phi is not None:
        past = np.mod(net[:, 1] - phi[0] + _SLACK, 2.0 * np.pi)
        inside &= past <= phi[1] - phi[0] + 2.0 * _SLACK
    return inside


def _check_range(limit: Range | None, where: str) -> None:
    if limit is not None and limit[0] > limit[1]:
        raise InputError(
            where,
            f"{list(limit)} ends before it begins",
            "two numbers, the smaller first",
            f"[{limit[1]}, {limit[0]}]",
        )


def _check_part(name: str, sheet: Sheet, where: str) -> None:
    if name not in sheet.parts:
        raise InputError(
            f"{where}: surface",
            f"the shape has no part {name!r}",
            ", ".join(sheet.parts),
            _nearest(name, sheet.parts),
        )


def _check_polar_parts(region: Region, sheet: Sheet, where: str) -> None:
    if not isinstance(region, All) or not any(isinstance(one, Polar) for one in region.all):
        return
    for one in region.all:
        if isinstance(one, Part) and sheet.axes[sheet.parts.index(one.surface)] != _ANGLES:
            curved = [p for p, a in zip(sheet.parts, sheet.axes, strict=True) if a == _ANGLES]
            raise InputError(
                f"{where}: polar",
                f"{one.surface} has no theta and phi",
                "polar on " + ", ".join(curved),
            )


def _unresolved(where: str, region: Region) -> InputError:
    return InputError(where, f"{region} is not resolved", "", "replace it by the patch's region")


def _nearest(name: str, names: tuple[str, ...]) -> str:
    close = get_close_matches(name, names, n=1, cutoff=0.5)
    return f"did you mean {close[0]}?" if close else ""
