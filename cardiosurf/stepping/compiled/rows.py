"""The matrices of a step, laid out for the compiled loops."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from cardiosurf.arrays import Floats, Ints, Matrix
from cardiosurf.fem.operators import Operators

LEAST = 6
BLOCK = 1024
"""Rows of a block: what a thread does at a time, and what sums are made of, in a fixed order."""


class Rows(NamedTuple):
    """M, K and A = M + w K row by row, in an order of their own.

    Neighbours are near one another (reverse Cuthill-McKee), and within a block rows with as many
    neighbours stand together. A row has at least six entries beside the diagonal: nearly all have
    exactly six, the loops over these are unrolled, and rows with fewer are filled up with zeros.

    Attributes
    ----------
    blocks : (b + 1,) uint64
        First run of each block.
    runs : (q, 4) uint64
        Rows with as many entries: first row, one past the last, entries of a row, first entry.
    columns : (z,) uint32
        The neighbour that an entry belongs to; the row itself where it was filled up.
    pair : (z, 2) float
        Its entries in M and K.
    system : (z,) float
        Its entry in D^-1/2 A D^-1/2, D the diagonal of A; ``weigh`` sets it.
    nodal : (4, n) float
        The diagonals of M and K, D^-1/2 (``weigh`` sets it), and the row sums of M.
    extents : (b + 1,) uint64
        First row of each block, and n.
    """

    blocks: NDArray[np.uint64]
    runs: NDArray[np.uint64]
    columns: NDArray[np.uint32]
    pair: Floats
    system: Floats
    nodal: Floats
    extents: NDArray[np.uint64]


class Arrangement(NamedTuple):
    """Rows, and which vertex each of them is.

    Attributes
    ----------
    rows : Rows
        The matrices.
    vertex : (n,) int
        The vertex of each row.
    row : (n,) int
        The row of each vertex.
    """

    rows: Rows
    vertex: Ints
    row: Ints


def arrange(operators: Operators) -> Arrangement:
    """Lay mass and stiffness out in rows.

    Parameters
    ----------
    operators : Operators
        The matrices; the layout is quickest made of two with the same pattern.
    """
    mass, stiffness = _same_pattern(operators.mass, operators.stiffness)
    n = mass.shape[0]
    neighbours = np.diff(mass.indptr) - 1
    vertex = np.asarray(reverse_cuthill_mckee(mass, symmetric_mode=True), dtype=np.int64)
    block = np.arange(n) // BLOCK
    vertex = vertex[np.lexsort((np.maximum(neighbours[vertex], LEAST), block))]
    row = np.empty(n, dtype=np.int64)
    row[vertex] = np.arange(n)

    given = neighbours[vertex].astype(np.int64)
    entry = _entries(mass, vertex)
    columns, owner = row[mass.indices[entry]], np.repeat(np.arange(n), given + 1)
    beside = columns != owner
    pair = np.column_stack((mass.data[entry], stiffness.data[entry]))

    count = np.maximum(given, LEAST)
    start = np.concatenate(([0], np.cumsum(count)))
    place = start[owner[beside]] + _ranks(given)
    blocks, runs = _runs(count, block)
    rows = Rows(
        blocks=blocks,
        runs=runs,
        columns=np.repeat(np.arange(n, dtype=np.uint32), count),
        pair=np.zeros((start[-1], 2)),
        system=np.empty(start[-1]),
        nodal=np.array((*pair[~beside].T, np.zeros(n), np.asarray(mass.sum(axis=1))[vertex])),
        extents=np.append(np.arange(0, n, BLOCK), n).astype(np.uint64),
    )
    rows.columns[place] = columns[beside]
    rows.pair[place] = pair[beside]
    return Arrangement(rows, vertex, row)


def _runs(count: Ints, block: Ints) -> tuple[NDArray[np.uint64], NDArray[np.uint64]]:
    """Return first run of each block, and the runs of rows with as many neighbours in a block."""
    n = len(count)
    change = np.flatnonzero((np.diff(count) != 0) | (np.diff(block) != 0)) + 1
    first = np.concatenate(([0], change))
    last = np.concatenate((change, [n]))
    entry = np.concatenate(([0], np.cumsum(count)))[first]
    runs = np.column_stack((first, last, count[first], entry)).astype(np.uint64)
    starts = np.arange(0, n + BLOCK, BLOCK)[: (n + BLOCK - 1) // BLOCK + 1]
    return np.searchsorted(first, starts).astype(np.uint64), runs


def _ranks(count: Ints) -> Ints:
    """Return 0, 1, ... for as many as each count says, one after another."""
    start = np.concatenate(([0], np.cumsum(count)[:-1]))
    ranks: Ints = np.arange(int(count.sum())) - np.repeat(start, count)
    return ranks


def _entries(matrix: Matrix, order: Ints) -> Ints:
    """Return the numbers of a matrix's entries, its rows taken in the given order."""
    indptr = matrix.indptr.astype(np.int64)
    count = np.diff(indptr)[order]
    entries: Ints = np.repeat(indptr[order], count) + _ranks(count)
    return entries


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
