"""Units and who can excite whom: layers without geometry, and the hexagonal packing."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.errors import InputError

NEIGHBOURS = np.array([[1, 0], [0, 1], [-1, 1], [-1, 0], [0, -1], [1, -1]])
"""Steps to the six neighbours in the packing's oblique coordinates (60 degrees apart)."""


@dataclass(frozen=True)
class Network:
    """Units and the directed links along which one can excite another.

    Attributes
    ----------
    count : int
        Number of units n.
    sources, targets : (e,) int
        The units at both ends of each link.
    speeds : (e,) float
        How much faster than elsewhere a link charges its target, above 0.
    costs : (e,) float
        What exciting the target through this link takes, above 0; 1 is a unit like the source.
    """

    count: int
    sources: Ints
    targets: Ints
    speeds: Floats
    costs: Floats


def linked(
    count: int,
    links: Sequence[tuple[int, int]] | Ints,
    speeds: Floats | None = None,
    costs: Floats | None = None,
) -> Network:
    """Return a network of links (source, target), all alike where nothing else is given.

    Parameters
    ----------
    count : int
        Number of units.
    links : (e, 2) int
        Source and target of each link.
    speeds, costs : (e,) float, optional
        As in ``Network``; 1 by default.

    Raises
    ------
    InputError
        If a link names a unit that is not there, or a speed or a cost is not above 0.
    """
    pairs = np.asarray(links, dtype=np.int64).reshape(-1, 2)
    if pairs.size and not 0 <= pairs.min() <= pairs.max() < count:
        raise InputError("links", "a link names a unit that is not there", f"0 to {count - 1}")
    ones = np.ones(len(pairs))
    fast = ones if speeds is None else np.asarray(speeds, dtype=np.float64)
    dear = ones if costs is None else np.asarray(costs, dtype=np.float64)
    for name, values in (("speeds", fast), ("costs", dear)):
        if not (np.isfinite(values) & (values > 0.0)).all():
            raise InputError(name, "a value is not above 0", "finite numbers above 0")
    return Network(count, pairs[:, 0], pairs[:, 1], fast, dear)


def layered(sizes: Sequence[int]) -> Network:
    """Return layers of units, each unit linked to all units of the next layer.

    The paper's "geometry-free" model: a layer excites the next one together and never itself or
    the one before it. Units are numbered layer by layer.

    Parameters
    ----------
    sizes : sequence of int
        Number of units of each layer.

    Notes
    -----
    Source: Chun's paper, Appendix B, figure relaccel2 B and D.
    """
    starts = np.concatenate([[0], np.cumsum(sizes)])
    links = [
        (source, target)
        for k in range(len(sizes) - 1)
        for source in range(starts[k], starts[k + 1])
        for target in range(starts[k + 1], starts[k + 2])
    ]
    return linked(int(starts[-1]), links)


@dataclass(frozen=True)
class Packing:
    """A hexagonal packing on a plane.

    Attributes
    ----------
    places : (n, 2) float
        Centre of each unit, in distances between neighbours.
    network : Network
        Its links, in both directions.
    """

    places: Floats
    network: Network


def packed(
    inside: Callable[[Floats], Mask],
    reach: float,
    diffusivity: Callable[[Floats], Floats] | None = None,
    *,
    loads: bool = True,
) -> Packing:
    """Return the units of a hexagonal packing (rows along x) whose centres lie in a region.

    Parameters
    ----------
    inside : callable
        Which of the places (n, 2) belong to it, (n,) bool.
    reach : float
        No place is farther from the origin than this.
    diffusivity : callable, optional
        The factors along x and y (n, 2) at places (n, 2); 1 by default.
    loads : bool
        As in ``link_factors``.
    """
    most = int(np.ceil(2.0 * reach / np.sqrt(3.0))) + 1
    grid = np.arange(-most, most + 1)
    steps = np.stack(np.meshgrid(grid, grid, indexing="ij"), axis=-1).reshape(-1, 2)
    places = _centres(steps)
    chosen = (np.hypot(places[:, 0], places[:, 1]) <= reach) & inside(places)
    steps, places = steps[chosen], places[chosen]
    number = np.full((2 * most + 3, 2 * most + 3), -1, dtype=np.int64)
    number[tuple((steps + most + 1).T)] = np.arange(len(steps))
    beside = number[tuple((steps[:, None] + NEIGHBOURS + most + 1).transpose(2, 0, 1))]
    source, way = np.nonzero(beside >= 0)
    target = beside[source, way]
    speeds = costs = None
    if diffusivity is not None:
        factors, towards = diffusivity(places), _centres(NEIGHBOURS)[way] ** 2
        along = [(factors[end] * towards).sum(axis=1) for end in (source, target)]
        speeds, costs = link_factors(along[0], along[1], loads=loads)
    pairs = np.stack([source, target], axis=1)
    return Packing(places, linked(len(places), pairs, speeds, costs))


def link_factors(source: Floats, target: Floats, *, loads: bool) -> tuple[Floats, Floats]:
    """Return the speed and the cost of links between units of given diffusivity.

    A wave is sqrt(d) faster. The flux that its front needs goes with sqrt(d) too, so a source of
    diffusivity d_s that excites a target of d_t has a load of sqrt(d_t / d_s) targets of its own
    kind. The paper speaks of the speed only.

    Parameters
    ----------
    source, target : (e,) float
        Diffusivity along the link at its two ends, relative to ordinary tissue.
    loads : bool
        Whether the target's greater need counts; False is the paper's reading, every cost 1.
    """
    speeds = np.sqrt(source)
    return speeds, np.sqrt(target / source) if loads else np.ones(len(speeds))


def _centres(steps: Ints) -> Floats:
    return np.asarray(steps @ np.array([[1.0, 0.0], [0.5, np.sqrt(0.75)]]))
