"""What every section of a config has in common.

A section is a frozen dataclass whose fields *are* the YAML keys. It lives next to what it builds
and knows nothing of YAML; ``cardiosurf.config`` decodes it.
"""

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from annotated_types import Ge, Interval

# far beyond any tissue, and far from where squares and products leave double precision
SMALLEST, LARGEST = 1e-6, 1e6
Positive = Annotated[float, Interval(ge=SMALLEST, le=LARGEST)]
NonNegative = Annotated[float, Interval(ge=0.0, le=LARGEST)]
Coordinate = Annotated[float, Interval(ge=-LARGEST, le=LARGEST)]
# values and currents that are set from outside, and how long a run may take
Amplitude = Annotated[float, Interval(ge=SMALLEST, le=10.0)]
Strength = Annotated[float, Interval(ge=SMALLEST, le=1e3)]
Span = Annotated[float, Interval(ge=SMALLEST, le=1e7)]
Instant = Annotated[float, Interval(ge=0.0, le=1e7)]
Count = Annotated[int, Ge(1)]


@dataclass(frozen=True)
class Worded:
    """Marks a section that is written with one of several words, ``{box: ...}``; for messages.

    Attributes
    ----------
    what : str
        What the word stands for: "a region".
    example : str
        One as it is written.
    joined : bool
        Whether several of them can be joined with ``all`` and ``any``.
    """

    what: str
    example: str
    joined: bool = False


def word_of(value: Any) -> str | None:
    """Return the tag of the one word that a section is written with."""
    if isinstance(value, dict) and len(value) == 1:
        return f"({next(iter(value))})"
    return None


class Section:
    """Base of every config section: strict types, no unknown keys, no NaN or infinite numbers."""

    __pydantic_config__: ClassVar[Any] = {
        "extra": "forbid",
        "strict": True,
        "allow_inf_nan": False,
        "validate_default": True,
    }
