"""What is predicted of a wave without marching it: arrival, and block at the patches.

Three explanations are held side by side, each a number for a patch and a limit for it:

- the paper's: the relative acceleration along the front, of_velocity + of_change (v = dv/dlambda =
  1 and dv/dn = 0, as in its Case II), root of the mean square over the entrance;
- source and sink: the flux needed against the flux available (``source_sink``), median over the
  entrance, against what a straight front of the kinetics just passes (``critical_jump``);
- curvature: g sqrt(d) K/c0 with the patch's d, median over the entrance; a front stands still at 1.
"""

from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np
import scipy

from cardiosurf.analysis.acceleration_map import acceleration_map, lat_direction
from cardiosurf.analysis.conductor import Conductor
from cardiosurf.analysis.critical_jump import critical_jump
from cardiosurf.analysis.eikonal import arrival
from cardiosurf.analysis.incidence import Incidence, incidence
from cardiosurf.analysis.planar_speed import curvature_factor, planar_speed
from cardiosurf.analysis.route import Map
from cardiosurf.analysis.source_sink import curvature_number, flux_ratio, with_curvature
from cardiosurf.analysis.sources import stimulus_sources
from cardiosurf.arrays import Floats, Mask
from cardiosurf.errors import InputError
from cardiosurf.geometry.surface import Surface
from cardiosurf.kinetics import AnyKinetics
from cardiosurf.tissue.stimuli import Pulse
from cardiosurf.tissue.tensor import Tissue

SCHEMA: Literal["cardiosurf/prediction/1"] = "cardiosurf/prediction/1"
WIDTH = 12.0
"""Over what a patch's edge is smoothed for the relative acceleration, in su: a front's width."""
ACCELERATION_LIMIT = 0.0479
"""Fitted on the plane alone (problem 1, published: 8 conducts, 10 does not): half way between the
values at 8 and at 10, 0.0456 and 0.0502 at edges of 1.5 and this width."""

Expected = Literal["block", "conduction"]


@dataclass(frozen=True)
class Front:
    """What a kinetics model says of its fronts.

    Attributes
    ----------
    speed : float
        c0 at d = 1, in su/tu.
    curvature_factor : float
        g of c = c0 - g d K.
    critical_jump : float
        Greatest d2/d1 that a straight front passes.
    """

    speed: float
    curvature_factor: float
    critical_jump: float

    @classmethod
    def of(cls, kinetics: AnyKinetics) -> "Front":
        """Return the front of a kinetics model.

        Raises
        ------
        InputError
            The model carries no wave.
        """
        speed = planar_speed(kinetics)
        if not speed > 0.0:
            raise InputError(
                "kinetics",
                "carries no wave, so nothing arrives and nothing is blocked",
                "a model and constants whose straight front propagates",
            )
        return cls(speed, curvature_factor(kinetics), critical_jump(kinetics))


@dataclass(frozen=True)
class Along:
    """The entrance edge by edge; angle in degrees, arrival in tu, curvature in 1/su."""

    points: tuple[tuple[float, ...], ...]
    arrival: tuple[float, ...]
    angle: tuple[float, ...]
    curvature: tuple[float, ...]
    source_sink: tuple[float | None, ...]


@dataclass(frozen=True)
class PatchPrediction:
    """What is predicted at a patch; None where the undisturbed wave does not enter it.

    Attributes
    ----------
    name : str
        The patch's name.
    entrance : float
        Length of its entrance, in su.
    first_arrival : float or None
        Of the undisturbed wave, in tu.
    angle, least_angle, greatest_angle : float or None
        Of incidence: median and limits, in degrees.
    curvature : float or None
        Of the undisturbed front at the entrance, median, in 1/su.
    of_velocity, of_change, of_spread : float or None
        Terms of the relative acceleration near the entrance (root of the mean square).
    acceleration : float or None
        Of of_velocity + of_change, likewise.
    anisotropy : float or None
        Greatest diffusivity in the patch over that outside.
    flux_ratio : float or None
        Flux needed over flux available, straight fronts; median.
    source_sink : float or None
        The same with the curvature of the front; median.
    curvature_number : float or None
        g sqrt(d) K/c0 with the patch's d; median.
    blocked_share : float or None
        Share of the entrance whose source-sink ratio is above the critical one.
    by_acceleration, by_source_sink, by_curvature : str or None
        What each explanation expects.
    along : Along
        The entrance edge by edge.
    """

    name: str
    entrance: float
    first_arrival: float | None
    angle: float | None
    least_angle: float | None
    greatest_angle: float | None
    curvature: float | None
    of_velocity: float | None
    of_change: float | None
    of_spread: float | None
    acceleration: float | None
    anisotropy: float | None
    flux_ratio: float | None
    source_sink: float | None
    curvature_number: float | None
    blocked_share: float | None
    by_acceleration: Expected | None
    by_source_sink: Expected | None
    by_curvature: Expected | None
    along: Along


@dataclass(frozen=True)
class TargetArrival:
    """When the eikonal wave is in a target, in tu: through the tissue as it is, nothing blocked."""

    name: str
    first: float | None
    last: float | None


@dataclass(frozen=True)
class Prediction:
    """All that is predicted of a config, as it stands in prediction.json."""

    name: str
    config_sha256: str
    edge_length: float
    width: float
    front: Front
    last_undisturbed: float
    last_arrival: float
    targets: tuple[TargetArrival, ...]
    patches: tuple[PatchPrediction, ...]
    acceleration_limit: float = ACCELERATION_LIMIT
    schema: Literal["cardiosurf/prediction/1"] = SCHEMA

    def to_json(self) -> dict[str, Any]:
        """Return the finding as plain JSON data, ``schema`` first."""
        data = asdict(self)
        return {"schema": data.pop("schema"), **data}


@dataclass(frozen=True)
class Arrivals:
    """Arrival times (n,) in tu; NaN = never, without the patches, and with them.

    Scar is a hole to both.
    """

    undisturbed: Floats
    as_it_is: Floats


def arrivals(
    surface: Surface, tissue: Tissue, pulses: tuple[Pulse, ...], ambient: float, speed: float
) -> Arrivals:
    """Return when the wave of the stimuli arrives: c0 sqrt(grad T . d grad T) = 1.

    Parameters
    ----------
    surface, tissue : Surface, Tissue
        The mesh, and what is on it.
    pulses : tuple of Pulse
        The stimuli.
    ambient : float
        Diffusivity outside the patches, in su^2/tu.
    speed : float
        c0, in su/tu.

    Raises
    ------
    InputError
        No stimulus starts a front.
    """
    triangles = surface.triangles[tissue.excitable]
    frame = surface.frame[tissue.excitable]
    even = ambient * np.einsum("mai,maj->mij", frame, frame)
    times = []
    for conductor in (
        Conductor(surface.points, triangles, even),
        Conductor.of(surface, tissue),
    ):
        sources = stimulus_sources(conductor, pulses, speed)
        times.append(arrival(conductor, sources, speed).times)
    return Arrivals(*times)


def patch_prediction(
    surface: Surface, tissue: Tissue, undisturbed: Floats, name: str, front: Front, *, width: float
) -> PatchPrediction:
    """Return what is predicted at a patch.

    Parameters
    ----------
    surface, tissue : Surface, Tissue
        The mesh, and what is on it.
    undisturbed : (n,) float
        Arrival without the patches, in tu.
    name : str
        The patch; excitable tissue.
    front : Front
        Of the kinetics.
    width : float
        Over what its edge is smoothed for the relative acceleration, in su.

    Raises
    ------
    InputError
        The width is less than two edge lengths.
    """
    inside = tissue.patch_of == tissue.names.index(name)
    tensor, excitable = tissue.tensor, tissue.excitable
    points, triangles = surface.points, surface.triangles
    met = incidence(Map(points, triangles, tensor, excitable, undisturbed, undisturbed), inside)
    before = met.before.flux_squared(np.zeros(len(met.angle)))
    number = curvature_number(before, met.curvature, front.curvature_factor, front.speed)
    straight = flux_ratio(met.before, met.within, np.sin(met.angle) / np.sqrt(before))
    ratio = with_curvature(straight, number)
    own = curvature_number(met.heading, met.curvature, front.curvature_factor, front.speed)
    terms = _acceleration(surface, tensor, undisturbed, met, width)
    limit = np.sqrt(front.critical_jump)
    angles = np.degrees(met.angle)
    blocked = float(met.lengths @ (ratio > limit) / met.lengths.sum()) if len(ratio) else None
    curved = met.median(own)
    outside = float(before.mean()) if len(before) else np.nan
    return PatchPrediction(
        name=name,
        entrance=float(met.lengths.sum()),
        first_arrival=float(met.times.min()) if len(angles) else None,
        angle=met.median(angles),
        least_angle=float(angles.min()) if len(angles) else None,
        greatest_angle=float(angles.max()) if len(angles) else None,
        curvature=met.median(met.curvature),
        of_velocity=terms[0],
        of_change=terms[1],
        of_spread=terms[2],
        acceleration=terms[3],
        anisotropy=_greatest(tensor, inside) / outside if len(before) else None,
        flux_ratio=_finite(met.median(straight)),
        source_sink=_finite(met.median(ratio)),
        curvature_number=curved,
        blocked_share=blocked,
        by_acceleration=_expected(terms[3], ACCELERATION_LIMIT),
        by_source_sink=_expected(met.median(ratio), limit),
        by_curvature=_expected(curved, 1.0),
        along=_along(met, ratio),
    )


def _acceleration(
    surface: Surface, tensor: Floats, times: Floats, met: Incidence, width: float
) -> list[float | None]:
    """Return the terms within half a width of the entrance, as roots of mean squares."""
    found = acceleration_map(surface, tensor, lat_direction(surface, times), width)
    if not len(met.points):
        return [None] * 4
    middles = surface.points[surface.triangles].mean(axis=1)
    away = np.asarray(scipy.spatial.cKDTree(met.points).query(middles)[0])
    near: Mask = (away <= 0.5 * width) & np.isfinite(found.of_velocity)
    areas = surface.areas()[near]
    if not near.any():
        return [None] * 4
    both = found.of_velocity + found.of_change
    fields = (found.of_velocity, found.of_change, found.of_spread, both)
    return [float(np.sqrt(np.average(one[near] ** 2, weights=areas))) for one in fields]


def _greatest(tensor: Floats, inside: Mask) -> float:
    """Return the mean over a patch of the greater diffusivity."""
    return float(np.linalg.eigvalsh(tensor[inside])[:, -1].mean())


def _expected(value: float | None, limit: float) -> Expected | None:
    return None if value is None else "block" if value > limit else "conduction"


def _finite(value: float | None) -> float | None:
    """Return a number that JSON has; infinity is 1e6, beyond every limit."""
    return None if value is None else min(value, 1e6)


def _along(met: Incidence, ratio: Floats) -> Along:
    def rounded(values: Floats, digits: int) -> tuple[float, ...]:
        return tuple(np.round(values, digits).tolist())

    return Along(
        points=tuple(tuple(place) for place in np.round(met.points, 3).tolist()),
        arrival=rounded(met.times, 3),
        angle=rounded(np.degrees(met.angle), 3),
        curvature=rounded(met.curvature, 6),
        source_sink=rounded(np.minimum(ratio, 1e6), 4),
    )


def prediction_schema() -> dict[str, Any]:
    """Return the JSON Schema of prediction.json; every key is always there, and no other."""
    from pydantic import TypeAdapter  # noqa: PLC0415 - of those who predict only `schema` needs it

    schema = TypeAdapter(Prediction).json_schema(mode="serialization")
    for part in (schema, *schema["$defs"].values()):
        part["required"] = sorted(part["properties"])
        part["additionalProperties"] = False
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": SCHEMA, **schema}
