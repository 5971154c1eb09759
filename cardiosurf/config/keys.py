"""What the types of the sections say about a key path: which keys there are, what is allowed."""

import dataclasses
import types
from collections.abc import Iterator
from functools import cache
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import annotated_types
from pydantic import Discriminator, Tag
from pydantic.fields import FieldInfo

from cardiosurf.config.accuracy import Accuracy
from cardiosurf.config.document import KeyPath
from cardiosurf.config.unions import KeyedBy
from cardiosurf.geometry.angles import Angle
from cardiosurf.sections import Worded


@dataclasses.dataclass(frozen=True)
class Choice:
    """A union whose member is chosen by a key (``key`` is its name) or by its one word."""

    members: dict[str, Any]
    key: str | None
    worded: Worded | None = None


def yaml_name(field_name: str) -> str:
    """Return a field's YAML key: ``not_`` is written ``not``."""
    return field_name.rstrip("_")


@cache
def fields_of(section: type) -> dict[str, Any]:
    """Return the YAML keys of a section and their types."""
    hints = get_type_hints(section, include_extras=True)
    return {yaml_name(field.name): hints[field.name] for field in dataclasses.fields(section)}


def is_required(section: type, key: str) -> bool:
    """Tell whether a section's key has no default."""
    for field in dataclasses.fields(section):
        if yaml_name(field.name) == key:
            missing = dataclasses.MISSING
            return field.default is missing and field.default_factory is missing
    return False


def choice_of(annotation: Any) -> Choice | None:
    """Return the choice that a type stands for, or None when there is nothing to choose."""
    for bare, metadata in _layers(annotation):
        if any(isinstance(item, Discriminator) for item in metadata):
            members = {_tag_of(member): member for member in get_args(bare)}
            for item in metadata:
                if isinstance(item, KeyedBy):
                    return Choice(members, item.key)
            worded = [item for item in metadata if isinstance(item, Worded)]
            return Choice(members, None, *worded)
    return None


def follow(annotation: Any, location: tuple[str | int, ...]) -> tuple[KeyPath, Any]:
    """Follow the location of a pydantic error from a type.

    Parameters
    ----------
    annotation : type
        The type that was being decoded.
    location : tuple
        Keys, indices, and between them the tags and branches of unions.

    Returns
    -------
    tuple
        The key path, without tags and branches, and the type there (None when there is no such
        key). A wrong or missing last key stays in the path.
    """
    path: list[str | int] = []
    for word in location:
        choice = choice_of(annotation)
        if choice is not None and isinstance(word, str) and word in choice.members:
            annotation = choice.members[word]
            continue
        inner = [child for child in _children(annotation, word) if child is not None]
        if not inner and isinstance(word, str) and _is_plain_union(annotation):
            continue
        path.append(word)
        annotation = inner[0] if inner else None
    return tuple(path), annotation


def section_of(annotation: Any) -> type | None:
    """Return the section class that a type stands for, if it is one."""
    for bare, _ in _layers(annotation):
        if dataclasses.is_dataclass(bare) and isinstance(bare, type):
            return bare
    return None


def items_of(annotation: Any) -> Iterator[Any]:
    """Yield the types of what a list, a mapping or a plain union holds."""
    for bare, _ in _layers(annotation):
        if get_origin(bare) in {tuple, dict} or _is_union(bare):
            yield from (item for item in get_args(bare) if item is not Ellipsis)


def describe(annotation: Any) -> str:
    """Return what a type allows, in words for a message."""
    if annotation == Angle:
        return "an angle: radians, a multiple of pi (-3*pi/4) or degrees (45 deg)"
    if annotation == Accuracy:
        return "a percentage from 0.05 % to 5 %, or a fraction such as 0.005"
    choice, section = choice_of(annotation), section_of(annotation)
    if choice is not None:
        text = _describe_choice(choice)
    elif section is not None:
        text = f"a mapping with the keys {', '.join(fields_of(section))}"
    else:
        bare, metadata = next(_layers(annotation))
        text = _describe_value(bare, metadata)
    return text


def words_of(annotation: Any) -> list[str]:
    """Return the words among the values that a type allows."""
    bare, _ = next(_layers(annotation))
    if get_origin(bare) is Literal:
        return [word for word in get_args(bare) if isinstance(word, str)]
    if _is_union(bare):
        return [word for member in get_args(bare) for word in words_of(member)]
    return []


def _describe_choice(choice: Choice) -> str:
    if "(by axis)" in choice.members:
        return " or ".join(describe(member) for member in choice.members.values())
    words = ", ".join(tag.strip("()") for tag in choice.members)
    if choice.worded is None:
        return f"a mapping with {choice.key}: {words}"
    return f"{choice.worded.what}, one of {words}"


def _describe_value(bare: Any, metadata: tuple[Any, ...]) -> str:
    arguments = get_args(bare)
    if _is_union(bare):
        given = [member for member in arguments if member is not type(None)]
        # null is worth a word beside a plain value only, where it switches something off
        is_list = get_origin(next(_layers(given[0]))[0]) is tuple
        shown = given if is_list else arguments
        return " or ".join(dict.fromkeys(describe(member) for member in shown))
    if get_origin(bare) is Literal:
        return ", ".join(str(word) for word in arguments)
    if get_origin(bare) is tuple:
        return _describe_list(arguments, metadata)
    if get_origin(bare) is dict:
        return f"a mapping from words to {describe(arguments[1])}"
    for item in metadata:
        if isinstance(item, FieldInfo) and item.description:
            return item.description
    return _NAMES.get(bare, str(bare)) + _limits(metadata)


_NAMES = {
    float: "a number",
    int: "a whole number",
    bool: "true or false",
    str: "text",
    type(None): "null",
    Any: "any value",
}


def _describe_list(items: tuple[Any, ...], metadata: tuple[Any, ...]) -> str:
    if items[-1] is Ellipsis:
        least = any(isinstance(item, annotated_types.MinLen) for item in _spread(metadata))
        return "a list of at least 1 item" if least else "a list"
    inner = describe(items[0])
    if inner == "a number" and len(items) == 2:
        return "a list of 2 numbers, [low, high]"
    names = "[low, high]" if len(items) == 2 else "[x, y, z]"
    return f"a list of {len(items)} numbers" if inner == "a number" else f"{names}, each {inner}"


def _limits(metadata: tuple[Any, ...]) -> str:
    found: list[str] = []
    low, high = (_limit(metadata, key) for key in ("ge", "le"))
    if low is not None and high is not None:
        return f" from {low:g} to {high:g}"
    for item in _spread(metadata):
        for attribute, words in _LIMIT_WORDS.items():
            limit = getattr(item, attribute, None)
            if limit is not None:
                found.append(f"{words} {limit:g}")
    return (" " + " and ".join(found)) if found else ""


def _limit(metadata: tuple[Any, ...], key: str) -> float | None:
    limits = (getattr(item, key, None) for item in _spread(metadata))
    return next((limit for limit in limits if limit is not None), None)


_LIMIT_WORDS = {
    "gt": "above",
    "ge": "of at least",
    "lt": "below",
    "le": "of at most",
}


def _spread(metadata: tuple[Any, ...]) -> Iterator[Any]:
    for item in metadata:
        if isinstance(item, FieldInfo):
            yield from item.metadata
        else:
            yield item


def _layers(annotation: Any) -> Iterator[tuple[Any, tuple[Any, ...]]]:
    """Yield a type without its annotations, and inside an optional one what is not None."""
    metadata: tuple[Any, ...] = ()
    while get_origin(annotation) is Annotated:
        metadata += annotation.__metadata__
        annotation = annotation.__origin__
    yield annotation, metadata
    if _is_union(annotation):
        inner = [member for member in get_args(annotation) if member is not type(None)]
        if len(inner) == 1:
            yield from _layers(inner[0])


def _is_union(bare: Any) -> bool:
    return get_origin(bare) in {Union, types.UnionType}


def _is_plain_union(annotation: Any) -> bool:
    """Tell whether pydantic tries the members in turn, and names the branch in its errors."""
    bare, _ = next(_layers(annotation))
    return _is_union(bare) and choice_of(annotation) is None


def _tag_of(member: Any) -> str:
    _, metadata = next(_layers(member))
    return next((item.tag for item in metadata if isinstance(item, Tag)), "")


def _children(annotation: Any, word: str | int) -> Iterator[Any]:
    """Yield the types that ``word`` leads to, one for each member of a plain union."""
    for bare, _ in _layers(annotation):
        origin, arguments = get_origin(bare), get_args(bare)
        if dataclasses.is_dataclass(bare) and isinstance(bare, type):
            yield fields_of(bare).get(str(word))
        elif origin is dict:
            yield arguments[1]
        elif origin is tuple and isinstance(word, int):
            yield (
                arguments[0] if arguments[-1] is Ellipsis else dict(enumerate(arguments)).get(word)
            )
