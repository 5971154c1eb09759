"""Linear elements for a front with curvature: the system of a Newton step, and w.

``net`` is (triangles, hats, fluxes, areas), see ``eikonal_curvature``.
"""

from typing import Any

import numpy as np

from cardiosurf.stepping.compiled.keep import apart, compiled


@apart
def insert(columns: Any, begin: Any, last: Any, column: Any) -> Any:
    """Put a column into the sorted ones of a row if it is not there; return where the row ends."""
    at = last
    while at > begin and columns[at - 1] > column:
        at -= 1
    if at > begin and columns[at - 1] == column:
        return last
    for move in range(last, at, -1):
        columns[move] = columns[move - 1]
    columns[at] = column
    return last + 1


@compiled
def pattern(triangles: Any, rows: Any, around: Any) -> Any:
    """Return where the matrix has entries: row starts, columns, and slots (m, 3, 3).

    ``rows`` (n,) is the number of a vertex' unknown, -1 for none; ``around`` are the unknowns'
    vertices, the corners at each vertex, and where these begin. A slot is the entry that two
    corners of a triangle add to, -1 for none.
    """
    order, corners, first = around
    slots = np.full((len(triangles), 3, 3), -1, dtype=np.int64)
    starts = np.zeros(len(order) + 1, dtype=np.int64)
    columns = np.empty(len(order) + 2 * len(corners), dtype=np.int32)
    last = 0
    for row in range(len(order)):
        begin, own = last, corners[first[order[row]] : first[order[row] + 1]]
        for corner in own:
            for k in range(3):
                if rows[triangles[corner // 3, k]] >= 0:
                    last = insert(columns, begin, last, rows[triangles[corner // 3, k]])
        starts[row + 1] = last
        for corner in own:
            for k in range(3):
                for at in range(begin, last):
                    if columns[at] == rows[triangles[corner // 3, k]]:
                        slots[corner // 3, corner % 3, k] = at
    return starts, columns[:last].copy(), slots


@apart
def combined(vectors: Any, values: Any, triangle: Any, t: Any, out: Any) -> None:
    """Write the sum of the vectors of a triangle's corners times the values there."""
    one, two, three = values[triangle[t, 0]], values[triangle[t, 1]], values[triangle[t, 2]]
    for k in range(3):
        out[k] = vectors[t, 0, k] * one + vectors[t, 1, k] * two + vectors[t, 2, k] * three


@apart
def inner(one: Any, other: Any) -> Any:
    """Return the product of two vectors of three."""
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


@compiled
def linearise(net: Any, fields: Any, rule: Any, rows: Any, slots: Any, data: Any) -> Any:
    """Write the matrix of a Newton step into ``data`` and return the residual of the unknowns.

    ``fields`` are the times and w at the vertices, ``rule`` is (c0, g).
    """
    triangles, hats, fluxes, areas = net
    speed, factor = rule
    residual = np.zeros(rows.max() + 1)
    data[:] = 0.0
    gradient, flux, drift = np.empty(3), np.empty(3), np.empty(3)
    for t in range(len(triangles)):
        combined(hats, fields[0], triangles, t, gradient)
        combined(fluxes, fields[0], triangles, t, flux)
        combined(fluxes, fields[1], triangles, t, drift)
        slow = np.sqrt(max(inner(gradient, flux), 1e-20))
        spread, third = factor * areas[t], areas[t] / 3.0
        rest = third * (speed * slow + factor * inner(gradient, drift) - 1.0)
        for k in range(3):
            drift[k] = third * (factor * drift[k] + speed * flux[k] / slow)
        for b in range(3):
            advected = inner(drift, hats[t, b])
            for a in range(3):
                if slots[t, a, b] >= 0:
                    data[slots[t, a, b]] += spread * inner(hats[t, a], fluxes[t, b]) + advected
        for a in range(3):
            if rows[triangles[t, a]] >= 0:
                residual[rows[triangles[t, a]]] += spread * inner(hats[t, a], flux) + rest
    return residual


@compiled
def log_slowness(net: Any, fields: Any, weights: Any, speed: Any, limits: Any) -> Any:
    """Return the means of log(c0 sqrt(q)) and of grad w over the triangles of each vertex.

    ``fields`` are the times and w, ``weights`` the sum of the areas of each vertex' triangles; the
    logarithm is held within its limits.
    """
    triangles, hats, fluxes, areas = net
    means, slopes = np.zeros(len(weights)), np.zeros((len(weights), 3))
    gradient, flux, slope = np.empty(3), np.empty(3), np.empty(3)
    for t in range(len(triangles)):
        combined(hats, fields[0], triangles, t, gradient)
        combined(fluxes, fields[0], triangles, t, flux)
        combined(hats, fields[1], triangles, t, slope)
        slow = speed * np.sqrt(max(inner(gradient, flux), 1e-20))
        value = np.log(min(max(slow, limits[0]), limits[1]))
        for a in range(3):
            vertex = triangles[t, a]
            share = areas[t] / weights[vertex]
            means[vertex] += share * value
            for k in range(3):
                slopes[vertex, k] += share * slope[k]
    return means, slopes
