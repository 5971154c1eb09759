"""How a patch is judged without a march: arrival times, and the numbers of each explanation."""

from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.analysis.acceleration_map import acceleration_map, lat_direction
from cardiosurf.analysis.conductor import Conductor
from cardiosurf.analysis.eikonal import arrival
from cardiosurf.analysis.incidence import Incidence, incidence
from cardiosurf.analysis.prediction import (
    ACCELERATION_LIMIT,
    Along,
    Expected,
    Front,
    PatchPrediction,
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
    wave = Map(
        surface.points,
        surface.triangles,
        tissue.tensor,
        tissue.excitable,
        undisturbed,
        lambda: undisturbed,
    )
    met = incidence(wave, inside)
    if not len(met.angle):
        # no wave enters from outside: nothing is known
        return PatchPrediction(name=name, entrance=0.0, along=Along((), (), (), (), ()))
    terms = _acceleration(surface, tissue.tensor, undisturbed, met, width)
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
        by_acceleration=_expected(terms[3], ACCELERATION_LIMIT),
        by_source_sink=_expected(met.median(ratio), limit),
        by_curvature=_expected(met.median(balance.own), 1.0),
        along=_along(met, ratio),
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


def _acceleration(
    surface: Surface, tensor: Floats, times: Floats, met: Incidence, width: float
) -> list[float | None]:
    """Return the terms within half a width of the entrance, as roots of mean squares."""
    found = acceleration_map(surface, tensor, lat_direction(surface, times), width)
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
