"""Columns of text."""

from collections.abc import Sequence


def table_lines(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return rows as lines of text in columns, the heads underlined.

    Parameters
    ----------
    heads : sequence of str
        What the columns are called.
    rows : sequence of sequence of str
        As many texts each as there are heads; numbers stand to the right.

    Examples
    --------
    >>> print(*table_lines(["case", "s"], [["one", "0.5"], ["twelve", "12.0"]]), sep="|")
    case       s|------  ----|one      0.5|twelve  12.0
    """
    columns = list(zip(heads, *rows, strict=True))
    widths = [max(map(len, column)) for column in columns]
    right = [bool(rows) and all(map(_is_number, column[1:])) for column in columns]

    def line(texts: Sequence[str]) -> str:
        placed = zip(texts, widths, right, strict=True)
        cells = (text.rjust(room) if number else text.ljust(room) for text, room, number in placed)
        return "  ".join(cells).rstrip()

    return [line(heads), line(["-" * width for width in widths]), *map(line, rows)]


def _is_number(text: str) -> bool:
    return text.replace(".", "", 1).replace("-", "", 1).isdigit() or text in {"", "-"}
