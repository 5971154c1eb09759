"""How a wave that no patch disturbs would meet a patch: edge by edge, of its entrance or all round.

Unlike ``entrance``, which looks at a run a front width before the patch, where the load is not felt
yet, this looks at arrival times without any patch, at the edge itself: nothing bends them there.
"""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from cardiosurf.analysis.quadratic import Fit
from cardiosurf.analysis.route import Map, edges_of, entrance_edges
from cardiosurf.analysis.source_sink import Edge
from cardiosurf.arrays import Floats, Ints, Mask

RADIUS = 8.0
"""Of the neighbourhood that arrival times are fitted in, in su; at least 2.5 edge lengths."""
WORST = 0.1
"""A fit that is off by more, in units of the front's time over the radius: fronts meet there."""


@dataclass(frozen=True)
class Incidence:
    """The undisturbed front at k edges of a patch.

    Attributes
    ----------
    points : (k, 3) float
        Middles of the edges, in su.
    lengths : (k,) float
        Their lengths, in su.
    times : (k,) float
        When the front is there, in tu.
    angle : (k,) float
        Angle of incidence A from the inward normal, in radians: from 0 to pi/2 where the front
        goes in, up to pi where it comes out.
    curvature : (k,) float
        Geodesic curvature K of the front, in 1/su; positive where it diverges.
    before, within : Edge
        The diffusivities on both sides, in su^2/tu.
    heading : (k,) float
        d inside the patch in the front's direction, in su^2/tu.
    enters : (k,) bool
        Whether the edge is one of the entrance: the front goes in, and not merely along.
    triangles : (k, 2) int
        The triangles inside and outside the patch.
    """

    points: Floats
    lengths: Floats
    times: Floats
    angle: Floats
    curvature: Floats
    before: Edge
    within: Edge
    heading: Floats
    enters: Mask
    triangles: Ints

    def only(self, chosen: Mask) -> "Incidence":
        """Return the same at some of the edges (k,)."""

        def kept(value: Any) -> Any:
            return value.only(chosen) if isinstance(value, Edge) else value[chosen]

        return Incidence(**{one.name: kept(getattr(self, one.name)) for one in fields(self)})

    def median(self, values: Floats) -> float | None:
        """Return the median of a field (k,) over the length of the entrance; None: not known."""
        return weighted_quantile(values, self.lengths, 0.5)


def incidence(wave: Map, inside: Mask) -> Incidence:
    """Return how the undisturbed wave meets a patch, all round it.

    Parameters
    ----------
    wave : Map
        Its arrival as ``lat`` and as ``unperturbed``, and the tissue with its patches.
    inside : (m,) bool
        The patch's triangles.

    Returns
    -------
    Incidence
        Without the edges where fronts meet, or where no wave comes.
    """
    points, triangles = wave.points, wave.triangles
    outside = wave.excitable & ~inside
    edges, owner = edges_of(triangles, inside, outside)
    # the same edges in the same order
    before = edges_of(triangles, outside, inside)[1]
    keys = [pairs @ np.array([len(points), 1]) for pairs in (edges, entrance_edges(wave, inside))]
    sides = points[edges[:, 1]] - points[edges[:, 0]]
    lengths = np.linalg.norm(sides, axis=1)
    along = sides / lengths[:, None]
    inward = points[triangles[owner]].mean(axis=1) - points[edges[:, 0]]
    inward -= along * np.einsum("ki,ki->k", inward, along)[:, None]
    inward /= np.linalg.norm(inward, axis=1)[:, None]
    direction, curvature = _fronts(wave, edges)
    sine = np.abs(np.einsum("ki,ki->k", direction, along))
    cosine = np.einsum("ki,ki->k", direction, inward)
    angle = np.arctan2(sine, cosine)
    tensor = wave.tensor
    within = Edge.of(tensor[owner], inward, along)
    cos, sin = np.cos(angle), np.einsum("ki,ki->k", direction, along)
    round_it = Incidence(
        points=points[edges].mean(axis=1),
        lengths=lengths,
        times=wave.lat[edges].mean(axis=1),
        angle=angle,
        curvature=curvature,
        before=Edge.of(tensor[before], inward, along),
        within=within,
        heading=within.normal * cos**2
        + within.tangential * sin**2
        + 2.0 * within.mixed * sin * cos,
        enters=np.isin(*keys) & (angle < 0.5 * np.pi),
        triangles=np.column_stack((owner, before)),
    )
    return round_it.only(np.isfinite(angle + curvature))


def weighted_quantile(values: Floats, weights: Floats, share: float) -> float | None:
    """Return the value below which a share of the weight lies; None without values.

    Parameters
    ----------
    values, weights : (k,) float
        Values, infinite ones among them, and their weights.
    share : float
        From 0 to 1.
    """
    if not len(values):
        return None
    order = np.argsort(values, kind="stable")
    below = np.cumsum(weights[order])
    place = int(np.searchsorted(below, share * below[-1]))
    return float(values[order][min(place, len(values) - 1)])


def _fronts(wave: Map, edges: Ints) -> tuple[Floats, Floats]:
    """Return direction (k, 3) and curvature (k,) of the front at edges; NaN where fronts meet."""
    sides = wave.points[edges[:, 1]] - wave.points[edges[:, 0]]
    usual = float(np.median(np.linalg.norm(sides, axis=1))) if len(edges) else 0.0
    ground = wave.triangles[wave.excitable]
    fit = Fit.of(wave.points, ground, np.isfinite(wave.lat), max(RADIUS, 2.5 * usual))
    vertices, own = np.unique(edges, return_inverse=True)
    found = np.full((len(vertices), 4), np.nan)
    for row, vertex in zip(found, vertices.tolist(), strict=True):
        front = fit.around(vertex, wave.lat)
        if front is None:
            continue
        gradient, hessian, misfit = front
        steepness = float(np.linalg.norm(gradient))
        if misfit <= WORST * fit.radius * steepness:
            unit = gradient / steepness
            row[:3] = unit
            row[3] = (np.trace(hessian) - unit @ hessian @ unit) / steepness
    mean = found[own.reshape(edges.shape)].mean(axis=1)
    size = np.linalg.norm(mean[:, :3], axis=1, keepdims=True)
    with np.errstate(invalid="ignore", divide="ignore"):
        return mean[:, :3] / size, mean[:, 3]
