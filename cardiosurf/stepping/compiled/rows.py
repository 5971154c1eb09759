"""The matrices of a step, laid out for the compiled loops."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from cardiosurf.arrays import Floats, Ints, Matrix
from cardiosurf.fem.operators import Operators
from cardiosurf.stepping.compiled.machine import GROUP

LEAST = 6
BLOCK = 1024
"""Rows of a block: what a thread does at a time, and what sums are made of, in a fixed order."""

CHUNK = 4 * BLOCK
"""Rows that are laid out at a time: little is needed beside the matrices themselves."""


class Rows(NamedTuple):
    """M and A = M + w K row by row, in an order of their own, scaled by D^-1/2 on both sides.

    D is the diagonal of A. Neighbours are near one another (reverse Cuthill-McKee), and within a
    block rows with as many neighbours stand together. Four rows make a group, which is done at
    once: their first entries lie side by side, then their second ones, and so on. A group has as
    many entries as its longest row, and at least six: nearly all have exactly six, and the loop
    over these is unrolled. What is missing is filled up with zeros.

    Attributes
    ----------
    start : (m / 4 + 1,) uint64
        First entry of each group; m is n rounded up to full groups.
    longer : (b,) uint64
        First group of each block that has more than six entries a row.
    columns : (z,) uint32
        The neighbour that an entry belongs to; 0 where it was filled up.
    mass, system : (z,) float
        Its entries in D^-1/2 M D^-1/2 and D^-1/2 A D^-1/2; ``weigh`` sets them.
    nodal : (4, m) float
        The diagonal of D^-1/2 M D^-1/2, D^1/2, D^-1/2, and D^-1/2 times the row sums of M:
        see ``passes.DIAGONAL``; ``weigh`` sets them.
    extents : (b + 1,) uint64
        First row of each block, and n.
    """

    start: NDArray[np.uint64]
    longer: NDArray[np.uint64]
    columns: NDArray[np.uint32]
    mass: Floats
    system: Floats
    nodal: Floats
    extents: NDArray[np.uint64]


class Arrangement(NamedTuple):
    """Rows, and which vertex each of them is.

    Attributes
    ----------
    rows : Rows
        The matrices.
    vertex : (n,) int32
        The vertex of each row.
    row : (n,) int32
        The row of each vertex.
    mass, stiffness : csr_array
        M and K in the order of the vertices, with the same pattern and a full diagonal.
    """

    rows: Rows
    vertex: NDArray[np.int32]
    row: NDArray[np.int32]
    mass: Matrix
    stiffness: Matrix


def arrange(operators: Operators) -> Arrangement:
    """Lay the pattern of mass and stiffness out in rows; ``weigh`` brings the numbers.

    Parameters
    ----------
    operators : Operators
        The matrices; two with the same pattern are shared, others copied.
    """
    mass, stiffness = _same_pattern(operators.mass, operators.stiffness)
    n = mass.shape[0]
    neighbours = np.diff(mass.indptr) - 1
    vertex = np.asarray(reverse_cuthill_mckee(mass, symmetric_mode=True), dtype=np.int32)
    block = np.arange(n, dtype=np.int32) // BLOCK
    vertex = vertex[np.lexsort((np.maximum(neighbours[vertex], LEAST), block))]
    row = np.empty(n, dtype=np.int32)
    row[vertex] = np.arange(n, dtype=np.int32)

    full = -(-n // GROUP) * GROUP
    width = np.full(full, LEAST)
    np.maximum(neighbours[vertex], LEAST, out=width[:n])
    longest = width.reshape(-1, GROUP).max(axis=1)
    start = np.concatenate(([0], np.cumsum(GROUP * longest))).astype(np.uint64)
    sixes = np.add.reduceat(longest == LEAST, np.arange(0, len(longest), BLOCK // GROUP))
    rows = Rows(
        start=start,
        longer=(np.arange(0, len(longest), BLOCK // GROUP) + sixes).astype(np.uint64),
        columns=np.zeros(start[-1], dtype=np.uint32),
        mass=np.zeros(start[-1]),
        system=np.zeros(start[-1]),
        nodal=np.zeros((4, full)),
        extents=np.append(np.arange(0, n, BLOCK), n).astype(np.uint64),
    )
    arrangement = Arrangement(rows, vertex, row, mass, stiffness)
    for place, _, _, column in _pieces(arrangement):
        rows.columns[place] = column
    return arrangement


def weigh(arrangement: Arrangement, w: float) -> None:
    """Set the matrices of a step for a weight w, in tu."""
    rows, vertex, _, mass, stiffness = arrangement
    diagonal = mass.diagonal()[vertex]
    with np.errstate(invalid="ignore", divide="ignore"):
        # a matrix that is not positive is found out by conjugate gradients
        root = np.sqrt(diagonal + w * stiffness.diagonal()[vertex])
        inverse = 1.0 / root
    lumped = np.asarray(mass.sum(axis=1))[vertex]
    for k, values in enumerate((diagonal * inverse**2, root, inverse, inverse * lumped)):
        rows.nodal[k, : len(vertex)] = values
    for place, entry, owner, column in _pieces(arrangement):
        scale = inverse[owner] * inverse[column]
        rows.mass[place] = scale * mass.data[entry]
        rows.system[place] = scale * (mass.data[entry] + w * stiffness.data[entry])


def _pieces(arrangement: Arrangement) -> Iterator[tuple[Ints, Ints, Ints, Ints]]:
    """Yield the entries beside the diagonal, some rows at a time.

    Yields their places in ``Rows``, their numbers in the matrices, and their rows and columns.
    """
    rows, vertex, row, mass, _ = arrangement
    for first in range(0, len(vertex), CHUNK):
        some = vertex[first : first + CHUNK]
        begin = mass.indptr[some].astype(np.int64)
        count = mass.indptr[some + 1] - begin
        entry = np.repeat(begin, count) + _ranks(count)
        owner = np.repeat(np.arange(first, first + len(some)), count)
        column = row[mass.indices[entry]]
        beside = column != owner
        entry, owner, column = entry[beside], owner[beside], column[beside]
        group, lane = np.divmod(owner, GROUP)
        place = rows.start[group].astype(np.int64) + GROUP * _ranks(count - 1) + lane
        yield place, entry, owner, column


def _ranks(count: Ints) -> Ints:
    """Return 0, 1, ... for as many as each count says, one after another."""
    start = np.concatenate(([0], np.cumsum(count)[:-1]))
    ranks: Ints = np.arange(int(count.sum())) - np.repeat(start, count)
    return ranks


def _same_pattern(mass: Matrix, stiffness: Matrix) -> tuple[Matrix, Matrix]:
    """Return both with the entries that either has, and a diagonal."""
    same = mass.nnz == stiffness.nnz and all(
        np.array_equal(getattr(mass, name), getattr(stiffness, name))
        for name in ("indptr", "indices")
    )
    if same and (mass.indices == _row_numbers(mass)).sum() == mass.shape[0]:
        return mass, stiffness
    n = mass.shape[0]
    keys = [_row_numbers(m) * n + m.indices for m in (mass, stiffness)]
    every = np.unique(np.concatenate((*keys, np.arange(n) * (n + 1))))
    indptr = np.searchsorted(every, np.arange(n + 1) * n)
    return _filled(mass, keys[0], every, indptr), _filled(stiffness, keys[1], every, indptr)


def _filled(matrix: Matrix, keys: Ints, every: Ints, indptr: Ints) -> Matrix:
    """Return a matrix with zeros added where the pattern has entries that it lacks."""
    data = np.zeros(len(every))
    data[np.searchsorted(every, keys)] = matrix.data
    filled: Any = csr_array((data, every % matrix.shape[0], indptr), shape=matrix.shape)
    return filled  # type: ignore[no-any-return]


def _row_numbers(matrix: Matrix) -> Ints:
    """Return the row of each entry."""
    rows: Ints = np.repeat(np.arange(matrix.shape[0], dtype=np.int64), np.diff(matrix.indptr))
    return rows
