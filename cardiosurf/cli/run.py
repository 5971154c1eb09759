"""Commands that make a verdict: run, analyze."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from cardiosurf.errors import InputError

if TYPE_CHECKING:
    from cardiosurf.analysis.verdict import Verdict
    from cardiosurf.recording.recording import Recording

OVERRIDE_HELP = "Change one key: a.b.c=value; list items by number or by their name."
MAPS = ("relative_acceleration.vtu", "relative_acceleration.png")


def _show(verdict: Verdict, extra: list[str], *, as_json: bool) -> None:
    from cardiosurf.report.summary import verdict_lines

    if as_json:
        click.echo(json.dumps(verdict.to_json(), indent=2))
    else:
        click.echo("\n".join([*verdict_lines(verdict), *extra]))


@click.command()
@click.argument("config", type=click.Path(path_type=Path))
@click.option("--set", "overrides", metavar="KEY=VALUE", multiple=True, help=OVERRIDE_HELP)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Folder for the run's files.  [default: runs/NAME]",
)
@click.option("--overwrite", is_flag=True, help="Replace a finished or unfinished run there.")
@click.option("--resume", is_flag=True, help="Go on with an unfinished run there, if any.")
@click.option(
    "--guard",
    is_flag=True,
    help="Repeat the run on a finer mesh and with smaller steps and say whether the verdict is"
    " converged; the exit code is 0 either way.",
)
@click.option("--no-jit", is_flag=True, help="March with NumPy and SciPy, not in machine code.")
@click.option(
    "--threads",
    type=click.IntRange(1, 64),
    help="Threads of the march.  [default: as many as pay, at most OMP_NUM_THREADS]",
)
@click.option("--json", "as_json", is_flag=True, help="Print the verdict as JSON.")
def run(
    config: Path,
    overrides: tuple[str, ...],
    output: Path | None,
    *,
    overwrite: bool,
    resume: bool,
    guard: bool,
    no_jit: bool,
    threads: int | None,
    as_json: bool,
) -> None:
    r"""Run a config and say whether conduction is blocked.

    Writes recording.h5, recording.xdmf, config.yaml (resolved) and verdict.json into the output
    folder. A run that is stopped (Ctrl-C) keeps its state there and goes on with --resume. With
    --guard the verdict also says whether it is converged; the runs behind that lie in guard/.

    \b
    Examples:
      cardiosurf run configs/t_domain.yaml
      cardiosurf run configs/plane_block.yaml --set tissue.patches.block.anisotropy.x=4
    """
    from cardiosurf.config import load

    loaded = load(config, overrides)
    # a config that is wrong need not wait for all that a march takes
    from cardiosurf.report.summary import cost_line
    from cardiosurf.stepping.controls import Execution
    from cardiosurf.study.folder import RunFolder
    from cardiosurf.study.guard import simulate_guarded
    from cardiosurf.study.simulation import simulate

    folder = output or Path("runs") / loaded.config.name
    place = RunFolder(folder)
    if resume and not (place.resumable or place.finished):
        click.echo(f"nothing to resume in {folder}: starting from the beginning", err=True)
    try:
        execution = Execution(jit=not no_jit, threads=threads)
        make = simulate_guarded if guard else simulate
        result = make(loaded, folder, overwrite=overwrite, resume=resume, execution=execution)
    except KeyboardInterrupt:
        if place.resumable:
            click.echo(f"\nstopped; go on with: --resume -o {folder}", err=True)
        elif guard and place.finished:
            click.echo(
                "\nstopped; the run is finished, its guard goes on when called again", err=True
            )
        raise
    files = [cost_line(result.meta), f"  files in {folder}"]
    _show(result.verdict, files, as_json=as_json)


@click.command()
@click.argument("recording", type=click.Path(path_type=Path))
@click.option(
    "--reentry",
    "with_reentry",
    is_flag=True,
    help="Print cycle lengths, the circuit and phase singularities instead of the verdict.",
)
@click.option(
    "--acceleration",
    "with_acceleration",
    is_flag=True,
    help="Measure the relative acceleration of neighbouring trajectories, print what it is where,"
    " and write its map: relative_acceleration.vtu and .png.",
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Folder for what --acceleration writes; beside the recording unless given.",
)
@click.option("--json", "as_json", is_flag=True, help="Print as JSON.")
def analyze(
    recording: Path,
    output: Path | None,
    *,
    with_reentry: bool,
    with_acceleration: bool,
    as_json: bool,
) -> None:
    r"""Judge a recording again and print its verdict.

    RECORDING is a recording.h5 or a run's folder that holds one. Nothing is written, but for the
    map that --acceleration asks for.

    \b
    Examples:
      cardiosurf analyze runs/t-domain-head-on
      cardiosurf analyze runs/spiral --reentry
      cardiosurf analyze runs/plane-block --acceleration
    """
    _check_options(output, with_reentry=with_reentry, with_acceleration=with_acceleration)
    from cardiosurf.analysis.findings import judge_recording
    from cardiosurf.recording.hdf5 import read_recording

    path = recording / "recording.h5" if recording.is_dir() else recording
    read = read_recording(path, with_frames=with_reentry)
    if with_reentry:
        _show_reentry(read, as_json=as_json)
    elif with_acceleration:
        _show_acceleration(read, output or path.parent, as_json=as_json)
    else:
        _show(judge_recording(read), [], as_json=as_json)


def _check_options(output: Path | None, *, with_reentry: bool, with_acceleration: bool) -> None:
    """Refuse options that contradict each other."""
    if with_reentry and with_acceleration:
        raise InputError("--acceleration", "and --reentry both say what to print", "one of them")
    if output is not None and not with_acceleration:
        raise InputError(f"-o {output}", "nothing is written", "-o with --acceleration only")


def _show_acceleration(read: Recording, folder: Path, *, as_json: bool) -> None:
    """Measure the relative acceleration, write its map, print its numbers."""
    from cardiosurf.analysis.acceleration_summary import summarise
    from cardiosurf.analysis.measured_acceleration import recorded_accelerations
    from cardiosurf.recording.whole_file import check_folder, whole_files
    from cardiosurf.report.acceleration_lines import acceleration_lines

    check_folder(folder, MAPS)

    found = recorded_accelerations(read)
    summary = summarise(read, found)
    # matplotlib takes long to import, and nothing before it needs it
    from cardiosurf.report.acceleration_map import (
        DOTS_PER_INCH,
        acceleration_map,
        write_acceleration,
    )
    from cardiosurf.report.canvas import save

    figure = acceleration_map(read, found)
    with whole_files(folder, MAPS) as staged:
        write_acceleration(read, found, staged / MAPS[0])
        save(figure, staged / "relative_acceleration", ("png",), dots_per_inch=DOTS_PER_INCH)
    if as_json:
        click.echo(json.dumps(summary.to_json(), indent=2))
    else:
        lines = acceleration_lines(summary)
        click.echo(
            "\n".join([*lines, f"  written to {folder / 'relative_acceleration'}.vtu and .png"])
        )


def _show_reentry(read: Recording, *, as_json: bool) -> None:
    from cardiosurf.analysis.rotation import analyse_reentry
    from cardiosurf.analysis.rotation_json import reentry_json
    from cardiosurf.report.reentry_summary import reentry_lines

    analysis = analyse_reentry(read)
    if as_json:
        click.echo(json.dumps(reentry_json(analysis)))
    else:
        click.echo("\n".join(reentry_lines(analysis)))
