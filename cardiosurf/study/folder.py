"""The folder of a run: complete, resumable, or empty, and never anything in between."""

import os
import shutil
from dataclasses import dataclass
from pathlib import Path

from cardiosurf.errors import InputError
from cardiosurf.recording.whole_file import unwritable, whole_file


@dataclass(frozen=True)
class RunFolder:
    """Where a run keeps its files.

    Attributes
    ----------
    path : Path
        The folder. ``verdict.json`` in it is written last, so it marks a finished run.
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
    def recording(self) -> Path:
        """The recording of a finished run."""
        return self.path / "recording.h5"

    @property
    def verdict(self) -> Path:
        """The verdict of a finished run."""
        return self.path / "verdict.json"

    @property
    def config(self) -> Path:
        """The resolved config."""
        return self.path / "config.yaml"

    def open(self, *, overwrite: bool, resume: bool) -> bool:
        """Make the folder ready for a run; return whether there is something to resume.

        Parameters
        ----------
        overwrite : bool
            Whether a finished run in it may be replaced. It stays in place until the new one is
            complete.
        resume : bool
            Whether to go on from an unfinished run.

        Raises
        ------
        InputError
            If the folder holds a finished run and ``overwrite`` is not given, or an unfinished
            one and neither that nor ``resume``, or if it cannot be written to.
        """
        if self.verdict.exists() and not overwrite:
            raise InputError(
                str(self.path),
                "this folder holds a finished run",
                "an empty or new folder, or --overwrite",
                f"add --overwrite, or give another folder: -o {self.path}-2",
            )
        if self.checkpoint.exists() and not (overwrite or resume):
            raise InputError(
                str(self.path),
                "this folder holds an unfinished run",
                "--resume goes on with it, --overwrite starts again",
                "add --resume",
            )
        resuming = resume and self.checkpoint.exists()
        try:
            if not resuming:
                self.discard_partial()
            self.partial.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise unwritable(self.path, error) from error
        if not os.access(self.partial, os.W_OK):
            raise unwritable(self.path, PermissionError(13, "Permission denied"))
        return resuming

    def discard_partial(self) -> None:
        """Remove what an unfinished run left, and the folder too if nothing else is in it."""
        if self.partial.exists():
            shutil.rmtree(self.partial)

    def abandon(self) -> None:
        """Leave nothing of a run that failed or was stopped and cannot be resumed."""
        self.discard_partial()
        if self.path.is_dir() and not any(self.path.iterdir()):
            self.path.rmdir()

    def write_text(self, path: Path, text: str) -> None:
        """Write a text file into the folder, whole or not at all."""
        with whole_file(path) as partial:
            partial.write_text(text, encoding="utf-8")
