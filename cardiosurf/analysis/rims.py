"""The rims of excitable tissue, open edges and the borders of scar, and waves that run round them.

A rim bounds a hole. If the phase turns along it, a wave circulates about the hole: anatomical
reentry, which has no phase singularity in the tissue. With each hole counted like a singularity,
the chiralities of all of them sum to 0 at every time: along every inner edge the turns of its two
triangles cancel.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.analysis.phase import Centre, chunks, turns
from cardiosurf.arrays import Floats, Ints
from cardiosurf.geometry.surface import Surface
from cardiosurf.geometry.topology import are_edges, open_edges
from cardiosurf.recording.recording import FrameSeries
from cardiosurf.tissue.tensor import Tissue


@dataclass(frozen=True)
class Rim:
    """One connected rim of the excitable tissue.

    Attributes
    ----------
    name : str
        The open edges and passive patches that it lies along.
    edges : (k, 2) int
        Its edges, the tissue on their left.
    length : float
        In su.
    """

    name: str
    edges: Ints
    length: float


def find_rims(surface: Surface, tissue: Tissue) -> tuple[Rim, ...]:
    """Return the rims of the excitable tissue, the longest first.

    Rims that meet in a vertex are one.

    Parameters
    ----------
    surface : Surface
        The triangulated surface.
    tissue : Tissue
        Tells which triangles are excitable.
    """
    edges = open_edges(surface.triangles[tissue.excitable])
    if not len(edges):
        return ()
    used, ends = np.unique(edges, return_inverse=True)
    ends = ends.reshape(-1, 2)
    graph = scipy.sparse.coo_array(
        (np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(len(used), len(used))
    )
    count, piece = scipy.sparse.csgraph.connected_components(graph, directed=False)
    rims = []
    for number in range(count):
        own = edges[piece[ends[:, 0]] == number]
        length = np.linalg.norm(surface.points[own[:, 1]] - surface.points[own[:, 0]], axis=1)
        rims.append(Rim(_name(own, surface, tissue), own, float(length.sum())))
    return tuple(sorted(rims, key=lambda rim: -rim.length))


def _name(edges: Ints, surface: Surface, tissue: Tissue) -> str:
    """Return the open edges and passive patches along a rim, in one line."""
    shared = np.zeros(len(edges), dtype=np.bool_)
    names = []
    for name, pairs in surface.edges.items():
        of_edge = _is_among(edges, pairs, len(surface.points))
        shared |= of_edge
        if of_edge.any():
            names.append(name)
    if not shared.all():
        for number, name in enumerate(tissue.names):
            passive = surface.triangles[(tissue.patch_of == number) & ~tissue.excitable]
            if len(passive) and are_edges(edges[~shared], passive).any():
                names.append(name)
    return " + ".join(names) or "unnamed"


def _is_among(edges: Ints, pairs: Ints, count: int) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    keys = [np.min(of, axis=1) * count + np.max(of, axis=1) for of in (edges, pairs.reshape(-1, 2))]
    return np.isin(*keys)


def rim_chiralities(frames: FrameSeries, rims: tuple[Rim, ...], centre: Centre) -> Ints:
    """Return how waves circulate about the holes that the rims bound, (k, rims).

    1: counterclockwise about the hole, as for a singularity; -1: clockwise; 0: not at all. On a
    plane with a single rotor the outer rim has the opposite number of the rotor.

    Parameters
    ----------
    frames : FrameSeries
        u and v of all vertices at k times.
    rims : tuple of Rim
        The rims of the excitable tissue.
    centre : Centre
        The point in the plane of u and v about which the phase turns.
    """
    result = np.zeros((len(frames.times), len(rims)), dtype=np.int64)
    if not rims:
        return result
    edges = np.concatenate([rim.edges for rim in rims])
    first = np.cumsum([0, *(len(rim.edges) for rim in rims[:-1])])
    vertices, ends = np.unique(edges, return_inverse=True)
    start, end = ends.reshape(-1, 2).T
    for rows in chunks(frames):
        # in single precision as for the triangles, so that the sum rule holds exactly
        a = (frames.u[rows][:, vertices] - np.float32(centre.u)).astype(float)
        b = (frames.v[rows][:, vertices] - np.float32(centre.v)).astype(float)
        passed = turns(a[:, start], b[:, start], a[:, end], b[:, end])
        result[rows] = np.add.reduceat(passed, first, axis=1)
    return result


def lasting(chiralities: Floats | Ints) -> int:
    """Return the number that a rim has in more than half of some frames, (k,); 0 if none has."""
    values, counts = np.unique(chiralities, return_counts=True)
    if not len(values) or 2 * counts.max() <= len(chiralities):
        return 0
    return int(values[np.argmax(counts)])
