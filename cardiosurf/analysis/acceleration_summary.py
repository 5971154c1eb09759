"""The measured relative acceleration in numbers: by tissue, and beside the patches' edges."""

from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np
import scipy

from cardiosurf.analysis.measured_acceleration import REACH, MeasuredAcceleration
from cardiosurf.analysis.separations import WINDOW
from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.surface import Surface
from cardiosurf.json_schema import result_schema
from cardiosurf.recording.recording import Recording

SCHEMA: Literal["cardiosurf/acceleration/1"] = "cardiosurf/acceleration/1"
SCAR = -2
"""Stands for it among the numbers of patches, of which -1 is the tissue outside."""
OUTSIDE = "outside patches"
BESIDE = 12.0
"""How far from its edge tissue is beside it, in su: a front's width."""
ERRORS = 2.0
"""Two values agree within so many errors."""


@dataclass(frozen=True)
class Measured:
    """What was measured on some tissue.

    Attributes
    ----------
    name : str
        A patch, ``outside patches``, or ``edge of`` a patch (both sides, 12 su). The first two
        leave out what lies so near to an edge between tissues that the pairs' derivatives reach
        over it.
    vertices : int
        How many there are.
    known : float
        Share of them with a value from pairs.
    rate : float or None
        |n|'/|n|, median, in 1/tu; None where nothing is known.
    relative : float or None
        |n|''/|n| from pairs, median, in 1/tu^2.
    low, high : float or None
        Its 5th and 95th percentile.
    error : float or None
        Its error, median.
    by_lat, by_lat_error : float or None
        The same from derivatives of the LAT, medians.
    agree : float or None
        Share of the vertices with both where they agree within two errors.
    """

    name: str
    vertices: int
    known: float
    rate: float | None
    relative: float | None
    low: float | None
    high: float | None
    error: float | None
    by_lat: float | None
    by_lat_error: float | None
    agree: float | None


@dataclass(frozen=True)
class AccelerationSummary:
    """What ``cardiosurf analyze --acceleration`` prints.

    Attributes
    ----------
    name : str
        The run's name.
    config_sha256 : str
        Hash of its resolved config.
    edge : float
        Mean edge of the mesh, in su.
    window : float or None
        Half the time that the pairs' derivatives are fitted to, in tu; None where nothing ran.
    reach : float
        How far from a vertex pairs count for it, in su.
    areas : tuple of Measured
        What was measured where.
    """

    name: str
    config_sha256: str
    edge: float
    window: float | None
    reach: float
    areas: tuple[Measured, ...]
    schema: Literal["cardiosurf/acceleration/1"] = SCHEMA

    def to_json(self) -> dict[str, Any]:
        """Return the finding as plain JSON data, ``schema`` first."""
        data = asdict(self)
        return {"schema": data.pop("schema"), **data}


def summarise(recording: Recording, found: MeasuredAcceleration) -> AccelerationSummary:
    """Return the numbers of a map by tissue.

    Parameters
    ----------
    recording : Recording
        The run.
    found : MeasuredAcceleration
        Its map.
    """
    surface, tissue = recording.surface, recording.tissue
    excitable = _vertices(surface, tissue.excitable)
    labels = np.where(tissue.excitable, tissue.patch_of, SCAR)
    every = {number: _vertices(surface, labels == number) for number in np.unique(labels)}
    edges = {
        number: np.intersect1d(own, _vertices(surface, labels != number))
        for number, own in every.items()
    }
    apart = _distance(surface.points, np.unique(np.concatenate(list(edges.values()))))
    clear = apart > (WINDOW + REACH) * found.edge
    areas = []
    for number in (-1, *range(len(tissue.names))):
        own = every.get(number)
        if own is None:
            continue
        name = OUTSIDE if number < 0 else tissue.names[number]
        areas.append(_measured(name, own[clear[own]], found))
        if number >= 0 and len(edges[number]):
            beside = excitable[_distance(surface.points, edges[number])[excitable] <= BESIDE]
            areas.append(_measured(f"edge of {name}", beside, found))
    return AccelerationSummary(
        name=recording.name,
        config_sha256=recording.config_sha256,
        edge=found.edge,
        window=found.window if np.isfinite(found.window) else None,
        reach=REACH * found.edge,
        areas=tuple(areas),
    )


def acceleration_schema() -> dict[str, Any]:
    """Return the JSON Schema of the summary; every key is always there, and no other."""
    return result_schema(AccelerationSummary, SCHEMA)


def _vertices(surface: Surface, mask: Mask) -> Ints:
    """Return the vertices of some triangles, in the order of their numbers."""
    return np.unique(surface.triangles[mask])


def _distance(points: Floats, others: Ints) -> Floats:
    """Return the distance of points (n, 3) to the nearest of some of them, (n,), in su."""
    if not len(others):
        return np.full(len(points), np.inf)
    return np.asarray(scipy.spatial.cKDTree(points[others]).query(points)[0])


def _measured(name: str, vertices: Ints, found: MeasuredAcceleration) -> Measured:
    """Return the numbers over some vertices."""
    relative, other = found.relative[vertices], found.by_lat.relative[vertices]
    errors = found.relative_error[vertices], found.by_lat.relative_error[vertices]
    known: Mask = np.isfinite(relative)
    both = known & np.isfinite(other)
    within = np.abs(relative - other) <= ERRORS * np.hypot(*errors)
    quantiles = [_quantile(relative, share) for share in (0.5, 0.05, 0.95)]
    return Measured(
        name=name,
        vertices=len(vertices),
        known=float(known.mean()) if len(vertices) else 0.0,
        rate=_quantile(found.rate[vertices], 0.5),
        relative=quantiles[0],
        low=quantiles[1],
        high=quantiles[2],
        error=_quantile(errors[0], 0.5),
        by_lat=_quantile(other, 0.5),
        by_lat_error=_quantile(errors[1], 0.5),
        agree=float(within[both].mean()) if both.any() else None,
    )


def _quantile(values: Floats, share: float) -> float | None:
    known = values[np.isfinite(values)]
    return float(np.quantile(known, share)) if known.size else None
