"""Predictors of block against simulation: the table of areas and the figure.

Run as ``python -m cardiosurf.report.roc_figure docs/results/prediction.csv docs/images``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from cardiosurf.analysis.roc import Roc, permuted, roc
from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.errors import given_words, told_on_stderr
from cardiosurf.report.canvas import INK, new_figure, save
from cardiosurf.report.table import table_lines
from cardiosurf.study.predictors import COARSER, PREDICTORS, read_table

CONDUCTS = 0.95
"""Activated share of a patch from which on it conducts, as for a verdict."""
HEAD_ON = 15.0
"""Median angle of incidence, in degrees, below which a front counts as head on."""
DRAWN = {
    "acceleration": "#d55e00",
    "of_spread": "#e69f00",
    "anisotropy": "#999999",
    "angle": "#56b4e9",
    "curvature_number": "#009e73",
    "source_sink": "#0072b2",
}
"""Predictors in the figure and their colours."""


@dataclass(frozen=True)
class Cases:
    """The cases of a table that a wave reached.

    Attributes
    ----------
    scores : mapping of str to (k,) float
        The predictors.
    failed : (k,) bool
        Whether less than 95 % of the patch was activated.
    failed_coarser : (k,) bool
        The same on the coarser mesh.
    not_through : (k,) bool
        Whether the wave did not come in through most of the entrance.
    groups : (k,) int
        The geometry of each.
    """

    scores: Mapping[str, Floats]
    failed: Mask
    failed_coarser: Mask
    not_through: Mask
    groups: Ints

    @classmethod
    def of(cls, rows: Sequence[Mapping[str, str]]) -> "Cases":
        """Return the cases in which the stimulus captured and the patch has an entrance."""
        used = [row for row in rows if row["captured"] == "true" and row["angle"]]

        def numbers(key: str) -> Floats:
            return np.array([float(row[key]) for row in used])

        names = np.array([row["case"] for row in used])
        return cls(
            scores={name: numbers(name) for name in PREDICTORS},
            failed=numbers("activated_fraction") < CONDUCTS,
            failed_coarser=numbers(COARSER) < CONDUCTS,
            not_through=np.array([row["route"] != "direct" for row in used]),
            groups=np.unique(names, return_inverse=True)[1],
        )


def roc_lines(cases: Cases) -> list[str]:
    """Return the areas of all predictors as lines of text, each with its error.

    Parameters
    ----------
    cases : Cases
        The cases.
    """
    head_on = cases.scores["angle"] < HEAD_ON
    everywhere = np.ones_like(head_on)
    columns = {
        "not activated": (everywhere, cases.failed),
        "coarser mesh": (everywhere, cases.failed_coarser),
        "not through": (everywhere, cases.not_through),
        "head on": (head_on, cases.failed),
        "oblique": (~head_on, cases.failed),
    }
    counts = [f"{int(which.sum())}, {int(out[which].sum())}" for which, out in columns.values()]
    rows = [("cases, blocked", *counts, "")]
    for name in PREDICTORS:
        score = cases.scores[name]
        areas = [
            _area(roc(score[which], outcome[which], cases.groups[which]))
            for which, outcome in columns.values()
        ]
        rows.append((name, *areas, f"{permuted(score, cases.failed):.4f}"))
    return table_lines(("predictor", *columns, "by chance"), rows)


def roc_figure(cases: Cases) -> Figure:
    """Return the curves of some predictors, for failure of conduction.

    Parameters
    ----------
    cases : Cases
        The cases.
    """
    count = len(cases.failed)
    title = f"Predictors of block, {count} simulated cases, {int(cases.failed.sum())} blocked"
    figure = new_figure(6.4, 5.6, title, None)
    axes = figure.add_subplot()
    axes.plot([0, 1], [0, 1], color=INK, linewidth=0.6, linestyle=":")
    for name, colour in DRAWN.items():
        curve = roc(cases.scores[name], cases.failed, cases.groups)
        label = f"{name}: {_area(curve)}"
        axes.plot(curve.false, curve.true, color=colour, linewidth=1.6, label=label)
    axes.set(xlabel="share of the conducting cases above it", aspect="equal")
    axes.set_ylabel("share of the blocked cases above the threshold")
    axes.legend(loc="lower right", fontsize=8, title="AUC", title_fontsize=8)
    return figure


def _area(curve: Roc) -> str:
    return f"{curve.area:.2f} +- {curve.error:.2f}"


if __name__ == "__main__":
    with told_on_stderr():
        kept, folder = map(Path, given_words(2, "TABLE FOLDER"))
        simulated = Cases.of(read_table(kept))
        print("\n".join(roc_lines(simulated)))  # noqa: T201 - what the module is run for
        save(roc_figure(simulated), folder / "roc", ("png",), dots_per_inch=110)
