"""The measured relative acceleration as a picture and as fields for ParaView."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize, SymLogNorm
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch

from cardiosurf.analysis.acceleration_map import FEWEST_EDGES, recorded_acceleration
from cardiosurf.analysis.measured_acceleration import MeasuredAcceleration
from cardiosurf.analysis.prediction import WIDTH
from cardiosurf.arrays import Floats
from cardiosurf.geometry.export import write_fields
from cardiosurf.recording.recording import Recording
from cardiosurf.recording.whole_file import whole_file
from cardiosurf.report import layers
from cardiosurf.report.canvas import INK, new_figure
from cardiosurf.report.views import View, flat_views

SIGNED, ERRORS = "RdBu_r", "magma_r"
DOTS_PER_INCH = 110
"""Three panels side by side are wide enough."""
DECADES = 100.0
"""Smaller values than so many times less than the greatest are not told apart by their colours."""
MOST = 0.98
"""Share of the values that the colours tell apart; the rest have the last colour."""


def acceleration_map(recording: Recording, found: MeasuredAcceleration) -> Figure:
    """Return the map from pairs, its error, and the map from the LAT, side by side.

    Parameters
    ----------
    recording : Recording
        The run.
    found : MeasuredAcceleration
        Its relative acceleration.
    """
    (view,) = flat_views(recording.surface)
    signed = _signed_norm(found)
    window = f"derivatives over +-{found.window:.0f} tu; " if np.isfinite(found.window) else ""
    caption = (
        f"{window}grey: not measured, or with an error beyond the"
        " colours; lines: LAT [tu] and patches"
    )
    figure = new_figure(
        15.6,
        5.2 if view.equal else 5.8,
        f"{recording.name}: relative acceleration |n|''/|n|",
        caption,
    )
    panels = figure.subplots(1, 3, squeeze=False)[0]
    pairs = _certain(found.relative, found.relative_error, signed)
    by_lat = _certain(found.by_lat.relative, found.by_lat.relative_error, signed)
    fields: tuple[tuple[str, Floats, Normalize, str], ...] = (
        ("from pairs of trajectories", pairs, signed, SIGNED),
        ("its error", found.relative_error, _error_norm(found), ERRORS),
        ("from derivatives of the LAT", by_lat, signed, SIGNED),
    )
    for axes, (title, field, norm, colours) in zip(panels, fields, strict=True):
        _draw(axes, view, recording, field, norm, colours)
        axes.set_title(title, fontsize=9)
        bar = figure.colorbar(
            ScalarMappable(norm, colours), ax=axes, shrink=0.8, aspect=28, pad=0.02, extend="both"
        )
        bar.set_label("[1/tu²]", fontsize=8)
        bar.ax.tick_params(labelsize=7)
    return figure


def write_acceleration(recording: Recording, found: MeasuredAcceleration, path: Path) -> None:
    """Write all fields of the map as VTU, and the terms of the paper's equation beside them.

    Parameters
    ----------
    recording : Recording
        The run.
    found : MeasuredAcceleration
        Its relative acceleration.
    path : Path
        The file; its folder must exist.

    Raises
    ------
    InputError
        The folder cannot be written to, or the disk is full.
    """
    fields = {
        "LAT [tu]": recording.first_activation,
        "rate [1 per tu]": found.rate,
        "rate error [1 per tu]": found.rate_error,
        "relative acceleration [1 per tu^2]": found.relative,
        "relative acceleration error [1 per tu^2]": found.relative_error,
        "rate from LAT [1 per tu]": found.by_lat.rate,
        "rate from LAT error [1 per tu]": found.by_lat.rate_error,
        "relative acceleration from LAT [1 per tu^2]": found.by_lat.relative,
        "relative acceleration from LAT error [1 per tu^2]": found.by_lat.relative_error,
    }
    cells = {"patch": recording.tissue.patch_of.astype(np.float64), **_terms(recording, found)}
    with whole_file(path) as partial:
        write_fields(recording.surface, partial, fields, cells)


def _terms(recording: Recording, found: MeasuredAcceleration) -> dict[str, Floats]:
    """Return the paper's terms in the directions of the run's first wave, (m,) each."""
    # edges differ, and smoothing asks for two of the mean of its own
    width = max(WIDTH, 1.1 * FEWEST_EDGES * found.edge)
    terms = recorded_acceleration(recording, width)
    return {
        f"of_velocity over {width:.3g} su [1 per su^2]": terms.of_velocity,
        f"of_change over {width:.3g} su [1 per su]": terms.of_change,
        f"of_spread over {width:.3g} su [1 per su]": terms.of_spread,
    }


def _signed_norm(found: MeasuredAcceleration) -> SymLogNorm:
    """Return colours that are linear within the usual error and logarithmic beyond it."""
    most = _quantile(np.abs(found.relative), MOST)
    noise = _quantile(found.relative_error, 0.5)
    linear = min(max(noise, most / DECADES), 0.5 * most)
    return SymLogNorm(linthresh=linear, vmin=-most, vmax=most, base=10)


def _error_norm(found: MeasuredAcceleration) -> LogNorm:
    most = _quantile(found.relative_error, MOST)
    return LogNorm(max(_quantile(found.relative_error, 1.0 - MOST), most / DECADES**2), most)


def _certain(values: Floats, errors: Floats, norm: SymLogNorm) -> Floats:
    """Return values (n,), NaN where the error is greater than all that the colours show."""
    with np.errstate(invalid="ignore"):
        return np.where(errors <= float(norm.vmax or 0.0), values, np.nan)


def _quantile(values: Floats, share: float) -> float:
    known = values[np.isfinite(values)]
    # where nothing is bent all is rounding
    return max(float(np.quantile(known, share)), 1e-12) if known.size else 1e-12


def _draw(
    axes: Axes, view: View, recording: Recording, field: Floats, norm: Normalize, colours: str
) -> None:
    """Draw a field with isochrones, patches and stimuli."""
    layers.draw_field(axes, view, field, norm, colours)
    layers.draw_border(axes, view)
    for mask in recording.patches.values():
        outline = layers.region_outline(view, mask)
        if outline is not None:
            axes.add_patch(PathPatch(outline, facecolor="none", edgecolor=INK, linewidth=1.4))
    layers.draw_stimuli(axes, view, layers.stimulus_profiles(recording))
    layers.draw_isochrones(axes, view, recording.first_activation, {})
    axes.set(xlabel=view.labels[0], ylabel=view.labels[1])
    axes.set_xlim(*view.limits[0])
    axes.set_ylim(*view.limits[1])
    if view.equal:
        axes.set_aspect("equal")
    if view.labels[1].startswith("theta"):
        axes.invert_yaxis()
