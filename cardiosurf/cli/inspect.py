"""Commands that look at a config without running it: validate, mesh, schema."""

from __future__ import annotations

import json
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import click

from cardiosurf.cli.errors import say
from cardiosurf.errors import CardiosurfError, InputError

if TYPE_CHECKING:
    from cardiosurf.config import Loaded
    from cardiosurf.geometry.surface import Surface

SCHEMAS = {
    "config": "cardiosurf.config:config_schema",
    "scenario": "cardiosurf.config.scenario:scenario_schema",
    "verdict": "cardiosurf.analysis.verdict:verdict_schema",
    "threshold": "cardiosurf.study.threshold_result:threshold_schema",
    "check": "cardiosurf.study.check_schema:check_schema",
    "prediction": "cardiosurf.analysis.prediction:prediction_schema",
    "discrete": "cardiosurf.study.discrete_game:game_schema",
    "stop": "cardiosurf.discrete.stops:stop_schema",
    "reentry": "cardiosurf.analysis.rotation_json:reentry_schema",
    "acceleration": "cardiosurf.analysis.acceleration_summary:acceleration_schema",
}
"""What has a schema -> module and function that returns it."""
OVERRIDE_HELP = "Change one key: a.b.c=value; list items by number or by their name."


@click.command()
@click.argument("configs", metavar="CONFIG...", nargs=-1, required=True)
@click.option("--set", "overrides", metavar="KEY=VALUE", multiple=True, help=OVERRIDE_HELP)
@click.option(
    "--mesh",
    "with_mesh",
    is_flag=True,
    help="Also build mesh, tissue and stimuli; finds empty regions and stimuli off the surface.",
)
def validate(configs: tuple[str, ...], overrides: tuple[str, ...], *, with_mesh: bool) -> None:
    r"""Check configs and scenarios and say what is wrong.

    Of a scenario, the configs of all its cases and points are checked. All files are checked
    before the command ends, with exit code 2 if any of them is wrong.

    \b
    Examples:
      cardiosurf validate configs/*.yaml scenarios/*.yaml
      cardiosurf validate --mesh my.yaml --set mesh.edge_length=4
    """
    from cardiosurf.config import load
    from cardiosurf.config.reader import read_document
    from cardiosurf.config.scenario_file import is_scenario

    wrong, worst = 0, 0
    for file in configs:
        try:
            if is_scenario(read_document(file).data):
                click.echo(f"ok  {file}  {_scenario(file, overrides, with_mesh=with_mesh)}")
                continue
            loaded = load(file, overrides)
            built = f", {_built(loaded)}" if with_mesh else ""
            click.echo(f"ok  {file}  {_contents(loaded)}{built}")
        except CardiosurfError as error:
            wrong, worst = wrong + 1, max(worst, error.exit_code)
            say(f"error: {error}")
    if wrong and len(configs) > 1:
        say(f"{wrong} of {len(configs)} files are wrong")
    if wrong:
        raise click.exceptions.Exit(worst)


@click.command()
@click.argument("config")
@click.option("--set", "overrides", metavar="KEY=VALUE", multiple=True, help=OVERRIDE_HELP)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Mesh file; its suffix chooses the format (.vtu, .vtk, .msh, .ply, .stl, .xdmf ...).",
)
@click.option("--overwrite", is_flag=True, help="Replace the mesh file if it is there.")
def mesh(config: str, overrides: tuple[str, ...], output: Path | None, *, overwrite: bool) -> None:
    r"""Build the mesh of a config, report its quality, write it.

    The file carries, for each triangle, its part of the surface, the regions it belongs to and
    the net frame, so that ParaView can show them.

    \b
    Examples:
      cardiosurf mesh configs/t_domain.yaml
      cardiosurf mesh configs/t_domain.yaml --set mesh.edge_length=5 -o t_domain.vtu
    """
    from cardiosurf.config import load

    loaded = load(config, overrides)
    if output is not None:
        _check_output(output, overwrite=overwrite)
    surface = _surface(loaded)
    click.echo("\n".join(_report(loaded, surface)))
    if output is not None:
        _write_whole(surface, output)
        click.echo(f"written to {output}")


@click.command()
@click.argument("what", type=click.Choice(list(SCHEMAS)), default="config")
def schema(what: str) -> None:
    r"""Print the JSON Schema of a config or of a result.

    An editor with a YAML language server then completes and checks keys while you type:

    \b
      cardiosurf schema > cardiosurf.schema.json
      # and as first line of a config:
      # yaml-language-server: $schema=cardiosurf.schema.json
    """
    module, function = SCHEMAS[what].split(":")
    click.echo(json.dumps(getattr(import_module(module), function)(), indent=2))


def _contents(loaded: Loaded) -> str:
    """Return one line about what a config holds."""
    config = loaded.config
    counts = (
        (len(config.tissue.patches), "patch", "patches"),
        (len(config.stimulus), "stimulus", "stimuli"),
        (len(config.targets), "target", "targets"),
    )
    listed = ", ".join(f"{count} {one if count == 1 else many}" for count, one, many in counts)
    edge = config.mesh.edge_length
    edges = "automatic edges" if edge == "auto" else f"edges {edge:g} su"
    return f"{config.name}: {config.geometry.kind}, {edges}, {listed}"


def _scenario(file: str, overrides: tuple[str, ...], *, with_mesh: bool) -> str:
    """Return one line about what a scenario holds, all its configs checked."""
    from cardiosurf.config.scenario_file import read_scenario

    if overrides:
        hint = "its own key set holds for all its cases"
        raise InputError(file, "is a scenario: --set changes configs only", "no --set", hint)
    read = read_scenario(Path(file))
    configs = [ready.loaded for ready in (*read.cases(), *read.cases(fast=True))]
    points = read.points() if read.scenario.sweeps else ()
    configs += [ready.loaded for ready in points]
    if with_mesh:
        for loaded in {loaded.sha256: loaded for loaded in configs}.values():
            _built(loaded)
    counts = (len(read.scenario.cases), "case"), (len(points), "point")
    listed = ", ".join(f"{count} {word}{'s' * (count != 1)}" for count, word in counts)
    return f"{read.scenario.name}: scenario, {listed}"


def _surface(loaded: Loaded) -> Surface:
    """Build the surface of a config; its errors name file and line."""
    from cardiosurf.config import regions_of
    from cardiosurf.study.edges import edge_of
    from cardiosurf.study.surface_cache import surface_of

    config = loaded.config
    with loaded.naming_lines():
        return surface_of(config.geometry, edge_of(config).edge_length, regions_of(config))


def _built(loaded: Loaded) -> str:
    """Build all that a run would march over, and return its size."""
    from cardiosurf.recording.probe_sites import place_probes
    from cardiosurf.study.setup import set_up

    with loaded.naming_lines():
        surface = set_up(loaded.config).surface
        place_probes(surface, loaded.config.record.probes)
    return f"{len(surface.points)} vertices, {len(surface.triangles)} triangles"


def _report(loaded: Loaded, surface: Surface) -> list[str]:
    """Return the quality of a mesh, and the area of each part and region, as lines of text."""
    from cardiosurf.geometry.quality import quality
    from cardiosurf.study.edges import edge_of

    q = quality(surface)
    wanted = edge_of(loaded.config).edge_length
    rows = [
        ("vertices, triangles, edges", f"{q.vertices}, {q.triangles}, {q.edges}", ""),
        ("smallest, largest angle", f"{q.smallest_angle:.1f}, {q.largest_angle:.1f} degrees", ""),
        (
            "shortest, mean, longest edge",
            f"{q.shortest_edge:.3g}, {q.mean_edge:.3g}, {q.longest_edge:.3g} su",
            f"asked for {wanted:g}",
        ),
        ("components", str(q.components), "1 is right"),
        ("duplicate vertices", str(q.duplicates), "0 is right"),
        ("orphan vertices", str(q.orphans), "0 is right"),
        ("crossed edges", str(q.crossed), "0 is right"),
        ("Euler characteristic", str(q.euler), "2 sphere, 1 disc, 0 ring or torus"),
        ("loops of open edges", str(q.loops), ", ".join(surface.edges)),
        ("area", f"{q.area:.6g} su^2", ""),
    ]
    areas = surface.areas()
    masks = {f"part {name}": surface.part_of == i for i, name in enumerate(surface.parts)}
    rows += [
        (name, f"{areas[mask].sum():.6g} su^2", f"{mask.sum()} triangles")
        for name, mask in (masks | dict(surface.regions)).items()
    ]
    width = max(len(label) for label, _, _ in rows)
    title = f"{loaded.config.name}: {loaded.config.geometry.kind}"
    return [title, *(f"  {row[0]:<{width}}  {row[1]:<24}  {row[2]}".rstrip() for row in rows)]


def _check_output(output: Path, *, overwrite: bool) -> None:
    """Refuse an output file that cannot be written, before any work is done."""
    from cardiosurf.geometry.export import written_files

    try:
        files = written_files(output)
    except InputError as error:
        hint = f"-o {error.hint}"
        raise InputError(f"-o {output}", error.problem, error.allowed, hint) from None
    if output.is_dir():
        raise InputError(f"-o {output}", "is a folder", "a file", f"-o {output}/surface.vtu")
    if not output.parent.is_dir():
        raise InputError(
            f"-o {output}", f"there is no folder {output.parent}", "an existing folder"
        )
    there = [file for file in files if file.exists()]
    if there and not overwrite:
        what = "the file" if there[0] == output else f"{there[0]}, which goes with it,"
        raise InputError(f"-o {output}", f"{what} is there already", "a new file, or --overwrite")
    if any(file.is_dir() for file in there):
        raise InputError(f"-o {output}", f"{there[0]} is a folder", "another name")


def _write_whole(surface: Surface, output: Path) -> None:
    """Write a mesh file, and what goes with it, beside its place and move it there when whole."""
    from tempfile import TemporaryDirectory

    from cardiosurf.geometry.export import write_mesh
    from cardiosurf.recording.whole_file import unwritable

    try:
        # some formats write a second file (.xdmf and .h5) that the first names
        with TemporaryDirectory(dir=output.parent, prefix=f".{output.name}.") as folder:
            write_mesh(surface, Path(folder) / output.name)
            for written in sorted(Path(folder).iterdir()):
                written.replace(output.parent / written.name)
    except OSError as error:
        raise unwritable(output, error) from error
