"""Critical values against what was varied from case to case, and the fronts that explain them."""

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cardiosurf.arrays import Floats
from cardiosurf.config.scenario_file import ScenarioFile
from cardiosurf.report.canvas import INK, new_figure
from cardiosurf.report.kept import Row, SearchRows

MARKERS = "os^Dv"
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00")


def critical_plot(group: SearchRows) -> Figure:
    """Return the critical values of searches of one name with their error bars.

    Parameters
    ----------
    group : SearchRows
        The searches; those without an ``against`` or a value are left out.
    """
    figure = new_figure(7.2, 4.2, group.searches[0][1].title or group.name, None)
    axes = figure.add_subplot()
    axis = ""
    for number, (file, search) in enumerate(group.searches):
        axis = axis or search.axis
        colour = COLOURS[number % len(COLOURS)]
        label = file.scenario.name
        for row in group.of(file, group.thresholds):
            if row.entry is None or row.entry["against"] is None:
                continue
            for change in row.entry["changes"]:
                if change["value"] is None:
                    continue
                # an open marker: the meshes do not draw together as they should
                axes.errorbar(
                    row.entry["against"],
                    change["value"],
                    change["error"],
                    marker=MARKERS[number % len(MARKERS)],
                    color=colour,
                    markerfacecolor=colour if change["converged"] else "white",
                    capsize=4,
                    linestyle="none",
                    label=label,
                )
                label = "_"
    _mark_values(axes, group)
    axes.set_xlabel(axis)
    axes.set_ylabel(f"critical {group.searches[0][1].vary.split('.')[-1]}")
    axes.grid(alpha=0.3)
    # nothing may hide a value
    figure.legend(loc="outside lower center", ncols=3, fontsize=8)
    return figure


def entrance_plot(group: SearchRows, file: ScenarioFile) -> Figure:
    """Return angle and curvature of the front along the pieces of an entrance, case by case.

    Parameters
    ----------
    group : SearchRows
        The searches.
    file : ScenarioFile
        The scenario whose cases are drawn.
    """
    rows = [row for row in group.of(file, group.entrances) if row.entry is not None]
    names = piece_names(rows)
    figure = new_figure(
        4.6 * max(1, len(names)), 5.6, f"{file.scenario.name}: the front before the patch", None
    )
    grid = figure.subplots(2, max(1, len(names)), sharex=True, sharey="row", squeeze=False)
    shades = colormaps["viridis"](np.linspace(0.0, 0.9, max(1, len(rows))))
    for row, shade in zip(rows, shades, strict=True):
        entry = row.entry or {}
        for piece in entry["pieces"]:
            if piece_name(piece) not in names:
                continue
            column = names.index(piece_name(piece))
            label = f"{entry['against']:g}" if entry["against"] is not None else row.wanted.name
            style = "-" if entry["verdict"] == "conduction" else "--"
            angle, curvature = np.degrees(numbers(piece["angle"])), numbers(piece["curvature"])
            for axes, values in ((grid[0, column], angle), (grid[1, column], curvature)):
                axes.plot(
                    numbers(piece["position"]),
                    _smoothed(values),
                    linestyle=style,
                    color=shade,
                    label=label,
                )
    if names:
        grid[0, 0].legend(title=group.searches[0][1].axis, fontsize=7, title_fontsize=7)
    for column, name in enumerate(names):
        grid[0, column].set_title(f"entrance {name}", fontsize=9)
        grid[1, column].set_xlabel("arc length along the entrance [su]")
        for axes in grid[:, column]:
            axes.axhline(0.0, color=INK, linewidth=0.5)
            axes.grid(alpha=0.3)
    grid[0, 0].set_ylabel("angle of incidence [deg]")
    grid[1, 0].set_ylabel("curvature [1/su]")
    return figure


def piece_name(piece: dict[str, list[float]]) -> str:
    """Return a piece of an entrance by its ends, rounded: (0, 0, 70) to (35, 0, 35)."""
    ends = (", ".join(f"{round(x) + 0:d}" for x in piece[end]) for end in ("start", "end"))
    return " to ".join(f"({end})" for end in ends)


def piece_names(rows: Sequence[Row]) -> list[str]:
    """Return the pieces that the front of every case reached, in the order of their names."""
    reached = [
        {
            piece_name(piece)
            for piece in row.entry["pieces"]
            if any(lat is not None for lat in piece["lat"])
        }
        for row in rows
        if row.entry is not None
    ]
    return sorted(set.intersection(*reached)) if reached else []


def _mark_values(axes: Axes, group: SearchRows) -> None:
    """Mark the value that the cases themselves have, where it is one for all of them."""
    values = set()
    for row in group.thresholds:
        value = row.wanted.ready.loaded.document.value_at(group.searches[0][1].vary)
        numbers = set(value.values()) if isinstance(value, dict) else {value}
        values |= {float(one) for one in numbers if isinstance(one, int | float)}
    if len(values) == 1:
        (value,) = values
        axes.axhline(
            value, color=INK, linewidth=0.8, linestyle=":", label=f"the cases' own: {value:g}"
        )


def numbers(values: Sequence[float | None]) -> Floats:
    """Return numbers as JSON has them as an array, NaN for null."""
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)


def _smoothed(values: Floats) -> Floats:
    """Return running means of three: places lie up to half an edge before or behind the line."""
    padded = np.pad(values, 1, mode="edge")
    return np.asarray((padded[:-2] + padded[1:-1] + padded[2:]) / 3.0)
