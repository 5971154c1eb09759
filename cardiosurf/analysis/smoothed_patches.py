"""Anisotropy on a net whose patches have soft edges of a stated width, with its derivatives.

The paper's formulas differentiate the anisotropy, which a patch changes in a jump. Here a patch is
a range of the net coordinates, and its anisotropy rises over ``width`` across each edge: from 10
to 90 % of the jump, as a front's width is counted.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cardiosurf.arrays import Floats
from cardiosurf.geometry.jets import Jet, constant, coordinates, logistic
from cardiosurf.geometry.nets import Net, RevolvedNet

TEN_TO_NINETY = 2.0 * np.log(9.0)
"""The logistic function 1 / (1 + exp(-x)) rises from 0.1 to 0.9 over this length."""

Limits = tuple[float, float] | None


@dataclass(frozen=True)
class SmoothedPatch:
    """A range of net coordinates with factors on the diffusivity along the net's axes.

    Attributes
    ----------
    first, second : pair of float or None
        Range of x^1 and of x^2; None is no limit. Angles may run past pi.
    factors : pair of float
        The factors s_1, s_2 inside; outside they are 1.
    width : float
        Distance over which they rise from 10 to 90 %, in su.
    """

    first: Limits
    second: Limits
    factors: tuple[float, float]
    width: float

    def share(self, net: Net, places: Floats) -> Jet:
        """Return how far inside the places are: 0 outside, 1 inside, 1/2 on an edge.

        The product over the edges of 1 / (1 + exp(-2 ln 9 h_k (x^k - edge) / width)).

        Parameters
        ----------
        net : Net
            The net.
        places : (n, 2) float
            Net coordinates, off the poles.
        """
        share = constant(1.0, len(places))
        pairs = zip(coordinates(places), net.metric(places), strict=True)
        for axis, (coordinate, metric) in enumerate(pairs):
            limits = (self.first, self.second)[axis]
            if limits is None:
                continue
            past = coordinate - 0.5 * (limits[0] + limits[1])
            if _goes_round(net, axis):
                turns = np.round(past.value / (2.0 * np.pi))
                past = Jet(past.value - 2.0 * np.pi * turns, past.first, past.second)
            steep = metric.power(0.5) * (TEN_TO_NINETY / self.width)
            half = 0.5 * (limits[1] - limits[0])
            share = share * logistic(steep * (past + half)) * logistic(steep * (half - past))
        return share


def smoothed_factors(net: Net, places: Floats, patches: Sequence[SmoothedPatch]) -> tuple[Jet, Jet]:
    """Return the factors s_1, s_2 along the net's axes; where patches overlap the later one wins.

    Parameters
    ----------
    net : Net
        The net.
    places : (n, 2) float
        Net coordinates, off the poles.
    patches : sequence of SmoothedPatch
        The patches, in order.
    """
    along = [constant(1.0, len(places)), constant(1.0, len(places))]
    for patch in patches:
        share = patch.share(net, places)
        along = [s + share * (factor - s) for s, factor in zip(along, patch.factors, strict=True)]
    return along[0], along[1]


def _goes_round(net: Net, axis: int) -> bool:
    """Tell whether a coordinate is an angle that comes back after 2 pi."""
    return isinstance(net, RevolvedNet) and (axis == 1 or net.profile.closed)
