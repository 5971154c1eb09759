"""Config sections of the tissue: the ambient diffusivity and the patches laid over it."""

from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

from pydantic import Discriminator, Tag

from cardiosurf.errors import InputError
from cardiosurf.geometry.regions import Region
from cardiosurf.sections import LARGEST, SMALLEST, Positive, Section
from cardiosurf.spelling import did_you_mean
from cardiosurf.tissue.fibres import ACROSS, ALONG, Fibres


def _form(value: Any) -> str:
    """Tell a factor for each axis from one number for both."""
    return "(by axis)" if isinstance(value, dict) else "(number)"


Factors: TypeAlias = Annotated[
    Annotated[Positive, Tag("(number)")] | Annotated[dict[str, Positive], Tag("(by axis)")],
    Discriminator(_form),
]


@dataclass(frozen=True)
class Patch(Section):
    """A region of the tissue that differs from the rest.

    Attributes
    ----------
    name : str
        What targets, ``--set`` and the recording call it.
    region : Region
        Where it is; the mesh resolves its edges.
    fibres : fibre rule
        Directions that take the place of the net axes, called ``along`` and ``across``.
    anisotropy : float or dict of str to float
        Factor on the diffusivity along a net axis ({x: 4}, {theta: 8, phi: 8}) or, with fibres,
        {along: 8, across: 1}; one number is both axes, an axis that is not named keeps the
        factor 1.
    frame_scaling : float or dict of str to float
        Factor on the frame itself; its square is the factor on the diffusivity.
    diffusivity : float
        Diffusivity of the patch in su^2/tu, before the factors; the ambient one if not given.
    excitable : bool
        False for a scar: it diffuses, but does not react.
    """

    name: str
    region: Region
    fibres: Fibres | None = None
    anisotropy: Factors | None = None
    frame_scaling: Factors | None = None
    diffusivity: Positive | None = None
    excitable: bool = True


@dataclass(frozen=True)
class TissueSection(Section):
    """The tissue: diffusivity in su^2/tu, and patches in order; where they overlap the later wins.

    Attributes
    ----------
    diffusivity : float
        Diffusivity outside the patches, in su^2/tu.
    patches : tuple of Patch
        Regions that differ, in order.
    """

    diffusivity: Positive = 1.0
    patches: tuple[Patch, ...] = ()


def patch_key(name: str) -> str:
    """Return the name under which a surface resolves the region of patch ``name``."""
    return f"tissue.patches.{name}"


def factors_of(patch: Patch) -> dict[str, float] | float:
    """Return the factors on the diffusivity, by axis or one for both axes.

    Parameters
    ----------
    patch : Patch
        The patch; of ``anisotropy`` and ``frame_scaling`` at most one is given.

    Raises
    ------
    InputError
        If both are given, if no axis is named, if a patch with fibres names others than ``along``
        and ``across`` or no factor at all, or if a factor on the diffusivity is not within 1e-6 to
        1e6.
    """
    where = patch_key(patch.name)
    if patch.anisotropy is not None and patch.frame_scaling is not None:
        raise InputError(
            where,
            "anisotropy and frame_scaling are both given",
            "one of them: anisotropy is the factor on the diffusivity, frame_scaling its root",
            f"keep one; frame_scaling {patch.frame_scaling} is the anisotropy {_squared(patch)}",
        )
    key = "anisotropy" if patch.frame_scaling is None else "frame_scaling"
    given = patch.anisotropy if patch.frame_scaling is None else patch.frame_scaling
    if given is None:
        if patch.fibres is None:
            return 1.0
        raise InputError(
            f"{where}.fibres",
            "fibres are given, but no factor along or across them",
            "fibres together with anisotropy or frame_scaling",
            "add anisotropy: {along: 8}",
        )
    named = given if isinstance(given, dict) else {"": given}
    if not named:
        raise InputError(
            f"{where}.{key}",
            "{} names no axis",
            "a number, or a mapping from an axis to a number",
            f"{key}: {{theta: 8}} on a vein or a sphere, {key}: {{x: 8}} on a plane",
        )
    if patch.fibres is not None and isinstance(given, dict):
        _check_axes_of_fibres(given, f"{where}.{key}")
    for axis, factor in named.items():
        scaled = factor if patch.frame_scaling is None else factor * factor
        _check_factor(factor, scaled, f"{where}.{key}.{axis}".rstrip("."))
    return given if patch.frame_scaling is None else _squared(patch)


def check_diffusivity(section: TissueSection) -> None:
    """Refuse patches whose diffusivity times a factor is beyond 1e-6 to 1e6 su^2/tu.

    Parameters
    ----------
    section : TissueSection
        Ambient diffusivity and patches.

    Raises
    ------
    InputError
        Naming the patch; also what ``factors_of`` raises.
    """
    for patch in section.patches:
        factors = factors_of(patch)
        base = section.diffusivity if patch.diffusivity is None else patch.diffusivity
        for factor in factors.values() if isinstance(factors, dict) else (factors,):
            if not SMALLEST <= base * factor <= LARGEST:
                raise InputError(
                    patch_key(patch.name),
                    f"diffusivity {base:g} times the factor {factor:g} is "
                    f"{base * factor:g} su^2/tu",
                    f"a product from {SMALLEST:g} to {LARGEST:g}",
                    "a smaller factor, or another diffusivity",
                )


def _check_factor(factor: float, scaled: float, where: str) -> None:
    """Refuse a number that makes no tensor; ``scaled`` is the factor on the diffusivity."""
    # written so that NaN is caught too
    if not 0.0 < factor < float("inf"):
        raise InputError(
            where, f"{factor} makes a tensor that is not positive", "a finite number above 0"
        )
    if not SMALLEST <= scaled <= LARGEST:
        raise InputError(
            where,
            f"{factor:g} is a factor of {scaled:g} on the diffusivity",
            f"a factor from {SMALLEST:g} to {LARGEST:g} on the diffusivity",
        )


def _check_axes_of_fibres(given: dict[str, float], where: str) -> None:
    for axis in given:
        if axis not in {ALONG, ACROSS}:
            guess = did_you_mean(axis, (ALONG, ACROSS))
            raise InputError(
                f"{where}.{axis}",
                f"a patch with fibres has no axis {axis!r}" + (f", {guess}" if guess else ""),
                f"{ALONG}, {ACROSS}",
                "" if guess else "leave fibres out to name axes of the net",
            )


def _squared(patch: Patch) -> dict[str, float] | float:
    scaling = patch.frame_scaling
    if isinstance(scaling, dict):
        return {axis: factor**2 for axis, factor in scaling.items()}
    return 1.0 if scaling is None else scaling**2
