"""The maps of a prediction: arrival, isochrones, relative acceleration, and how patches are met."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch

from cardiosurf.analysis.acceleration_map import AccelerationMap
from cardiosurf.arrays import Floats
from cardiosurf.geometry.export import write_fields
from cardiosurf.recording.whole_file import whole_file
from cardiosurf.report import layers
from cardiosurf.report.canvas import INK, new_figure
from cardiosurf.report.views import View, flat_views
from cardiosurf.study.prediction import Predicted

SIGNED = "RdBu_r"
MOST = 0.98
"""Share of the relative accelerations that the colours tell apart."""


def prediction_map(predicted: Predicted) -> Figure:
    """Return arrival without the patches and with them, and the relative acceleration.

    Parameters
    ----------
    predicted : Predicted
        What ``predict`` returned.
    """
    (view,) = flat_views(predicted.surface)
    times, terms = predicted.arrivals, predicted.acceleration
    last = float(np.nanmax([times.undisturbed, times.as_it_is]))
    norm = Normalize(0.0, max(last, 1.0))
    count = 2 if terms is None else 3
    figure = new_figure(5.8 * count, 6.0, predicted.prediction.name, _caption(predicted))
    panels = list(figure.subplots(1, count, squeeze=False)[0])
    fields = (("without the patches", times.undisturbed), ("tissue as it is", times.as_it_is))
    for axes, (title, field) in zip(panels[:2], fields, strict=True):
        layers.draw_field(axes, view, field, norm)
        _furnish(axes, view, predicted, field)
        axes.set_title(f"{title} ({view.title})" if view.title else title, fontsize=9)
    _bar(figure, panels[:2], ScalarMappable(norm, layers.COLOURS), "eikonal arrival [tu]")
    if terms is not None:
        _draw_terms(figure, panels[2], view, predicted, terms)
    return figure


def write_maps(predicted: Predicted, path: Path) -> None:
    """Write arrivals and the terms of the relative acceleration as VTU.

    Parameters
    ----------
    predicted : Predicted
        What ``predict`` returned.
    path : Path
        The file; its folder must exist.

    Raises
    ------
    InputError
        The folder cannot be written to, or the disk is full.
    """
    times, terms = predicted.arrivals, predicted.acceleration
    fields = {
        "arrival without patches [tu]": times.undisturbed,
        "arrival without patches, with curvature [tu]": times.curved,
        "arrival [tu]": times.as_it_is,
    }
    cells: dict[str, Floats] = {"patch": predicted.tissue.patch_of.astype(np.float64)}
    if terms is not None:
        cells |= {
            "of_velocity [1 per su^2]": terms.of_velocity,
            "of_change [1 per su]": terms.of_change,
            "of_spread [1 per su]": terms.of_spread,
            "angle from the first net axis [rad]": terms.angle,
        }
    with whole_file(path) as partial:
        write_fields(predicted.surface, partial, fields, cells)


def _caption(predicted: Predicted) -> str:
    """Return what the three explanations expect of each patch."""
    return "; ".join(
        f"{one.name}: acceleration {one.by_acceleration or 'not known'}, "
        f"source-sink {one.by_source_sink}, curvature {one.by_curvature}"
        for one in predicted.prediction.patches
        if one.first_arrival is not None
    )


def _draw_terms(
    figure: Figure, axes: Axes, view: View, predicted: Predicted, terms: AccelerationMap
) -> None:
    """Draw the relative acceleration in the directions of the undisturbed wave."""
    field = _at_vertices(predicted, terms.together)
    known = np.abs(field[np.isfinite(field)])
    most = max(float(np.quantile(known, MOST)), 1e-9) if known.size else 1.0
    norm = Normalize(-most, most)
    layers.draw_field(axes, view, field, norm, SIGNED)
    _furnish(axes, view, predicted, predicted.arrivals.undisturbed)
    axes.set_title("relative acceleration of the undisturbed front (Case II)", fontsize=9)
    label = f"of_velocity + of_change, over {terms.width:g} su [1/su², 1/su]"
    _bar(figure, [axes], ScalarMappable(norm, SIGNED), label)


def _at_vertices(predicted: Predicted, values: Floats) -> Floats:
    """Return means over the triangles of each vertex that have a value, (n,)."""
    corners, count = predicted.surface.triangles, len(predicted.surface.points)
    known = np.isfinite(values)
    owners = corners[known].ravel()
    total = np.bincount(owners, np.repeat(values[known], 3), count)
    number = np.bincount(owners, minlength=count)
    return np.where(number > 0, total / np.maximum(number, 1), np.nan)


def _bar(figure: Figure, axes: list[Axes], shown: ScalarMappable, label: str) -> None:
    bar = figure.colorbar(shown, ax=axes, shrink=0.75, aspect=30, pad=0.02)
    bar.set_label(label)


def _furnish(axes: Axes, view: View, predicted: Predicted, times: Floats) -> None:
    """Draw patches, stimuli, isochrones and the axes of a view."""
    layers.draw_border(axes, view)
    tissue = predicted.tissue
    for number in range(len(tissue.names)):
        outline = layers.region_outline(view, tissue.patch_of == number)
        if outline is not None:
            axes.add_patch(PathPatch(outline, facecolor="none", edgecolor=INK, linewidth=1.4))
    layers.draw_stimuli(axes, view, [pulse.profile for pulse in predicted.pulses])
    layers.draw_isochrones(axes, view, times, {})
    axes.set(xlabel=view.labels[0], ylabel=view.labels[1])
    axes.set_xlim(*view.limits[0])
    axes.set_ylim(*view.limits[1])
    if view.equal:
        axes.set_aspect("equal")
    if view.labels[1].startswith("theta"):
        axes.invert_yaxis()
