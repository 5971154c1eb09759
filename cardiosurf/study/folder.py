"""The folder of a run: complete, resumable, or empty, and never anything in between."""

import json
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from cardiosurf.errors import InputError
from cardiosurf.recording.signals import held_signals
from cardiosurf.recording.whole_file import sync, unwritable, whole_file
from cardiosurf.study.lock import NAME, locked

RECORDING, CONFIG, VERDICT = "recording.h5", "config.yaml", "verdict.json"
FILES = (RECORDING, "recording.xdmf", "recording_maps.xdmf", CONFIG, VERDICT)
"""What a run may write, the verdict last: it marks a finished run."""
_DRAWN = ("activation_map", "vein_unrolled", "activation_count", "reentry_map", "probe_traces")
FIGURES = (
    *(f"{stem}.{ending}" for stem in _DRAWN for ending in ("png", "svg", "pdf")),
    "relative_acceleration.png",
    "relative_acceleration.vtu",
)
"""What ``plot`` and ``analyze`` make of a run; a new run makes them wrong."""


@dataclass(frozen=True)
class RunFolder:
    """Where a run keeps its files.

    Attributes
    ----------
    path : Path
        The folder. ``verdict.json`` in it is put there last, so it marks a finished run.
    """

    path: Path

    @property
    def partial(self) -> Path:
        """Where an unfinished run works."""
        return self.path / ".partial"

    @property
    def checkpoint(self) -> Path:
        """The state that an unfinished run can be resumed from."""
        return self.partial / "checkpoint.npz"

    @property
    def spool(self) -> Path:
        """The frames of an unfinished run."""
        return self.partial / "frames.bin"

    @property
    def staged(self) -> Path:
        """Where all files of a run are written before any is put into place."""
        return self.partial / "files"

    @property
    def resumable(self) -> bool:
        """Whether the folder holds an unfinished run that can be gone on with."""
        # unlike Path.exists, this is no error where a name is too long or access is denied
        return os.path.exists(self.checkpoint)  # noqa: PTH110

    @property
    def finished(self) -> bool:
        """Whether the folder holds a finished run: a verdict that cardiosurf wrote."""
        try:
            verdict = json.loads((self.path / VERDICT).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return False
        schema = verdict.get("schema") if isinstance(verdict, dict) else None
        return str(schema).startswith("cardiosurf/verdict/")

    @contextmanager
    def in_use(self) -> Iterator[None]:
        """Keep other runs out of the folder, and leave nothing behind that says nothing.

        Raises
        ------
        InputError
            Another run is working in the folder, or it cannot be written to.
        """
        with locked(self.partial):
            try:
                yield
            finally:
                self._tidy()

    def open(self, *, overwrite: bool, resume: bool) -> bool:
        """Make the folder ready for a run; return whether there is something to resume.

        Parameters
        ----------
        overwrite : bool
            Whether a finished run in it may be replaced. It stays in place until the new one is
            complete.
        resume : bool
            Whether to go on from an unfinished run. One that was to replace a finished run may.

        Raises
        ------
        InputError
            If the folder holds a finished run and ``overwrite`` is not given, or an unfinished
            one and neither that nor ``resume``, or files of others that the run would replace,
            or if it cannot be written to.
        """
        self._check_names()
        resuming = resume and self.resumable
        if self.finished and not (overwrite or resuming):
            raise InputError(
                str(self.path),
                "this folder holds a finished run",
                "an empty or new folder, or --overwrite",
                f"add --overwrite, or give another folder: -o {self.path}-2",
            )
        if self.resumable and not (overwrite or resume):
            raise InputError(
                str(self.path),
                "this folder holds an unfinished run",
                "--resume goes on with it, --overwrite starts again",
                "add --resume",
            )
        for folder in (self.path, self.partial):
            if not os.access(folder, os.W_OK):
                raise unwritable(folder, PermissionError(13, "Permission denied"))
        if not resuming:
            self._empty_partial()
        return resuming

    def _check_names(self) -> None:
        """Refuse a folder where what a run writes would replace what no run wrote."""
        present = [self.path / name for name in FILES if os.path.lexists(self.path / name)]
        for path in present:
            if path.is_dir():
                raise InputError(
                    str(path),
                    "a folder is in the way: the run would write a file of this name",
                    "an empty or new folder",
                    f"move it, or give another folder: -o {self.path}-2",
                )
        # all files staged: a run that was killed while it put them into place
        ours = self.finished or (self.staged / VERDICT).exists()
        if present and not ours:
            raise InputError(
                str(present[0]),
                "is in the way: the run would replace it, and it belongs to no finished run",
                "an empty or new folder, or that of a run",
                f"move the file, or give another folder: -o {self.path / 'run'}",
            )

    def stage(self) -> None:
        """Make an empty place for the files of a run."""
        try:
            if self.staged.exists():
                shutil.rmtree(self.staged)
            self.staged.mkdir()
        except OSError as error:
            raise unwritable(self.staged, error) from error

    def publish(self) -> None:
        """Put the staged files into place, the verdict last, and end the unfinished run.

        Files of an earlier run that this one does not replace, and figures of it, are removed.

        Raises
        ------
        InputError
            A file cannot be put into place.
        KeyboardInterrupt
            A signal came meanwhile; all is in place then.
        """
        with held_signals():
            try:
                for name in FILES:
                    if (self.staged / name).exists():
                        sync(self.staged / name)
                # while files are replaced, an old verdict must not stand beside a new recording
                (self.path / VERDICT).unlink(missing_ok=True)
                if (self.path / RECORDING).exists():
                    for name in FIGURES:
                        (self.path / name).unlink(missing_ok=True)
                for name in FILES:
                    if (self.staged / name).exists():
                        (self.staged / name).replace(self.path / name)
                    else:
                        (self.path / name).unlink(missing_ok=True)
            except OSError as error:
                raise unwritable(self.path, error) from error
            self.discard_partial()

    def discard_partial(self) -> None:
        """Remove what an unfinished run left."""
        if self.partial.exists():
            shutil.rmtree(self.partial)

    def write_text(self, path: Path, text: str, *, synced: bool = True) -> None:
        """Write a text file into the folder, whole or not at all (``whole_file``)."""
        with whole_file(path, synced=synced) as partial:
            partial.write_text(text, encoding="utf-8")

    def _empty_partial(self) -> None:
        """Remove all but the lock."""
        try:
            for inside in self.partial.iterdir():
                if inside.is_dir():
                    shutil.rmtree(inside)
                elif inside.name != NAME:
                    inside.unlink()
        except OSError as error:
            raise unwritable(self.partial, error) from error

    def _tidy(self) -> None:
        """Remove the place of an unfinished run if only the lock is in it, then an empty folder."""
        with suppress(OSError):  # another run may be moving in
            if self.partial.exists():
                if {inside.name for inside in self.partial.iterdir()} - {NAME}:
                    return
                (self.partial / NAME).unlink(missing_ok=True)
                self.partial.rmdir()
            self.path.rmdir()
