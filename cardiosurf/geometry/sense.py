"""Whether a region makes sense on a shape."""

from difflib import get_close_matches

from cardiosurf.errors import InputError
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
    Region,
)
from cardiosurf.geometry.sheet import Sheet
from cardiosurf.sections import SMALLEST

_ANGLES = ("theta", "phi")


def check_region(region: Region, sheet: Sheet, where: str) -> None:
    """Raise InputError if the region can mean nothing on the surface.

    Parameters
    ----------
    region : Region
        Any region, its patch references replaced.
    sheet : Sheet
        The exact surface.
    where : str
        How the error names the region.

    Raises
    ------
    InputError
        For ranges that end before they begin, a half space without a direction, a part the shape
        does not have, angles on a part without them, a patch reference.
    """
    match region:
        case All(inner) | AnyOf(inner):
            for one in inner:
                check_region(one, sheet, where)
            if isinstance(region, All):
                _check_polar_parts(region, sheet, where)
        case Not(one):
            check_region(one, sheet, where)
        case Part(surface):
            _check_part(surface, sheet, where)
        case Polar():
            _check_polar(region, sheet, where)
        case _:
            _check_limits(region, where)


def _check_limits(region: Region, where: str) -> None:
    match region:
        case Box(limits):
            for axis, limit in zip("xyz", (limits.x, limits.y, limits.z), strict=True):
                _check_range(limit, f"{where}: box: {axis}")
        case Ball(limits) if not limits.radius > 0:
            raise InputError(f"{where}: ball: radius", f"{limits.radius}", "above 0")
        case HalfSpace(limits) if max(map(abs, limits.normal)) < SMALLEST:
            raise InputError(
                f"{where}: half_space: normal",
                f"{list(limits.normal)}",
                "any direction",
                "[1, 0, 0]",
            )
        case PatchReference(patch):
            raise InputError(
                where, f"the patch {patch!r} is not resolved", "", "the patch's own region"
            )


def _check_range(limit: tuple[float, float] | None, where: str) -> None:
    if limit is not None and limit[0] > limit[1]:
        raise InputError(
            where,
            f"{list(limit)} ends before it begins",
            "two numbers, the smaller first",
            f"[{limit[1]}, {limit[0]}]",
        )


def _check_part(name: str, sheet: Sheet, where: str) -> None:
    if name not in sheet.parts:
        close = get_close_matches(name, sheet.parts, n=1, cutoff=0.5)
        raise InputError(
            f"{where}: surface",
            f"the shape has no part {name!r}",
            ", ".join(sheet.parts),
            f"did you mean {close[0]}?" if close else "",
        )


def _check_polar(region: Polar, sheet: Sheet, where: str) -> None:
    _check_range(region.polar.theta, f"{where}: polar: theta")
    _check_range(region.polar.phi, f"{where}: polar: phi")
    if _ANGLES not in sheet.axes:
        raise InputError(
            f"{where}: polar",
            "no part of the shape has theta and phi",
            "box, ball, half_space, surface, all, any, not",
        )


def _check_polar_parts(region: All, sheet: Sheet, where: str) -> None:
    if not any(isinstance(one, Polar) for one in region.all):
        return
    for one in region.all:
        if isinstance(one, Part) and sheet.axes[sheet.parts.index(one.surface)] != _ANGLES:
            curved = [p for p, a in zip(sheet.parts, sheet.axes, strict=True) if a == _ANGLES]
            raise InputError(
                f"{where}: polar",
                f"{one.surface} has no theta and phi",
                "polar on " + ", ".join(curved),
            )
