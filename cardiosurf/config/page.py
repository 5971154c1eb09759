"""What a scenario has for the reproduction page: the paper's figures, critical values to find."""

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, TypeAlias

from annotated_types import Interval, MinLen

from cardiosurf.config.sections import Name
from cardiosurf.sections import Instant, Positive, Section

Bound: TypeAlias = Annotated[float, Interval(ge=-1e9, le=1e9)]
_TICKS = 1000
"""Of a tu: times of figures are told apart to a thousandth."""


@dataclass(frozen=True, kw_only=True)
class Figure(Section):
    """A figure of the paper that shows u at some times, and what is seen in ours.

    Attributes
    ----------
    label : str
        How the paper calls it.
    times : tuple of float
        The times it shows, as printed.
    unit : float
        How many tu a unit of the printed times is; 10 in section 6.
    view : pair of float
        Elevation and azimuth to look from, in degrees; without it, planes and T-domains are seen
        from above, closed surfaces from their usual side.
    shown : str
        What the paper says that it shows.
    seen : str
        What is seen in ours, in a sentence: someone has looked at it.
    """

    label: Name
    times: Annotated[tuple[Instant, ...], MinLen(1)]
    unit: Positive = 1.0
    view: tuple[Bound, Bound] | None = None
    shown: str = ""
    seen: str = ""

    @property
    def moments(self) -> tuple[float, ...]:
        """The times in tu."""
        return tuple(time * self.unit for time in self.times)

    @property
    def every(self) -> float:
        """The longest time between frames that has one at each of the times, in tu."""
        ticks = [round(time * _TICKS) for time in self.moments]
        return float(Fraction(max(math.gcd(*ticks), 1), _TICKS))


@dataclass(frozen=True, kw_only=True)
class Search(Section):
    """A critical value that is looked for in some of the cases.

    Attributes
    ----------
    name : str
        What it is called; searches of one name, in whatever scenario, are shown together.
    title : str
        Its heading on the page.
    cases : tuple of str
        The cases that begin with; what is varied replaces their own value.
    vary : str
        The number that is varied, as in ``cardiosurf threshold --vary``.
    between : pair of float
        Where to look for it.
    tolerance : float
        Half width of a bracket; 1/400 of the interval without it.
    edges : tuple of float
        Edge lengths of the meshes, in su; without it, 1.41, 1 and 0.71 times the case's.
    of : str
        What is asked of each run.
    against : str
        The number of each case that the critical values are drawn against, by its key path.
    axis : str
        What that is, with its unit.
    entrance : str
        The patch before which the front is measured, in each of the cases as it stands.
    """

    name: Name
    title: str = ""
    cases: Annotated[tuple[str, ...], MinLen(1)]
    vary: str
    between: tuple[Bound, Bound]
    tolerance: Positive | None = None
    edges: tuple[Positive, ...] = ()
    of: str = "conduction"
    against: str | None = None
    axis: str = ""
    entrance: str | None = None
