"""Conduction or block: how much of a target was activated, when, and by which way."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardiosurf.analysis.route import Map, Route, route_into
from cardiosurf.arrays import Floats, Mask

TargetVerdict = Literal["conduction", "block", "partial"]

CONDUCTION_FRACTION = 0.95
BLOCK_FRACTION = 0.05


@dataclass(frozen=True)
class TargetFinding:
    """What happened to one target.

    Attributes
    ----------
    name : str
        The target's name.
    verdict : str
        ``conduction`` (at least 95 % of the area activated), ``block`` (at most 5 %) or
        ``partial``.
    activated_fraction : float
        Activated share of the target's excitable area.
    first_activation, last_activation : float or None
        First and last LAT in the activated part, in tu.
    route : str or None
        ``direct``: the wave came in across at least half of the entrance that the unperturbed
        wave would meet; ``indirect``: mostly by another way; None: not activated.
    direct_fraction : float or None
        The share of the entrance's length that the wave crossed.
    """

    name: str
    verdict: TargetVerdict
    activated_fraction: float
    first_activation: float | None
    last_activation: float | None
    route: Route | None
    direct_fraction: float | None


def judge(fraction: float) -> TargetVerdict:
    """Return the verdict for an activated share of the area."""
    if fraction >= CONDUCTION_FRACTION:
        return "conduction"
    return "block" if fraction <= BLOCK_FRACTION else "partial"


def target_finding(name: str, activation: Map, inside: Mask, areas: Floats) -> TargetFinding:
    """Judge one target.

    A triangle counts as activated when all three of its vertices were: the vertices on the
    target's edge belong to the tissue outside as well and say nothing about the target.

    Parameters
    ----------
    name : str
        The target's name.
    activation : Map
        The activation map.
    inside : (m,) bool
        The target's excitable triangles, at least one.
    areas : (m,) float
        Areas of all triangles, in su^2.
    """
    lat = activation.lat[activation.triangles[inside]]
    activated = np.isfinite(lat).all(axis=1)
    fraction = float(areas[inside][activated].sum() / areas[inside].sum())
    if not activated.any():
        return TargetFinding(name, judge(fraction), fraction, None, None, None, None)
    way = route_into(activation, inside)
    return TargetFinding(
        name,
        judge(fraction),
        fraction,
        float(lat[activated].min()),
        float(lat[activated].max()),
        way.route,
        way.direct_fraction,
    )
