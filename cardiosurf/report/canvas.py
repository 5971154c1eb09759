"""Figures without global state, and their files."""

from collections.abc import Sequence
from pathlib import Path
from textwrap import wrap

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from cardiosurf.recording.whole_file import whole_file

NEVER = "#b8b8b8"
"""Tissue that was never activated."""
STIMULUS = "#d55e00"
INK = "#1a1a1a"
FORMATS = ("png", "svg")
DOTS_PER_INCH = 160


def new_figure(width: float, height: float, title: str, caption: str | None) -> Figure:
    """Return an empty figure, in inches, with the run's name and the verdict on top."""
    figure = Figure(figsize=(width, height), layout=ConstrainedLayoutEngine(h_pad=0.08))
    FigureCanvasAgg(figure)
    lines = [title, *([] if caption is None else wrap(caption, width=int(12 * width)))]
    figure.suptitle("\n".join(lines), fontsize=11)
    return figure


def save(
    figure: Figure,
    stem: Path,
    formats: Sequence[str] = FORMATS,
    *,
    dots_per_inch: int = DOTS_PER_INCH,
) -> tuple[Path, ...]:
    """Write a figure as ``stem.png``, ``stem.svg``, ...; each file appears whole.

    Raises
    ------
    InputError
        The folder cannot be written to, or the disk is full.
    """
    written = []
    for kind in formats:
        path = stem.with_name(f"{stem.name}.{kind}")
        metadata = {"Date": None} if kind == "svg" else None
        # text stays text in an SVG (searchable, small), and equal figures give equal files
        with (
            mpl.rc_context(
                {"svg.fonttype": "none", "svg.hashsalt": "cardiosurf", "hatch.linewidth": 0.6}
            ),
            whole_file(path) as partial,
        ):
            figure.savefig(partial, format=kind, dpi=dots_per_inch, metadata=metadata)
        written.append(path)
    return tuple(written)
