"""Arrival times over the triangles: settled in order at first order, then swept at second.

A triangle is known by the travel times along its edges: with a constant metric on each triangle it
is flat, and rays in it are straight. ``net`` is (triangles, starts, corners, lengths, sides,
pulls), see ``eikonal``.
"""

from typing import Any

import numpy as np

from cardiosurf.stepping.compiled.keep import apart, compiled

AGREEING = 0.5
"""How far the slopes at the ends of an edge may be from those of a parabola, relative to their
difference: further apart they belong to two fronts, or to two tissues."""
FOLDED = 0.05
"""The same relative to the edge: between triangles in different planes a slope is short by half the
square of the angle. Without it converging fronts, whose times are concave, come too early."""
ROUNDS = 8
"""Of Newton's method for the point where a ray crosses an edge; four are enough by far."""


@apart
def straight(first: Any, second: Any, edge: Any, to_first: Any, to_second: Any) -> Any:
    """Return the arrival at a corner through the opposite edge, and where the ray crosses it.

    The time on the edge is linear between those of its ends, and all lengths are travel times.
    """
    rise = second - first
    squared = edge * edge
    slack = squared - rise * rise
    foot = (squared + to_first * to_first - to_second * to_second) / (2.0 * squared)
    height = max(to_first * to_first - foot * foot * squared, 0.0)
    best, place = first + to_first, 0.0
    if second + to_second < best:
        best, place = second + to_second, 1.0
    if slack > 0.0:
        s = foot - rise * np.sqrt(height / (squared * slack))
        if 0.0 < s < 1.0:
            inside = first + s * rise + np.sqrt(height + squared * (s - foot) * (s - foot))
            if inside < best:
                best, place = inside, s
    return best, place


@apart
def curved(ends: Any, slopes: Any, lengths: Any, before: Any) -> Any:
    """Return what ``straight`` returns, the time on the edge a cubic with given slopes at its ends.

    ``lengths`` are those of the edge and from the corner to its ends. Where the slopes are unknown
    (NaN) or contradict the times, the time on the edge is linear; and where the cubic is not so far
    from the line that the arrival could be ``before`` what another triangle has found.
    """
    first, second = ends
    edge, to_first, to_second = lengths
    best, place = straight(first, second, edge, to_first, to_second)
    rise = second - first
    alpha, beta = slopes[0] - rise, slopes[1] - rise
    steepest = max(abs(alpha), abs(beta))
    # of a parabola the two are opposite
    if not abs(alpha + beta) <= AGREEING * steepest + FOLDED * edge:
        return best, place
    # s (1-s) times a mean of the two
    if best - 0.25 * steepest >= before:
        return best, place
    squared = edge * edge
    foot = (squared + to_first * to_first - to_second * to_second) / (2.0 * squared)
    height = max(to_first * to_first - foot * foot * squared, 0.0)
    s = min(max(place, 0.0), 1.0)
    total = alpha + beta
    for _ in range(ROUNDS):
        ray = np.sqrt(height + squared * (s - foot) * (s - foot)) + 1e-300
        # rise s + s (1-s) ((1-s) alpha - s beta)
        slope = rise + alpha - 2.0 * s * (total + alpha) + 3.0 * s * s * total
        bend = -2.0 * (total + alpha) + 6.0 * s * total
        bend += squared * height / (ray * ray * ray)
        if not bend > 0.0:
            break
        new = min(max(s - (slope + squared * (s - foot) / ray) / bend, 0.0), 1.0)
        moved = abs(new - s)
        s = new
        if moved < 1e-12:
            break
    ray = np.sqrt(height + squared * (s - foot) * (s - foot))
    onto = first + rise * s + s * (1.0 - s) * ((1.0 - s) * alpha - s * beta)
    best, place = onto + ray, s
    if first + to_first < best:
        best, place = first + to_first, 0.0
    if second + to_second < best:
        best, place = second + to_second, 1.0
    return best, place


@apart
def rise_up(heap: Any, where: Any, times: Any, at: Any) -> None:
    """Move an entry of the heap towards its top until its parent is earlier."""
    vertex = heap[at]
    while at > 0:
        parent = (at - 1) // 2
        if times[heap[parent]] <= times[vertex]:
            break
        heap[at] = heap[parent]
        where[heap[at]] = at
        at = parent
    heap[at] = vertex
    where[vertex] = at


@apart
def take_first(heap: Any, where: Any, times: Any, count: Any) -> Any:
    """Return the earliest vertex and take it from the heap of ``count`` entries."""
    first, last = heap[0], heap[count - 1]
    where[first] = -1
    left = count - 1
    at = 0
    while True:
        child = 2 * at + 1
        if child >= left:
            break
        if child + 1 < left and times[heap[child + 1]] < times[heap[child]]:
            child += 1
        if times[last] <= times[heap[child]]:
            break
        heap[at] = heap[child]
        where[heap[at]] = at
        at = child
    if left > 0:
        heap[at] = last
        where[last] = at
    return first


@compiled
def settle(net: Any, times: Any, tolerance: Any) -> Any:
    """Lower the times to the least that first-order updates make of the given ones.

    The earliest vertex is taken first; one that becomes earlier after it was taken is taken again,
    as it happens in obtuse triangles. Returns how many were taken.
    """
    triangles, starts, corners, lengths = net[0], net[1], net[2], net[3]
    heap = np.empty(len(times), dtype=np.int64)
    where = np.full(len(times), -1, dtype=np.int64)
    count, taken = 0, 0
    for vertex in range(len(times)):
        if times[vertex] < np.inf:
            heap[count] = vertex
            rise_up(heap, where, times, count)
            count += 1
    while count > 0:
        vertex = take_first(heap, where, times, count)
        count -= 1
        taken += 1
        for item in range(starts[vertex], starts[vertex + 1]):
            t, own = corners[item] // 3, corners[item] % 3
            for turn in range(1, 3):
                goal, other = (own + turn) % 3, (own + 3 - turn) % 3
                new, _ = straight(
                    times[vertex],
                    times[triangles[t, other]],
                    lengths[t, goal],
                    lengths[t, other],
                    lengths[t, own],
                )
                aim = triangles[t, goal]
                if new < times[aim] - tolerance:
                    times[aim] = new
                    if where[aim] < 0:
                        heap[count] = aim
                        where[aim] = count
                        count += 1
                    rise_up(heap, where, times, where[aim])
    return taken


@apart
def slope_along(gradient: Any, vertex: Any, side: Any) -> Any:
    """Return how much the time grows along an edge by the gradient at a vertex."""
    return (
        gradient[vertex, 0] * side[0]
        + gradient[vertex, 1] * side[1]
        + gradient[vertex, 2] * side[2]
    )


@apart
def best_ray(net: Any, times: Any, gradients: Any, vertex: Any, second: Any) -> Any:
    """Return the earliest arrival at a vertex, where its ray crosses the opposite edge, and which.

    The edge is that opposite the corner returned; -1 where no neighbour has a time.
    """
    triangles, starts, corners, lengths, sides = net[0], net[1], net[2], net[3], net[4]
    best, place, origin = np.inf, 0.0, -1
    for item in range(starts[vertex], starts[vertex + 1]):
        t, own = corners[item] // 3, corners[item] % 3
        one, two = (own + 1) % 3, (own + 2) % 3
        a, b = triangles[t, one], triangles[t, two]
        if times[a] == np.inf and times[b] == np.inf:
            continue
        edge, to_a, to_b = lengths[t, own], lengths[t, two], lengths[t, one]
        if second:
            side = sides[t, own]
            slopes = (slope_along(gradients, a, side), slope_along(gradients, b, side))
            new, s = curved((times[a], times[b]), slopes, (edge, to_a, to_b), best)
        else:
            new, s = straight(times[a], times[b], edge, to_a, to_b)
        if new < best:
            best, place, origin = new, s, corners[item]
    return best, place, origin


@apart
def point_along(net: Any, gradients: Any, vertex: Any, place: Any, origin: Any) -> None:
    """Write the gradient M x / sqrt(x . M x) at a vertex, x the last piece of its ray."""
    sides, pulls = net[4], net[5]
    t, own = origin // 3, origin % 3
    # side ``one`` runs from ``two`` to the vertex, side ``two`` from the vertex to ``one``
    one, two = (own + 1) % 3, (own + 2) % 3
    squared = 0.0
    for k in range(3):
        ray = place * sides[t, one, k] - (1.0 - place) * sides[t, two, k]
        pull = place * pulls[t, one, k] - (1.0 - place) * pulls[t, two, k]
        gradients[vertex, k] = pull
        squared += ray * pull
    for k in range(3):
        gradients[vertex, k] /= np.sqrt(squared)


@compiled
def sweep(net: Any, times: Any, gradients: Any, order: Any, rule: Any) -> Any:
    """Compute the vertices of ``order`` anew from their neighbours until none changes.

    ``rule`` is (whether slopes on edges are taken from the gradients, the change that counts as
    none, how many sweeps there are at the most). A sweep does the vertices with a neighbour that
    changed. Returns the number of sweeps and the greatest change in the last one.
    """
    triangles, starts, corners = net[0], net[1], net[2]
    second, enough, most = rule
    due = np.zeros(len(times), dtype=np.bool_)
    for vertex in order:
        due[vertex] = True
    sweeps, largest = 0, np.inf
    while sweeps < most and largest > enough:
        sweeps += 1
        largest = 0.0
        for vertex in order:
            if not due[vertex]:
                continue
            due[vertex] = False
            best, place, origin = best_ray(net, times, gradients, vertex, second)
            if origin < 0:
                continue
            point_along(net, gradients, vertex, place, origin)
            change = abs(best - times[vertex])
            times[vertex] = best
            largest = max(largest, change)
            # the first time there is a gradient where there was none
            if change > enough or sweeps == 1:
                for item in range(starts[vertex], starts[vertex + 1]):
                    for k in range(3):
                        due[triangles[corners[item] // 3, k]] = True
    return sweeps, largest
