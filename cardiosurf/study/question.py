"""What a search asks of each run: a word read off its verdict."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from cardiosurf.errors import InputError
from cardiosurf.spelling import did_you_mean

Verdict: TypeAlias = Mapping[str, Any]
"""A verdict as it stands in verdict.json."""

NO_CAPTURE = "no_capture"
NO_CONDUCTION = "no conduction"


@dataclass(frozen=True)
class Question:
    """What is asked of a run.

    Attributes
    ----------
    word : str
        One of ``QUESTIONS``.
    target : str or None
        The target it is about; None: all of them, or the whole run.
    """

    word: str = "conduction"
    target: str | None = None

    def answer(self, verdict: Verdict) -> str:
        """Return the answer in a verdict; a stimulus that started no wave is one by itself.

        Parameters
        ----------
        verdict : mapping
            verdict.json of a run.
        """
        if not verdict["captured"]:
            return NO_CAPTURE
        chosen = [t for t in verdict["targets"] if self.target in (None, t["name"])]
        return QUESTIONS[self.word](verdict, chosen)

    def is_open(self, verdict: Verdict) -> bool:
        """Return whether a longer run might answer differently: it ended before rest.

        Parameters
        ----------
        verdict : mapping
            verdict.json of a run.
        """
        return verdict["quiescent_at"] is None and self.answer(verdict) not in _SETTLED

    def __str__(self) -> str:
        """Return the question as ``parse_question`` reads it."""
        return self.word if self.target is None else f"{self.word}:{self.target}"


def _conducts(verdict: Verdict, targets: Sequence[Verdict]) -> str:
    whole = all(target["verdict"] == "conduction" for target in targets)
    return "conduction" if whole else NO_CONDUCTION


def _whole(verdict: Verdict, targets: Sequence[Verdict]) -> str:
    return str(verdict["verdict"])


def _reentry(verdict: Verdict, targets: Sequence[Verdict]) -> str:
    return str(verdict["reentry"]["verdict"])


def _of_target(verdict: Verdict, targets: Sequence[Verdict]) -> str:
    return str(targets[0]["verdict"])


def _route(verdict: Verdict, targets: Sequence[Verdict]) -> str:
    return str(targets[0]["route"] or "not activated")


QUESTIONS: dict[str, Callable[[Verdict, Sequence[Verdict]], str]] = {
    "conduction": _conducts,
    "verdict": _whole,
    "reentry": _reentry,
    "target": _of_target,
    "route": _route,
}
"""conduction: whether the target (each target) conducts; verdict: the whole verdict; reentry: its
verdict; target: the target's verdict, partial by itself; route: by which way it was activated."""
_NEEDS_TARGET = ("target", "route")
_TAKES_TARGET = ("conduction", *_NEEDS_TARGET)
# what was activated stays so, whatever else a longer run brings
_SETTLED = ("conduction", "direct", "indirect")


def parse_question(text: str, targets: Sequence[str]) -> Question:
    """Return the question that an option spells: ``WORD`` or ``WORD:TARGET``.

    Parameters
    ----------
    text : str
        What ``--of`` was given.
    targets : sequence of str
        The names of the config's targets.

    Raises
    ------
    InputError
        There is no such question or target.
    """
    word, colon, name = text.partition(":")
    where = f"--of {text}"
    listed = ", ".join(f"{one}:NAME" if one in _NEEDS_TARGET else one for one in QUESTIONS)
    if word not in QUESTIONS:
        guess = did_you_mean(word, QUESTIONS)
        raise InputError(where, " ".join(["there is no such question,", guess]).strip(" ,"), listed)
    if colon and word not in _TAKES_TARGET:
        raise InputError(where, f"{word} is of the whole run and takes no target", listed)
    if colon and name not in targets:
        guess = did_you_mean(name, targets)
        problem = f"the config has no target {name!r}" + (f", {guess}" if guess else "")
        raise InputError(where, problem, ", ".join(targets) or "none: the config has no targets")
    if word in _NEEDS_TARGET and not colon:
        example = targets[0] if targets else "NAME"
        raise InputError(where, "which target?", f"{word}:NAME", f"--of {word}:{example}")
    return Question(word, name if colon else None)
