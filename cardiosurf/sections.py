"""What every section of a config has in common.

A section is a frozen dataclass whose fields *are* the YAML keys. It lives next to what it builds
and knows nothing of YAML; ``cardiosurf.config`` decodes it.
"""

from typing import Annotated, Any, ClassVar

from annotated_types import Ge, Gt

Positive = Annotated[float, Gt(0)]
NonNegative = Annotated[float, Ge(0)]
Count = Annotated[int, Ge(1)]


class Section:
    """Base of every config section: strict types, no unknown keys, no NaN or infinite numbers."""

    __pydantic_config__: ClassVar[Any] = {
        "extra": "forbid",
        "strict": True,
        "allow_inf_nan": False,
        "validate_default": True,
    }
