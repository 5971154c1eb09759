"""A config played with Appendix B's units, the triangles of its surface."""

from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

from cardiosurf.analysis.block import TargetVerdict, judge
from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.config.sections import Config, regions_of, target_key
from cardiosurf.discrete.play import Play, Rule, play
from cardiosurf.discrete.triangles import Units, units_of
from cardiosurf.errors import InputError
from cardiosurf.geometry.surface import Surface
from cardiosurf.json_schema import result_schema
from cardiosurf.study.edges import edge_of
from cardiosurf.study.setup import check_targets
from cardiosurf.study.surface_cache import surface_of
from cardiosurf.tissue.stimuli import build_pulses
from cardiosurf.tissue.tensor import build_tissue

SCHEMA: Literal["cardiosurf/discrete/1"] = "cardiosurf/discrete/1"
LEVEL = 0.5
"""u that a stimulus has to set somewhere to start a wave."""
MOST = 2000.0
"""Excitation times after which a game is ended, if it has not ended by itself."""


@dataclass(frozen=True)
class TargetShare:
    """What the game made of a target.

    Attributes
    ----------
    name : str
        The target's name; "tissue" where the config has none.
    verdict : str
        ``conduction``, ``block`` or ``partial``, with the limits of a simulation's verdict.
    activated_fraction : float
        Activated share of its excitable area.
    first_activation : float or None
        When its first unit was excited, in excitation times.
    """

    name: str
    verdict: TargetVerdict
    activated_fraction: float
    first_activation: float | None


@dataclass(frozen=True, kw_only=True)
class GameFinding:
    """What came of a game, as ``cardiosurf discrete --json`` prints it.

    Attributes
    ----------
    name : str
        The config's name.
    rule : Rule
        What a unit can do.
    loads : bool
        Whether anisotropy counts as load.
    units, failures : int
        How many units there are, how many were charged in vain.
    spacing : float
        Mean distance of neighbours, in su.
    end : float
        When the last thing happened, in excitation times.
    ended : bool
        Whether it ended by itself.
    most_activations : int
        How often the unit that was excited most often was excited.
    targets : tuple of TargetShare
        What became of each target.
    """

    name: str
    rule: Rule
    loads: bool
    units: int
    failures: int
    spacing: float
    end: float
    ended: bool
    most_activations: int
    targets: tuple[TargetShare, ...]
    schema: Literal["cardiosurf/discrete/1"] = SCHEMA


@dataclass(frozen=True, kw_only=True)
class Game(GameFinding):
    """A finished game.

    Attributes
    ----------
    first : (m,) float
        First excitation of each unit (triangle); NaN never.
    """

    first: Floats

    def to_json(self) -> dict[str, Any]:
        """Return all but the map as plain JSON data, ``schema`` first."""
        told = asdict(self)
        del told["first"]
        return {"schema": told.pop("schema"), **told}


def game_schema() -> dict[str, Any]:
    """Return the JSON Schema of a game's finding; every key is always there, and no other."""
    return result_schema(GameFinding, SCHEMA)


def play_config(config: Config, rule: Rule, *, loads: bool = True) -> Game:
    """Play a config with the triangles of its surface as units.

    Kinetics and time are not looked at. Units whose triangle a beat at time 0 sets to more than
    half its profile are excited at the start.

    Parameters
    ----------
    config : Config
        A decoded config.
    rule : Rule
        What a unit can do.
    loads : bool
        Whether a unit of greater diffusivity takes more to be excited, see ``link_factors``.

    Raises
    ------
    InputError
        If the config does not fit its surface, or no beat at time 0 excites a unit.
    """
    surface = surface_of(config.geometry, edge_of(config).edge_length, regions_of(config))
    tissue = build_tissue(surface, config.tissue)
    check_targets(config, surface, tissue)
    units = units_of(surface, tissue, loads=loads)
    start = _start(config, surface, units.refuse)
    played = play(units.network, rule, start, most=MOST, refuse=units.refuse)
    masks = {one.name: surface.regions[target_key(one.name)] for one in config.targets}
    if not masks:
        masks = {"tissue": np.ones(len(surface.triangles), dtype=np.bool_)}
    targets = tuple(
        _share(name, played, mask & tissue.excitable, surface.areas())
        for name, mask in masks.items()
    )
    return _game(config.name, rule, units, played, targets, loads=loads)


def _game(
    name: str,
    rule: Rule,
    units: Units,
    played: Play,
    targets: tuple[TargetShare, ...],
    *,
    loads: bool,
) -> Game:
    return Game(
        name=name,
        rule=rule,
        loads=loads,
        units=units.network.count,
        failures=int(np.count_nonzero(played.failures)),
        spacing=units.spacing,
        end=played.end,
        ended=played.end < MOST,
        most_activations=int(np.bincount(played.units).max()),
        targets=targets,
        first=played.first,
    )


def _start(config: Config, surface: Surface, refuse: Mask) -> Ints:
    """Return the triangles that the beats at time 0 excite."""
    beats = [pulse for pulse in build_pulses(surface, config.stimulus) if pulse.time == 0.0]
    excited = np.zeros(len(surface.triangles), dtype=np.bool_)
    for beat in beats:
        # as for the eikonal and a run, u below 0.5 starts no front; a current may
        if beat.duration == 0.0 and beat.profile.max() < LEVEL:
            continue
        level = beat.profile[surface.triangles].mean(axis=1)
        excited |= level > 0.5 * beat.profile.max()
    excited &= ~refuse
    if not excited.any():
        raise InputError(
            "stimulus",
            "no unit is excited at time 0",
            "a stimulus with at: 0 and an amplitude above 0.5, or a current, on excitable tissue",
            "the game begins at 0 and is played once: later beats are not looked at",
        )
    return np.flatnonzero(excited)


def _share(name: str, played: Play, mask: Mask, areas: Floats) -> TargetShare:
    first = played.first[mask]
    reached = np.isfinite(first)
    fraction = float(areas[mask][reached].sum() / areas[mask].sum())
    begun = float(first[reached].min()) if reached.any() else None
    return TargetShare(name, judge(fraction), fraction, begun)
