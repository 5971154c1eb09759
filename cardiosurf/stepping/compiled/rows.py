"""The matrices of a step, laid out for the compiled loops."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from cardiosurf.arrays import Floats, Ints, Matrix, Singles
from cardiosurf.fem.operators import Operators
from cardiosurf.stepping.compiled.machine import GROUP

LEAST = 6
BLOCK = 1024
"""Rows of a block: what a thread does at a time, and what sums are made of, in a fixed order."""

CHUNK = 4 * BLOCK
"""Rows that are laid out at a time: little is needed beside the matrices themselves."""


class Rows(NamedTuple):
    """M, K and A = M + w K row by row, in an order of their own.

    Neighbours are near one another (reverse Cuthill-McKee), and within a block rows with as many
    neighbours stand together. Four rows make a group, which is done at once: their first entries
    lie side by side, then their second ones, and so on. A group has as many entries as its longest
    row, and at least six: nearly all have exactly six, and the loop over these is unrolled. What
    is missing is filled up with zeros.

    Entries are those beside the diagonal, in single precision. What stands on the diagonal
    follows from the row sums, which are exact: the lumped mass for M and nothing for K. So a
    potential that is the same everywhere stays so, and charge is kept (docs/numerics.md).

    Attributes
    ----------
    start : (m / 4 + 1,) uint64
        First entry of each group; m is n rounded up to full groups.
    longer : (b,) uint64
        First group of each block that has more than six entries a row.
    columns : (z,) uint32
        The neighbour that an entry belongs to; 0 where it was filled up.
    mass, stiffness : (z,) float32
        Its entries in M and K.
    system : (z,) float32
        Its entry in D^-1/2 A D^-1/2, D the diagonal of A; ``weigh`` sets them.
    nodal : (2, m) float
        The row sums of M and D^-1/2: see ``passes.LUMPED``; ``weigh`` sets the latter.
    extents : (b + 1,) uint64
        First row of each block, and n.
    """

    start: NDArray[np.uint64]
    longer: NDArray[np.uint64]
    columns: NDArray[np.uint32]
    mass: Singles
    stiffness: Singles
    system: Singles
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
    """

    rows: Rows
    vertex: NDArray[np.int32]
    row: NDArray[np.int32]


def arrange(operators: Operators) -> Arrangement:
    """Lay mass and stiffness out in rows; ``weigh`` makes the matrix of a step of them.

    Nothing of the operators is kept.

    Parameters
    ----------
    operators : Operators
        M and K.
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
        mass=np.zeros(start[-1], dtype=np.float32),
        stiffness=np.zeros(start[-1], dtype=np.float32),
        system=np.zeros(start[-1], dtype=np.float32),
        nodal=np.zeros((2, full)),
        extents=np.append(np.arange(0, n, BLOCK), n).astype(np.uint64),
    )
    rows.nodal[0, :n] = np.asarray(mass.sum(axis=1))[vertex]
    arrangement = Arrangement(rows, vertex, row)
    for place, entry, column in _pieces(arrangement, mass):
        rows.columns[place] = column
        rows.mass[place] = mass.data[entry]
        rows.stiffness[place] = stiffness.data[entry]
    return arrangement


def weigh(rows: Rows, w: float) -> None:
    """Set the matrix of a step for a weight w, in tu."""
    lumped, inverse = rows.nodal
    for first, owner, entry in _stretches(rows):
        beside = rows.mass[entry] + w * rows.stiffness[entry].astype(np.float64)
        size = len(lumped[first : first + CHUNK])
        sums = np.bincount(owner - first, beside, minlength=size)
        with np.errstate(invalid="ignore", divide="ignore"):
            # a matrix that is not positive is found out by conjugate gradients
            inverse[first : first + CHUNK] = 1.0 / np.sqrt(lumped[first : first + CHUNK] - sums)
    # rows that only fill the last group up
    inverse[lumped == 0.0] = 0.0
    for _, owner, entry in _stretches(rows):
        beside = rows.mass[entry] + w * rows.stiffness[entry].astype(np.float64)
        rows.system[entry] = beside * inverse[owner] * inverse[rows.columns[entry]]


def _stretches(rows: Rows) -> Iterator[tuple[int, Ints, slice]]:
    """Yield the first of some rows, and their entries with the rows that these are in."""
    for first in range(0, rows.nodal.shape[1], CHUNK):
        bounds = rows.start[first // GROUP : (first + CHUNK) // GROUP + 1].astype(np.int64)
        groups = np.repeat(np.arange(len(bounds) - 1), np.diff(bounds))
        owner = first + GROUP * groups + np.arange(len(groups)) % GROUP
        yield first, owner, slice(int(bounds[0]), int(bounds[-1]))


def _pieces(arrangement: Arrangement, pattern: Matrix) -> Iterator[tuple[Ints, Ints, Ints]]:
    """Yield the entries beside the diagonal, some rows at a time.

    Yields their places in ``Rows``, their numbers in the matrices, and their columns.
    """
    rows, vertex, row = arrangement
    for first in range(0, len(vertex), CHUNK):
        some = vertex[first : first + CHUNK]
        begin = pattern.indptr[some].astype(np.int64)
        count = pattern.indptr[some + 1] - begin
        entry = np.repeat(begin, count) + _ranks(count)
        owner = np.repeat(np.arange(first, first + len(some)), count)
        column = row[pattern.indices[entry]]
        beside = column != owner
        entry, owner, column = entry[beside], owner[beside], column[beside]
        group, lane = np.divmod(owner, GROUP)
        place = rows.start[group].astype(np.int64) + GROUP * _ranks(count - 1) + lane
        yield place, entry, column


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
