"""The command that brings the reproduction page up to date: reproduce."""

from __future__ import annotations

import os
from pathlib import Path

import click

from cardiosurf.cli.errors import say
from cardiosurf.cli.study import WORKERS_HELP, cores, goes_on

STAGES = ("cases", "thresholds", "entrances", "images", "page")


@click.command()
@click.argument("scenarios", metavar="SCENARIO...", nargs=-1, required=True)
@click.option(
    "--only",
    type=click.Choice(STAGES),
    multiple=True,
    help="This stage alone; may be repeated.  [default: all of them, in this order]",
)
@click.option(
    "--results",
    type=click.Path(path_type=Path),
    default=Path("docs/results"),
    show_default=True,
    help="Folder of the results that are kept.",
)
@click.option(
    "--page",
    type=click.Path(path_type=Path),
    default=Path("docs/reproduction.md"),
    show_default=True,
    help="The page; its images go to images/reproduction beside it.",
)
@click.option("--workers", type=click.IntRange(1, 64), help=WORKERS_HELP)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    default=Path("runs/reproduction"),
    show_default=True,
    help="Folder for the runs.",
)
def reproduce(
    scenarios: tuple[str, ...],
    output: Path,
    page: Path,
    results: Path,
    *,
    only: tuple[str, ...],
    workers: int | None,
) -> None:
    r"""Rerun the paper's experiments and write the page.

    Results are kept as small JSON files; only what has none for its present config is run: the
    cases with the convergence guard, the critical values, the fronts before the patches, the
    figures. To run something again, delete its entry.

    \b
    Examples:
      cardiosurf reproduce scenarios
      cardiosurf reproduce scenarios --only page
    """
    from cardiosurf.config.scenario_file import read_scenario, scenario_paths

    files = [read_scenario(path) for path in scenario_paths([Path(one) for one in scenarios])]
    files = [file for file in files if file.scenario.on_page]
    # a scenario that is wrong need not wait for what follows
    for file in files:
        file.cases()
    from cardiosurf.report.kept import Kept
    from cardiosurf.report.reproduction import reproduction_page
    from cardiosurf.study.lock import alone_in
    from cardiosurf.study.reproduction import Work, bring_up_to_date
    from cardiosurf.study.results import Results

    stages = only or STAGES
    images = page.parent / "images" / "reproduction"
    if set(stages) != {"page"}:
        work = Work(Results(results), output, workers or cores(), say)
        with goes_on(), alone_in(output):
            bring_up_to_date(files, work, stages)
            if "images" in stages:
                from cardiosurf.report.reproduction_images import update_images

                update_images(Kept.read(files, results), images, work)
    if "page" in stages:
        from cardiosurf.recording.whole_file import whole_file

        text = reproduction_page(Kept.read(files, results), os.path.relpath(images, page.parent))
        with whole_file(page) as partial:
            partial.write_text(text, encoding="utf-8")
        click.echo(f"written to {page}")
