"""Wavefronts of an activation map: isochrones over the triangles, and their geodesic curvature."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.analysis.conductor import Conductor
from cardiosurf.analysis.trajectories import Places
from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.topology import area_vectors, numbered_edges

WINDOW = 4.0
"""Half the length of front that a curvature is fitted to, in mean edge lengths."""


@dataclass(frozen=True)
class Wavefront:
    """A connected piece of an isochrone: straight in each triangle, from edge to edge.

    Attributes
    ----------
    time : float
        Its LAT, in tu.
    points : (k, 3) float
        Where it crosses edges, in order, with the later tissue on its left as seen from where the
        triangles run counter-clockwise; a closed one does not repeat its first point.
    places : Places
        The same points, each in the triangle that the front goes on in (at the end of an open one:
        comes from).
    closed : bool
        Whether it ends where it begins.
    """

    time: float
    points: Floats
    places: Places
    closed: bool

    def arc(self) -> Floats:
        """Return the length along it up to each point, (k,), in su."""
        steps = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        return np.concatenate([[0.0], np.cumsum(steps)])

    def length(self) -> float:
        """Return its length, in su."""
        closing = np.linalg.norm(self.points[0] - self.points[-1]) if self.closed else 0.0
        return float(self.arc()[-1] + closing)


@dataclass(frozen=True)
class FrontCurvature:
    """Geodesic curvature along a front.

    Attributes
    ----------
    curvature : (k,) float
        1/su at each point, positive where the front bulges into later tissue (diverges); NaN where
        the front is too short for a fit.
    error : (k,) float
        Standard error of the fit, in 1/su.
    window : float
        Half the length of front that each was fitted to, in su.
    """

    curvature: Floats
    error: Floats
    window: float


def wavefronts(conductor: Conductor, lat: Floats, time: float) -> tuple[Wavefront, ...]:
    """Return the pieces of the isochrone T = time, the longest first.

    Parameters
    ----------
    conductor : Conductor
        The triangles.
    lat : (n,) float
        Activation times, in tu; NaN where never: no front goes through a triangle with such a
        vertex.
    time : float
        In tu.
    """
    triangles = conductor.triangles
    corners = lat[triangles]
    late = corners >= time
    crossed = np.isfinite(corners).all(axis=1) & late.any(axis=1) & ~late.all(axis=1)
    chosen = np.flatnonzero(crossed)
    enters, leaves, share_in, share_out = _crossings(corners[chosen], late[chosen], time)
    edges = numbered_edges(triangles)[1][chosen]
    rows = np.arange(len(chosen))
    chains = _chains(edges[rows, enters], edges[rows, leaves])
    found = []
    for chain, closed in chains:
        where, shares = chosen[chain], share_in[chain]
        if not closed:
            where, shares = np.append(where, where[-1]), np.vstack([shares, share_out[chain[-1]]])
        places = Places(where, shares)
        found.append(Wavefront(float(time), places.points(conductor), places, closed))
    return tuple(sorted(found, key=lambda front: -front.length()))


def _crossings(corners: Floats, late: Mask, time: float) -> tuple[Ints, Ints, Floats, Floats]:
    """Return through which edges of each triangle a front comes and goes, and where, (k, 3).

    With the late side on its left it comes through the edge from a late to an early corner, going
    round the triangle, and leaves through the one from an early to a late one.
    """
    count = len(corners)
    rows = np.arange(count)
    following = np.roll(late, -1, axis=1)
    turns = []
    for step in (late & ~following, ~late & following):
        begin = np.argmax(step, axis=1)
        end = (begin + 1) % 3
        first, second = corners[rows, begin], corners[rows, end]
        share = (time - first) / (second - first)
        shares = np.zeros((count, 3))
        shares[rows, begin], shares[rows, end] = 1.0 - share, share
        turns.append(((begin + 2) % 3, shares))
    return turns[0][0], turns[1][0], turns[0][1], turns[1][1]


def _chains(enters: Ints, leaves: Ints) -> list[tuple[Ints, bool]]:
    """Return the rows in the order in which one enters through the edge that another left by."""
    by_entry = {edge: row for row, edge in enumerate(enters.tolist())}
    following = [by_entry.get(edge, -1) for edge in leaves.tolist()]
    led_to = set(following)
    left = dict.fromkeys(range(len(enters)))
    heads = [row for row in range(len(enters)) if row not in led_to]
    chains = []
    while left:
        closed = not heads
        row = next(iter(left)) if closed else heads.pop()
        chain = []
        while row in left:
            del left[row]
            chain.append(row)
            row = following[row]
        chains.append((np.array(chain), closed))
    return chains


def front_curvature(
    conductor: Conductor, front: Wavefront, *, window: float | None = None
) -> FrontCurvature:
    """Return the geodesic curvature along a front, by local parabolas.

    At each point the front within ``window`` on both sides is seen from above the surface, and a
    parabola is fitted to it by least squares, each point with the length of front that belongs to
    it: K = -2 a2/(1 + a1^2)^(3/2). What is seen from above the tangent plane has the geodesic
    curvature. A window of several edges averages what linear times put into an isochrone (its
    points are off by up to h^2/8 of its curvature). A curvature that changes over less than the
    window is flattened, and that of a circle is too large by the part 0.2 (K window)^2. Near the
    ends of an open front the window is one-sided.

    Parameters
    ----------
    conductor : Conductor
        The triangles.
    front : Wavefront
        The front.
    window : float, optional
        Half the length of the fit, in su; 4 mean edge lengths without.
    """
    sides = np.linalg.norm(np.diff(conductor.points[conductor.triangles[:, :2]], axis=1), axis=2)
    half = WINDOW * float(sides.mean()) if window is None else window
    count = len(front.points)
    normals = area_vectors(conductor.points, conductor.triangles[front.places.triangles])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    arc, length = front.arc(), front.length()
    weights = _lengths(arc, length, closed=front.closed)
    curvature, error = np.full(count, np.nan), np.full(count, np.nan)
    for i in range(count):
        away = arc - arc[i]
        if front.closed:
            away -= length * np.round(away / length)
        near = np.flatnonzero((np.abs(away) <= half) & (weights > 0.0))
        if len(near) < 5 or np.ptp(away[near]) < half:
            continue
        upward = (weights[near, None] * normals[near]).sum(axis=0)
        seen = _from_above(front.points[near] - front.points[i], upward, away[near])
        curvature[i], error[i] = _parabola(seen, weights[near])
    return FrontCurvature(curvature, error, half)


def _lengths(arc: Floats, length: float, *, closed: bool) -> Floats:
    """Return the length of front that belongs to each point, (k,)."""
    steps = np.diff(arc)
    last = length - arc[-1] if closed else 0.0
    before, after = np.concatenate([[last], steps]), np.concatenate([steps, [last]])
    return np.asarray(0.5 * (before + after))


def _from_above(away: Floats, upward: Floats, arc: Floats) -> tuple[Floats, Floats]:
    """Return the points (k, 3) along the front and across it, towards later tissue."""
    upward = upward / np.linalg.norm(upward)
    along = away.T @ (arc - arc.mean())
    along -= upward * (along @ upward)
    along /= np.linalg.norm(along)
    return away @ along, away @ np.cross(upward, along)


def _parabola(seen: tuple[Floats, Floats], weights: Floats) -> tuple[float, float]:
    """Return -2 a2/(1 + a1^2)^(3/2) of the parabola through the points, and its standard error."""
    x, y = seen
    powers = np.stack([np.ones_like(x), x, x * x], axis=1)
    scale = weights / weights.mean()
    system = powers.T @ (scale[:, None] * powers)
    found = np.linalg.solve(system, powers.T @ (scale * y))
    left = y - powers @ found
    variance = float(scale @ (left * left)) / max(len(x) - 3, 1)
    spread = float(np.sqrt(variance * np.linalg.inv(system)[2, 2]))
    slant = float((1.0 + found[1] ** 2) ** 1.5)
    return -2.0 * float(found[2]) / slant, 2.0 * spread / slant
