"""The picture of a reentrant wave: one cycle of it, the circuit it runs round, the rotors' tips."""

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch as Swatch
from matplotlib.tri import Triangulation

from cardiosurf.analysis.circuit import Circuit
from cardiosurf.analysis.neighbours import Lists
from cardiosurf.analysis.rotation import ReentryAnalysis
from cardiosurf.analysis.tracks import Track
from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.surface import Surface
from cardiosurf.recording.recording import Events, Recording
from cardiosurf.report import layers
from cardiosurf.report.canvas import INK, NEVER, new_figure
from cardiosurf.report.views import View, flat_views

CIRCUIT = "#d55e00"
TIPS = {1: "#ffffff", -1: "#f0e442"}
"""Colour of the tips by the sense of their rotation."""
SENSES = {1: "counterclockwise", -1: "clockwise"}
LATE = 1.15
"""Tissue activated within so many cycles of its end belongs to a cycle: they differ in length."""
ARROWS = 4
ISOCHRONES = 10


def one_cycle(recording: Recording, cycle: float, until: float) -> Floats:
    """Return when each vertex was activated in one cycle, (n,), in tu since it began.

    NaN where it was not.

    Parameters
    ----------
    recording : Recording
        The run.
    cycle : float
        Its length, in tu.
    until : float
        When it ended, in tu.
    """
    every = recording.activations
    before = every.times <= until
    last = Events(every.nodes[before], every.times[before]).last(recording.node_count)
    since = last - (until - cycle)
    return np.where(since > (1.0 - LATE) * cycle, np.clip(since, 0.0, cycle), np.nan)


def shown_until(recording: Recording, analysis: ReentryAnalysis) -> float:
    """Return the end of the cycle that is shown, in tu: when the circuit closed, else the last."""
    if analysis.circuit is not None:
        return float(analysis.circuit.times[-1])
    return float(np.nanmax(recording.last_activation))


def reentry_map(
    recording: Recording, analysis: ReentryAnalysis, *, caption: str | None = None
) -> Figure:
    """Return the map of one cycle, with the circuit and the tips of the rotors.

    Parameters
    ----------
    recording : Recording
        The run.
    analysis : ReentryAnalysis
        What was found in it; it must have a cycle length.
    caption : str, optional
        A line below the run's name, usually the verdict.

    Raises
    ------
    ValueError
        Nothing came back, so there is no cycle.
    """
    cycle = analysis.cycle_length.median
    if cycle is None:
        raise ValueError("a map of a cycle needs reentry")
    until = shown_until(recording, analysis)
    norm = Normalize(0.0, cycle)
    views = flat_views(recording.surface)
    figure = new_figure(7.4 * len(views), 6.8, recording.name, caption)
    legend: dict[str, Artist] = {}
    for axes, view in zip(figure.subplots(1, len(views), squeeze=False)[0], views, strict=True):
        drawn = _draw_cycle(axes, view, one_cycle(recording, cycle, until), norm)
        if analysis.circuit is not None:
            drawn += _draw_circuit(axes, view, recording.surface, analysis.circuit)
        for rotor in analysis.rotors:
            shown = (rotor.times > until - cycle) & (rotor.times <= until)
            drawn += _draw_tip(axes, view, recording.surface, rotor, shown)
        drawn += layers.draw_patches(axes, view, recording, {})
        legend |= {str(artist.get_label()): artist for artist in drawn}
        _frame(axes, view)
    bar = figure.colorbar(
        ScalarMappable(norm, layers.COLOURS), ax=figure.axes, shrink=0.75, aspect=30, pad=0.02
    )
    bar.set_label(f"activation in the {cycle:.0f} tu up to t = {until:.0f} tu [tu]")
    handles = list(legend.values())
    figure.legend(handles=handles, loc="outside lower center", ncols=3, fontsize=8)
    return figure


def _draw_cycle(axes: Axes, view: View, times: Floats, norm: Normalize) -> list[Artist]:
    """Colour the cycle, with isochrones, and the front where its end meets its beginning."""
    whole = layers.draw_never(axes, view, times)
    values = np.nan_to_num(times[view.vertex_of])
    jump = np.ptp(values[view.triangles], axis=1) > 0.5 * float(norm.vmax or 1.0)
    smooth = whole & ~jump
    swatches: list[Artist] = []
    if smooth.any():
        mesh = Triangulation(view.points[:, 0], view.points[:, 1], view.triangles, ~smooth)
        axes.tripcolor(
            mesh, values, shading="gouraud", cmap=layers.COLOURS, norm=norm, rasterized=True
        )
        levels = np.linspace(0.0, float(norm.vmax or 1.0), ISOCHRONES + 1)[1:-1]
        axes.tricontour(mesh, values, levels=levels, colors=INK, linewidths=0.5)
    front = np.flatnonzero(whole & jump)
    if front.size:
        mesh = Triangulation(view.points[:, 0], view.points[:, 1], view.triangles[front])
        axes.tripcolor(mesh, np.zeros(len(view.points)), cmap="gray", vmin=0, vmax=1)
        swatches.append(Swatch(facecolor="black", label="the front at the end of it"))
    if not whole.all():
        swatches.append(Swatch(facecolor=NEVER, label="not activated in this cycle"))
    return swatches


def _draw_circuit(axes: Axes, view: View, surface: Surface, circuit: Circuit) -> list[Artist]:
    """Draw the pieces of the circuit, each in its triangle, and arrows along it."""
    ends = [
        _in_view(view, surface, circuit.triangles, points)
        for points in (circuit.points[:-1], circuit.points[1:])
    ]
    pieces = np.stack((ends[0][0], ends[1][0]), axis=1)
    if not len(pieces):
        return []
    for colour, width in (("white", 4.5), (CIRCUIT, 2.5)):
        axes.add_collection(LineCollection(list(pieces), colors=colour, linewidths=width))
    long = np.flatnonzero(np.linalg.norm(pieces[:, 1] - pieces[:, 0], axis=1) > 0.0)
    for number in long[np.linspace(0, len(long), ARROWS, endpoint=False).astype(int)]:
        tail, head = pieces[number]
        style = {"arrowstyle": "-|>", "color": CIRCUIT, "mutation_scale": 18, "linewidth": 0}
        axes.annotate("", tuple(head), tuple(tail), arrowprops=style)
    label = f"circuit: {circuit.length:.0f} su in {circuit.period:.0f} tu"
    return [Line2D([], [], color=CIRCUIT, linewidth=2.5, label=label)]


def _draw_tip(axes: Axes, view: View, surface: Surface, rotor: Track, shown: Mask) -> list[Artist]:
    """Draw where a rotor's tip was at some of the times of its track, (k,) bool."""
    if not shown.any():
        return []
    places, _ = _in_view(view, surface, rotor.triangles[shown], rotor.points[shown])
    tips, entry = axes.plot(*places.T)[0], Line2D([], [])
    for line in (tips, entry):
        line.set(marker="o", markersize=3.0, linestyle="none", markeredgewidth=0.5)
        line.set(color=TIPS[rotor.chirality], markeredgecolor=INK)
    entry.set_label(f"tip of a rotor, {SENSES[rotor.chirality]}")
    return [entry]


def _in_view(view: View, surface: Surface, triangles: Ints, points: Floats) -> tuple[Floats, Ints]:
    """Return where points (k, 3) of some triangles (k,) are drawn, and which point each is.

    A triangle on the cut of an unrolled map is drawn at both its ends.
    """
    order = np.argsort(view.triangle_of, kind="stable")
    rows, owner = Lists.of(view.triangle_of[order], order, len(surface.triangles)).at(triangles)
    a, b, c = (surface.points[surface.triangles[triangles[owner], k]] for k in range(3))
    place, normal = points[owner], np.cross(b - a, c - a)
    parts = [np.cross(c - b, place - b), np.cross(a - c, place - c), np.cross(b - a, place - a)]
    squared = np.einsum("kd,kd->k", normal, normal)
    weights = np.stack([np.einsum("kd,kd->k", part, normal) / squared for part in parts], axis=1)
    corners = view.points[view.triangles[rows]]
    return np.einsum("ki,kid->kd", weights, corners), owner


def _frame(axes: Axes, view: View) -> None:
    layers.draw_border(axes, view)
    axes.set(xlabel=view.labels[0], ylabel=view.labels[1])
    axes.set_title(view.title, fontsize=9)
    room = 0.02 * np.ptp(view.limits, axis=1) * (1.0 if view.equal else 0.0)
    axes.set_xlim(view.limits[0, 0] - room[0], view.limits[0, 1] + room[0])
    axes.set_ylim(view.limits[1, 0] - room[1], view.limits[1, 1] + room[1])
    if view.equal:
        axes.set_aspect("equal")
    if view.labels[1].startswith("theta"):
        axes.invert_yaxis()
