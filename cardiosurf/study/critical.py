"""Critical values: where the answer of a computation changes, on one mesh after the other.

Nothing here knows of runs. What is searched is a function of a value and a level (0 is the
coarsest mesh) whose answers are words, and which may change more than once.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import ceil, floor, log10
from typing import TypeAlias

Answer: TypeAlias = str
Ask: TypeAlias = Callable[[int, Sequence[float]], Sequence[Answer]]
"""The answers at some values on a level; it may find them side by side."""

FIRST_SHIFT = 0.5
"""How far a change is expected to move from the coarsest level to the next, in scan intervals."""
MARGIN = 3.0
"""Half width of the first bracket on a finer level, in tolerances at least."""


@dataclass(frozen=True)
class Bracket:
    """Two neighbouring values with different answers.

    Attributes
    ----------
    low, high : float
        The values.
    below, above : str
        The answers at them.
    """

    low: float
    high: float
    below: Answer
    above: Answer

    @property
    def value(self) -> float:
        """The middle."""
        return 0.5 * (self.low + self.high)

    @property
    def half_width(self) -> float:
        """How far the change may be from the middle."""
        return 0.5 * (self.high - self.low)

    @property
    def kind(self) -> tuple[Answer, Answer]:
        """From which answer to which."""
        return self.below, self.above


@dataclass(frozen=True)
class Change:
    """A change of the answer, followed over the levels.

    Attributes
    ----------
    below, above : str
        The answers below and above it.
    brackets : tuple of Bracket or None
        Where it lies on each level, the coarsest first; None: it is not there.
    """

    below: Answer
    above: Answer
    brackets: tuple[Bracket | None, ...]


@dataclass(frozen=True)
class Search:
    """Where to look, and how closely.

    Attributes
    ----------
    low, high : float
        Between which values.
    tolerance : float
        Half width of a final bracket at most.
    scan : int
        Number of values that are tried first, on the coarsest level; two changes between two of
        them are not seen.
    parallel : int
        How many values are asked for at a time where that saves time.
    most : int
        Bound for the values tried on one level; brackets stay wide where it is reached.
    """

    low: float
    high: float
    tolerance: float
    scan: int = 9
    parallel: int = 1
    most: int = 200

    def tidy(self, value: float) -> float:
        """Return a value with no more digits than a hundredth of the tolerance."""
        digits = 2 - floor(log10(self.tolerance))
        return min(max(round(value, digits), self.low), self.high)


@dataclass
class _Level:
    """What is known of one level."""

    number: int
    search: Search
    ask: Ask
    answers: dict[float, Answer] = field(default_factory=dict)

    def learn(self, values: Sequence[float]) -> None:
        """Ask for the answers at values that are not known yet, as far as the bound allows."""
        room = self.search.most - len(self.answers)
        tidied = dict.fromkeys(self.search.tidy(value) for value in values)
        new = [value for value in tidied if value not in self.answers][: max(room, 0)]
        if new:
            self.answers |= dict(zip(new, self.ask(self.number, new), strict=True))

    def brackets(self) -> list[Bracket]:
        """Return all changes, each between the nearest values that are known."""
        known = sorted(self.answers.items())
        return [
            Bracket(low, high, below, above)
            for (low, below), (high, above) in pairwise(known)
            if below != above
        ]


def find_changes(ask: Ask, sizes: Sequence[float], search: Search) -> tuple[Change, ...]:
    """Return every change of the answer, followed from the coarsest level to the finest.

    The coarsest level is scanned. A finer one begins with a bracket around each change of the
    level before, and with both ends of the interval, so that a change which came or went in
    between is noticed.

    Parameters
    ----------
    ask : function
        The answers at some values on a level.
    sizes : sequence of float
        Edge length of each level, falling; the shift from one to the next is expected to go with
        its square.
    search : Search
        Where to look, and how closely.
    """
    changes: list[Change] = []
    for number in range(len(sizes)):
        level = _Level(number, search, ask)
        if number == 0:
            step = (search.high - search.low) / (search.scan - 1)
            level.learn([search.low + i * step for i in range(search.scan)])
        else:
            expected = [_expected(change, sizes, number, search) for change in changes]
            _enclose(level, changes, expected)
        _narrow(level)
        changes = _follow(changes, level.brackets(), number)
    return tuple(changes)


def _narrow(level: _Level) -> None:
    """Divide the bracket of every change until each is narrow enough."""
    search = level.search
    while True:
        # rounding must not call for another division
        goal = search.tolerance * (1.0 + 1e-9)
        wide = [found for found in level.brackets() if found.half_width > goal]
        known = len(level.answers)
        each = max(1, search.parallel // len(wide)) if wide else 0
        level.learn([value for found in wide for value in _inside(found, each, search.tolerance)])
        if len(level.answers) == known:
            return


def _inside(bracket: Bracket, count: int, tolerance: float) -> Iterator[float]:
    """Yield values that divide a bracket into ``count`` + 1 parts, or as many as are needed."""
    parts = min(count + 1, max(2, ceil(bracket.half_width / tolerance)))
    for number in range(1, parts):
        yield bracket.low + (bracket.high - bracket.low) * number / parts


def _expected(
    change: Change, sizes: Sequence[float], number: int, search: Search
) -> tuple[float, float]:
    """Return where a change is expected on a level, as low and high."""
    known = [(i, b) for i, b in enumerate(change.brackets) if b is not None]
    last, bracket = known[-1]
    floor_ = MARGIN * search.tolerance
    if len(known) == 1:
        shift = FIRST_SHIFT * (search.high - search.low) / (search.scan - 1)
        half = max(floor_, shift)
        return bracket.value - half, bracket.value + half
    before, other = known[-2]
    ratio = (sizes[last] ** 2 - sizes[number] ** 2) / (sizes[before] ** 2 - sizes[last] ** 2)
    shift = ratio * (bracket.value - other.value)
    half = max(floor_, abs(shift))
    return bracket.value + shift - half, bracket.value + shift + half


def _enclose(
    level: _Level, changes: Sequence[Change], expected: Sequence[tuple[float, float]]
) -> None:
    """Ask around every change, and further away on the side where it must have gone."""
    search = level.search
    ends = {i: [search.tidy(low), search.tidy(high)] for i, (low, high) in enumerate(expected)}
    level.learn([search.low, search.high, *(value for pair in ends.values() for value in pair)])
    while True:
        moved = []
        for number, (low, high) in ends.items():
            below, above = level.answers.get(low), level.answers.get(high)
            width = 2.0 * max(high - low, search.tolerance)
            kind = (changes[number].below, changes[number].above)
            if below == above == kind[0] and high < search.high:
                moved.append((number, high, search.tidy(high + width)))
            elif below == above == kind[1] and low > search.low:
                moved.append((number, search.tidy(low - width), low))
        known = len(level.answers)
        level.learn([value for _, low, high in moved for value in (low, high)])
        ends = {number: [low, high] for number, low, high in moved}
        if not ends or len(level.answers) == known:
            return


def _follow(changes: Sequence[Change], found: Sequence[Bracket], number: int) -> list[Change]:
    """Continue each change with the nearest bracket of its kind; what is left over is new."""
    pairs = sorted(
        (abs(_last(change).value - bracket.value), i, j)
        for i, change in enumerate(changes)
        for j, bracket in enumerate(found)
        if (change.below, change.above) == bracket.kind
    )
    taken: dict[int, int] = {}
    for _, i, j in pairs:
        if i not in taken and j not in taken.values():
            taken[i] = j
    followed = [
        Change(c.below, c.above, (*c.brackets, found[taken[i]] if i in taken else None))
        for i, c in enumerate(changes)
    ]
    followed += [
        Change(*bracket.kind, ((None,) * number) + (bracket,))
        for j, bracket in enumerate(found)
        if j not in taken.values()
    ]
    return sorted(followed, key=lambda change: _last(change).value)


def _last(change: Change) -> Bracket:
    """Return the bracket on the finest level that has the change."""
    return next(bracket for bracket in reversed(change.brackets) if bracket is not None)
