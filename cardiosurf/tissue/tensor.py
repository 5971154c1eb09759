"""The diffusivity tensor of every triangle."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.errors import InputError
from cardiosurf.geometry.surface import Surface
from cardiosurf.spelling import nearest
from cardiosurf.tissue.patches import Patch, TissueSection, factors_of, patch_key


@dataclass(frozen=True)
class Tissue:
    """What the surface is made of, a triangle.

    Attributes
    ----------
    tensor : (m, 3, 3) float
        Diffusivity d = s1 e1 e1 + s2 e2 e2 in su^2/tu, tangential to the triangle.
    excitable : (m,) bool
        False where the tissue diffuses but does not react.
    names : tuple of str
        Names of the patches, in order.
    patch_of : (m,) int
        Index into ``names`` of the patch that holds; -1 outside all of them.
    """

    tensor: Floats
    excitable: Mask
    names: tuple[str, ...]
    patch_of: Ints


def build_tissue(surface: Surface, section: TissueSection) -> Tissue:
    """Lay the patches over the surface: d = s1 e1 e1 + s2 e2 e2 on each triangle.

    Parameters
    ----------
    surface : Surface
        A surface whose ``regions`` hold each patch under ``patch_key(name)``.
    section : TissueSection
        Ambient diffusivity and patches; where patches overlap the later one wins as a whole.

    Raises
    ------
    InputError
        If a patch covers no triangle, names an axis that its part of the surface does not have,
        or makes a tensor that is not positive.
    """
    count = len(surface.triangles)
    _require_positive(section.diffusivity, "tissue.diffusivity")
    along_axes = np.full((count, 2), float(section.diffusivity))
    excitable = np.ones(count, dtype=np.bool_)
    patch_of = np.full(count, -1, dtype=np.int64)
    for number, patch in enumerate(section.patches):
        mask = surface.regions[patch_key(patch.name)]
        if not mask.any():
            raise InputError(
                f"{patch_key(patch.name)}.region",
                "the region is empty: it holds no triangle of the surface",
                "a region that lies on the surface",
                "cardiosurf mesh prints the extent of the surface",
            )
        base = section.diffusivity if patch.diffusivity is None else patch.diffusivity
        _require_positive(base, f"{patch_key(patch.name)}.diffusivity")
        along_axes[mask] = base * _along_axes(surface, patch, mask)[mask]
        excitable[mask] = patch.excitable
        patch_of[mask] = number
    scaled = along_axes[:, :, None] * surface.frame
    tensor = scaled[:, 0, :, None] * surface.frame[:, 0, None, :]
    tensor += scaled[:, 1, :, None] * surface.frame[:, 1, None, :]
    return Tissue(tensor, excitable, tuple(patch.name for patch in section.patches), patch_of)


def _along_axes(surface: Surface, patch: Patch, mask: Mask) -> Floats:
    """Return the factors of a patch along both net axes, (m, 2)."""
    factors = factors_of(patch)
    along = np.ones((len(surface.triangles), 2))
    if not isinstance(factors, dict):
        along[:] = factors
        return along
    key = "anisotropy" if patch.frame_scaling is None else "frame_scaling"
    for part in np.unique(surface.part_of[mask]):
        axes = surface.axes[part]
        for axis, factor in factors.items():
            if axis not in axes:
                raise _wrong_axis(surface, f"{patch_key(patch.name)}.{key}.{axis}", axis, int(part))
            along[surface.part_of == part, axes.index(axis)] = factor
    return along


def _wrong_axis(surface: Surface, where: str, axis: str, part: int) -> InputError:
    name, axes = surface.parts[part], surface.axes[part]
    having = [p for p, a in zip(surface.parts, surface.axes, strict=True) if axis in a]
    close = nearest(axis, axes)
    if having:
        advice = (
            f"keep the patch on {having[0]!r}: region: {{all: [{{surface: {having[0]}}}, ...]}}"
        )
    elif close:
        advice = f"did you mean {close!r}?"
    else:
        advice = "one number, without an axis, scales both axes"
    return InputError(
        where,
        f"the patch lies on {name!r}, which has no axis {axis!r}",
        f"the axes of {name!r}: {', '.join(axes)}",
        advice,
    )


def _require_positive(value: float, where: str) -> None:
    if not 0.0 < value < float("inf"):
        raise InputError(
            where, f"{value} makes a tensor that is not positive", "a finite number above 0"
        )
