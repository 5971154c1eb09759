"""Results that are kept beside the docs: small JSON files, each entry with what it was asked."""

import hashlib
import json
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias

from cardiosurf.errors import InputError
from cardiosurf.recording.whole_file import made_folder, whole_file
from cardiosurf.study.check import CaseResult

SCHEMA = "cardiosurf/results/1"
Kind = Literal["cases", "thresholds", "entrances", "figures", "discrete"]
Entry: TypeAlias = dict[str, Any]
ASKED = "asked"
"""The key of an entry that holds the hash of what was asked."""
_DIGITS = 16


@dataclass(frozen=True)
class Results:
    """A folder of kept results.

    Attributes
    ----------
    folder : Path
        It holds a file for each kind: ``cases.json``, ``thresholds.json``, ...
    """

    folder: Path

    def read(self, kind: Kind) -> dict[str, Entry]:
        """Return all entries of a kind by their names; none if there is no file.

        Raises
        ------
        InputError
            The file cannot be read, or is something else.
        """
        path = self.folder / f"{kind}.json"
        try:
            data = json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return {}
        except (OSError, ValueError) as error:
            raise InputError(str(path), f"cannot be read: {error}", "a file of results") from None
        if not isinstance(data, dict) or data.get("schema") != SCHEMA:
            raise InputError(str(path), "is not a file of results", f"one with schema {SCHEMA}")
        entries: dict[str, Entry] = data["entries"]
        return entries

    def write(self, kind: Kind, entries: Mapping[str, Entry]) -> None:
        """Write all entries of a kind, in the order of their names.

        Raises
        ------
        InputError
            The folder cannot be written to.
        """
        data = {"schema": SCHEMA, "entries": dict(sorted(entries.items()))}
        with whole_file(made_folder(self.folder) / f"{kind}.json") as partial:
            partial.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")

    def keep(self, kind: Kind, name: str, entry: Entry) -> None:
        """Put one entry beside the others of its kind, in place of an older one of its name."""
        self.write(kind, self.read(kind) | {name: entry})

    def prune(self, kind: Kind, scenarios: Collection[str], wanted: Collection[str]) -> None:
        """Drop what these scenarios do not have any more.

        Parameters
        ----------
        kind : str
            Of which kind.
        scenarios : collection of str
            Names of the scenarios; entries of others stay.
        wanted : collection of str
            The names of entries that they have.
        """
        entries = self.read(kind)
        left = {
            name: entry
            for name, entry in entries.items()
            if name.split("/")[0] not in scenarios or name in wanted
        }
        if left != entries:
            self.write(kind, left)


def current(entry: Entry | None, asked: str) -> Entry | None:
    """Return an entry if it is there and answers what is asked now, else None."""
    return entry if entry is not None and entry.get(ASKED) == asked else None


def asked_hash(*parts: Any) -> str:
    """Return the hash of what is asked: plain data, in their order."""
    text = json.dumps(parts, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]


def case_json(case: CaseResult) -> dict[str, Any]:
    """Return what came of a case of a check as plain JSON data.

    Parameters
    ----------
    case : CaseResult
        What came of it.
    """
    done, meta = case.done, case.done.meta
    return {
        "scenario": case.scenario,
        "case": case.case,
        "status": case.status,
        "published": case.published,
        "note": case.note,
        "fast": case.coarsened,
        "compared": [asdict(one) for one in case.compared],
        "converged": case.converged,
        "guard": asdict(case.guarded.finding) if case.guarded and case.guarded.finding else None,
        "edge_length": meta.get("edge_length"),
        "step": meta.get("step"),
        "vertices": meta.get("vertices"),
        "seconds": done.seconds,
        "reused": done.reused,
        "error": {"kind": done.kind, "text": done.error} if done.kind else None,
        "change": asdict(case.change) if case.change else None,
        "run": str(case.folder),
        "verdict": done.verdict,
    }
