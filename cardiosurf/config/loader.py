"""From a config file to a checked config."""

import hashlib
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from cardiosurf.config.checks import check, resolved
from cardiosurf.config.decode import ConfigError, decode
from cardiosurf.config.document import Document
from cardiosurf.config.dump import dump_config
from cardiosurf.config.keys import fields_of
from cardiosurf.config.overrides import override
from cardiosurf.config.reader import parse_document, read_document
from cardiosurf.config.sections import LONGEST_NAME, Config
from cardiosurf.errors import InputError


@dataclass(frozen=True)
class Loaded:
    """A config, and what identifies it.

    Attributes
    ----------
    config : Config
        The config with all defaults, patch references replaced by the patches' regions.
    text : str
        The same as canonical YAML: loading it gives the same config.
    sha256 : str
        Of ``text``.
    document : Document
        The config as it was written, to name lines in messages.
    """

    config: Config
    text: str
    sha256: str
    document: Document

    @contextmanager
    def naming_lines(self) -> Iterator[None]:
        """Put file and line before the key path of any InputError raised inside.

        Errors that name no key of a config (a folder, say) pass as they are.
        """
        try:
            yield
        except InputError as error:
            first = error.where.removeprefix("region ").split(".")[0]
            if isinstance(error, ConfigError) or first not in fields_of(Config):
                raise
            raise self.document.placed(error) from None


def load(path: str | Path, overrides: Sequence[str] = ()) -> Loaded:
    """Load a config file.

    Parameters
    ----------
    path : path
        A YAML file.
    overrides : sequence of str
        ``--set`` options, ``key.path=value``, laid over the file in their order.

    Raises
    ------
    InputError
        With file, line and key path of everything that is wrong (as ConfigError, when the file
        could be read as YAML).
    """
    document = read_document(str(path))
    for option in overrides:
        document = override(document, option)
    return load_document(document)


def overlay(loaded: Loaded, overrides: Sequence[str]) -> Loaded:
    """Return a loaded config with ``--set`` options laid over it, in their order.

    Raises
    ------
    InputError
        As ``load`` does.
    """
    document = loaded.document
    for option in overrides:
        document = override(document, option)
    return load_document(document)


def load_text(text: str, name: str = "config") -> Loaded:
    """Load a config from its text; messages call it ``name``."""
    return load_document(parse_document(text, name))


def load_document(document: Document) -> Loaded:
    """Load a config from its data, whatever was laid over them.

    Raises
    ------
    InputError
        With the place of everything that is wrong (as ConfigError).
    """
    if "name" not in document.data:
        named = {"name": _safe_name(Path(document.file).stem), **document.data}
        document = replace(document, data=named)
    config = decode(document, Config)
    problems = sorted(check(config), key=lambda e: document.line(document.find(e.where)))
    if problems:
        raise ConfigError(document.file, [document.placed(error) for error in problems])
    config = resolved(config)
    text = dump_config(config)
    return Loaded(config, text, hashlib.sha256(text.encode()).hexdigest(), document)


def _safe_name(stem: str) -> str:
    """Return a file's stem as a word that can name a run."""
    word = re.sub(r"[^A-Za-z0-9_.-]+", "-", stem).strip("-._")
    return word[:LONGEST_NAME].rstrip("-._") or "simulation"
