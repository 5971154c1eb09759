"""A config carried through to what is predicted of it, without a march."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cardiosurf.analysis.acceleration_map import (
    AccelerationMap,
    acceleration_map,
    lat_direction,
)
from cardiosurf.analysis.patch_prediction import Arrivals, arrivals, patch_prediction
from cardiosurf.analysis.prediction import (
    Front,
    Prediction,
    TargetArrival,
    acceleration_limit,
)
from cardiosurf.arrays import Floats, Mask
from cardiosurf.config import Config, Loaded
from cardiosurf.config.sections import regions_of, target_key
from cardiosurf.geometry.surface import Surface
from cardiosurf.recording.whole_file import made_folder, whole_file
from cardiosurf.study.edges import edge_of
from cardiosurf.study.setup import check_targets
from cardiosurf.study.surface_cache import surface_of
from cardiosurf.tissue.stimuli import Pulse, build_pulses
from cardiosurf.tissue.tensor import Tissue, build_tissue

FILE = "prediction.json"


@dataclass(frozen=True)
class Predicted:
    """A prediction and the maps behind it.

    Attributes
    ----------
    prediction : Prediction
        What it says.
    surface, tissue : Surface, Tissue
        The mesh, and what is on it.
    pulses : tuple of Pulse
        The stimuli.
    arrivals : Arrivals
        Of the wave without the patches, without and with its curvature, and with them.
    acceleration : AccelerationMap or None
        The paper's relative acceleration in the directions of the undisturbed wave; None where no
        patch can be excited.
    """

    prediction: Prediction
    surface: Surface
    tissue: Tissue
    pulses: tuple[Pulse, ...]
    arrivals: Arrivals
    acceleration: AccelerationMap | None


def predict(loaded: Loaded, width: float) -> Predicted:
    """Return arrival times and what is predicted at each patch of a config.

    Parameters
    ----------
    loaded : Loaded
        The config.
    width : float
        Over what patch edges are smoothed for the relative acceleration (10 to 90 %), in su.

    Raises
    ------
    InputError
        The config does not fit its surface, its kinetics carries no wave, no stimulus starts a
        front, or the width is less than two edge lengths or wider than the surface.
    """
    config = loaded.config
    edge = edge_of(config).edge_length
    surface = surface_of(config.geometry, edge, regions_of(config))
    tissue = build_tissue(surface, config.tissue)
    pulses = build_pulses(surface, config.stimulus)
    check_targets(config, surface, tissue)
    front = Front.of(config.kinetics)
    found = arrivals(surface, tissue, pulses, config.tissue.diffusivity, front)
    patches = tuple(
        patch_prediction(surface, tissue, found.undisturbed, name, front, width=width)
        for number, name in enumerate(tissue.names)
        if tissue.excitable[tissue.patch_of == number].any()
    )
    prediction = Prediction(
        name=config.name,
        config_sha256=loaded.sha256,
        edge_length=edge,
        width=width,
        acceleration_limit=acceleration_limit(width),
        front=front,
        last_undisturbed=float(np.nanmax(found.undisturbed)),
        curvature_delay=float(np.nanmedian(found.curved - found.undisturbed)),
        last_arrival=float(np.nanmax(found.as_it_is)),
        targets=_targets(config, surface, found.as_it_is),
        patches=patches,
    )
    direction = lat_direction(surface, found.undisturbed)
    terms = acceleration_map(surface, tissue.tensor, direction, width) if patches else None
    return Predicted(prediction, surface, tissue, pulses, found, terms)


def write_prediction(prediction: Prediction, folder: Path) -> None:
    """Write prediction.json into a folder, which is made if it is not there.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    with whole_file(made_folder(folder) / FILE) as partial:
        partial.write_text(json.dumps(prediction.to_json(), indent=2) + "\n", encoding="utf-8")


def _targets(config: Config, surface: Surface, times: Floats) -> tuple[TargetArrival, ...]:
    """Return the arrival in each target."""

    def limits(inside: Mask) -> tuple[float | None, float | None]:
        own = times[np.unique(surface.triangles[inside])]
        own = own[np.isfinite(own)]
        return (float(own.min()), float(own.max())) if own.size else (None, None)

    return tuple(
        TargetArrival(one.name, *limits(surface.regions[target_key(one.name)]))
        for one in config.targets
    )
