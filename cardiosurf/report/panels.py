"""u on the surface at some times, in a row, and the activation map beside them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.patches import PathPatch
from mpl_toolkits.mplot3d.art3d import Line3DCollection

from cardiosurf.analysis.route import edges_of
from cardiosurf.arrays import Floats, Mask
from cardiosurf.errors import InputError
from cardiosurf.recording.recording import Recording
from cardiosurf.report import layers
from cardiosurf.report.canvas import new_figure
from cardiosurf.report.figures import lat_norm
from cardiosurf.report.solid import draw_solid, triangle_colours, viewpoints
from cardiosurf.report.views import View, flat_views

COLOURS = "magma"
"""Of u; LAT has other colours, so that they are not mistaken for each other."""
OUTLINE = "#56b4e9"
ZOOM = 1.45
"""Without axes there is room for more."""
WIDTH, HEIGHT = 3.1, 3.3
"""Of one panel, in inches."""


@dataclass(frozen=True)
class Moments:
    """The times that a figure shows.

    Attributes
    ----------
    times : tuple of float
        In tu.
    names : tuple of str
        What stands above them: the times as the paper prints them.
    """

    times: Sequence[float]
    names: Sequence[str]


def snapshots(
    recording: Recording,
    moments: Moments,
    title: str,
    viewpoint: tuple[float, float] | None = None,
) -> Figure:
    """Return a figure of u at some times beside the activation map.

    Parameters
    ----------
    recording : Recording
        A run with frames.
    moments : Moments
        The times.
    title : str
        What stands on top.
    viewpoint : pair of float, optional
        Elevation and azimuth to look from, in degrees; without it, surfaces of which nothing is
        hidden from above are seen from there, others from their usual side.

    Raises
    ------
    InputError
        The run has no frame at one of the times.
    """
    (flat,) = flat_views(recording.surface)
    if viewpoint is None and not flat.equal:
        viewpoint = viewpoints(recording.surface)[0]
    columns = len(moments.times) + 1
    figure = new_figure(WIDTH * columns + 0.6, HEIGHT, title, None)
    grid = figure.add_gridspec(1, columns)
    u_norm = Normalize(0.0, 1.0)
    drawn: list[Axes] = []
    for column, (time, name) in enumerate(zip(moments.times, moments.names, strict=True)):
        u, seen_at = frame_at(recording, time)
        values = np.where(_excitable_vertices(recording), u, np.nan)
        drawn.append(_draw_u(figure, grid[column], recording, values, viewpoint))
        rest = "" if seen_at >= time - 1e-6 else f" (at rest since {seen_at:.0f})"
        drawn[-1].set_title(f"{name}{rest}", fontsize=9)
    lat_axes = figure.add_subplot(grid[columns - 1])
    norm = lat_norm(recording)
    _draw_lat(lat_axes, flat, recording, norm)
    _bar(figure, u_norm, COLOURS, drawn, "u")
    _bar(figure, norm, layers.COLOURS, [lat_axes], "LAT [tu]")
    return figure


def frame_at(recording: Recording, time: float) -> tuple[Floats, float]:
    """Return u at a time, (n,), and the time of the frame, in tu.

    After a run that ended at rest nothing changes: its last frame stands for all later times.

    Parameters
    ----------
    recording : Recording
        A run with frames.
    time : float
        In tu.

    Raises
    ------
    InputError
        There is no frame within two steps of the time.
    """
    times = recording.frames.times
    if len(times) and time > times[-1] and recording.quiescent_at is not None:
        return np.asarray(recording.frames.u[len(times) - 1], dtype=np.float64), float(times[-1])
    near = int(np.argmin(np.abs(times - time))) if len(times) else -1
    # a frame is taken at the first step at or beyond its time
    if near < 0 or abs(times[near] - time) > 2.0 * float(recording.meta.get("step", 0.0)) + 1e-6:
        raise InputError(
            recording.name, f"has no frame at {time:g} tu", "a run that lasts so long, with frames"
        )
    return np.asarray(recording.frames.u[near], dtype=np.float64), max(float(times[near]), time)


def _excitable_vertices(recording: Recording) -> Mask:
    """Return the vertices of which some triangle is excitable, (n,)."""
    found = np.zeros(recording.node_count, dtype=np.bool_)
    found[recording.surface.triangles[recording.tissue.excitable]] = True
    return found


def _draw_u(
    figure: Figure,
    place: SubplotSpec,
    recording: Recording,
    values: Floats,
    viewpoint: tuple[float, float] | None,
) -> Axes:
    """Draw u with the outlines of the patches, flat or in space."""
    norm = Normalize(0.0, 1.0)
    if viewpoint is not None:
        surface = recording.surface
        colours = triangle_colours(surface, values, norm, viewpoint, COLOURS)
        solid = draw_solid(figure, place, surface, colours, viewpoint)
        solid.set_axis_off()
        solid.set_box_aspect(tuple(np.ptp(surface.points, axis=0)), zoom=ZOOM)
        # what is visible is decided here, not by the middles of lines and triangles
        solid.computed_zorder = False
        for mask in recording.patches.values():
            lines = _visible_outline(recording, mask, viewpoint)
            outline = Line3DCollection(lines, colors=OUTLINE, linewidths=1.3, zorder=2)
            solid.add_collection3d(outline)
        axes: Axes = solid
        return axes
    (flat,) = flat_views(recording.surface)
    flat_axes = figure.add_subplot(place)
    layers.draw_field(flat_axes, flat, values, norm, COLOURS)
    _furnish(flat_axes, flat, recording, OUTLINE)
    return flat_axes


def _draw_lat(axes: Axes, view: View, recording: Recording, norm: Normalize) -> None:
    """Draw the activation map with isochrones, patches, targets and stimuli."""
    layers.draw_field(axes, view, recording.first_activation, norm)
    layers.draw_isochrones(axes, view, recording.first_activation, {})
    _furnish(axes, view, recording, "white")
    layers.draw_stimuli(axes, view, layers.stimulus_profiles(recording))
    axes.set_title("LAT, isochrones", fontsize=9)


def _furnish(axes: Axes, view: View, recording: Recording, colour: str) -> None:
    """Draw border and outlines of the patches; lay the axes out."""
    layers.draw_border(axes, view)
    for mask in recording.patches.values():
        outline = layers.region_outline(view, mask)
        if outline is not None:
            axes.add_patch(PathPatch(outline, facecolor="none", edgecolor=colour, linewidth=1.3))
    axes.set(xlim=view.limits[0], ylim=view.limits[1])
    axes.set_xlabel(view.labels[0], fontsize=7, labelpad=1)
    axes.set_ylabel(view.labels[1], fontsize=7, labelpad=1)
    axes.tick_params(labelsize=6)
    if view.equal:
        axes.set_aspect("equal")
    if view.labels[1].startswith("theta"):
        axes.invert_yaxis()


def _visible_outline(
    recording: Recording, mask: Mask, viewpoint: tuple[float, float]
) -> list[Floats]:
    """Return the edges of a patch, (2, 3) each, that the side turned to the viewer has."""
    surface = recording.surface
    edges, owner = edges_of(surface.triangles, mask, ~mask)
    if not len(edges):
        return []
    elevation, azimuth = np.radians(viewpoint)
    towards = np.array(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ]
    )
    a, b, c = (surface.points[surface.triangles[owner, k]] for k in range(3))
    facing = np.cross(b - a, c - a) @ towards
    # a surface that is open is seen from both sides
    shown = np.ones(len(edges), dtype=np.bool_) if surface.edges else facing > 0.0
    return list(surface.points[edges[shown]])


def _bar(figure: Figure, norm: Normalize, colours: str, axes: list[Axes], label: str) -> None:
    bar = figure.colorbar(ScalarMappable(norm, colours), ax=axes, shrink=0.75, pad=0.02, aspect=25)
    bar.set_label(label, fontsize=8)
    bar.ax.tick_params(labelsize=7)
