"""The figures of a recording: activation maps, the unrolled vein, probe traces."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, Normalize
from matplotlib.figure import Figure

from cardiosurf.analysis.rotation import ReentryAnalysis
from cardiosurf.arrays import Floats
from cardiosurf.errors import InputError
from cardiosurf.recording.recording import THRESHOLD, Recording
from cardiosurf.report import layers
from cardiosurf.report.canvas import FORMATS, INK, new_figure, save
from cardiosurf.report.reentry_map import reentry_map
from cardiosurf.report.solid import draw_solid, triangle_colours, viewpoints
from cardiosurf.report.strokes import draw_strokes
from cardiosurf.report.views import View, flat_views, has_vein, unrolled_vein

AGAIN = 0.01
"""Share of the nodes that must be activated twice for a map of the counts to say anything."""


def activation_map(recording: Recording, *, caption: str | None = None) -> Figure:
    """Return the map of first activation with isochrones, flat and in space.

    Parameters
    ----------
    recording : Recording
        The run.
    caption : str, optional
        A line below the run's name, usually the verdict.
    """
    surface = recording.surface
    norm = lat_norm(recording)
    flat, solid = flat_views(surface), viewpoints(surface)
    columns = len(flat) + len(solid)
    width = 7.4 if columns == 1 else 6.4 + 5.0 * len(solid)
    figure = new_figure(width, 6.4, recording.name, caption)
    grid = figure.add_gridspec(1, columns, width_ratios=[1.15] * len(flat) + [1.0] * len(solid))
    legend: list[Artist] = []
    for column, view in enumerate(flat):
        legend += _draw_map(figure.add_subplot(grid[column]), view, recording, norm)
    for column, viewpoint in enumerate(solid, start=len(flat)):
        colours = triangle_colours(surface, recording.first_activation, norm, viewpoint)
        draw_solid(figure, grid[column], surface, colours, viewpoint)
    _finish(figure, norm, "LAT, first activation [tu]", legend)
    return figure


def vein_unrolled(recording: Recording, *, caption: str | None = None) -> Figure:
    """Return the map of first activation on the vein, unrolled.

    Parameters
    ----------
    recording : Recording
        The run.
    caption : str, optional
        A line below the run's name, usually the verdict.

    Raises
    ------
    InputError
        The surface has no vein.
    """
    if not has_vein(recording.surface):
        raise InputError(recording.name, "has no vein to unroll", "a surface with a part vein")
    norm = lat_norm(recording)
    figure = new_figure(8.4, 5.2, recording.name, caption)
    legend = _draw_map(figure.add_subplot(), unrolled_vein(recording.surface), recording, norm)
    _finish(figure, norm, "LAT, first activation [tu]", legend)
    return figure


def activation_count(recording: Recording, *, caption: str | None = None) -> Figure:
    """Return the map of how often each place was activated.

    Parameters
    ----------
    recording : Recording
        The run.
    caption : str, optional
        A line below the run's name, usually the verdict.
    """
    count = recording.activation_count.astype(np.float64)
    most = max(2, int(count.max()))
    norm = BoundaryNorm(np.arange(0.5, most + 1), 256) if most <= 12 else Normalize(1, most)
    figure = new_figure(7.4, 6.4, recording.name, caption)
    (view,) = flat_views(recording.surface)
    axes = figure.add_subplot()
    grey = layers.draw_counts(axes, view, np.where(count > 0, count, np.nan), norm)
    legend = _furnish(axes, view, recording, {})
    _finish(figure, norm, "number of activations", legend + _never(drawn=grey))
    return figure


def probe_traces(recording: Recording, *, caption: str | None = None) -> Figure:
    """Return u (thick) and v (thin) at the probes over time.

    Parameters
    ----------
    recording : Recording
        The run.
    caption : str, optional
        A line below the run's name, usually the verdict.

    Raises
    ------
    InputError
        The run has no probes.
    """
    probes = recording.probes
    if not probes.names:
        raise InputError(recording.name, "has no probes", "a run whose config has record.probes")
    rows = len(probes.names)
    figure = new_figure(8.4, 1.2 + 1.5 * rows, recording.name, caption)
    every = figure.subplots(rows, 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    for number, (axes, name) in enumerate(zip(every, probes.names, strict=True)):
        axes.axhline(THRESHOLD, color=INK, linewidth=0.5, linestyle=":")
        axes.plot(probes.times, probes.u[:, number], color="#0072b2", linewidth=1.6, label="u")
        axes.plot(probes.times, probes.v[:, number], color="#d55e00", linewidth=0.8, label="v")
        place = ", ".join(f"{coordinate:.4g}" for coordinate in probes.positions[number])
        axes.set_title(f"{name} at ({place}) su", fontsize=9, loc="left")
        axes.set_ylabel("u, v [1]")
        axes.margins(x=0.01)
    every[0].legend(loc="upper right", fontsize=8, ncols=2)
    every[-1].set_xlabel("t [tu]")
    return figure


def plot_all(
    recording: Recording,
    folder: Path,
    formats: Sequence[str] = FORMATS,
    *,
    caption: str | None = None,
    reentry: ReentryAnalysis | None = None,
) -> tuple[Path, ...]:
    """Write every figure that the recording gives rise to.

    Parameters
    ----------
    recording : Recording
        The run.
    folder : Path
        Where to write; made if it is not there.
    formats : sequence of str
        "png", "svg", or another that matplotlib knows.
    caption : str, optional
        A line below the run's name, usually the verdict.
    reentry : ReentryAnalysis, optional
        With it, and if a wave came back, a map of one cycle is drawn too.

    Returns
    -------
    tuple of Path
        activation_map, vein_unrolled (with a vein), activation_count (where 1 % of the nodes or
        more were activated twice), reentry_map, probe_traces (with probes), each in every format.

    Raises
    ------
    InputError
        The folder cannot be written to, or the disk is full.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            str(folder), f"cannot be made: {error.strerror}", hint="give another folder with -o"
        ) from error
    written: list[Path] = []
    for name, maker in _makers(recording, caption, reentry).items():
        written += save(maker(), folder / name, formats)
    return tuple(written)


def _makers(
    recording: Recording, caption: str | None, reentry: ReentryAnalysis | None
) -> dict[str, Callable[[], Figure]]:
    """Return what draws each figure that makes sense, by the figure's name."""
    makers: dict[str, Callable[[], Figure]] = {
        "activation_map": lambda: activation_map(recording, caption=caption)
    }
    if has_vein(recording.surface):
        makers["vein_unrolled"] = lambda: vein_unrolled(recording, caption=caption)
    # the tissue under a stimulus may be activated twice: by it, and by the wave it starts
    if np.mean(recording.activation_count > 1) > AGAIN:
        makers["activation_count"] = lambda: activation_count(recording, caption=caption)
    if reentry is not None and reentry.cycle_length.median is not None:
        makers["reentry_map"] = lambda: reentry_map(recording, reentry, caption=caption)
    if recording.probes.names:
        makers["probe_traces"] = lambda: probe_traces(recording, caption=caption)
    return makers


def lat_norm(recording: Recording) -> Normalize:
    """Return the range of colours: from the first to the last LAT on the whole surface."""
    lat: Floats = recording.first_activation
    if not np.isfinite(lat).any():
        return Normalize(0.0, 1.0)
    low, high = float(np.nanmin(lat)), float(np.nanmax(lat))
    return Normalize(low, max(high, low + 1.0))


def _draw_map(axes: Axes, view: View, recording: Recording, norm: Normalize) -> list[Artist]:
    """Draw first activation on a view; return what belongs into the legend."""
    grey = layers.draw_field(axes, view, recording.first_activation, norm)
    spots: layers.Spots = {}
    legend = _furnish(axes, view, recording, spots)
    layers.draw_isochrones(axes, view, recording.first_activation, spots)
    return legend + _never(drawn=grey)


def _furnish(axes: Axes, view: View, recording: Recording, spots: layers.Spots) -> list[Artist]:
    """Draw border, fibres, patches, targets, stimuli, axes; return what belongs into the legend."""
    layers.draw_border(axes, view)
    legend = draw_strokes(axes, view, recording)
    legend += layers.draw_patches(axes, view, recording, spots)
    legend += layers.draw_targets(axes, view, recording, spots)
    legend += layers.draw_stimuli(axes, view, layers.stimulus_profiles(recording))
    axes.set(xlabel=view.labels[0], ylabel=view.labels[1])
    axes.set_title(view.title, fontsize=9)
    room = 0.02 * np.ptp(view.limits, axis=1) * (1.0 if view.equal else 0.0)
    axes.set_xlim(view.limits[0, 0] - room[0], view.limits[0, 1] + room[0])
    axes.set_ylim(view.limits[1, 0] - room[1], view.limits[1, 1] + room[1])
    if view.equal:
        axes.set_aspect("equal")
    else:
        axes.set_xticks(np.arange(-180.0, 181.0, 45.0))
    if view.labels[1].startswith("theta"):
        axes.invert_yaxis()
    return legend


def _never(*, drawn: bool) -> list[Artist]:
    return [layers.never_swatch()] if drawn else []


def _finish(figure: Figure, norm: Normalize, label: str, legend: list[Artist]) -> None:
    """Add colour bar and legend."""
    bar = figure.colorbar(
        ScalarMappable(norm, layers.COLOURS), ax=figure.axes, shrink=0.75, aspect=30, pad=0.02
    )
    bar.set_label(label)
    if isinstance(norm, BoundaryNorm):
        bar.set_ticks((norm.boundaries[:-1] + 0.5).tolist())
    if legend:
        figure.legend(handles=legend, loc="outside lower center", ncols=4, fontsize=8)
