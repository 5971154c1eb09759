"""How a wave meets a patch: angle of incidence and curvature of the front along its entrance.

Both are read off the activation map one front width before the patch, where its load is not felt
yet. Around each of the places there T, the LAT, is fitted by a quadratic in the tangent plane:

    cos(angle) = n . grad T / |grad T|,    K = div(grad T / |grad T|),    speed = 1 / |grad T|

with n the direction to the patch by the shortest way. K is the geodesic curvature of the isochrone:
the tangent plane differs from normal coordinates of the surface by terms of third order, so that
the second derivatives of the fit are the surface's own. K > 0 where the front diverges: 1/r at
distance r from a point on the plane.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.analysis.eikonal import distance_from
from cardiosurf.analysis.quadratic import Fit
from cardiosurf.analysis.route import FRONT_WIDTH, Map, entrance_edges
from cardiosurf.analysis.sources import Sources
from cardiosurf.analysis.stimulation import stimulation
from cardiosurf.analysis.waves import trace_waves
from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.errors import InputError
from cardiosurf.recording.recording import Recording
from cardiosurf.spelling import did_you_mean

BEFORE = FRONT_WIDTH
"""How far before the patch the front is looked at, in su."""
RADIUS = 8.0
"""Of the neighbourhood that is fitted, in su; at least 2.5 edge lengths."""
HEAD_ON = np.radians(15.0)
"""Largest angle of incidence at which a front counts as meeting the patch head on."""
NEAREST = 0.5
"""What of that way no neighbourhood goes beyond."""
GRAZING = 0.1
"""Cosine of the largest angle at which the unperturbed wave still counts as entering."""
WORST = 0.1
"""A fit that is off by more, in units of the front's time over the radius, is none: a collision."""


@dataclass(frozen=True)
class Profile:
    """The front along one piece of an entrance, a front width before it.

    Attributes
    ----------
    position : (k,) float
        Arc length along the entrance of the point that is entered, in su. It counts from that
        end of the piece whose coordinates (x, then y, then z) are the smaller.
    points : (k, 3) float
        Where the front was looked at, in su.
    lat : (k,) float
        When it was there, in tu; NaN, as in what follows, where it never came.
    angle : (k,) float
        Between its direction and the way to the patch, in radians; positive where it runs towards
        larger positions.
    curvature : (k,) float
        Geodesic curvature of the isochrone, in 1/su; positive where the front diverges.
    speed : (k,) float
        In su/tu.
    length : float
        Of this piece of the entrance, in su.
    start, end : (3,) float
        Its ends.
    """

    position: Floats
    points: Floats
    lat: Floats
    angle: Floats
    curvature: Floats
    speed: Floats
    length: float
    start: Floats
    end: Floats


def head_on_length(
    position: Floats, angle: Floats, length: float, within: float = HEAD_ON
) -> float:
    """Return how much of a piece of an entrance the front meets head on, in su.

    Each place stands for the entrance half way to its neighbours, the first and last for what is
    beyond them.

    Parameters
    ----------
    position, angle : (k,) float
        As in a Profile; NaN is not head on.
    length : float
        Of the piece, in su.
    within : float
        Largest angle of incidence that counts, in radians.
    """
    if not len(position):
        return 0.0
    # several places may enter at the same point of the edge
    at, own = np.unique(position, return_inverse=True)
    share = np.bincount(own, weights=np.abs(angle) <= within) / np.bincount(own)
    limits = np.concatenate(([0.0], 0.5 * (at[1:] + at[:-1]), [length]))
    return float(share @ np.diff(limits))


@dataclass(frozen=True)
class _Piece:
    """Vertices of a connected piece of the entrance in turn, and their arc lengths."""

    vertices: Ints
    position: Floats


def patch_entrances(recording: Recording, patch: str) -> tuple[Profile, ...]:
    """Return how the first wave of a run meets a patch along each piece of its entrance.

    Parameters
    ----------
    recording : Recording
        A finished run.
    patch : str
        The patch's name.

    Raises
    ------
    InputError
        The run has no such patch.
    """
    inside = recording.patches.get(patch)
    if inside is None:
        guess = did_you_mean(patch, list(recording.patches))
        problem = f"has no patch {patch!r}" + (f", {guess}" if guess else "")
        raise InputError(recording.name, problem, ", ".join(recording.patches) or "it has none")
    surface, tissue = recording.surface, recording.tissue
    waves = trace_waves(
        recording.activations,
        recording.repolarisations,
        surface.triangles,
        recording.pulses,
        recording.node_count,
    )
    activation = Map(
        surface.points,
        surface.triangles,
        tissue.tensor,
        tissue.excitable,
        recording.first_activation,
        stimulation(recording, waves).unperturbed,
    )
    return entrance_profiles(activation, inside)


def entrance_profiles(
    activation: Map, inside: Mask, *, before: float = BEFORE, radius: float = RADIUS
) -> tuple[Profile, ...]:
    """Return how a wave meets a patch along each connected piece of its entrance.

    Parameters
    ----------
    activation : Map
        The activation map; ``unperturbed`` tells where the entrance is.
    inside : (m,) bool
        The patch's triangles.
    before : float
        How far before the patch to look, in su.
    radius : float
        Of the neighbourhoods that are fitted, in su; at least 2.5 edge lengths are taken.

    Returns
    -------
    tuple of Profile
        The longest piece first; none if the wave enters nowhere.
    """
    edges = entrance_edges(activation, inside, GRAZING)
    if not len(edges):
        return ()
    points, outside = activation.points, activation.excitable & ~inside
    ground = activation.triangles[outside]
    distance = distance_from(points, ground, Sources.at(np.unique(edges)))
    sides = points[edges[:, 1]] - points[edges[:, 0]]
    edge = float(np.median(np.linalg.norm(sides, axis=1)))
    layer = np.flatnonzero(np.abs(distance - before) < 0.5 * edge)
    # nearer than that the load is felt: there may be tissue that is activated much later
    away = np.isfinite(distance) & (distance > NEAREST * before)
    fit = Fit.of(points, ground, away, max(radius, 2.5 * edge))
    pieces = [_in_turn(points, piece) for piece in _pieces(edges)]
    entered = np.concatenate([piece.vertices for piece in pieces])
    nearest = np.asarray(scipy.spatial.cKDTree(points[entered]).query(points[layer])[1])
    found, first = [], 0
    for piece in pieces:
        # what is nearest to an end may lie beyond it, where there is nothing to enter
        own = (nearest > first) & (nearest < first + len(piece.vertices) - 1)
        place = nearest[own] - first
        found.append(_profile(activation, distance, fit, piece, (layer[own], place)))
        first += len(piece.vertices)
    return tuple(sorted(found, key=lambda one: -one.length))


def _profile(
    activation: Map, distance: Floats, fit: Fit, piece: _Piece, places: tuple[Ints, Ints]
) -> Profile:
    """Return the profile of a piece, read at vertices that enter it at its given vertices."""
    rows = []
    for vertex, place in zip(*(one.tolist() for one in places), strict=True):
        neighbours = piece.vertices[[place - 1, place + 1]]
        along = np.subtract(*activation.points[neighbours][::-1])
        front = _front(fit, vertex, activation.lat, distance, along)
        rows.append((piece.position[place], activation.lat[vertex], *front))
    table = np.array(rows, dtype=np.float64).reshape(-1, 5)
    order = np.argsort(table[:, 0], kind="stable")
    position, lat, angle, curvature, speed = table[order].T
    return Profile(
        position=position,
        points=activation.points[places[0][order]],
        lat=lat,
        angle=angle,
        curvature=curvature,
        speed=speed,
        length=float(piece.position[-1]),
        start=activation.points[piece.vertices[0]],
        end=activation.points[piece.vertices[-1]],
    )


def _front(
    fit: Fit, vertex: int, lat: Floats, distance: Floats, along: Floats
) -> tuple[float, float, float]:
    """Return angle, curvature and speed of the front at a vertex; NaN where it has none."""
    front, way = fit.around(vertex, lat), fit.around(vertex, distance)
    if front is None or way is None or not np.isfinite(lat[vertex]):
        return np.nan, np.nan, np.nan
    gradient, hessian, misfit = front
    steepness = float(np.linalg.norm(gradient))
    if misfit > WORST * fit.radius * steepness:
        return np.nan, np.nan, np.nan
    direction, inward = gradient / steepness, -way[0] / np.linalg.norm(way[0])
    sideways = along - (along @ inward) * inward
    sine = float(direction @ sideways / np.linalg.norm(sideways))
    # div(g/|g|) = (tr H - d . H d) / |g|, d = g/|g|
    curvature = float(np.trace(hessian) - direction @ hessian @ direction) / steepness
    return float(np.arctan2(sine, direction @ inward)), curvature, 1.0 / steepness


def _pieces(edges: Ints) -> list[Ints]:
    """Return the connected pieces of a set of edges (k, 2), each as edges again."""
    names, number = np.unique(edges, return_inverse=True)
    ends = number.reshape(-1, 2)
    links = scipy.sparse.coo_array(
        (np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(len(names), len(names))
    )
    count, label = scipy.sparse.csgraph.connected_components(links, directed=False)
    return [edges[label[ends[:, 0]] == one] for one in range(count)]


def _in_turn(points: Floats, edges: Ints) -> _Piece:
    """Return the vertices of a connected piece in turn, and their arc lengths from its start."""
    beside: dict[int, list[int]] = {}
    for a, b in edges.tolist():
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    ends = [vertex for vertex, others in beside.items() if len(others) == 1] or list(beside)
    here = min(ends, key=lambda vertex: tuple(points[vertex].round(6).tolist()))
    turn, seen = [here], {here}
    while following := [vertex for vertex in beside[here] if vertex not in seen]:
        here = following[0]
        turn.append(here)
        seen.add(here)
    vertices = np.array(turn)
    sides = np.linalg.norm(np.diff(points[vertices], axis=0), axis=1)
    return _Piece(vertices, np.concatenate(([0.0], np.cumsum(sides))))
