"""Fibre rules: in which direction of the surface the fibres of a patch run.

A rule gives the angle alpha from the first net vector e1 to the fibre f, in the surface:
f = cos(alpha) e1 + sin(alpha) e2, and g = -sin(alpha) e1 + cos(alpha) e2 across it.
"""

from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated, Any, TypeAlias

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Tag, WithJsonSchema

from cardiosurf.arrays import Floats, Ints
from cardiosurf.errors import InputError
from cardiosurf.expressions import FUNCTIONS, ExpressionError, evaluate, names_in, parse, pointed
from cardiosurf.geometry.angles import Angle
from cardiosurf.geometry.regions import Vector
from cardiosurf.geometry.surface import Surface
from cardiosurf.sections import Section, Worded, word_of
from cardiosurf.spelling import did_you_mean

ALONG, ACROSS = "along", "across"
"""The axes that factors are given for, where a patch has fibres."""

SPACE = ("x", "y", "z")
_MEANING = (
    "an angle in radians, of numbers, pi, x, y, z, the net's axes, + - * / ** ( ) and "
    f"{', '.join(FUNCTIONS)}"
)


def _expression(value: Any) -> Any:
    """Check the spelling of an expression; a plain number is one too."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return repr(value)
    if isinstance(value, str):
        try:
            parse(value)
        except ExpressionError as error:
            msg = f"is not an expression: {error}"
            raise ValueError(msg) from None
    return value


AngleExpression: TypeAlias = Annotated[
    str,
    BeforeValidator(_expression),
    Field(description=_MEANING),
    WithJsonSchema(
        {
            "anyOf": [{"type": "number"}, {"type": "string", "minLength": 1, "maxLength": 500}],
            "description": _MEANING,
        }
    ),
]


@dataclass(frozen=True)
class Winding(Section):
    """Circles about a point, or spirals into it.

    Attributes
    ----------
    centre : (3,) float
        The point, in su; on the surface or off it.
    pitch : float
        Angle in radians by which the fibres wind inward as they go round counter-clockwise (seen
        against the net's normal e1 x e2): 0 for circles, pi/2 for rays.
    """

    centre: Vector
    pitch: Angle = 0.0


@dataclass(frozen=True)
class Circles(Section):
    """Fibres along circles about a point, chiral with a pitch.

    f = cos(pitch) n x r - sin(pitch) r, where r is the direction of x - centre in the surface and
    n the surface's normal. A triangle that reaches to the centre, or to a place straight above or
    below it, holds circles of every direction: both directions get the mean of the two factors.

    Attributes
    ----------
    circles : Winding
        Centre and pitch.
    """

    circles: Winding

    def angles(self, surface: Surface, chosen: Ints, where: str) -> Floats:
        """Return the angles from e1 to the fibres on the triangles ``chosen``; NaN for none."""
        corners = surface.points[surface.triangles[chosen]]
        middle = corners.mean(axis=1)
        outward = np.einsum(
            "tad,td->ta", surface.frame[chosen], middle - np.asarray(self.circles.centre)
        )
        reach = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
        unclear = np.hypot(*outward.T) <= reach
        if unclear.all():
            raise InputError(
                f"{where}.circles.centre",
                f"no place of the patch lies to the side of {list(self.circles.centre)}: circles "
                "about it have no direction",
                "a point that is not straight above or below all of the patch",
                "a point of the surface",
            )
        angles = np.arctan2(outward[:, 1], outward[:, 0]) + (0.5 * np.pi + self.circles.pitch)
        return np.where(unclear, np.nan, angles)


@dataclass(frozen=True)
class AngleField(Section):
    """Fibres at an angle to the first net axis.

    Attributes
    ----------
    angle : str
        The angle in radians, from the first towards the second net axis: an expression of x, y, z
        and the net's coordinates (theta, phi), taken at the middle of each triangle.
    """

    angle: AngleExpression

    def angles(self, surface: Surface, chosen: Ints, where: str) -> Floats:
        """Return the angles from e1 to the fibres on the triangles ``chosen``."""
        middle = surface.points[surface.triangles[chosen]].mean(axis=1)
        result = np.empty(len(chosen))
        for part in np.unique(surface.part_of[chosen]):
            inside = np.flatnonzero(surface.part_of[chosen] == part)
            axes = surface.axes[part]
            check_names(self.angle, axes, f"{where}.angle", f"the part {surface.parts[part]!r}")
            values = dict(zip(SPACE, middle[inside].T, strict=True))
            # on flat parts an axis is a coordinate of space
            values |= dict(zip(axes, surface.net[chosen[inside]].T, strict=True))
            try:
                result[inside] = evaluate(parse(self.angle), values, len(inside))
            except ExpressionError as error:
                raise _not_finite(error, middle[inside], f"{where}.angle") from None
        return result


AnyFibres: TypeAlias = Circles | AngleField

FIBRES: MappingProxyType[str, type[AnyFibres]] = MappingProxyType(
    {"circles": Circles, "angle": AngleField}
)
"""Every fibre rule, by the word that it is written with."""

Fibres: TypeAlias = Annotated[
    Annotated[Circles, Tag("(circles)")] | Annotated[AngleField, Tag("(angle)")],
    Discriminator(word_of),
    Worded("a fibre rule", "{circles: {centre: [0, 0, 0]}}"),
]


def check_names(text: str, axes: tuple[str, ...], where: str, what: str) -> None:
    """Refuse an expression with names that are no coordinates.

    Parameters
    ----------
    text : str
        An expression.
    axes : tuple of str
        Names of the net axes there are.
    where : str
        Key path for the message.
    what : str
        What has these axes, for the message.

    Raises
    ------
    InputError
        Naming the first of them.
    """
    known = tuple(dict.fromkeys((*SPACE, *axes)))
    for name in names_in(parse(text).root):
        if name.name not in known:
            guess = did_you_mean(name.name, known)
            raise InputError(
                where,
                f"{what} has no coordinate {name.name!r}"
                + (f", {guess}" if guess else "")
                + f"\n{pointed(text, name.at)}",
                f"{', '.join(known)}; and pi",
            )


def _not_finite(error: ExpressionError, places: Floats, where: str) -> InputError:
    spot = ", ".join(f"{c:.6g}" for c in places[error.place or 0])
    return InputError(
        where,
        f"{error.problem}, at (x, y, z) = ({spot})\n{pointed(error.text, error.at)}",
        "an angle that is finite on the whole patch",
        "atan2(y, x) is finite everywhere, unlike y/x" if " / " in error.problem else "",
    )
