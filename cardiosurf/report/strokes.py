"""Short strokes along the fibres, drawn over a map."""

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D

from cardiosurf.arrays import Floats, Ints
from cardiosurf.recording.recording import Recording
from cardiosurf.report.canvas import INK
from cardiosurf.report.views import View
from cardiosurf.tissue.tensor import main_directions

ACROSS_A_VIEW = 32
"""How many strokes find room beside each other."""
LENGTH = 0.7
"""Of a stroke, in parts of the room that it has."""


def draw_strokes(axes: Axes, view: View, recording: Recording) -> list[Artist]:
    """Draw strokes along the direction of the greatest diffusivity, where there is one.

    Returns
    -------
    list of Artist
        What the legend says about them.
    """
    fibres = main_directions(recording.surface, recording.tissue.tensor)[view.triangle_of]
    room = np.ptp(view.limits, axis=1).max() if view.equal else np.ptp(view.limits, axis=1)
    room = np.broadcast_to(room / ACROSS_A_VIEW, (2,))
    middles = view.points[view.triangles].mean(axis=1)
    visible = (middles >= view.limits[:, 0]) & (middles <= view.limits[:, 1])
    having = np.flatnonzero(visible.all(axis=1) & np.any(fibres, axis=1))
    chosen = having[_one_a_cell(middles[having] / room)]
    if not len(chosen):
        return []
    along = _in_view(view, recording, fibres[chosen], chosen) / room
    # steep ones look short, and those along the line of sight are not seen
    along *= 0.5 * LENGTH / np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
    ends = np.stack([middles[chosen] - along * room, middles[chosen] + along * room], axis=1)
    axes.add_collection(LineCollection(list(ends), colors=INK, linewidths=0.9, alpha=0.8))
    return [Line2D([], [], color=INK, linewidth=0.9, label="fibres (greatest diffusivity)")]


def _one_a_cell(places: Floats) -> Ints:
    """Return for each square of unit side the number of the place next to its middle."""
    cells = np.floor(places)
    away = np.linalg.norm(places - cells - 0.5, axis=1)
    order = np.argsort(away, kind="stable")
    _, first = np.unique(cells[order], axis=0, return_index=True)
    return np.asarray(order[first])


def _in_view(view: View, recording: Recording, directions: Floats, chosen: Ints) -> Floats:
    """Return directions (k, 3) of the surface as they lie in the view, (k, 2).

    The view maps each triangle linearly: a direction keeps its coordinates along two sides.
    """
    surface = recording.surface
    corners = surface.points[surface.triangles[view.triangle_of[chosen]]]
    sides = corners[:, 1:] - corners[:, :1]
    shares = np.einsum("tds,td->ts", np.linalg.pinv(sides), directions)
    flat = view.points[view.triangles[chosen]]
    return np.asarray(np.einsum("ts,tsc->tc", shares, flat[:, 1:] - flat[:, :1]))
