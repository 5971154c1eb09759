"""Targets: the regions that a verdict is about."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import MinLen

from cardiosurf.geometry.regions import Region
from cardiosurf.sections import Section

WHOLE_TISSUE = "tissue"
"""Name of the target that stands in where a config has none."""


@dataclass(frozen=True)
class Target(Section):
    """A named region whose activation decides between conduction and block."""

    name: Annotated[str, MinLen(1)]
    region: Region
