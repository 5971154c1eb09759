"""What stands in check.json: its keys and their types, for the schema that is published."""

from dataclasses import dataclass
from typing import Any, Literal

from cardiosurf.analysis.verdict import GuardFinding, Verdict
from cardiosurf.json_schema import result_schema
from cardiosurf.study.check import Status
from cardiosurf.study.history import Change
from cardiosurf.study.outcome import Compared
from cardiosurf.study.pairs import PairResult

SCHEMA: Literal["cardiosurf/check/1"] = "cardiosurf/check/1"


@dataclass(frozen=True)
class Failure:
    """Why there is no verdict: ``input``, ``numerical``, ... and the message."""

    kind: str
    text: str


@dataclass(frozen=True)
class CheckedCase:
    """A case of a check, as ``results.case_json`` writes it; lengths in su, times in tu or s."""

    scenario: str
    case: str
    status: Status
    published: str
    note: str
    fast: bool
    compared: tuple[Compared, ...]
    converged: str | None
    guard: GuardFinding | None
    edge_length: float | None
    step: float | None
    vertices: int | None
    seconds: float
    reused: bool
    error: Failure | None
    change: Change | None
    run: str
    verdict: Verdict | None


@dataclass(frozen=True)
class Checked:
    """A check: whether all is as expected, its wall time in seconds, its cases and pairs."""

    schema: Literal["cardiosurf/check/1"]
    agrees: bool
    seconds: float
    cases: tuple[CheckedCase, ...]
    pairs: tuple[PairResult, ...]


def check_schema() -> dict[str, Any]:
    """Return the JSON Schema of check.json; every key is always there, and no other."""
    return result_schema(Checked, SCHEMA)
