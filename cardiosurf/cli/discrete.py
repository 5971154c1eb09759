"""The command that plays Appendix B's game: discrete."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from cardiosurf.cli.inspect import OVERRIDE_HELP
from cardiosurf.errors import InputError
from cardiosurf.spelling import did_you_mean

if TYPE_CHECKING:
    from cardiosurf.study.discrete_game import Game

SCENARIOS = ("free", "sg-i", "sc-ii", "figure-f")
"""Of ``discrete.stops.STOPS``, which takes longer to import than --help to print."""


@click.command()
@click.argument("config")
@click.option("--set", "overrides", metavar="KEY=VALUE", multiple=True, help=OVERRIDE_HELP)
@click.option(
    "--n-max", type=float, default=3.0, show_default=True, help="How many units one can excite."
)
@click.option(
    "--refractory",
    type=float,
    default=30.0,
    show_default=True,
    help="How long a unit cannot be excited again, in excitation times.",
)
@click.option(
    "--failed",
    type=click.Choice(["refractory", "rest"]),
    default="refractory",
    show_default=True,
    help="What becomes of a unit that was charged in vain.",
)
@click.option(
    "--anisotropy",
    type=click.Choice(["load", "speed"]),
    default="load",
    show_default=True,
    help="Whether a unit of diffusivity d takes sqrt(d) to be excited (load), or anisotropy is only"
    " faster, as the paper has it (speed).",
)
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
def discrete(
    config: str,
    overrides: tuple[str, ...],
    *,
    n_max: float,
    refractory: float,
    failed: Literal["refractory", "rest"],
    anisotropy: str,
    as_json: bool,
) -> None:
    r"""Play the paper's discrete model on the surface of a config.

    Each triangle is a unit that excites at most N_max units' worth of its neighbours. Nothing is
    marched and nothing is written; docs/theory.md says where the answers agree with a run's. In
    place of a CONFIG one of the appendix's scenarios in layers may stand: free, sg-i, sc-ii,
    figure-f.

    \b
    Examples:
      cardiosurf discrete configs/t_domain.yaml
      cardiosurf discrete configs/plane_block.yaml --n-max 2.7 --json
      cardiosurf discrete sg-i
    """
    if not 1e-6 <= n_max <= 1e6:
        raise InputError("--n-max", f"{n_max:g} is not a positive number", "0.000001 to 1000000")
    # units that are ready again before they have excited others go on without time going on
    if not 1.0 <= refractory <= 1e6:
        raise InputError("--refractory", f"{refractory:g} is out of range", "1 to 1000000")
    if config in SCENARIOS:
        _play_stop(config, overrides, (n_max, refractory, failed), as_json=as_json)
        return
    from cardiosurf.config import load

    _check_name(config)
    loaded = load(config, overrides)
    from cardiosurf.discrete.play import Rule
    from cardiosurf.study.discrete_game import play_config

    rule = Rule(n_max=n_max, refractory=refractory, failed=failed)
    with loaded.naming_lines():
        game = play_config(loaded.config, rule, loads=anisotropy == "load")
    click.echo(json.dumps(game.to_json(), indent=2) if as_json else "\n".join(_lines(game)))


def _check_name(config: str) -> None:
    """Refuse what is neither a file nor a scenario, but might have been meant as one."""
    if Path(config).suffix or os.path.lexists(config):
        return
    raise InputError(
        config,
        "no such file, and no scenario",
        f"a CONFIG, or one of {', '.join(SCENARIOS)}",
        did_you_mean(config, SCENARIOS),
    )


def _play_stop(
    name: str,
    overrides: tuple[str, ...],
    rule: tuple[float, float, Literal["refractory", "rest"]],
    *,
    as_json: bool,
) -> None:
    """Play one of the appendix's scenarios and print what came of it."""
    if overrides:
        raise InputError(f"--set {overrides[0]}", f"{name} is no config", "--set with a CONFIG")
    from cardiosurf.discrete.play import Rule
    from cardiosurf.discrete.stops import play_stop

    n_max, refractory, failed = rule
    found = play_stop(name, Rule(n_max=n_max, refractory=refractory, failed=failed))
    if as_json:
        click.echo(json.dumps(found.to_json(), indent=2))
        return
    outcome = "conducts" if found.conducts else "stops"
    click.echo(f"{name}: {found.about}, N_max = {n_max:g}: {outcome}")
    for unit in found.units:
        vain = "charged in vain" if unit.in_vain else "never excited"
        click.echo(f"  {unit.name}  {vain if unit.first is None else f'{unit.first:.4g}'}")


def _lines(game: Game) -> list[str]:
    """Return what happened, as lines of text."""
    width = max(len(target.name) for target in game.targets)
    lines = [f"{game.name}: {game.units} units {game.spacing:.3g} su apart, played"]
    for target in game.targets:
        line = f"  {target.name:{width}}  {target.verdict:10}  {target.activated_fraction:6.1%}"
        if target.first_activation is not None:
            line += f", from {target.first_activation:.1f} excitation times on"
        lines.append(line)
    lines.append(f"  {game.failures} units were charged in vain")
    if game.most_activations > 1:
        lines.append(f"  reentry, up to {game.most_activations} excitations")
    lines.append(
        f"  ended at {game.end:.1f}" if game.ended else f"  stopped at {game.end:.0f}, still going"
    )
    return lines
