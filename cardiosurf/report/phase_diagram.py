"""Phase diagrams: the verdicts of a sweep over what was varied."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from cardiosurf.arrays import Floats
from cardiosurf.config.expansion import short_names
from cardiosurf.report.canvas import new_figure
from cardiosurf.study.sweep import Row, SweepResult

# a colour and a marker each, so that neither is needed alone
STYLES = {
    "conduction": ("#0072b2", "o"),
    "partial": ("#e69f00", "D"),
    "block": ("#d55e00", "X"),
    "reentry": ("#cc79a7", "P"),
    "no_capture": ("#7f7f7f", "v"),
    "failed": ("#000000", "x"),
}
MOST_PANELS = 12


@dataclass(frozen=True)
class Axis:
    """One varied key along an axis.

    Attributes
    ----------
    key, label : str
        Its key path, and what stands beside the axis.
    ticks : tuple
        Its values in order, where they are no numbers and stand one beside the other.
    """

    key: str
    label: str
    ticks: tuple[str, ...] = ()

    def place(self, row: Row) -> float:
        """Return where a row stands along the axis."""
        value = row[self.key]
        return float(self.ticks.index(_written(value))) if self.ticks else float(value)


def phase_diagram(result: SweepResult) -> Figure:
    """Return the map of a sweep's verdicts.

    Two varied keys span a map, one a line; those beyond two, and several cases, give a panel for
    each combination of their values. Beyond ``MOST_PANELS`` panels only the first are drawn, which
    the title says. Keys with one value only are left out.

    Parameters
    ----------
    result : SweepResult
        The sweep.
    """
    keys = [key for key in result.varied if len({_written(row[key]) for row in result.rows}) > 1]
    keys = keys or list(result.varied[:1])
    names = short_names(result.varied)
    axes = [_axis(key, names[key], result.rows) for key in keys[:2]]
    panels = _panels(result.rows, keys[2:], names)
    shown = panels[:MOST_PANELS]
    columns = min(len(shown), 3)
    lines = -(-len(shown) // columns)
    height = 1.4 + (3.9 if len(axes) > 1 else 1.4) * lines
    caption = f"{len(shown)} of {len(panels)} panels" if len(shown) < len(panels) else None
    figure = new_figure(1.6 + 4.6 * columns, height, result.name, caption)
    every = figure.subplots(lines, columns, squeeze=False, sharex=True, sharey=True).ravel()
    for place, (title, rows) in zip(every, shown, strict=False):
        place.set_title(title, fontsize=9)
        _draw(place, axes, rows)
    for place in every[len(shown) :]:
        place.set_axis_off()
    figure.legend(handles=_legend(result.rows), loc="outside lower center", ncols=6, fontsize=8)
    return figure


def verdict_of(row: Row) -> str:
    """Return the verdict of a row, ``failed`` where there is none."""
    return row["verdict"] or "failed"


def _axis(key: str, label: str, rows: Sequence[Row]) -> Axis:
    values = [row[key] for row in rows]
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        return Axis(key, label)
    return Axis(key, label, tuple(dict.fromkeys(map(_written, values))))


def _panels(
    rows: Sequence[Row], keys: Sequence[str], names: dict[str, str]
) -> list[tuple[str, list[Row]]]:
    """Return title and rows of each panel."""
    found: dict[str, list[Row]] = {}
    several = len({row["case"] for row in rows}) > 1
    for row in rows:
        words = [row["case"]] if several else []
        words += [f"{names[key]} = {_written(row[key])}" for key in keys]
        found.setdefault(", ".join(words), []).append(row)
    return list(found.items())


def _draw(place: Axes, axes: Sequence[Axis], rows: Sequence[Row]) -> None:
    """Draw one panel: cells where the points make a grid, a marker for every run."""
    x = np.array([axes[0].place(row) for row in rows])
    y = np.array([axes[1].place(row) for row in rows]) if len(axes) > 1 else np.zeros(len(rows))
    if len(axes) > 1:
        _draw_cells(place, x, y, [verdict_of(row) for row in rows])
        place.set_ylabel(axes[1].label)
    else:
        place.set_yticks([])
        place.set_ylim(-1.0, 1.0)
    for verdict, (colour, marker) in STYLES.items():
        chosen = np.array([verdict_of(row) == verdict for row in rows])
        if chosen.any():
            marks = place.scatter(x[chosen], y[chosen], s=70, c=colour, marker=marker, zorder=3)
            if marker != "x":
                marks.set(edgecolor="white", linewidth=0.6)
    place.set_xlabel(axes[0].label)
    for set_ticks, axis in zip((place.set_xticks, place.set_yticks), axes, strict=False):
        if axis.ticks:
            set_ticks(range(len(axis.ticks)), axis.ticks, fontsize=7)


def _draw_cells(place: Axes, x: Floats, y: Floats, verdicts: Sequence[str]) -> None:
    """Colour the cell around each point, if every column has a point in every line."""
    across, up = np.unique(x), np.unique(y)
    if min(len(across), len(up)) < 2 or len(across) * len(up) != len(x):
        return
    picture = np.ones((len(up), len(across), 4))
    colours = [tuple(int(STYLES[v][0][i : i + 2], 16) / 255 for i in (1, 3, 5)) for v in verdicts]
    picture[np.searchsorted(up, y), np.searchsorted(across, x), :3] = colours
    picture[:, :, 3] = 0.25
    place.pcolormesh(_edges(across), _edges(up), picture, zorder=1)


def _edges(centres: Floats) -> Floats:
    """Return the edges between values, and as far beyond the outer ones."""
    inner = 0.5 * (centres[1:] + centres[:-1])
    first, last = 2.0 * centres[0] - inner[0], 2.0 * centres[-1] - inner[-1]
    return np.concatenate([[first], inner, [last]])


def _legend(rows: Sequence[Row]) -> list[Artist]:
    there = {verdict_of(row) for row in rows}
    return [
        Line2D([], [], color=colour, marker=marker, linestyle="none", markersize=8, label=name)
        for name, (colour, marker) in STYLES.items()
        if name in there
    ]


def _written(value: Any) -> str:
    return json.dumps(value) if isinstance(value, dict | list | tuple) else f"{value}"
