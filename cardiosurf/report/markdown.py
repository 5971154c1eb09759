"""Pieces of Markdown."""

from collections.abc import Sequence


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return a table in Markdown.

    Parameters
    ----------
    heads : sequence of str
        What the columns are called.
    rows : sequence of sequence of str
        Texts; a bar inside one is escaped.
    """
    every = [heads, ["---"] * len(heads), *rows]
    return ["| " + " | ".join(cell.replace("|", r"\|") for cell in row) + " |" for row in every]


def stem_of(name: str) -> str:
    """Return the file name, without ending, of the image of a result."""
    return name.replace("/", "_")


def image_file(images: str, name: str) -> str:
    """Return where the image of a result is, seen from the page."""
    return f"{images}/{stem_of(name)}.png"
