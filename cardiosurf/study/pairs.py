"""Two directions of one way, and whether a wave passes in both, in one or in none."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from cardiosurf.config import Loaded
from cardiosurf.config.scenario import Pair, PairVerdict


@dataclass(frozen=True)
class PairResult:
    """What two cases say together.

    Attributes
    ----------
    scenario, name : str
        The pair.
    published : str
        What was published about it.
    expected : str or None
        What was expected.
    verdict : str or None
        ``unidirectional`` (conduction in one direction only), ``bidirectional block`` or
        ``bidirectional conduction``; None: one of the runs failed.
    passing : tuple of str
        The cases in which the target was reached.
    margins : mapping of str to float or None
        For ``forward`` and ``backward``: how far the value is above the critical one, relative to
        it; negative below. None: not known.
    agrees : bool
        Whether the verdict is the expected one.
    """

    scenario: str
    name: str
    published: str
    expected: PairVerdict | None
    verdict: PairVerdict | None
    passing: tuple[str, ...]
    margins: Mapping[str, float | None]
    agrees: bool


def judge_pair(
    scenario: str,
    pair: Pair,
    verdicts: Mapping[str, Mapping[str, Any] | None],
    configs: Mapping[str, Loaded],
) -> PairResult:
    """Judge a pair by the verdicts of its cases.

    A direction passes when its target is ``conduction``; ``partial`` is not enough.

    Parameters
    ----------
    scenario : str
        The scenario's name.
    pair : Pair
        The pair.
    verdicts : mapping of str to dict or None
        The verdict of each case, by its name; None: it failed.
    configs : mapping of str to Loaded
        The config of each case.
    """
    back = pair.target if pair.backward_target is None else pair.backward_target
    ways = {"forward": (pair.forward, pair.target), "backward": (pair.backward, back)}
    found = {way: _answer(verdicts[case], target) for way, (case, target) in ways.items()}
    verdict: PairVerdict | None = None
    if all(answer is not None for answer in found.values()):
        passing = sum(answer == "conduction" for answer in found.values())
        verdicts_by_count: tuple[PairVerdict, ...] = (
            "bidirectional block",
            "unidirectional",
            "bidirectional conduction",
        )
        verdict = verdicts_by_count[passing]
    return PairResult(
        scenario=scenario,
        name=pair.name,
        published=pair.published,
        expected=pair.expect,
        verdict=verdict,
        passing=tuple(ways[way][0] for way, answer in found.items() if answer == "conduction"),
        margins={way: margin(pair, way, configs[case]) for way, (case, _) in ways.items()},
        agrees=pair.expect is None or verdict == pair.expect,
    )


def margin(pair: Pair, way: str, loaded: Loaded) -> float | None:
    """Return (value - critical) / critical of one direction, None if that is not known.

    Parameters
    ----------
    pair : Pair
        Names the key and the critical values.
    way : str
        ``forward`` or ``backward``.
    loaded : Loaded
        The config of the direction's case; several values under the key must be equal.
    """
    if pair.thresholds is None:
        return None
    critical = pair.thresholds.forward if way == "forward" else pair.thresholds.backward
    value: Any = loaded.document.data
    path = loaded.document.find(pair.thresholds.key)
    if len(path) != len(pair.thresholds.key.split(".")):
        return None
    for key in path:
        value = value[key]
    if isinstance(value, dict) and len(set(map(str, value.values()))) == 1:
        value = next(iter(value.values()))
    if not critical or isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return (value - critical) / critical


def _answer(verdict: Mapping[str, Any] | None, target: str) -> str | None:
    if verdict is None:
        return None
    return next(str(one["verdict"]) for one in verdict["targets"] if one["name"] == target)
