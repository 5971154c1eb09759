"""The matrices of a step, laid out for the compiled loops."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from cardiosurf.arrays import Floats, Ints, Matrix, Singles
from cardiosurf.fem.operators import Operators
from cardiosurf.stepping.compiled.machine import GROUP, WINDOW

BLOCK = 1024
"""Rows of a block: what a thread does at a time, and what sums are made of, in a fixed order."""

CHUNK = 16 * BLOCK
"""Rows that are laid out at a time: little is needed beside the matrices themselves."""

_NONE = 2**40
"""A column beyond all others."""


class Rows(NamedTuple):
    """M, K and A = M + w K row by row, in an order of their own.

    Neighbours are near one another (reverse Cuthill-McKee), so neighbours of eight rows in a row
    are, too. A slot holds an entry of each of eight rows, all in columns of one window of sixteen;
    it fills as few as it can, mostly six to nine for eight rows. What is missing is filled up with
    zeros.

    Entries are those beside the diagonal, in single precision. What stands on the diagonal
    follows from the row sums, which are exact: the lumped mass for M and nothing for K. So a
    potential that is the same everywhere stays so, and charge is kept (docs/numerics.md).

    Attributes
    ----------
    start : (g + 1,) uint64
        First slot of each group of eight rows; m is n rounded up to full groups, and a group more.
    window : (z,) uint32
        First column of each slot, a multiple of eight.
    place : (z, 8) uint8
        Where in the window an entry's column is; 0 where it was filled up.
    mass, stiffness : (z, 8) float32
        Its entries in M and K.
    system : (z, 8) float32
        Its entry in D^-1/2 A D^-1/2, D the diagonal of A; ``weigh`` sets them.
    nodal : (2, m) float
        The row sums of M and D^-1/2: see ``passes.LUMPED``; ``weigh`` sets the latter.
    extents : (b + 1,) uint64
        First row of each block, and n.
    """

    start: NDArray[np.uint64]
    window: NDArray[np.uint32]
    place: NDArray[np.uint8]
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
    vertex = np.asarray(reverse_cuthill_mckee(mass, symmetric_mode=True), dtype=np.int32)
    row = np.empty(n, dtype=np.int32)
    row[vertex] = np.arange(n, dtype=np.int32)
    chunks = [_chunk(first, mass, vertex, row) for first in range(0, n, CHUNK)]
    slots = np.concatenate([chunk.slots for chunk in chunks])
    entry = [chunk.entry for chunk in chunks]
    rows = Rows(
        start=np.concatenate(([0], np.cumsum(slots))).astype(np.uint64),
        window=np.concatenate([chunk.window for chunk in chunks]),
        place=np.concatenate([chunk.place for chunk in chunks]),
        mass=_entries(mass.data, entry),
        stiffness=_entries(stiffness.data, entry),
        system=np.zeros((int(slots.sum()), GROUP), dtype=np.float32),
        nodal=np.zeros((2, GROUP * (len(slots) + 1))),
        extents=np.append(np.arange(0, n, BLOCK), n).astype(np.uint64),
    )
    rows.nodal[0, :n] = np.asarray(mass.sum(axis=1))[vertex]
    return Arrangement(rows, vertex, row)


def weigh(rows: Rows, w: float) -> None:
    """Set the matrix of a step for a weight w, in tu."""
    lumped, inverse = rows.nodal
    for groups, some in _stretches(rows):
        beside = rows.mass[some] + w * rows.stiffness[some].astype(np.float64)
        sums = np.add.reduceat(beside, (rows.start[groups] - rows.start[groups.start]).astype(int))
        of_groups = slice(GROUP * groups.start, GROUP * groups.stop)
        diagonal = lumped[of_groups] - sums.ravel()
        with np.errstate(invalid="ignore", divide="ignore"):
            # a matrix that is not positive is found out by conjugate gradients
            inverse[of_groups] = 1.0 / np.sqrt(diagonal)
    # rows that only fill the last group up
    inverse[lumped == 0.0] = 0.0
    for groups, some in _stretches(rows):
        beside = rows.mass[some] + w * rows.stiffness[some].astype(np.float64)
        count = np.diff(rows.start[groups.start : groups.stop + 1]).astype(np.int64)
        first_row = GROUP * np.arange(groups.start, groups.stop)
        owner = np.repeat(first_row, count)[:, None] + np.arange(GROUP)
        column = rows.window[some].astype(np.int64)[:, None] + rows.place[some]
        rows.system[some] = beside * inverse[owner] * inverse[column]


def _stretches(rows: Rows) -> Iterator[tuple[slice, slice]]:
    """Yield some groups and their slots, a chunk at a time."""
    count = len(rows.start) - 1
    for first in range(0, count, CHUNK // GROUP):
        last = min(first + CHUNK // GROUP, count)
        yield slice(first, last), slice(int(rows.start[first]), int(rows.start[last]))


class _Chunk(NamedTuple):
    """Some of the rows: slots of each group, and the rest as in ``Rows``.

    ``entry`` (z, 8) are the numbers of the entries in the matrices, -1 where there is none.
    """

    slots: Ints
    window: NDArray[np.uint32]
    place: NDArray[np.uint8]
    entry: NDArray[np.int32]


def _chunk(
    first: int, pattern: Matrix, vertex: NDArray[np.int32], row: NDArray[np.int32]
) -> _Chunk:
    """Lay some rows out."""
    columns, entries = _table(first, pattern, vertex, row)
    groups, lane = len(columns), np.arange(GROUP)
    # a row's entries come in the order of their columns: those that are left begin ``at`` some
    at = np.zeros((groups, GROUP), dtype=np.int64)
    found: list[tuple[Ints, Ints, Ints, Ints]] = []
    left = np.arange(groups)
    while len(left):
        next_ones = (left[:, None], lane, at[left])
        nearest = columns[next_ones]
        base = nearest.min(axis=1, keepdims=True) // GROUP * GROUP
        taken = nearest < np.minimum(base + WINDOW, _NONE)
        place, entry = np.where(taken, nearest - base, 0), np.where(taken, entries[next_ones], -1)
        found.append((left, np.where(taken.any(axis=1), base[:, 0], 0), place, entry))
        at[left] += taken
        left = left[(columns[left[:, None], lane, at[left]] < _NONE).any(axis=1)]

    group, window, place, entry = (np.concatenate(part) for part in zip(*found, strict=True))
    order = np.argsort(group, kind="stable")
    return _Chunk(
        slots=np.bincount(group),
        window=window[order].astype(np.uint32),
        place=place[order].astype(np.uint8),
        entry=entry[order].astype(np.int32),
    )


def _table(
    first: int, pattern: Matrix, vertex: NDArray[np.int32], row: NDArray[np.int32]
) -> tuple[Ints, Ints]:
    """Return columns and numbers of the entries beside the diagonal of some rows.

    By groups of rows, (g, 8, w), in the order of the columns; ``_NONE`` where a row has no more.
    """
    some = vertex[first : first + CHUNK]
    begin = pattern.indptr[some].astype(np.int64)
    count = pattern.indptr[some + 1] - begin
    entry = np.repeat(begin, count) + _ranks(count)
    owner = np.repeat(np.arange(len(some)), count)
    column = row[pattern.indices[entry]].astype(np.int64)
    order = np.lexsort((column, owner))
    beside = order[column[order] != first + owner[order]]
    owner, column, entry = owner[beside], column[beside], entry[beside]
    shape = (-(-len(some) // GROUP) * GROUP, int(count.max()))
    columns, entries = np.full(shape, _NONE), np.full(shape, -1)
    place = (owner, _ranks(count - 1))
    columns[place], entries[place] = column, entry
    return columns.reshape(-1, GROUP, shape[1]), entries.reshape(-1, GROUP, shape[1])


def _entries(data: Floats, places: list[NDArray[np.int32]]) -> Singles:
    """Return a matrix's entries in single precision, zero where there is none."""
    entries = np.empty((sum(map(len, places)), GROUP), dtype=np.float32)
    done = 0
    for some in places:
        entries[done : done + len(some)] = np.where(some >= 0, data[some], 0.0)
        done += len(some)
    return entries


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
