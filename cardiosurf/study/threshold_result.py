"""What a threshold search found, as it stands in threshold.json."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

from cardiosurf.json_schema import result_schema
from cardiosurf.study.critical import Change
from cardiosurf.study.extrapolation import LEVELS, OrderIs, Sample, extrapolate

SCHEMA: Literal["cardiosurf/threshold/1"] = "cardiosurf/threshold/1"


@dataclass(frozen=True)
class Level:
    """A mesh and the step on it.

    Attributes
    ----------
    edge_length : float
        In su.
    step : float
        In tu.
    """

    edge_length: float
    step: float


@dataclass(frozen=True)
class RunRow:
    """One run of a search.

    Attributes
    ----------
    edge_length, step : float
        The mesh, in su, and the step, in tu.
    value : float
        What the varied key was.
    answer : str
        The answer to the question that was asked.
    verdict : str
        The whole verdict.
    activated_fraction : mapping of str to float
        The activated share of each target.
    end : float
        When the run ended, in tu.
    settled : bool
        Whether a longer run would answer the same.
    seconds : float
        Its wall time.
    reused : bool
        Whether it was there already.
    """

    edge_length: float
    step: float
    value: float
    answer: str
    verdict: str
    activated_fraction: Mapping[str, float]
    end: float
    settled: bool
    seconds: float
    reused: bool


@dataclass(frozen=True)
class LevelValue:
    """Where a change lies on one mesh.

    Attributes
    ----------
    edge_length, step : float
        The mesh, in su, and the step, in tu.
    low, high : float or None
        Its bracket; None: the change is not there.
    """

    edge_length: float
    step: float
    low: float | None
    high: float | None


@dataclass(frozen=True)
class CriticalValue:
    """A value at which the answer changes.

    Attributes
    ----------
    below, above : str
        The answers below and above it.
    value : float or None
        Extrapolated to infinitely fine meshes; None: the change is not on the three finest.
    error : float or None
        How far the converged value is from it at most (docs/threshold.md has the rule).
    bracket_error : float or None
        The half width of the bracket on the finest mesh, which is part of the error.
    order : float or None
        The order of convergence that was extrapolated with; None: no trend to extrapolate.
    order_is : str or None
        ``fitted`` to the meshes, ``assumed``, or ``none``: the values turn round, or stay.
    converged : bool
        Whether the values on the three finest meshes draw closer as they should, or are as close
        as the brackets let one tell (``extrapolate``).
    levels : tuple of LevelValue
        Where it lies on each mesh, the coarsest first.
    note : str
        Where it is not on every mesh; empty otherwise.
    """

    below: str
    above: str
    value: float | None
    error: float | None
    bracket_error: float | None
    order: float | None
    order_is: OrderIs | None
    converged: bool
    levels: tuple[LevelValue, ...]
    note: str


@dataclass(frozen=True)
class Threshold:
    """The critical values of a config between two values, as they stand in threshold.json.

    Attributes
    ----------
    schema : str
        The version of this layout.
    name : str
        The config's name.
    config_sha256 : str
        Hash of the resolved config that was varied.
    vary : str
        The key that was varied.
    between : pair of float
        The interval that was searched.
    tolerance : float
        Half width of a bracket at most.
    scan : int
        How many values the coarsest mesh was scanned with; two changes between two of them are
        not seen.
    question : str
        What was asked of each run.
    levels : tuple of Level
        The meshes, the coarsest first.
    changes : tuple of CriticalValue
        All changes of the answer, by rising value.
    runs : tuple of RunRow
        All runs.
    notes : tuple of str
        Warnings for the reader.
    """

    name: str
    config_sha256: str
    vary: str
    between: tuple[float, float]
    tolerance: float
    scan: int
    question: str
    levels: tuple[Level, ...]
    changes: tuple[CriticalValue, ...]
    runs: tuple[RunRow, ...]
    notes: tuple[str, ...] = ()
    schema: Literal["cardiosurf/threshold/1"] = SCHEMA

    @property
    def seconds(self) -> float:
        """Wall time of all runs together, in seconds."""
        return sum(run.seconds for run in self.runs)

    def to_json(self) -> dict[str, Any]:
        """Return the finding as plain JSON data, ``schema`` first."""
        data = asdict(self)
        return {"schema": data.pop("schema"), **data}


def critical_value(change: Change, levels: Sequence[Level]) -> CriticalValue:
    """Return a change with its extrapolated value, where it is on the three finest meshes.

    Parameters
    ----------
    change : Change
        The change, followed over all levels.
    levels : sequence of Level
        The meshes.
    """
    places = tuple(
        LevelValue(
            level.edge_length,
            level.step,
            None if bracket is None else bracket.low,
            None if bracket is None else bracket.high,
        )
        for level, bracket in zip(levels, change.brackets, strict=True)
    )
    samples = [
        Sample(level.edge_length, bracket.value, bracket.half_width)
        for level, bracket in zip(levels[-LEVELS:], change.brackets[-LEVELS:], strict=True)
        if bracket is not None
    ]
    note = _presence(change, levels)
    if len(samples) < LEVELS:
        none = (None, None, None, None, None)
        return CriticalValue(change.below, change.above, *none, False, places, note)
    found = extrapolate(samples)
    return CriticalValue(
        change.below,
        change.above,
        found.value,
        found.error,
        found.bracket_error,
        found.order,
        found.order_is,
        converged=found.converged,
        levels=places,
        note=note,
    )


def threshold_schema() -> dict[str, Any]:
    """Return the JSON Schema of threshold.json; every key is always there, and no other."""
    return result_schema(Threshold, SCHEMA)


def _presence(change: Change, levels: Sequence[Level]) -> str:
    """Return on which meshes a change is missing, in words; nothing if on none."""
    missing = [
        f"{level.edge_length:g}"
        for level, bracket in zip(levels, change.brackets, strict=True)
        if bracket is None
    ]
    return f"not found on edges of {', '.join(missing)} su" if missing else ""
