"""How a patch is judged without a march: arrival times, and the numbers of each explanation."""

from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.analysis.acceleration_map import (
    AccelerationMap,
    acceleration_map,
    lat_direction,
)
from cardiosurf.analysis.conductor import Conductor
from cardiosurf.analysis.eikonal import arrival
from cardiosurf.analysis.eikonal_curvature import curved_arrival
from cardiosurf.analysis.incidence import Incidence, incidence
from cardiosurf.analysis.prediction import (
    Along,
    Expected,
    Front,
    PatchPrediction,
    acceleration_limit,
)
from cardiosurf.analysis.route import Map
from cardiosurf.analysis.source_sink import curvature_number, flux_ratio, with_curvature
from cardiosurf.analysis.sources import stimulus_sources
from cardiosurf.arrays import Floats, Mask
from cardiosurf.geometry.surface import Surface
from cardiosurf.tissue.stimuli import Pulse
from cardiosurf.tissue.tensor import Tissue

TERMS = ("of_velocity", "of_change", "of_spread", "acceleration")


@dataclass(frozen=True)
class Arrivals:
    """Arrival times (n,) in tu; NaN = never. Scar is a hole to all of them.

    Without the patches, the same with fronts that curvature slows, and with the patches. (Where d
    jumps, what curvature does to a front does not settle with the mesh: docs/theory.md.)
    """

    undisturbed: Floats
    curved: Floats
    as_it_is: Floats


def arrivals(
    surface: Surface, tissue: Tissue, pulses: tuple[Pulse, ...], ambient: float, front: Front
) -> Arrivals:
    """Return when the wave of the stimuli arrives: c0 sqrt(grad T . d grad T) = 1.

    With curvature its speed is c0 sqrt(d) - g d K.

    Parameters
    ----------
    surface, tissue : Surface, Tissue
        The mesh, and what is on it.
    pulses : tuple of Pulse
        The stimuli.
    ambient : float
        Diffusivity outside the patches, in su^2/tu.
    front : Front
        Of the kinetics.

    Raises
    ------
    InputError
        No stimulus starts a front.
    """
    triangles = surface.triangles[tissue.excitable]
    frame = surface.frame[tissue.excitable]
    even = ambient * np.einsum("mai,maj->mij", frame, frame)
    speed, bare = front.speed, Conductor(surface.points, triangles, even)
    sources = stimulus_sources(bare, pulses, speed)
    undisturbed = arrival(bare, sources, speed).times
    curved = curved_arrival(
        bare, sources, speed, factor=front.curvature_factor, straight=undisturbed
    ).times
    patched = Conductor.of(surface, tissue)
    sources = stimulus_sources(patched, pulses, speed)
    return Arrivals(undisturbed, curved, arrival(patched, sources, speed).times)


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
    wave = Map(
        surface.points,
        surface.triangles,
        tissue.tensor,
        tissue.excitable,
        undisturbed,
        lambda: undisturbed,
    )
    round_it = incidence(wave, inside)
    met = round_it.only(round_it.enters)
    direction = lat_direction(surface, undisturbed)
    accelerations = acceleration_map(surface, tissue.tensor, direction, width)
    along = _along(round_it, accelerations, front)
    if not len(met.angle):
        # no wave enters from outside: nothing is known
        return PatchPrediction(name=name, entrance=0.0, along=along)
    terms = _near(surface, accelerations, met, width)
    balance = _Balance.of(met, front)
    ratio, limit = balance.ratio, np.sqrt(front.critical_jump)
    return PatchPrediction(
        name=name,
        entrance=float(met.lengths.sum()),
        first_arrival=float(met.times.min()),
        **_angles(met),
        curvature=met.median(met.curvature),
        **dict(zip(TERMS, terms, strict=True)),
        anisotropy=_greatest(tissue.tensor, inside) / float(balance.before.mean()),
        flux_ratio=_finite(met.median(balance.straight)),
        source_sink=_finite(met.median(ratio)),
        curvature_number=met.median(balance.own),
        blocked_share=float(met.lengths @ (ratio > limit) / met.lengths.sum()),
        by_acceleration=_expected(terms[3], acceleration_limit(width)),
        by_source_sink=_expected(met.median(ratio), limit),
        by_curvature=_expected(met.median(balance.own), 1.0),
        along=along,
    )


@dataclass(frozen=True)
class _Balance:
    """Source and sink at each edge of an entrance, (k,): see ``source_sink``."""

    before: Floats
    straight: Floats
    ratio: Floats
    own: Floats

    @classmethod
    def of(cls, met: Incidence, front: Front) -> "_Balance":
        before = met.before.flux_squared(np.zeros(len(met.angle)))
        straight = flux_ratio(met.before, met.within, np.sin(met.angle) / np.sqrt(before))
        g, speed = front.curvature_factor, front.speed
        number = curvature_number(before, met.curvature, g, speed)
        own = curvature_number(met.heading, met.curvature, g, speed)
        return cls(before, straight, with_curvature(straight, number), own)


def _angles(met: Incidence) -> dict[str, float | None]:
    """Return median and limits of the angle of incidence, in degrees."""
    angles = np.degrees(met.angle)
    least, greatest = float(angles.min()), float(angles.max())
    return {"angle": met.median(angles), "least_angle": least, "greatest_angle": greatest}


def _near(
    surface: Surface, found: AccelerationMap, met: Incidence, width: float
) -> list[float | None]:
    """Return the terms within half a width of the entrance, as roots of mean squares."""
    middles = surface.points[surface.triangles].mean(axis=1)
    away = np.asarray(scipy.spatial.cKDTree(met.points).query(middles)[0])
    near: Mask = (away <= 0.5 * width) & np.isfinite(found.of_velocity)
    areas = surface.areas()[near]
    if not near.any():
        return [None] * 4
    fields = (found.of_velocity, found.of_change, found.of_spread, found.together)
    return [float(np.sqrt(np.average(one[near] ** 2, weights=areas))) for one in fields]


def _greatest(tensor: Floats, inside: Mask) -> float:
    """Return the mean over a patch of the greater diffusivity."""
    return float(np.linalg.eigvalsh(tensor[inside])[:, -1].mean())


def _expected(value: float | None, limit: float | None) -> Expected | None:
    if value is None or limit is None:
        return None
    return "block" if value > limit else "conduction"


def _finite(value: float | None) -> float | None:
    """Return a number that JSON has; infinity is 1e6, beyond every limit."""
    return None if value is None else min(value, 1e6)


def _along(round_it: Incidence, found: AccelerationMap, front: Front) -> Along:
    """Return what the front meets all round a patch; source and sink where it enters."""
    ratio = _Balance.of(round_it.only(round_it.enters), front).ratio
    balance = np.full(len(round_it.angle), np.nan)
    balance[round_it.enters] = np.minimum(ratio, 1e6)
    # smooth over the width, so the mean of both sides stands for the edge
    acceleration = found.together[round_it.triangles].mean(axis=1)

    def rounded(values: Floats, digits: int) -> tuple[float | None, ...]:
        return tuple(
            None if np.isnan(value) else value for value in np.round(values, digits).tolist()
        )

    def numbers(values: Floats, digits: int) -> tuple[float, ...]:
        return tuple(np.round(values, digits).tolist())

    return Along(
        points=tuple(tuple(place) for place in np.round(round_it.points, 3).tolist()),
        enters=tuple(round_it.enters.tolist()),
        arrival=numbers(round_it.times, 3),
        angle=numbers(np.degrees(round_it.angle), 3),
        curvature=numbers(round_it.curvature, 6),
        acceleration=rounded(acceleration, 6),
        source_sink=rounded(balance, 4),
    )
