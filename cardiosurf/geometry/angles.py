"""Angles as people write them: radians, multiples of pi, degrees."""

import math
import re
from typing import Annotated, Any, TypeAlias

from annotated_types import Interval
from pydantic import BeforeValidator, WithJsonSchema

_NUMBER = r"\d+(?:\.\d*)?|\.\d+"
_MULTIPLE_OF_PI = re.compile(
    rf"(?P<sign>[-+]?)\s*(?:(?P<factor>{_NUMBER})\s*\*\s*)?pi"
    rf"(?:\s*\*\s*(?P<times>{_NUMBER}))?(?:\s*/\s*(?P<over>{_NUMBER}))?"
)
_DEGREES = re.compile(rf"(?P<value>[-+]?(?:{_NUMBER}))\s*(?:deg|degrees|°)")


def parse_angle(text: str) -> float:
    """Return the angle that ``text`` stands for, in radians.

    Parameters
    ----------
    text : str
        ``pi/4``, ``-3*pi/4``, ``pi``, ``3*pi/4`` or ``45 deg``.

    Raises
    ------
    ValueError
        If ``text`` is none of these.

    Examples
    --------
    >>> round(parse_angle("-3*pi/4"), 6), round(parse_angle("45 deg"), 6)
    (-2.356194, 0.785398)
    """
    stripped = text.strip()
    degrees = _DEGREES.fullmatch(stripped)
    if degrees:
        return math.radians(float(degrees["value"]))
    multiple = _MULTIPLE_OF_PI.fullmatch(stripped)
    if multiple and float(multiple["over"] or 1) != 0:
        size = float(multiple["factor"] or 1) * float(multiple["times"] or 1)
        angle = size * math.pi / float(multiple["over"] or 1)
        return -angle if multiple["sign"] == "-" else angle
    msg = "is not an angle: write radians, a multiple of pi such as -3*pi/4, or degrees as 45 deg"
    raise ValueError(msg)


def _radians(value: Any) -> Any:
    return parse_angle(value) if isinstance(value, str) else value


Angle: TypeAlias = Annotated[
    float,
    Interval(ge=-100.0, le=100.0),
    BeforeValidator(_radians),
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "number"},
                {
                    "type": "string",
                    "pattern": r"^\s*([-+0-9.* ]*pi[*/0-9. ]*|[-+0-9.]+ *(deg|degrees|°))\s*$",
                },
            ],
            "description": "An angle: radians, a multiple of pi (-3*pi/4) or degrees (45 deg).",
        }
    ),
]
