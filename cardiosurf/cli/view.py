"""Commands that show a recording: plot."""

from pathlib import Path

import click

from cardiosurf.errors import InputError


@click.command()
@click.argument("recording", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Folder for the figures; beside the recording unless given.",
)
@click.option(
    "--format",
    "formats",
    type=click.Choice(["png", "svg", "pdf"]),
    multiple=True,
    help="May be given several times; png and svg unless given.",
)
def plot(recording: Path, output: Path | None, formats: tuple[str, ...]) -> None:
    r"""Draw activation maps, probe traces and the circuit of reentry.

    RECORDING is a recording.h5 or the folder of a run. Prints the files it wrote.

    \b
    Examples:
      cardiosurf plot runs/t-domain-head-on
      cardiosurf plot runs/plane-block/recording.h5 -o figures --format svg
    """
    from cardiosurf.analysis.findings import judge_recording
    from cardiosurf.analysis.rotation import analyse_reentry
    from cardiosurf.recording.hdf5 import read_recording

    path = recording_file(recording)
    read = read_recording(path)
    # matplotlib takes longer to import than a wrong path takes to be found
    from cardiosurf.report.canvas import FORMATS
    from cardiosurf.report.caption import verdict_caption
    from cardiosurf.report.figures import plot_all

    verdict = judge_recording(read)
    caption = verdict_caption(verdict)
    reentry = None if verdict.reentry.verdict == "none" else analyse_reentry(read)
    folder = path.parent if output is None else output
    for written in plot_all(read, folder, formats or FORMATS, caption=caption, reentry=reentry):
        click.echo(written)


def recording_file(path: Path) -> Path:
    """Return the recording that a path means: the file itself, or the one in a run's folder.

    Raises
    ------
    InputError
        The folder holds no finished recording.
    """
    if not path.is_dir():
        return path
    inside = path / "recording.h5"
    if not inside.is_file():
        raise InputError(
            where=str(path),
            problem="this folder holds no recording.h5",
            allowed="the folder of a finished run, or a recording",
            hint="finish the run first: cardiosurf run CONFIG --resume",
        )
    return inside
