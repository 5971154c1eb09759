"""What the cases of a check were when they last agreed, to say what changed when they do not."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from cardiosurf.config.difference import config_differences
from cardiosurf.config.expectation import Plain
from cardiosurf.recording.whole_file import whole_file

NAME = "history.json"
SCHEMA = "cardiosurf/history/1"


@dataclass(frozen=True)
class Past:
    """A case when it last agreed with what was expected.

    Attributes
    ----------
    findings : mapping
        What was found (``findings_of``).
    config : str
        The resolved config.
    seconds : float
        Wall time of the run.
    """

    findings: Mapping[str, Plain]
    config: str
    seconds: float


@dataclass(frozen=True)
class Change:
    """What is different from when a case last agreed.

    Attributes
    ----------
    findings : tuple of str
        As ``key: before -> now``.
    config : tuple of str
        As ``key: before -> now``; none: the same config, so the program is another.
    """

    findings: tuple[str, ...]
    config: tuple[str, ...]


def change_since(past: Past, findings: Mapping[str, Plain], config: str) -> Change:
    """Return in what a case differs from its past.

    Parameters
    ----------
    past : Past
        When it last agreed.
    findings : mapping
        What is found now.
    config : str
        The resolved config now.
    """
    keys = dict.fromkeys([*past.findings, *findings])
    changed = [
        f"{key}: {_shown(past.findings.get(key))} -> {_shown(findings.get(key))}"
        for key in keys
        if _shown(past.findings.get(key)) != _shown(findings.get(key))
    ]
    return Change(tuple(changed), tuple(config_differences(past.config, config)))


def read_history(folder: Path) -> dict[str, Past]:
    """Return the past of every case that a check in this folder has one of, by its name."""
    try:
        data = json.loads((folder / NAME).read_text(encoding="utf-8"))
        if data["schema"] != SCHEMA:
            return {}
        return {name: Past(**past) for name, past in data["cases"].items()}
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        # it is a help, and nothing rests on it
        return {}


def write_history(folder: Path, history: Mapping[str, Past]) -> None:
    """Write the past of every case.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    data = {"schema": SCHEMA, "cases": {name: asdict(past) for name, past in history.items()}}
    with whole_file(folder / NAME) as partial:
        partial.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")


def _shown(value: Plain) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
