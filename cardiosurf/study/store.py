"""Finished runs under the hash of all that they follow from, so that none is made twice."""

import hashlib
import json
import platform
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import cardiosurf
from cardiosurf.config import Loaded
from cardiosurf.recording.whole_file import whole_file
from cardiosurf.study.folder import VERDICT, RunFolder

RECORD = "run.json"
"""Beside a run's files: what the run was made for, and what it took."""
SCHEMA = "cardiosurf/run/1"

# what the numbers of a run come from; cli, report and the rest of study only arrange them
NUMERIC = (
    "expressions",
    "geometry",
    "tissue",
    "fem",
    "kinetics",
    "stepping",
    "recording",
    "analysis",
    "config/accuracy.py",
    "study/edges.py",
    "study/setup.py",
    "study/simulation.py",
)
_PACKAGES = ("numpy", "scipy", "numba")
_DIGITS = 16


@dataclass(frozen=True)
class RunRecord:
    """What a batch notes in the folder of a run.

    Attributes
    ----------
    key : str
        ``run_key`` of the run.
    seconds : float or None
        Wall time of the run; None: it was begun and is not finished.
    meta : mapping
        How it was computed (``Recording.meta``).
    verdict_sha256 : str or None
        Hash of the verdict.json that belongs to it.
    """

    key: str
    seconds: float | None = None
    meta: Mapping[str, Any] | None = None
    verdict_sha256: str | None = None


@dataclass(frozen=True)
class RunStore:
    """A folder of runs, each in a folder named by what it follows from.

    Attributes
    ----------
    root : Path
        The folder; made by the first run.
    """

    root: Path

    def folder_of(self, loaded: Loaded) -> Path:
        """Return the folder of a config's run, whether it is there or not."""
        return self.root / run_key(loaded)[:_DIGITS]

    def finished(self, loaded: Loaded) -> dict[str, Any] | None:
        """Return the verdict (verdict.json) of a config's finished run, None if there is none."""
        found = finished_run(self.folder_of(loaded), run_key(loaded))
        return None if found is None else found[0]


def run_key(loaded: Loaded) -> str:
    """Return the hash of all that a run follows from: its config and the program.

    Parameters
    ----------
    loaded : Loaded
        The config; its hash covers every key, defaults and name included.
    """
    return hashlib.sha256(f"{_program()} {loaded.sha256}".encode()).hexdigest()


def finished_run(folder: Path, key: str) -> tuple[dict[str, Any], RunRecord] | None:
    """Return verdict and record of the finished run in a folder, None unless it has this key.

    Parameters
    ----------
    folder : Path
        The folder of a run.
    key : str
        ``run_key`` of the run that is looked for.
    """
    record = read_record(folder)
    if record is None or record.key != key or record.seconds is None:
        return None
    try:
        text = (folder / VERDICT).read_bytes()
    except OSError:
        return None
    # another run may have replaced the one that the record is about
    if hashlib.sha256(text).hexdigest() != record.verdict_sha256:
        return None
    verdict: dict[str, Any] = json.loads(text)
    return verdict, record


def read_record(folder: Path) -> RunRecord | None:
    """Return the record in the folder of a run, None if there is none that can be read."""
    try:
        data = json.loads((folder / RECORD).read_text(encoding="utf-8"))
        if data.pop("schema") != SCHEMA:
            return None
        return RunRecord(**data)
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return None


def note_begun(folder: Path, key: str) -> None:
    """Note which run is being made in a folder, so that its checkpoint is not taken for another's.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    _write(folder, RunRecord(key))


def note_finished(folder: Path, key: str, seconds: float, meta: Mapping[str, Any]) -> RunRecord:
    """Note that the run in a folder is finished, and return the record.

    Parameters
    ----------
    folder : Path
        The folder of the run; its verdict.json is there.
    key : str
        ``run_key`` of the run.
    seconds : float
        Its wall time.
    meta : mapping
        How it was computed.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    sha256 = hashlib.sha256((folder / VERDICT).read_bytes()).hexdigest()
    record = RunRecord(key, seconds, meta, sha256)
    _write(folder, record)
    return record


def forget(folder: Path) -> None:
    """Remove the record of a run that came to nothing, and the folder if nothing else is in it."""
    if RunFolder(folder).resumable or RunFolder(folder).finished:
        return
    with suppress(OSError):
        (folder / RECORD).unlink(missing_ok=True)
        folder.rmdir()


def _write(folder: Path, record: RunRecord) -> None:
    with whole_file(folder / RECORD) as partial:
        folder.mkdir(parents=True, exist_ok=True)
        data = {"schema": SCHEMA, **asdict(record)}
        partial.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")


@cache
def _program() -> str:
    """Return the hash of the sources and packages that the numbers of a run come from."""
    versions = " ".join(version(package) for package in _PACKAGES)
    found = hashlib.sha256(f"{versions} {platform.machine()}".encode())
    root = Path(str(cardiosurf.__file__)).parent
    for name in NUMERIC:
        place = root / name
        for file in sorted(place.rglob("*.py")) if place.is_dir() else [place]:
            relative = file.relative_to(root).as_posix()
            found.update(relative.encode() + b"\0" + file.read_bytes() + b"\0")
    return found.hexdigest()
