"""The map of a prediction: arrival, isochrones, the patches and how their entrances are met."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch

from cardiosurf.arrays import Floats
from cardiosurf.report import layers
from cardiosurf.report.canvas import INK, new_figure
from cardiosurf.report.views import View, flat_views
from cardiosurf.study.prediction import Predicted


def prediction_map(predicted: Predicted) -> Figure:
    """Return the arrival without the patches, and through the tissue as it is, side by side.

    Parameters
    ----------
    predicted : Predicted
        What ``predict`` returned.
    """
    (view,) = flat_views(predicted.surface)
    times = predicted.arrivals
    last = float(np.nanmax([times.undisturbed, times.as_it_is]))
    norm = Normalize(0.0, max(last, 1.0))
    figure = new_figure(11.6, 6.0, predicted.prediction.name, _caption(predicted))
    panels = figure.subplots(1, 2, squeeze=False)[0]
    fields = (("without the patches", times.undisturbed), ("tissue as it is", times.as_it_is))
    for axes, (title, field) in zip(panels, fields, strict=True):
        _draw(axes, view, predicted, field, norm)
        axes.set_title(f"{title} ({view.title})" if view.title else title, fontsize=9)
    bar = figure.colorbar(
        ScalarMappable(norm, layers.COLOURS), ax=figure.axes, shrink=0.75, aspect=30, pad=0.02
    )
    bar.set_label("eikonal arrival [tu]")
    return figure


def _caption(predicted: Predicted) -> str:
    """Return what the three explanations expect of each patch."""
    return "; ".join(
        f"{one.name}: acceleration {one.by_acceleration}, source-sink {one.by_source_sink}, "
        f"curvature {one.by_curvature}"
        for one in predicted.prediction.patches
        if one.first_arrival is not None
    )


def _draw(axes: Axes, view: View, predicted: Predicted, field: Floats, norm: Normalize) -> None:
    """Draw arrival, patches and stimuli on a view."""
    layers.draw_field(axes, view, field, norm)
    layers.draw_border(axes, view)
    tissue = predicted.tissue
    for number in range(len(tissue.names)):
        outline = layers.region_outline(view, tissue.patch_of == number)
        if outline is not None:
            axes.add_patch(PathPatch(outline, facecolor="none", edgecolor=INK, linewidth=1.4))
    layers.draw_stimuli(axes, view, [pulse.profile for pulse in predicted.pulses])
    layers.draw_isochrones(axes, view, field, {})
    axes.set(xlabel=view.labels[0], ylabel=view.labels[1])
    axes.set_xlim(*view.limits[0])
    axes.set_ylim(*view.limits[1])
    if view.equal:
        axes.set_aspect("equal")
    if view.labels[1].startswith("theta"):
        axes.invert_yaxis()
