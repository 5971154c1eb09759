"""What is wrong with an expression, and where in it."""

_WIDEST = 60


class ExpressionError(ValueError):
    """An expression that cannot be read, or that has no finite value.

    Attributes
    ----------
    text : str
        The expression.
    at : int
        The character that the problem is at, counted from 0; the length for the end.
    problem : str
        What is wrong there.
    place : int or None
        Of an expression that was evaluated at many places the one where it has no finite value.
    """

    def __init__(self, text: str, at: int, problem: str, place: int | None = None) -> None:
        super().__init__(problem)
        self.text, self.at, self.problem, self.place = text, at, problem, place

    def __str__(self) -> str:
        """Return the problem, and below it the expression with a mark under the place."""
        return f"{self.problem}\n{pointed(self.text, self.at)}"


def pointed(text: str, at: int) -> str:
    """Return two lines: the expression (of a long one the part around ``at``) and a mark below it.

    Examples
    --------
    >>> print(pointed("2*(x + ", 7))
        2*(x +
               ^
    """
    first = max(0, min(at - _WIDEST // 2, len(text) - _WIDEST))
    before, after = "..." * (first > 0), "..." * (first + _WIDEST < len(text))
    # a control character would break the line or move the mark
    shown = "".join(c if c.isprintable() else " " for c in text[first : first + _WIDEST])
    line = f"    {before}{shown}{after}".rstrip()
    return f"{line}\n{' ' * (4 + len(before) + at - first)}^"
