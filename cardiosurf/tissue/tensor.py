"""The diffusivity tensor of every triangle."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.errors import InputError
from cardiosurf.geometry.surface import Surface
from cardiosurf.spelling import nearest
from cardiosurf.tissue.fibres import ACROSS, ALONG, AnyFibres
from cardiosurf.tissue.patches import Patch, TissueSection, factors_of, patch_key

ISOTROPIC = 1e-9
"""Relative difference of the two diffusivities below which a tensor has no main direction."""


@dataclass(frozen=True)
class Tissue:
    """What the surface is made of, a triangle.

    Attributes
    ----------
    tensor : (m, 3, 3) float
        Diffusivity d = s1 e1 e1 + s2 e2 e2 in su^2/tu, tangential to the triangle; where a patch
        has fibres, along and across them instead.
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

    The directions are those of the net, or f and g along and across the fibres of a patch.

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
        has fibres without a direction, or makes a tensor that is not positive.
    """
    count = len(surface.triangles)
    _require_positive(section.diffusivity, "tissue.diffusivity")
    along_axes = np.full((count, 2), float(section.diffusivity))
    frame = surface.frame.copy()
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
        if patch.fibres is None:
            frame[mask] = surface.frame[mask]
            along_axes[mask] = base * _along_axes(surface, patch, mask)[mask]
        else:
            frame[mask], factors = _along_fibres(surface, patch, patch.fibres, np.flatnonzero(mask))
            along_axes[mask] = base * factors
        excitable[mask] = patch.excitable
        patch_of[mask] = number
    return Tissue(
        _tensor(along_axes, frame),
        excitable,
        tuple(patch.name for patch in section.patches),
        patch_of,
    )


def _tensor(along_axes: Floats, frame: Floats) -> Floats:
    """Return s1 e1 e1 + s2 e2 e2, (m, 3, 3), for factors (m, 2) and directions (m, 2, 3)."""
    # columns: products of rows of three are slow
    first, second = np.ascontiguousarray(np.moveaxis(frame, 0, -1))
    scaled_first, scaled_second = along_axes[:, 0] * first, along_axes[:, 1] * second
    tensor = np.empty((len(frame), 3, 3))
    for i in range(3):
        for j in range(3):
            tensor[:, i, j] = scaled_first[i] * first[j] + scaled_second[i] * second[j]
    return tensor


def main_directions(surface: Surface, tensor: Floats) -> Floats:
    """Return the direction of the greatest diffusivity of each triangle, (m, 3) unit vectors.

    Zero where the diffusivity is the same in all directions of the surface. Its sign means nothing.

    Parameters
    ----------
    surface : Surface
        The mesh.
    tensor : (m, 3, 3) float
        Diffusivity of its triangles, in su^2/tu.
    """
    d11, d12, d22 = along_net(surface, tensor)
    difference, twice = d11 - d22, 2.0 * d12
    # diffusivities that are equal differ by rounding
    unlike = np.flatnonzero(np.hypot(difference, twice) >= ISOTROPIC * (d11 + d22))
    angle = 0.5 * np.arctan2(twice[unlike], difference[unlike])
    first, second = surface.frame[unlike, 0], surface.frame[unlike, 1]
    directions = np.zeros((len(tensor), 3))
    directions[unlike] = np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second
    return directions


def along_net(surface: Surface, tensor: Floats) -> tuple[Floats, Floats, Floats]:
    """Return d11, d12 and d22, each (m,), the diffusivity of each triangle in its net's frame.

    Parameters
    ----------
    surface : Surface
        The mesh.
    tensor : (m, 3, 3) float
        Symmetric diffusivity of its triangles, in su^2/tu.
    """
    # columns: sums over rows of three are slow
    frame = np.ascontiguousarray(surface.frame.reshape(-1, 6).T)
    d = np.ascontiguousarray(tensor.reshape(-1, 9).T)
    first, second = frame[:3], frame[3:]
    along_first, along_second = (
        [d[i] * one[0] + d[i + 3] * one[1] + d[i + 6] * one[2] for i in range(3)]
        for one in (first, second)
    )
    d11, d12, d22 = (
        one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
        for one, other in (
            (first, along_first),
            (first, along_second),
            (second, along_second),
        )
    )
    return d11, d12, d22


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


def _along_fibres(
    surface: Surface, patch: Patch, fibres: AnyFibres, chosen: Ints
) -> tuple[Floats, Floats]:
    """Return the unit vectors f, g (k, 2, 3) along and across the fibres, and their factors (k, 2).

    Where fibres have no direction these are the net's, both with the mean of the factors.
    """
    factors = factors_of(patch)
    named = factors if isinstance(factors, dict) else dict.fromkeys((ALONG, ACROSS), factors)
    pair = np.array([named.get(axis, 1.0) for axis in (ALONG, ACROSS)])
    angles = fibres.angles(surface, chosen, f"{patch_key(patch.name)}.fibres")
    known = np.isfinite(angles)
    turn = np.where(known, angles, 0.0)
    cosine, sine = np.cos(turn)[:, None], np.sin(turn)[:, None]
    first, second = surface.frame[chosen, 0], surface.frame[chosen, 1]
    frame = np.stack([cosine * first + sine * second, cosine * second - sine * first], axis=1)
    return frame, np.where(known[:, None], pair, pair.mean())


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
