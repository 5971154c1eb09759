"""Critical values on the reproduction page, and the fronts that explain them."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from cardiosurf.analysis.entrance import head_on_length
from cardiosurf.config.scenario_file import ScenarioFile
from cardiosurf.report.critical_plots import numbers, piece_name
from cardiosurf.report.front_measures import MEASURES, correlations
from cardiosurf.report.kept import Row, SearchRows
from cardiosurf.report.markdown import image_file, table
from cardiosurf.report.threshold_lines import with_error
from cardiosurf.study.results import Entry

MISSING = "not run yet"


def search_section(group: SearchRows, images: str) -> list[str]:
    """Return the section of all searches of one name, as lines of Markdown.

    Parameters
    ----------
    group : SearchRows
        The searches and their results.
    images : str
        The folder of the images, seen from the page.
    """
    search = group.searches[0][1]
    lines = [f"## {search.title or group.name}", ""]
    for file, _ in group.searches:
        if file.scenario.answer:
            lines += [f"**{file.scenario.name}.** {file.scenario.answer}", ""]
    if any(row.entry is not None for row in group.thresholds):
        lines += [f"![critical values]({image_file(images, group.name)})", ""]
    heads = ("case", search.axis or "-", "critical value", "order", "on each mesh")
    rows = [
        _threshold(row) for file, _ in group.searches for row in group.of(file, group.thresholds)
    ]
    about = (
        f"Critical value of `{search.vary}`, asked for {search.of} (open symbols: not converged):"
    )
    lines += [about, "", *table(heads, rows)]
    lines.append("")
    for file, _ in group.searches:
        lines += _entrances(group, file, images)
    return lines + _measures(group)


def _threshold(row: Row) -> list[str]:
    entry = row.entry or {}
    name = f"{row.wanted.file.scenario.name}/{row.wanted.ready.case.name}"
    if not entry:
        return [name, "-", MISSING, "-", "-"]
    against = "-" if entry["against"] is None else f"{entry['against']:g}"
    orders = [
        "no trend" if one["order"] is None else f"{one['order']:.1f}, {one['order_is']}"
        for one in entry["changes"]
        if one["value"] is not None
    ]
    meshes = "; ".join(_on_meshes(one) for one in entry["changes"])
    return [name, against, critical_words(row), "; ".join(orders) or "-", meshes or "-"]


def _on_meshes(change: dict[str, Any]) -> str:
    found = []
    for level in change["levels"]:
        if level["low"] is None:
            found.append(f"{level['edge_length']:g}: none")
        else:
            found.append(f"{level['edge_length']:g}: {0.5 * (level['low'] + level['high']):.4g}")
    return ", ".join(found)


def _entrances(group: SearchRows, file: ScenarioFile, images: str) -> list[str]:
    """Return how the front meets the patch in a scenario's cases."""
    rows = group.of(file, group.entrances)
    if not rows:
        return []
    search = next(one for own, one in group.searches if own is file)
    name = f"{file.scenario.name}/{group.name}/entrance"
    lines = [f"### {file.scenario.name}: the front before {search.entrance}", ""]
    if any(row.entry is not None for row in rows):
        lines += [f"![angle and curvature along the entrance]({image_file(images, name)})", ""]
    heads = (
        search.axis or "case",
        "verdict",
        "entrance",
        "met from [tu]",
        "angle there [deg]",
        "mean abs(angle) [deg]",
        "met within 15 deg [su]",
        "curvature there [1/su]",
        "mean curvature [1/su]",
    )
    return [*lines, *table(heads, [line for row in rows for line in _fronts(row)]), ""]


def _measures(group: SearchRows) -> list[str]:
    """Return how every measure of the front goes with the critical values, reading by reading."""
    found = {
        file.scenario.name: correlations(
            group.of(file, group.thresholds), group.of(file, group.entrances)
        )
        for file, search in group.searches
        if search.entrance is not None
    }
    shown = {
        name: every for name, every in found.items() if not np.isnan(list(every.values())).all()
    }
    if not shown:
        return []
    rows = [
        [measure, *(_signed(every[measure]) for every in shown.values())] for measure in MEASURES
    ]
    text = (
        f"Rank correlation with the critical values of {len(MEASURES)} measures of the front at the"
        " entrance that is met first, all that were tried. They were thought of after the critical"
        " values were known, and there are few sites: the largest numbers are no test of anything."
    )
    return ["### No measure left out", "", text, "", *table(("measure", *shown), rows), ""]


def _signed(value: float) -> str:
    return "-" if np.isnan(value) else f"{value:+.2f}"


def _fronts(row: Row) -> Iterator[list[str]]:
    """Yield a line for each piece of an entrance that the front came to."""
    entry = row.entry
    if entry is None:
        yield [row.wanted.ready.case.name, MISSING, *["-"] * 7]
        return
    against = row.wanted.ready.case.name
    if entry["against"] is not None:
        against = f"{entry['against']:g}"
    for piece in entry["pieces"]:
        angle, curvature = np.degrees(numbers(piece["angle"])), numbers(piece["curvature"])
        lat = np.where(np.isfinite(angle), numbers(piece["lat"]), np.nan)
        if not np.isfinite(lat).any():
            continue
        first = int(np.nanargmin(lat))
        position, radians = numbers(piece["position"]), numbers(piece["angle"])
        head_on = head_on_length(position, radians, piece["length"])
        yield [
            against,
            entry["verdict"],
            piece_name(piece),
            f"{lat[first]:.0f}",
            f"{angle[first]:+.0f}",
            f"{np.nanmean(np.abs(angle)):.0f}",
            f"{head_on:.0f} of {piece['length']:.0f}",
            f"{curvature[first]:+.4f}",
            f"{np.nanmean(curvature):+.4f}",
        ]


def critical_words(row: Row) -> str:
    """Return the critical values of a search in a few words.

    Parameters
    ----------
    row : Row
        The search of a case and its result.
    """
    return MISSING if row.entry is None else change_words(row.entry)


def change_words(entry: Entry) -> str:
    """Return the critical values of a search's result in a few words.

    Parameters
    ----------
    entry : mapping
        It, with ``changes`` and ``between``.
    """
    if not entry["changes"]:
        low, high = entry["between"]
        return f"no change from {low:g} to {high:g}"
    return ", ".join(_change(change) for change in entry["changes"])


def _change(change: dict[str, Any]) -> str:
    if change["value"] is None:
        return f"no value ({change['note']})"
    value = with_error(change["value"], change["error"])
    return value if change["converged"] else f"{value} (not converged)"
