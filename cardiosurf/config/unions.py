"""Sections that come in several kinds, told apart by one key (``kind``, ``model``, ``shape``)."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce
from operator import or_
from typing import Annotated, Any

from pydantic import Discriminator, Tag


@dataclass(frozen=True)
class KeyedBy:
    """The key that tells the kinds of a section apart, and the kind that holds without it."""

    key: str
    default: str | None = None


def keyed_union(key: str, registry: Mapping[str, Any], default: str | None = None) -> Any:
    """Return the type "one of the registry's classes, chosen by ``key``" for a section's field.

    Parameters
    ----------
    key : str
        The YAML key that names the class.
    registry : mapping of str to class
        The classes by that name.
    default : str, optional
        The name that holds when the key is not given; without it the key is required.
    """

    def tag_of(value: Any) -> str | None:
        # a default of the section is an object already
        given = value.get(key, default) if isinstance(value, dict) else getattr(value, key, None)
        return f"({given})" if isinstance(given, str) else None

    tagged = [Annotated[section, Tag(f"({name})")] for name, section in registry.items()]
    return Annotated[reduce(or_, tagged), Discriminator(tag_of), KeyedBy(key, default)]
