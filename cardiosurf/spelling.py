"""The nearest right spelling of a wrong word."""

from collections.abc import Iterable
from difflib import get_close_matches


def nearest(word: str, known: Iterable[str]) -> str | None:
    """Return the word of ``known`` that ``word`` is most likely a misspelling of, or None.

    Examples
    --------
    >>> nearest("boks", ["box", "ball"])
    'box'
    """
    by_folded = {candidate.lower(): candidate for candidate in known}
    folded = word.lower()
    matches = get_close_matches(folded, by_folded, n=1, cutoff=0.55)
    if matches:
        return by_folded[matches[0]]
    # a word cut short is a likely slip too ("rogers" for "rogers_mcculloch"), and so is the reverse
    starts = [k for k in by_folded if len(folded) > 2 and k.startswith(folded)]
    return by_folded[starts[0]] if len(starts) == 1 else None


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return ``did you mean 'box'?``, or nothing when no word is near."""
    close = nearest(word, known)
    return f"did you mean {close!r}?" if close else ""
