"""The images of the reproduction page: drawn where they are missing or out of date."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from cardiosurf.config import overlay
from cardiosurf.config.page import Figure as PaperFigure
from cardiosurf.recording.hdf5 import read_recording
from cardiosurf.report.canvas import save
from cardiosurf.report.critical_plots import critical_plot, entrance_plot
from cardiosurf.report.kept import Kept, Row, SearchRows
from cardiosurf.report.markdown import stem_of
from cardiosurf.report.panels import Moments, snapshots
from cardiosurf.study.folder import RECORDING
from cardiosurf.study.reproduction import Work, run_case
from cardiosurf.study.results import ASKED, asked_hash, current
from cardiosurf.study.wanted import Wanted

DOTS_PER_INCH = 72


def image_name(name: str) -> str:
    """Return the file name of the image of a result."""
    return f"{stem_of(name)}.png"


def _save(figure: Figure, images: Path, name: str) -> None:
    """Write an image, coarse: the page has many."""
    save(figure, images / stem_of(name), ("png",), dots_per_inch=DOTS_PER_INCH)


def update_images(kept: Kept, images: Path, work: Work) -> None:
    """Draw the images that are missing or out of date.

    Figures of the paper take a run with frames each, plots only the results that are kept.

    Parameters
    ----------
    kept : Kept
        The results, thresholds and entrances among them already up to date.
    images : Path
        The folder of the images; made if it is not there.
    work : Work
        Where runs and results are.

    Raises
    ------
    InputError
        A run has no frame at a time that is to be shown, or the folder cannot be written to.
    NumericalError
        A run broke down.
    KeyboardInterrupt
        It was stopped; the same call goes on.
    """
    images.mkdir(parents=True, exist_ok=True)
    for row, figure in kept.figures:
        if row.entry is None or not (images / image_name(row.wanted.name)).exists():
            _draw(row.wanted, figure, images, work)
    for group in kept.searches:
        _plots(group, images, work)


def _draw(wanted: Wanted, figure: PaperFigure, images: Path, work: Work) -> None:
    """Run a case with frames, draw it, and note what was drawn."""
    with_frames = overlay(wanted.ready.loaded, [f"record.frames_every={figure.every!r}"])
    folder, done = run_case(with_frames, wanted.name, work)
    moments = Moments(figure.moments, [f"T = {time:g}" for time in figure.times])
    title = f"{wanted.file.scenario.name} / {wanted.ready.case.name} ({figure.label})"
    drawn = snapshots(read_recording(folder / RECORDING), moments, title, figure.view)
    _save(drawn, images, wanted.name)
    entry = {
        ASKED: wanted.asked,
        "edge_length": done.meta["edge_length"],
        "step": done.meta["step"],
        "verdict": (done.verdict or {})["verdict"],
        "seconds": round(done.seconds, 1),
    }
    work.results.keep("figures", wanted.name, entry)
    work.say(f"{wanted.name}: drawn")


def entrance_name(group: SearchRows, scenario: str) -> str:
    """Return the name of the plot of a scenario's entrances."""
    return f"{scenario}/{group.name}/entrance"


def _plots(group: SearchRows, images: Path, work: Work) -> None:
    """Draw the plots of a search whose numbers have changed since."""
    if any(row.entry is not None for row in group.thresholds):
        _plot(group.name, group.thresholds, images, work, partial(critical_plot, group))
    for file, _ in group.searches:
        rows = group.of(file, group.entrances)
        if any(row.entry is not None for row in rows):
            name = entrance_name(group, file.scenario.name)
            _plot(name, rows, images, work, partial(entrance_plot, group, file))


def _plot(
    name: str, rows: Sequence[Row], images: Path, work: Work, draw: Callable[[], Figure]
) -> None:
    """Draw a plot, unless its image is there and was made from the same entries."""
    asked = asked_hash([row.entry for row in rows])
    path = images / image_name(name)
    if path.exists() and current(work.results.read("figures").get(name), asked):
        return
    _save(draw(), images, name)
    work.results.keep("figures", name, {ASKED: asked})
    work.say(f"{name}: drawn")
