"""The command that predicts without marching: predict."""

from __future__ import annotations

import json
from pathlib import Path

import click

OVERRIDE_HELP = "Change one key: a.b.c=value; list items by number or by their name."
FILES = ("prediction.json", "prediction.vtu", "prediction.png")


@click.command()
@click.argument("config", type=click.Path(path_type=Path))
@click.option("--set", "overrides", metavar="KEY=VALUE", multiple=True, help=OVERRIDE_HELP)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Folder for prediction.json, .vtu and .png.  [default: runs/NAME/prediction]",
)
@click.option(
    "--width",
    type=click.FloatRange(0.0, min_open=True),
    help="Over what patch edges are smoothed for the relative acceleration, in su.  [default: 12]",
)
@click.option("--json", "as_json", is_flag=True, help="Print prediction.json, not the lines.")
def predict(
    config: Path,
    overrides: tuple[str, ...],
    output: Path | None,
    *,
    width: float | None,
    as_json: bool,
) -> None:
    r"""Predict arrival and block of a config, without time stepping.

    Arrival times are those of the eikonal equation, through the tissue as it is and without its
    patches. At the entrance of each patch three explanations of block are held side by side:
    relative acceleration (the paper's), source and sink, curvature of the front. How often they
    are right is in docs/theory.md; a verdict takes `cardiosurf run`.

    \b
    Examples:
      cardiosurf predict configs/t_domain.yaml
      cardiosurf predict configs/plane_block.yaml --set tissue.patches.block.anisotropy.x=4
    """
    from cardiosurf.config import load

    loaded = load(config, overrides)
    folder = output or Path("runs") / loaded.config.name / "prediction"
    from cardiosurf.recording.whole_file import check_folder, whole_files

    check_folder(folder, FILES)
    from cardiosurf.analysis.prediction import WIDTH
    from cardiosurf.report.prediction_lines import prediction_lines
    from cardiosurf.study.prediction import predict as make
    from cardiosurf.study.prediction import write_prediction

    with loaded.naming_lines():
        predicted = make(loaded, WIDTH if width is None else width)
    # matplotlib takes long to import, and nothing before it needs it
    from cardiosurf.report.canvas import save
    from cardiosurf.report.prediction_map import prediction_map, write_maps

    figure = prediction_map(predicted)
    with whole_files(folder, FILES) as staged:
        write_prediction(predicted.prediction, staged)
        write_maps(predicted, staged / "prediction.vtu")
        save(figure, staged / "prediction", ("png",))
    if as_json:
        click.echo(json.dumps(predicted.prediction.to_json(), indent=2))
    else:
        lines = prediction_lines(predicted.prediction)
        click.echo("\n".join([*lines, f"  files in {folder}"]))
