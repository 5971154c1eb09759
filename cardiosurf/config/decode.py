"""Plain data to typed sections; every mistake with its place, what is allowed, what was meant."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError
from pydantic_core import ErrorDetails

from cardiosurf.config.document import Document, KeyPath
from cardiosurf.config.keys import (
    choice_of,
    describe,
    fields_of,
    follow,
    is_required,
    section_of,
    words_of,
)
from cardiosurf.errors import InputError
from cardiosurf.sections import Worded
from cardiosurf.spelling import did_you_mean

Root = TypeVar("Root")
_MOST_PROBLEMS = 10


class ConfigError(InputError):
    """What is wrong in one config file, all of it; ``problems`` holds each by itself."""

    def __init__(self, file: str, problems: Sequence[InputError]) -> None:
        first = problems[0]
        super().__init__(first.where, first.problem, first.allowed, first.hint)
        self.file = file
        self.problems = tuple(problems)

    def __str__(self) -> str:
        """Return the problems one below the other."""
        if len(self.problems) == 1:
            return str(self.problems[0])
        shown = [str(problem) for problem in self.problems[:_MOST_PROBLEMS]]
        more = len(self.problems) - len(shown)
        if more:
            shown.append(f"... and {more} more")
        return "\n".join([f"{self.file}: {len(self.problems)} problems", *shown])


@dataclass(frozen=True)
class _Mistake:
    """One thing that is wrong, at a key path."""

    path: KeyPath
    problem: str
    allowed: str = ""
    hint: str = ""


@cache
def adapter_of(root: Any) -> TypeAdapter[Any]:
    """Return pydantic's adapter of a section."""
    return TypeAdapter(root)


def decode(document: Document, root: type[Root]) -> Root:
    """Return the config or scenario that a document's data spell.

    Parameters
    ----------
    document : Document
        The data.
    root : type
        The section that the whole file is.

    Raises
    ------
    ConfigError
        With every mistake pydantic found, in the order of the file.
    """
    try:
        # strict mode takes a mapping for a dataclass and a list for a tuple from JSON only
        hashable: Any = root  # mypy doubts it
        decoded: Root = adapter_of(hashable).validate_json(json.dumps(document.data))
        return decoded  # noqa: TRY300
    except ValidationError as error:
        details = error.errors(include_url=False)
    mistakes: dict[KeyPath, _Mistake] = {}
    for detail in details:
        mistake = _mistake(detail, root)
        known = mistakes.get(mistake.path)
        # members of a plain union complain one by one about the same value
        if known is None or not known.allowed:
            mistakes[mistake.path] = mistake
    problems = [
        InputError(document.where(m.path), m.problem, m.allowed, m.hint)
        for m in sorted(mistakes.values(), key=lambda m: document.line(m.path))
        if not _follows_from_another(m, mistakes, document)
    ]
    raise ConfigError(document.file, problems)


def _follows_from_another(
    mistake: _Mistake, mistakes: dict[KeyPath, _Mistake], document: Document
) -> bool:
    """Tell whether a list is said to be too short only because its items are wrong."""
    deeper = any(path[: len(mistake.path)] == mistake.path != path for path in mistakes)
    return deeper and "item" in mistake.problem


def _mistake(detail: ErrorDetails, root: type) -> _Mistake:
    path, annotation = follow(root, detail["loc"])
    kind = detail["type"]
    if kind in {"unexpected_keyword_argument", "extra_forbidden"}:
        return _unknown_key(detail, path, root)
    if kind == "missing":
        return _missing(detail, path, annotation, root)
    if kind in {"union_tag_invalid", "union_tag_not_found"}:
        choice = choice_of(annotation)
        words = [tag.strip("()") for tag in choice.members] if choice is not None else []
        if choice is not None and choice.worded is not None:
            return _wrong_word(path, detail["input"], words, choice.worded)
        if choice is not None and choice.key is not None:
            return _wrong_choice(path, detail["input"], choice.key, words)
    value = detail["input"]
    problem = f"{show(value)} {_complaint(detail, annotation)}"
    guess = did_you_mean(value, words_of(annotation)) if isinstance(value, str) else ""
    problem += f", {guess}" if guess else ""
    return _Mistake(path, problem, describe(annotation), _advice(value, annotation))


def _unknown_key(detail: ErrorDetails, path: KeyPath, root: type) -> _Mistake:
    _, parent = follow(root, detail["loc"][:-1])
    section = section_of(parent)
    known = list(fields_of(section)) if section else []
    wrong = str(path[-1])
    guess = did_you_mean(wrong, known)
    problem = f"unknown key {wrong!r}" + (f", {guess}" if guess else "")
    return _Mistake(path, problem, ", ".join(known))


def _missing(detail: ErrorDetails, path: KeyPath, annotation: Any, root: type) -> _Mistake:
    if isinstance(path[-1], int):
        _, parent = follow(root, detail["loc"][:-1])
        given = detail["input"]
        count = len(given) if isinstance(given, list) else 0
        return _Mistake(path[:-1], f"{show(given)} has {_items(count)}", describe(parent))
    return _Mistake(path, f"key {path[-1]!r} is missing", describe(annotation))


def _wrong_choice(path: KeyPath, value: Any, key: str, words: list[str]) -> _Mistake:
    allowed = ", ".join(words)
    if not isinstance(value, dict):
        problem = f"{show(value)} is not a mapping with the key {key!r}"
        return _Mistake(path, problem, allowed, f"{key}: {words[0]}")
    if key not in value:
        return _Mistake((*path, key), f"key {key!r} is missing", allowed)
    given = value[key]
    guess = did_you_mean(given, words) if isinstance(given, str) else ""
    problem = f"unknown {key} {show(given)}" + (f", {guess}" if guess else "")
    return _Mistake((*path, key), problem, allowed)


def _wrong_word(path: KeyPath, value: Any, words: list[str], worded: Worded) -> _Mistake:
    allowed = ", ".join(words)
    if not isinstance(value, dict):
        return _Mistake(path, f"{show(value)} is not {worded.what}", allowed, worded.example)
    unknown = [word for word in value if word not in words]
    if unknown:
        guess = did_you_mean(unknown[0], words)
        kind = worded.what.removeprefix("a ")
        problem = f"unknown {kind} word {unknown[0]!r}" + (f", {guess}" if guess else "")
        return _Mistake((*path, unknown[0]), problem, allowed)
    if not value:
        return _Mistake(path, f"{{}} is not {worded.what}", allowed, worded.example)
    problem = f"{worded.what} has one word, this one has {len(value)}: {', '.join(value)}"
    if not worded.joined:
        return _Mistake(path, problem, allowed, worded.example)
    both = ", ".join(f"{{{word}: ...}}" for word in value)
    return _Mistake(
        path,
        problem,
        allowed,
        f"{{all: [{both}]}} where they overlap, {{any: [{both}]}} for all of them",
    )


def _complaint(detail: ErrorDetails, annotation: Any) -> str:
    """Return what is wrong with a value, as the end of a sentence that begins with it."""
    context: dict[str, Any] = dict(detail.get("ctx", {}))
    kind = detail["type"]
    section = section_of(annotation)
    if section is not None or kind == "dict_type":
        return "is not a mapping"
    if kind in {"too_short", "too_long"}:
        return f"has {_items(int(context.get('actual_length') or 0))}"
    if kind == "value_error":
        return str(context["error"])
    fixed = {
        "finite_number": "is not a finite number",
        "float_type": "is not a number",
        "int_type": "is not a whole number",
        "int_from_float": "is not a whole number",
        "bool_type": "is neither true nor false",
        "string_type": "is not text",
        "tuple_type": "is not a list",
        "literal_error": "is not allowed",
        "string_pattern_mismatch": "has characters that a name cannot have",
    }
    if kind in fixed:
        return fixed[kind]
    limits = {
        "greater_than": ("is not above", "gt"),
        "greater_than_equal": ("is below", "ge"),
        "less_than": ("is not below", "lt"),
        "less_than_equal": ("is above", "le"),
    }
    if kind in limits:
        words, key = limits[kind]
        if kind == "greater_than_equal" and context[key] > 0 >= detail["input"]:
            words, key = "is not above", ""
        return f"{words} {context.get(key, 0):g}"
    return f"is refused ({detail['msg'].lower()})"


def _advice(value: Any, annotation: Any) -> str:
    """Return the likely slip behind a wrong value, if there is one."""
    if isinstance(value, str):
        if value.lower() in _SWITCHES and "true or false" in describe(annotation):
            return _SWITCHES[value.lower()]
        try:
            float(value)
        except ValueError:
            return ""
        return f"remove the quotes: {value}"
    if isinstance(value, dict) and describe(annotation).startswith("a list"):
        return "put it in a list: begin it with '- '"
    section = section_of(annotation)
    if section is not None and not isinstance(value, dict):
        required = [key for key in fields_of(section) if is_required(section, key)]
        return f"{{{required[0]}: {show(value)}}}" if len(required) == 1 else ""
    return ""


_SWITCHES = {"yes": "true", "on": "true", "no": "false", "off": "false"}


def _items(count: int) -> str:
    return f"{count} item" + "s" * (count != 1)


def show(value: Any) -> str:
    """Return a value as it is written in YAML, cut to a readable length."""
    if isinstance(value, float) and value != value:  # noqa: PLR0124 - NaN only differs from itself
        return ".nan"
    if value in (float("inf"), float("-inf")):
        return "-.inf" if value < 0 else ".inf"
    text = repr(value) if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:57]}..."
