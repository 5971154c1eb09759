"""One trajectory over the triangles: straight in each, from edge to edge."""

from typing import Any

import numpy as np

from cardiosurf.stepping.compiled.keep import apart, compiled

OPEN_EDGE, MEETING, STILL, LONG = np.arange(4)
"""How a trajectory ends: at an open edge, where flows meet (or there is no way on), in tissue
without a direction (never reached, or excited all at once), or because there was no more room."""
TURNS = 12
"""Edges crossed on the spot after which a trajectory counts as being at a vertex."""
CLOSE = 1e-12


@apart
def way_out(shares: Any, rates: Any) -> Any:
    """Return when, and through the edge opposite which corner, a straight line leaves a triangle.

    ``shares`` are the barycentric coordinates and ``rates`` what they grow by.
    """
    when, corner = np.inf, -1
    for k in range(3):
        if rates[k] < 0.0:
            time = max(shares[k], 0.0) / -rates[k]
            if time < when:
                when, corner = time, k
    return when, corner


@apart
def sector(web: Any, vertex: Any) -> Any:
    """Return the triangle at a vertex into which its own flow leads from there, -1 for none.

    Of several the one whose flow is most in the middle.
    """
    starts, corners, rates = web[2], web[3], web[4]
    best, chosen = -1.0, -1
    for item in range(starts[vertex], starts[vertex + 1]):
        t, own = corners[item] // 3, corners[item] % 3
        one, two = rates[t, (own + 1) % 3], rates[t, (own + 2) % 3]
        if one >= 0.0 and two >= 0.0 and one + two > 0.0:
            middle = min(one, two) / max(one, two)
            if middle > best:
                best, chosen = middle, t
    return chosen


@apart
def steepest(web: Any, points: Any, heights: Any, vertex: Any) -> Any:
    """Return the neighbour towards which the height grows most, -1 if it grows to none."""
    triangles, starts, corners = web[0], web[2], web[3]
    best, chosen = 0.0, -1
    for item in range(starts[vertex], starts[vertex + 1]):
        t, own = corners[item] // 3, corners[item] % 3
        for turn in range(1, 3):
            other = triangles[t, (own + turn) % 3]
            squared = 0.0
            for k in range(3):
                squared += (points[other, k] - points[vertex, k]) ** 2
            slope = (heights[other] - heights[vertex]) / np.sqrt(squared)
            if slope > best:
                best, chosen = slope, other
    return chosen


@apart
def write(track: Any, count: Any, web: Any, field: Any, t: Any, shares: Any) -> None:
    """Write a place of the trajectory: x, y, z, height, and the triangle it goes on in."""
    triangles = web[0]
    points, heights = field
    for k in range(5):
        track[count, k] = 0.0
    for i in range(3):
        vertex = triangles[t, i]
        for k in range(3):
            track[count, k] += shares[i] * points[vertex, k]
        track[count, 3] += shares[i] * heights[vertex]
    track[count, 4] = t


@apart
def onto_vertex(web: Any, t: Any, vertex: Any, shares: Any) -> None:
    """Set the barycentric coordinates of a vertex in one of its triangles."""
    for k in range(3):
        shares[k] = 1.0 if web[0][t, k] == vertex else 0.0


@apart
def onto_edge(web: Any, t: Any, shares: Any) -> Any:
    """Go straight to the edge that the flow leads to; return which, and whether that is a way."""
    rates = web[4]
    when, out = way_out(shares, rates[t])
    moved = 0.0
    for k in range(3):
        moved = max(moved, abs(when * rates[t, k]))
        shares[k] = max(shares[k] + when * rates[t, k], 0.0)
    shares[out] = 0.0
    whole = shares[0] + shares[1] + shares[2]
    for k in range(3):
        shares[k] /= whole
    return out, moved > CLOSE


@apart
def share_of(triangles: Any, t: Any, vertex: Any, shares: Any) -> Any:
    """Return the barycentric coordinate that belongs to a vertex, 0 if it is not one of t."""
    for k in range(3):
        if triangles[t, k] == vertex:
            return shares[k]
    return 0.0


@apart
def across(web: Any, t: Any, beyond: Any, shares: Any) -> None:
    """Set the barycentric coordinates of a place on an edge to those in the triangle beyond."""
    triangles = web[0]
    new = (
        share_of(triangles, t, triangles[beyond, 0], shares),
        share_of(triangles, t, triangles[beyond, 1], shares),
        share_of(triangles, t, triangles[beyond, 2], shares),
    )
    for k in range(3):
        shares[k] = new[k]


@apart
def meet(web: Any, t: Any, beyond: Any) -> Any:
    """Return whether the flow of one triangle runs against the gradient beyond its edge."""
    flow, slope = web[5], web[6]
    product = 0.0
    for k in range(3):
        product += flow[t, k] * slope[beyond, k]
    return product < 0.0


@apart
def along_edges(web: Any, field: Any, vertex: Any, track: Any, state: Any) -> Any:
    """Go on from a vertex, along edges if need be, up to where a flow leads into a triangle.

    ``field`` is (points, heights), ``state`` (places so far, shares). Returns the number of places
    and that triangle, -1 where there is no way on.
    """
    points, heights = field
    count, shares = state
    while count < len(track):
        onto = sector(web, vertex)
        t = web[3][web[2][vertex]] // 3 if onto < 0 else onto
        onto_vertex(web, t, vertex, shares)
        write(track, count, web, field, t, shares)
        count += 1
        if onto >= 0:
            return count, onto
        vertex = steepest(web, points, heights, vertex)
        if vertex < 0:
            return count, -1
    return count, -1


@compiled
def follow(web: Any, field: Any, start: Any, track: Any) -> Any:
    """Follow the flow from a place in a triangle, and return how many places it has and its end.

    ``web`` is (triangles, twins, starts, corners, rates, flow, slope): the half edges beyond each
    half edge, the corners around each vertex, and of each triangle what the barycentric
    coordinates grow by, the flow and the gradient that it follows. ``field`` is (points, heights),
    ``start`` (triangle, shares).
    """
    triangles, twins, rates, heights = web[0], web[1], web[4], field[1]
    t, shares = start[0], start[1].copy()
    write(track, 0, web, field, t, shares)
    count, idle = 1, 0
    while count < len(track):
        if not abs(rates[t, 0]) + abs(rates[t, 1]) + abs(rates[t, 2]) > 0.0:
            return count, STILL
        out, moved = onto_edge(web, t, shares)
        if moved:
            write(track, count, web, field, t, shares)
            count += 1
        idle = 0 if moved else idle + 1
        twin = twins[3 * t + out]
        if twin < 0:
            return count, OPEN_EDGE
        beyond, entry = twin // 3, twin % 3
        if idle < TURNS and rates[beyond, entry] > 0.0:
            across(web, t, beyond, shares)
            t = beyond
            track[count - 1, 4] = t
            continue
        if not abs(rates[beyond, entry]) >= 0.0:
            return count, STILL
        if idle < TURNS and meet(web, t, beyond):
            return count, MEETING
        # both flows lead onto the edge, and on along it to its higher end
        left, right = (out + 1) % 3, (out + 2) % 3
        higher = heights[triangles[t, left]] > heights[triangles[t, right]]
        if idle >= TURNS:
            higher = shares[left] > shares[right]
        vertex = triangles[t, left] if higher else triangles[t, right]
        count, t = along_edges(web, field, vertex, track, (count, shares))
        idle = 0
        if t < 0:
            return count, MEETING
    return count, LONG
