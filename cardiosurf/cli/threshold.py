"""The command that finds critical values: threshold."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from cardiosurf.cli.run import OVERRIDE_HELP
from cardiosurf.errors import InputError

if TYPE_CHECKING:
    from cardiosurf.config import Loaded
    from cardiosurf.study.question import Question
    from cardiosurf.study.threshold_plan import Plan
    from cardiosurf.study.threshold_result import Threshold

RESULT, RUNS = "threshold.json", "runs"


@click.command()
@click.argument("config", type=click.Path(path_type=Path))
@click.option("--vary", metavar="KEY", required=True, help="The number to vary, as in --set.")
@click.option(
    "--between", nargs=2, type=float, metavar="A B", required=True, help="Where to look for it."
)
@click.option("--set", "overrides", metavar="KEY=VALUE", multiple=True, help=OVERRIDE_HELP)
@click.option("--target", metavar="NAME", help="Ask about this target alone: --of conduction:NAME.")
@click.option(
    "--of",
    "question",
    metavar="QUESTION",
    help="What changes: conduction[:NAME], verdict, reentry, target:NAME or route:NAME.  "
    "[default: conduction, of all targets]",
)
@click.option("--tolerance", type=float, help="Half width of a bracket.  [default: (B - A) / 400]")
@click.option(
    "--edges",
    metavar="H,H,H",
    help="Edge lengths of three meshes or more, in su."
    "  [default: 1.41, 1 and 0.71 times the config's]",
)
@click.option(
    "--scan",
    type=click.IntRange(2, 1000),
    default=9,
    show_default=True,
    help="How many values to try first, on the coarsest mesh.",
)
@click.option("--workers", type=click.IntRange(1, 64), default=1, help="Runs at a time.")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Folder for the runs and threshold.json.  [default: runs/threshold/NAME]",
)
@click.option("--overwrite", is_flag=True, help="Replace another search's threshold.json there.")
@click.option("--json", "as_json", is_flag=True, help="Print threshold.json.")
def threshold(
    config: Path,
    *,
    vary: str,
    between: tuple[float, float],
    overrides: tuple[str, ...],
    target: str | None,
    question: str | None,
    tolerance: float | None,
    edges: str | None,
    scan: int,
    workers: int,
    output: Path | None,
    overwrite: bool,
    as_json: bool,
) -> None:
    r"""Find the value at which a verdict changes.

    The coarsest of three meshes (or more) is scanned; every change of the answer is bisected on
    it, followed to the finer ones, and extrapolated: value +- error. All runs are kept, and a
    search that was stopped goes on when it is called again.

    \b
    Examples:
      cardiosurf threshold configs/t_domain.yaml \
          --vary tissue.patches.strip.anisotropy --between 6 10
      cardiosurf threshold configs/t_domain.yaml --vary stimulus[0].centre[2] --between 0 120 \
          --set tissue.patches.strip.anisotropy=7.4
    """
    from cardiosurf.config import load

    loaded = load(config, overrides)
    asked = _question(loaded, question, target)
    # a wrong config or option need not wait for all that a march takes
    from cardiosurf.study.threshold_plan import Plan, key_path, plan_levels, plan_search

    path = key_path(vary)
    search = plan_search(between, tolerance, scan=scan, workers=workers)
    levels = plan_levels(loaded, _edges(edges))
    plan = Plan(loaded, path, search, levels, asked)
    folder = output or Path("runs") / "threshold" / loaded.config.name
    _check_folder(folder, plan, overwrite=overwrite)
    from cardiosurf.study.lock import alone_in

    with alone_in(folder):
        found = _searched(plan, folder, workers)
    _show(found, folder, as_json=as_json)


def _searched(plan: Plan, folder: Path, workers: int) -> Threshold:
    """Search, write threshold.json, and return what was found."""
    from cardiosurf.recording.whole_file import whole_file
    from cardiosurf.report.threshold_lines import run_line
    from cardiosurf.study.store import RunStore
    from cardiosurf.study.threshold import find_threshold

    store = RunStore(folder / RUNS)
    try:
        found = find_threshold(
            plan, store, workers=workers, on_run=lambda row: click.echo(run_line(row), err=True)
        )
    except KeyboardInterrupt:
        click.echo("\nstopped; the same command goes on from here", err=True)
        raise
    with whole_file(folder / RESULT) as partial:
        partial.write_text(json.dumps(found.to_json(), indent=2) + "\n", encoding="utf-8")
    return found


def _show(found: Threshold, folder: Path, *, as_json: bool) -> None:
    from cardiosurf.report.threshold_lines import threshold_lines

    if as_json:
        click.echo(json.dumps(found.to_json(), indent=2))
    else:
        click.echo("\n".join([*threshold_lines(found), f"  written to {folder / RESULT}"]))


def _question(loaded: Loaded, question: str | None, target: str | None) -> Question:
    """Return what is asked of each run."""
    from cardiosurf.study.question import parse_question

    names = [one.name for one in loaded.config.targets]
    if target is None:
        return parse_question(question or "conduction", names)
    if question is not None:
        raise InputError(
            f"--target {target}",
            f"and --of {question} both say what is asked",
            "one of them",
            f"--of conduction:{target}",
        )
    try:
        return parse_question(f"conduction:{target}", names)
    except InputError as error:
        raise InputError(f"--target {target}", error.problem, error.allowed) from None


def _edges(text: str | None) -> list[float]:
    """Return the edge lengths that ``--edges`` lists."""
    if text is None:
        return []
    try:
        return [float(word) for word in text.split(",")]
    except ValueError:
        raise InputError(
            f"--edges {text}", "is not a list of numbers", "3.5,2.5,1.75", "no spaces between"
        ) from None


def _check_folder(folder: Path, plan: Plan, *, overwrite: bool) -> None:
    """Refuse a folder that holds the result of another search."""
    file = folder / RESULT
    if overwrite or not file.exists():
        return
    try:
        there = json.loads(file.read_text(encoding="utf-8"))
        same = (there["config_sha256"], there["vary"], there["question"]) == (
            plan.loaded.sha256,
            plan.vary,
            str(plan.question),
        )
    except (OSError, ValueError, KeyError, TypeError):
        same = False
    if not same:
        raise InputError(
            str(file),
            "is the result of another search",
            "an empty or new folder, or that of the same search",
            f"-o {folder}-2, or --overwrite",
        )
