"""Angles as people write them: radians, multiples of pi, degrees."""

from typing import Annotated, Any, TypeAlias

from annotated_types import Interval
from pydantic import BeforeValidator, WithJsonSchema

from cardiosurf.expressions import ExpressionError, constant


def parse_angle(text: str) -> float:
    """Return the angle that ``text`` stands for, in radians.

    Parameters
    ----------
    text : str
        ``pi/4``, ``-3*pi/4``, ``45 deg``, or any other expression without names.

    Raises
    ------
    ValueError
        If ``text`` is none of these.

    Examples
    --------
    >>> round(parse_angle("-3*pi/4"), 6), round(parse_angle("45 deg"), 6)
    (-2.356194, 0.785398)
    """
    try:
        return constant(text)
    except ExpressionError as error:
        msg = (
            f"is not an angle ({error.problem}): write radians, a multiple of pi such as -3*pi/4, "
            "or degrees as 45 deg"
        )
        raise ValueError(msg) from None


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
                {"type": "string", "pattern": r"^[-+*/(),.0-9A-Za-z° ]+$", "maxLength": 500},
            ],
            "description": "An angle: radians, a multiple of pi (-3*pi/4) or degrees (45 deg).",
        }
    ),
]
