"""What is predicted of a wave without marching it: arrival, and block at the patches.

Three explanations are held side by side, each a number for a patch and a limit for it:

- the paper's: the relative acceleration along the front, of_velocity + of_change (v = dv/dlambda =
  1 and dv/dn = 0, as in its Case II), root of the mean square over the entrance;
- source and sink: the flux needed against the flux available (``source_sink``), median over the
  entrance, against what a straight front of the kinetics just passes (``critical_jump``);
- curvature: g sqrt(d) K/c0 with the patch's d, median over the entrance; a front stands still at 1.
"""

import math
from dataclasses import asdict, dataclass
from typing import Any, Literal

from cardiosurf.analysis.critical_jump import critical_jump
from cardiosurf.analysis.planar_speed import curvature_factor, planar_speed
from cardiosurf.errors import InputError
from cardiosurf.json_schema import result_schema
from cardiosurf.kinetics import AnyKinetics

SCHEMA: Literal["cardiosurf/prediction/1"] = "cardiosurf/prediction/1"
WIDTH = 12.0
"""Over what a patch's edge is smoothed for the relative acceleration, in su: a front's width."""
ACCELERATION_LIMIT = 0.0479
"""Fitted on the plane alone (problem 1, published: 8 conducts, 10 does not): half way between the
values at 8 and at 10, 0.0456 and 0.0502 at edges of 1.5 and this width."""

COARSE = 2.0
"""Edges above this, in su, put the relative acceleration too low by more than 4 % (9, 21, 13 %
at 3, 4, 5: problem 1), where its values at anisotropy 8 and 10 lie 10 % apart."""

Expected = Literal["block", "conduction"]


def acceleration_limit(width: float) -> float | None:
    """Return the relative acceleration beyond which the paper expects block, in 1/su.

    The terms go with 1/width and 1/width^2, so the limit that was fitted is one for its own width
    and for no other.

    Parameters
    ----------
    width : float
        Over what patch edges are smoothed, in su.
    """
    return ACCELERATION_LIMIT if math.isclose(width, WIDTH) else None


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
    """The edges all round a patch that the undisturbed front meets.

    Arrival in tu; angle of incidence in degrees from the inward normal, above 90 where the front
    comes out; curvature in 1/su; acceleration as in ``PatchPrediction``, with its sign; source and
    sink where the front enters.
    """

    points: tuple[tuple[float, ...], ...]
    enters: tuple[bool, ...]
    arrival: tuple[float, ...]
    angle: tuple[float, ...]
    curvature: tuple[float, ...]
    acceleration: tuple[float | None, ...]
    source_sink: tuple[float | None, ...]


@dataclass(frozen=True, kw_only=True)
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
        What each explanation expects; the first at the width that its limit was fitted at only.
    along : Along
        Edge by edge, all round it.
    """

    name: str
    entrance: float
    first_arrival: float | None = None
    angle: float | None = None
    least_angle: float | None = None
    greatest_angle: float | None = None
    curvature: float | None = None
    of_velocity: float | None = None
    of_change: float | None = None
    of_spread: float | None = None
    acceleration: float | None = None
    anisotropy: float | None = None
    flux_ratio: float | None = None
    source_sink: float | None = None
    curvature_number: float | None = None
    blocked_share: float | None = None
    by_acceleration: Expected | None = None
    by_source_sink: Expected | None = None
    by_curvature: Expected | None = None
    along: Along


@dataclass(frozen=True)
class TargetArrival:
    """When the eikonal wave is in a target, in tu: through the tissue as it is, nothing blocked."""

    name: str
    first: float | None
    last: float | None


@dataclass(frozen=True)
class Prediction:
    """All that is predicted of a config, as it stands in prediction.json.

    Last arrivals are those without the patches, the same with fronts that curvature slows, and
    through the tissue as it is. The limit of the relative acceleration is None at other widths than
    that it was fitted at.
    """

    name: str
    config_sha256: str
    edge_length: float
    width: float
    front: Front
    last_undisturbed: float
    curvature_delay: float
    last_arrival: float
    targets: tuple[TargetArrival, ...]
    patches: tuple[PatchPrediction, ...]
    acceleration_limit: float | None
    schema: Literal["cardiosurf/prediction/1"] = SCHEMA

    def to_json(self) -> dict[str, Any]:
        """Return the finding as plain JSON data, ``schema`` first."""
        data = asdict(self)
        return {"schema": data.pop("schema"), **data}


def prediction_schema() -> dict[str, Any]:
    """Return the JSON Schema of prediction.json; every key is always there, and no other."""
    return result_schema(Prediction, SCHEMA)
