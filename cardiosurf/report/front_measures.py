"""Does any one number of the front order the critical values? All that were tried, side by side.

Each is of the piece of the entrance that is met first. They were thought of with the critical
values in view, so the best of them is no finding by itself; that is why none is left out.
"""

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np

from cardiosurf.analysis.entrance import head_on_length
from cardiosurf.arrays import Floats
from cardiosurf.report.critical_plots import numbers, piece_name, piece_names
from cardiosurf.report.kept import Row

Piece: TypeAlias = dict[str, Any]


def rank_correlation(one: Sequence[float], other: Sequence[float]) -> float:
    """Return Spearman's rank correlation; NaN if either does not vary or is not known.

    Examples
    --------
    >>> round(rank_correlation([1, 2, 3, 4], [10, 20, 40, 30]), 3)
    0.8
    """
    pair = np.array([_ranks(np.asarray(one, float)), _ranks(np.asarray(other, float))])
    if np.isnan([one, other]).any() or pair.shape[1] < 3 or (np.ptp(pair, axis=1) == 0).any():
        return float("nan")
    return float(np.corrcoef(pair)[0, 1])


def correlations(thresholds: Sequence[Row], entrances: Sequence[Row]) -> dict[str, float]:
    """Return for every measure its rank correlation with the critical values of some cases.

    Parameters
    ----------
    thresholds, entrances : sequence of Row
        The results of the same cases; those without one critical value are left out.
    """
    values = {
        row.wanted.name: row.entry["changes"][0]["value"]
        for row in thresholds
        if row.entry is not None and len(row.entry["changes"]) == 1
    }
    names = piece_names(entrances)
    cases = [
        (values[row.wanted.name], _first_met(row.entry["pieces"], names))
        for row in entrances
        if row.entry is not None and names and values.get(row.wanted.name) is not None
    ]
    critical = [value for value, _ in cases]
    return {
        name: rank_correlation([measure(piece) for _, piece in cases], critical)
        for name, measure in MEASURES.items()
    }


def _ranks(values: Floats) -> Floats:
    """Return ranks; equal values have the mean of theirs."""
    below = (values[None, :] < values[:, None]).sum(axis=1)
    return np.asarray(below + 0.5 * ((values[None, :] == values[:, None]).sum(axis=1) + 1))


def _first_met(pieces: Sequence[Piece], names: Sequence[str]) -> Piece:
    having = [piece for piece in pieces if piece_name(piece) in names]
    return min(having, key=lambda piece: float(np.nanmin(numbers(piece["lat"]))))


def _within_angle(degrees: float) -> Callable[[Piece], float]:
    return lambda piece: head_on_length(
        numbers(piece["position"]), numbers(piece["angle"]), piece["length"], np.radians(degrees)
    )


def _within_time(span: float) -> Callable[[Piece], float]:
    def longest(piece: Piece) -> float:
        position, lat = numbers(piece["position"]), numbers(piece["lat"])
        known = np.isfinite(lat)
        places = np.linspace(0.0, piece["length"], 401)
        # places lie up to half an edge before or behind the line, which a smooth curve evens out
        smooth = np.polynomial.Polynomial.fit(position[known], lat[known], 5)(places)
        inside = (smooth[None, :] >= smooth[:, None]) & (smooth[None, :] <= smooth[:, None] + span)
        return float(inside.mean(axis=1).max() * piece["length"])

    return longest


def _spread(piece: Piece) -> float:
    return float(np.ptp(numbers(piece["lat"])[np.isfinite(numbers(piece["lat"]))]))


def _first_place(piece: Piece) -> int:
    return int(np.nanargmin(np.where(_known(piece), numbers(piece["lat"]), np.nan)))


def _known(piece: Piece) -> Floats:
    return np.asarray(np.isfinite(numbers(piece["angle"])))


def _head_on_curvature(piece: Piece) -> float:
    head_on = np.abs(np.degrees(numbers(piece["angle"]))) <= 15.0
    return float(np.mean(numbers(piece["curvature"])[head_on])) if head_on.any() else float("nan")


MEASURES: dict[str, Callable[[Piece], float]] = {
    **{f"length met within {n} deg": _within_angle(n) for n in (5, 10, 15, 20, 30, 45)},
    "mean abs(angle)": lambda piece: float(np.nanmean(np.abs(numbers(piece["angle"])))),
    "abs(angle) where met first": lambda piece: abs(piece["angle"][_first_place(piece)]),
    "mean curvature": lambda piece: float(np.nanmean(numbers(piece["curvature"]))),
    "median curvature": lambda piece: float(np.nanmedian(numbers(piece["curvature"]))),
    "curvature where met first": lambda piece: piece["curvature"][_first_place(piece)],
    "mean curvature within 15 deg": _head_on_curvature,
    **{f"length met within {n} tu": _within_time(n) for n in (15, 30, 45)},
    "spread of arrival": _spread,
}
