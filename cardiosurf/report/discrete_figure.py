"""Appendix B's stopping conditions as a figure, figure relaccel2 played (``make figures``)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from cardiosurf.discrete.packings import HALF, block_of_fibres
from cardiosurf.discrete.play import Rule
from cardiosurf.discrete.stops import Layers, expansion, fibre
from cardiosurf.report.canvas import INK, NEVER, STIMULUS, new_figure

SPEED = 4.0
ANISOTROPY = 16.0


def stopping() -> Figure:
    """Return free propagation, SG-i, SC-ii, and a block of fibres in a packing."""
    figure = new_figure(
        11.0,
        6.4,
        "Appendix B's units with N_max = 3: when they are excited",
        "numbers: excitation times; crosses: charged in vain",
    )
    axes = figure.subplots(2, 2)
    _layers(axes[0, 0], "figure B: 2, 3, 4 units, conducts", expansion((2, 3, 4)))
    _layers(axes[0, 1], "figure D, SG-i: 2 units for 7, stops", expansion((2, 7)))
    title = f"SC-ii, figure F and a unit more in B, C: fibre {SPEED:g} times as fast, stops"
    _layers(axes[1, 0], title, fibre(SPEED, (3, 4)))
    _block(axes[1, 1])
    return figure


def _layers(axes: Axes, title: str, layers: Layers) -> None:
    """Draw layers from left to right, each unit with the time of its excitation."""
    played, layer = layers.played(Rule()), np.array(layers.layers)
    height = np.zeros(len(layer))
    for one in np.unique(layer):
        count = np.count_nonzero(layer == one)
        height[layer == one] = np.arange(count) - 0.5 * (count - 1)
    if layer.max() > 2:
        # the fibre's units in one line
        height -= np.array([height[layer == one].min() for one in layer])
    places = np.stack([1.6 * layer, height], axis=1)
    network = layers.network
    lines = np.stack([places[network.sources], places[network.targets]], axis=1)
    widths = np.where(network.speeds > 1.0, 2.2, 0.5)
    axes.add_collection(LineCollection(list(lines), colors=NEVER, linewidths=widths, zorder=1))
    reached = np.isfinite(played.first)
    x, y = places.T
    axes.scatter(x[reached], y[reached], s=420, c=INK, zorder=2)
    axes.scatter(x[~reached], y[~reached], s=420, c="white", edgecolors=INK, zorder=2)
    axes.scatter(x[~reached], y[~reached], s=120, c=STIMULUS, marker="x", zorder=3)
    for unit in np.flatnonzero(reached):
        label = f"{played.first[unit]:.2g}"
        axes.text(x[unit], y[unit], label, color="white", ha="center", va="center", fontsize=8)
    axes.set_title(title, fontsize=9)
    axes.margins(0.12)
    axes.set_axis_off()


def _block(axes: Axes) -> None:
    packing, played = block_of_fibres(ANISOTROPY, Rule())
    x, y = packing.places.T
    reached = np.isfinite(played.first)
    shown = axes.scatter(x[reached], y[reached], s=13, c=played.first[reached], cmap="viridis")
    axes.scatter(x[~reached], y[~reached], s=13, c=NEVER)
    vain = played.failures > 0
    axes.scatter(x[vain], y[vain], s=16, c=STIMULUS, marker="x", linewidths=0.9)
    side = 0.5 * HALF
    axes.plot([-side, side, side, -side, -side], [-side, -side, side, side, -side], color=INK)
    axes.set_aspect("equal")
    axes.set_title(
        f"fibres up and down, anisotropy {ANISOTROPY:g} as load; wave from above",
        fontsize=9,
    )
    axes.set_axis_off()
    axes.figure.colorbar(shown, ax=axes, label="first excitation")
