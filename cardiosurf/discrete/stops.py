"""The paper's figure relaccel2 as networks: free propagation, SG-i and SC-ii."""

from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

from cardiosurf.arrays import Ints
from cardiosurf.discrete.network import Network, layered, linked
from cardiosurf.discrete.play import Play, Rule, play
from cardiosurf.json_schema import result_schema


@dataclass(frozen=True)
class Layers:
    """A network in layers, to be played from its first one.

    Attributes
    ----------
    network : Network
        Its links.
    names : tuple of str
        "A1", "A2", "B1", ...
    layers : tuple of int
        The layer of each unit, 0 for A.
    """

    network: Network
    names: tuple[str, ...]
    layers: tuple[int, ...]

    def start(self) -> Ints:
        """Return the units of layer A."""
        return np.flatnonzero(np.array(self.layers) == 0)

    def unit(self, name: str) -> int:
        """Return the number of a unit."""
        return self.names.index(name)

    def played(self, rule: Rule) -> Play:
        """Return what comes of exciting layer A."""
        return play(self.network, rule, self.start())


def expansion(sizes: tuple[int, ...]) -> Layers:
    """Return layers in which each unit faces the whole next layer.

    (2, 3, 4) is figure B, which conducts; (2, 7) is figure D, where every A-unit would have to
    excite 3.5 (SG-i).

    Parameters
    ----------
    sizes : tuple of int
        Number of units of each layer.
    """
    return Layers(layered(sizes), *_named(sizes))


def fibre(speed: float, beside: tuple[int, int] = (2, 3), last: int = 5) -> Layers:
    """Return figure F: a fibre A1, B1, C1 that outruns its neighbours A2, B2..., C2...

    C1 begins with all D-units by itself. It is spent at T1 = 2 / speed + n_max, if there are more
    D-units than that; the other C-units begin at T2 = beside[0] + beside[1] / beside[0]. If T1 <
    T2, the D-units were charged in vain and nothing excites them any more: SC-ii.

    Parameters
    ----------
    speed : float
        How much faster the fibre is.
    beside : pair of int
        How many B-units and C-units are not on the fibre; figure F has 2 and 3.
    last : int
        Number of D-units.

    Notes
    -----
    Source: Chun's paper, Appendix B. That C1 faces *all* D-units belongs to the layers without
    geometry; in the packing itself it faces two of them.
    """
    second, third = beside
    sizes = (2, 1 + second, 1 + third, last)
    names, layers = _named(sizes)
    b, c, d = 2, 3 + second, 4 + second + third
    links = [(0, b), (b, c)]
    speeds = [speed, speed]
    links += [(1, b + k) for k in range(1, 1 + second)]
    links += [(b + j, c + k) for j in range(1, 1 + second) for k in range(1, 1 + third)]
    links += [(c + k, d + j) for k in range(1 + third) for j in range(last)]
    speeds += [1.0] * (len(links) - 2)
    return Layers(linked(len(names), links, np.array(speeds)), names, layers)


def in_rows(sizes: tuple[int, ...], speed: float = 1.0) -> Layers:
    """Return layers as they lie in the packing: unit k faces k and k + 1 of the next layer.

    Parameters
    ----------
    sizes : tuple of int
        Number of units of each layer, each one more than the layer before.
    speed : float
        How much faster the links from first unit to first unit are.
    """
    names, layers = _named(sizes)
    starts = np.concatenate([[0], np.cumsum(sizes)])
    links, speeds = [], []
    for layer, size in enumerate(sizes[:-1]):
        for k in range(size):
            for onward in (k, k + 1):
                links.append((int(starts[layer]) + k, int(starts[layer + 1]) + onward))
                speeds.append(speed if k == onward == 0 else 1.0)
    return Layers(linked(len(names), links, np.array(speeds)), names, layers)


def _named(sizes: tuple[int, ...]) -> tuple[tuple[str, ...], tuple[int, ...]]:
    pairs = [(k, j) for k, size in enumerate(sizes) for j in range(size)]
    return tuple(f"{chr(65 + k)}{j + 1}" for k, j in pairs), tuple(k for k, _ in pairs)


@dataclass(frozen=True)
class Fate:
    """What became of a unit: when it was excited first (None: never), whether charged in vain."""

    name: str
    first: float | None
    in_vain: bool


@dataclass(frozen=True, kw_only=True)
class StopFinding:
    """What came of layers, as ``cardiosurf discrete sg-i --json`` prints it.

    Attributes
    ----------
    name : str
        Which of ``STOPS``.
    about : str
        What it shows.
    rule : Rule
        What a unit can do.
    conducts : bool
        Whether the last layer was excited.
    units : tuple of Fate
        What became of each unit.
    """

    name: str
    about: str
    rule: Rule
    conducts: bool
    units: tuple[Fate, ...]
    schema: Literal["cardiosurf/stop/1"] = "cardiosurf/stop/1"

    def to_json(self) -> dict[str, Any]:
        """Return the finding as plain JSON data, ``schema`` first."""
        data = asdict(self)
        return {"schema": data.pop("schema"), **data}


STOPS: dict[str, tuple[str, Layers]] = {
    "free": ("figure B: 2, 3 and 4 units", expansion((2, 3, 4))),
    "sg-i": ("figure D, SG-i: 2 units for 7", expansion((2, 7))),
    "sc-ii": ("figure F and a unit more in B and C, fibre 4 times as fast", fibre(4.0, (3, 4))),
    "figure-f": ("figure F as printed, fibre 4 times as fast", fibre(4.0)),
}
"""The appendix's scenarios by their names, each with what it shows."""


def play_stop(name: str, rule: Rule) -> StopFinding:
    """Return what comes of one of the appendix's scenarios.

    Parameters
    ----------
    name : str
        Which of ``STOPS``.
    rule : Rule
        What a unit can do.
    """
    about, layers = STOPS[name]
    played = layers.played(rule)
    last = np.array(layers.layers) == max(layers.layers)
    units = tuple(
        Fate(unit, float(first) if np.isfinite(first) else None, bool(failures))
        for unit, first, failures in zip(layers.names, played.first, played.failures, strict=True)
    )
    conducts = bool(np.isfinite(played.first[last]).all())
    return StopFinding(name=name, about=about, rule=rule, conducts=conducts, units=units)


def stop_schema() -> dict[str, Any]:
    """Return the JSON Schema of a scenario's finding; every key is always there, and no other."""
    return result_schema(StopFinding, "cardiosurf/stop/1")
