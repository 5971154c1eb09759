"""What the compiled loops work on, beside the matrices."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cardiosurf.arrays import Floats, Ints, Matrix, Singles
from cardiosurf.fem.operators import Operators
from cardiosurf.stepping.compiled.rows import Arrangement

LEAST_CROSSINGS = 4096
LINE = 8
"""Numbers in a line of the cache."""
FIRST_SLOTS = np.arange(8)
"""The rows of ``Work.fields`` that hold u0 u1 u2 u3, the new u, v0 v1 and the new v at first."""


class Rule(NamedTuple):
    """A step of a scheme, as numbers: everything divided by its first a_j.

    Attributes
    ----------
    constants : named tuple
        Those of the kinetics.
    state0, state1 : float
        Weights of the last two states in what is known.
    push0, push1 : float
        Weights of their reactions, in tu.
    implicit1 : float
        Weight of the last state's diffusion, relative to that of the new one.
    weight : float
        w of M + w K, in tu.
    current_step : float
        Weight of the current, in tu.
    tolerance : float
        Of conjugate gradients.
    watch_rest, resting : bool
        Whether to end the stride where rest begins or ends, and whether there is rest now.
    threads : int
        How many share the blocks.
    """

    constants: Any
    state0: float
    state1: float
    push0: float
    push1: float
    implicit1: float
    weight: float
    current_step: float
    tolerance: float
    watch_rest: bool
    resting: bool
    threads: int


class Scar(NamedTuple):
    """Mass of the passive triangles in the columns of excitable vertices, by rows that have any."""

    rows: Ints
    start: Ints
    columns: Ints
    values: Floats


class Work(NamedTuple):
    """The state, and room for a stride; all in the order of the rows.

    Attributes
    ----------
    fields : (8, m) float
        Five potentials and three recoveries, which take turns (``slots``). m as in
        ``Rows``.
    pairs : (2, m) float
        What M and K are applied to.
    singles : (4, m) float32
        Vectors of conjugate gradients (``passes.R``), in the place of ``pairs``: they come later.
    direction : (m,) float32
        Their direction.
    active : (n,) uint8
        1 where the reaction acts.
    current : (n,) or (0,) float
        The stimulus that is on, in 1/tu.
    sums : (b, 9) float
        Sums and counts of each block: see ``passes.SIZE``.
    slots, guess :
        See ``stride.Now``.
    watch : (w,) int
        Rows whose state is told after every step.
    watched : (k, 2, w) float
        Their u and v.
    crossings : (c, 3) float
        Row, time and direction (1 is up) of crossings of 0.5.
    report, reals : (7,) int64, (3,) float
        What came of a stride, and what threads pass on: see ``stride.REASON``.
    """

    fields: Floats
    pairs: Floats
    singles: Singles
    direction: Singles
    active: NDArray[np.uint8]
    current: Floats
    sums: Floats
    slots: Ints
    guess: Floats
    watch: Ints
    watched: Floats
    crossings: Floats
    report: Ints
    reals: Floats


def make_work(arrangement: Arrangement, active: NDArray[np.bool_], watch: Ints, most: int) -> Work:
    """Return empty work space.

    Parameters
    ----------
    arrangement : Arrangement
        The matrices and their order.
    active : (n,) bool
        Vertices where the reaction acts.
    watch : (w,) int
        Vertices whose state is told after every step.
    most : int
        The most steps of a stride.
    """
    n, blocks = len(arrangement.vertex), len(arrangement.rows.extents) - 1
    full = arrangement.rows.nodal.shape[1]
    pairs = _lined_up(2, full)
    return Work(
        fields=_lined_up(8, full),
        pairs=pairs,
        singles=pairs.view(np.float32).reshape(4, full),
        direction=np.zeros(full, dtype=np.float32),
        active=active[arrangement.vertex].astype(np.uint8),
        current=np.zeros(0),
        sums=np.zeros((blocks, 9)),
        slots=FIRST_SLOTS.copy(),
        guess=np.zeros(4),
        watch=arrangement.row[watch].astype(np.int64),
        watched=np.zeros((most, 2, len(watch))),
        crossings=np.zeros((LEAST_CROSSINGS + n // 16, 3)),
        report=np.zeros(7, dtype=np.int64),
        reals=np.zeros(3),
    )


def _lined_up(rows: int, columns: int) -> Floats:
    """Return zeros that begin where a line of the cache does."""
    spare = np.zeros(rows * columns + LINE)
    begin = -spare.ctypes.data // spare.itemsize % LINE
    return spare[begin : begin + rows * columns].reshape(rows, columns)


def scar_of(operators: Operators, arrangement: Arrangement) -> Scar:
    """Return the mass of the passive triangles, as far as the reaction meets it."""
    none = np.zeros(0, dtype=np.int64)
    if operators.reaction_mass is operators.mass:
        return Scar(none, np.zeros(1, dtype=np.int64), none, np.zeros(0))
    passive: Matrix = (operators.mass - operators.reaction_mass).tocsr()
    # differences of equal numbers leave rounding behind
    scale = operators.mass.diagonal().max()
    rows = np.repeat(np.arange(passive.shape[0]), np.diff(passive.indptr))
    kept = (np.abs(passive.data) > 1e-13 * scale) & operators.excitable_nodes[passive.indices]
    row = arrangement.row.astype(np.int64)
    rows, columns = row[rows[kept]], row[passive.indices[kept]]
    order = np.lexsort((columns, rows))
    found, count = np.unique(rows, return_counts=True)
    start = np.concatenate(([0], np.cumsum(count))).astype(np.int64)
    return Scar(found, start, columns[order], passive.data[kept][order])
