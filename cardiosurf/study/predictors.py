"""The predictors of block beside what was simulated: a table of a sweep.

Run as ``python -m cardiosurf.study.predictors SCENARIO RESULTS COARSER_RESULTS TABLE PATCH``.

A row is a run of ``cardiosurf sweep`` and what ``predict`` says of the same config. The table is
kept (docs/results/prediction.csv), so that its figures need no run.
"""

import csv
import io
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from cardiosurf.analysis.prediction import WIDTH, PatchPrediction
from cardiosurf.config.scenario_file import ScenarioFile, read_scenario
from cardiosurf.errors import InputError, given_words, told_on_stderr
from cardiosurf.recording.whole_file import whole_file
from cardiosurf.study.prediction import predict

PREDICTORS = (
    "anisotropy",
    "angle",
    "curvature",
    "of_velocity",
    "of_change",
    "of_spread",
    "acceleration",
    "flux_ratio",
    "source_sink",
    "curvature_number",
)
"""Fields of a PatchPrediction that may tell a block."""
FOUND = ("captured", "verdict", "activated_fraction", "route")
COARSER = "coarser_fraction"
"""Activated fraction on the coarser mesh."""


def predictor_rows(
    file: ScenarioFile,
    simulated: Iterable[Mapping[str, str]],
    coarser: Iterable[Mapping[str, str]],
    patch: str,
) -> list[dict[str, str]]:
    """Return a row for each run of a sweep: what was found at a patch, and its predictors.

    Parameters
    ----------
    file : ScenarioFile
        The scenario.
    simulated : iterable of mapping
        The rows of its results.csv; ``patch`` is the name of a target, too.
    coarser : iterable of mapping
        Those of the same sweep on a coarser mesh.
    patch : str
        The patch.

    Raises
    ------
    InputError
        A point was not simulated.
    """
    found = {row["point"]: row for row in simulated}
    checks = {row["point"]: row for row in coarser}
    rows = []
    for point in file.points():
        run, check = found.get(point.name), checks.get(point.name)
        if run is None or check is None or run["error"] or check["error"]:
            raise InputError(point.name, "has no result", "a sweep that is complete")
        (met,) = (
            one for one in predict(point.loaded, WIDTH).prediction.patches if one.name == patch
        )
        settings = {key.rpartition(".")[2]: value for key, value in point.point.values.items()}
        row = {"case": point.case.name if point.case else "", **_texts(settings)}
        row["captured"] = run["captured"]
        row |= {key: run[f"{patch}.{key}"] for key in FOUND[1:]}
        row[COARSER] = check[f"{patch}.activated_fraction"]
        rows.append(row | _texts(_numbers(met)))
    return rows


def table_text(rows: Sequence[Mapping[str, str]]) -> str:
    """Return rows as CSV."""
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def read_table(path: Path) -> list[dict[str, str]]:
    """Return the rows of a CSV file.

    Raises
    ------
    InputError
        There is no such file.
    """
    try:
        rows = list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            str(path),
            f"cannot be read: {getattr(error, 'strerror', 'not text')}",
            "a CSV file of a sweep",
        ) from error
    if not rows or "captured" not in rows[0]:
        raise InputError(str(path), "has no column 'captured'", "a CSV file of a sweep")
    return rows


def _numbers(met: PatchPrediction) -> dict[str, float | None]:
    return {name: getattr(met, name) for name in PREDICTORS}


def _texts(values: Mapping[str, object]) -> dict[str, str]:
    """Return values as they stand in the table: five digits, nothing where there is none."""

    def text(value: object) -> str:
        if value is None:
            return ""
        if isinstance(value, float) and math.isfinite(value):
            return f"{0.0 if abs(value) < 1e-9 else value:.5g}"
        return str(value)

    return {key: text(value) for key, value in values.items()}


def main(arguments: Sequence[str]) -> None:
    """Write the table of a sweep: scenario, its rows, those of a coarser mesh, table, patch."""
    scenario, simulated, coarser, table = (Path(one) for one in arguments[:4])
    rows = predictor_rows(
        read_scenario(scenario), read_table(simulated), read_table(coarser), arguments[4]
    )
    with whole_file(table) as partial:
        partial.write_text(table_text(rows), encoding="utf-8")


if __name__ == "__main__":
    with told_on_stderr():
        main(given_words(5, "SCENARIO RESULTS COARSER_RESULTS TABLE PATCH"))
