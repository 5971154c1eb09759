"""Commands that make many runs: check, sweep."""

from __future__ import annotations

import json
import os
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from cardiosurf.cli.errors import say

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from cardiosurf.study.batch import Done

WORKERS_HELP = "Runs at a time.  [default: as many as there are cores]"


@click.command()
@click.argument("scenarios", metavar="SCENARIO...", nargs=-1, required=True)
@click.option("--fast", is_flag=True, help="Coarser, as far as the scenarios say that it will do.")
@click.option(
    "--guard",
    is_flag=True,
    help="Run each case on a finer mesh and with smaller steps too: is it converged?",
)
@click.option("--workers", type=click.IntRange(1, 256), help=WORKERS_HELP)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    default=Path("runs/check"),
    show_default=True,
    help="Folder for check.json, junit.xml and the runs.",
)
@click.option("--json", "as_json", is_flag=True, help="Print check.json, not the table.")
def check(
    scenarios: tuple[str, ...],
    output: Path,
    *,
    fast: bool,
    guard: bool,
    workers: int | None,
    as_json: bool,
) -> None:
    r"""Run scenarios and compare with what is expected.

    SCENARIO is a file or a folder of files. Runs that are there already are used again, as long
    as neither their config nor the program has changed; what was stopped goes on.

    Ends with 0 if all is as expected, with 1 if something differs, with 3 if a run broke down;
    a case that is not converged is told, and no failure.

    \b
    Examples:
      cardiosurf check scenarios
      cardiosurf check --fast scenarios/plane.yaml
    """
    from cardiosurf.config.scenario_file import read_scenario, scenario_paths

    files = [read_scenario(path) for path in scenario_paths([Path(one) for one in scenarios])]
    # a scenario that is wrong need not wait for what follows
    for file in files:
        file.cases(fast=fast)
    from cardiosurf.report.check_report import check_json, check_lines
    from cardiosurf.report.junit import junit_xml
    from cardiosurf.study.check import How
    from cardiosurf.study.check import check as run_check
    from cardiosurf.study.lock import alone_in

    count = sum(len(file.scenario.cases) for file in files) * (3 if guard else 1)
    how = How(fast=fast, guard=guard)
    with goes_on(), alone_in(output):
        result = run_check(
            files, output, how=how, workers=workers or cores(), on_done=_counter(count)
        )
        data = json.dumps(check_json(result), indent=2)
        _write(output / "check.json", data + "\n")
        _write(output / "junit.xml", junit_xml(result))
    click.echo(data if as_json else "\n".join(check_lines(result)))
    if result.exit_code:
        raise click.exceptions.Exit(result.exit_code)


@click.command()
@click.argument("scenario", type=click.Path(path_type=Path))
@click.option("--workers", type=click.IntRange(1, 256), help=WORKERS_HELP)
@click.option(
    "--resume/--no-resume",
    default=True,
    help="Use what an earlier call has run, or run everything again.  [default: --resume]",
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Folder for the sweep's files.  [default: runs/sweep/NAME]",
)
@click.option("--json", "as_json", is_flag=True, help="Print the rows as JSON, not the table.")
def sweep(
    scenario: Path, output: Path | None, *, workers: int | None, resume: bool, as_json: bool
) -> None:
    r"""Run all that a scenario varies and map the verdicts.

    Writes the resolved config of every run (cases/NAME.yaml) before the first one begins, then
    results.csv and phase_diagram.png. Called again it runs only what is missing or has changed,
    and goes on with what was stopped.

    \b
    Examples:
      cardiosurf sweep scenarios/plane_sweep.yaml
      cardiosurf sweep scenarios/plane_sweep.yaml --workers 4 -o runs/plane
    """
    from cardiosurf.config.scenario_file import read_scenario

    file = read_scenario(scenario)
    count = len(file.points())
    folder = output or Path("runs") / "sweep" / file.scenario.name
    from cardiosurf.report.sweep_table import csv_text, sweep_lines
    from cardiosurf.study.lock import alone_in
    from cardiosurf.study.sweep import sweep as run_sweep

    with goes_on(), alone_in(folder):
        result = run_sweep(
            file,
            folder,
            fresh=not resume,
            workers=workers or cores(),
            on_done=_counter(count),
        )
        _write(folder / "results.csv", csv_text(result))
        # matplotlib takes long to import, and nothing before it needs it
        from cardiosurf.report.canvas import save
        from cardiosurf.report.phase_diagram import phase_diagram

        save(phase_diagram(result), folder / "phase_diagram", ("png",))
    files = f"results.csv and phase_diagram.png in {folder}"
    click.echo(json.dumps(result.rows, indent=2) if as_json else "\n".join(sweep_lines(result)))
    say(files)
    if result.exit_code:
        raise click.exceptions.Exit(result.exit_code)


@contextmanager
def goes_on() -> Iterator[None]:
    """Say after Ctrl-C that nothing is lost."""
    try:
        yield
    except KeyboardInterrupt:
        say("\nstopped; the same command goes on")
        raise


def cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _counter(count: int) -> Callable[[Done], None]:
    """Return a function that says on stderr which run has ended."""
    ended = 0

    def tell(done: Done) -> None:
        nonlocal ended
        ended += 1
        found = done.verdict["verdict"] if done.verdict else f"failed ({done.kind})"
        took = "reused" if done.reused else f"{done.seconds:.1f} s"
        say(f"  {ended}/{count}  {done.name}: {found}, {took}")

    return tell


def _write(path: Path, text: str) -> None:
    from cardiosurf.recording.whole_file import whole_file

    with whole_file(path) as partial:
        partial.write_text(text, encoding="utf-8")
