"""Conjugate gradients, and how threads meet."""

from typing import Any

import numpy as np

from cardiosurf.stepping.compiled.keep import apart
from cardiosurf.stepping.compiled.machine import atomic_add, atomic_load, breathe, give_way
from cardiosurf.stepping.compiled.passes import (
    ERROR,
    PQ,
    QQ,
    RQ,
    multiply,
    update,
)

REASON, CROSSINGS, STEPS, ITERATIONS, MOST, ARRIVED, MET = range(7)
GAIN, LEFT, GOAL = range(3)
"""Places in ``work.report`` and ``work.reals``."""

ITERATION_LIMIT = 1000
SPINS = 100
"""How often to look before the system may run other threads: some 2 us."""


@apart
def meet(report: Any, threads: int) -> None:
    """Wait until all threads are here."""
    if threads > 1:
        met = atomic_load(report, MET)
        if atomic_add(report, ARRIVED, 1) == threads - 1:
            atomic_add(report, ARRIVED, -threads)
            atomic_add(report, MET, 1)
        else:
            spins = 0
            while atomic_load(report, MET) == met:
                spins += 1
                if spins > SPINS:
                    give_way()
                else:
                    breathe()


@apart
def total(sums: Any, column: Any) -> float:
    """Return the sum over the blocks, in their order."""
    found = 0.0
    for k in range(len(sums)):
        found += sums[k, column]
    return found


@apart
def solve(vectors: Any, system: Any, notes: Any, shares: Any, error: float, goal: float) -> Any:
    """Iterate conjugate gradients from the residual's square ``error`` down to the goal.

    With the products r q and q q the new residual is known before it is written: one pass over
    the matrix and one over the vectors an iteration. They correct a guess, whose residual was
    found in double precision, so single precision is enough for them (docs/numerics.md).
    ``vectors`` are p, r, q and x, ``notes`` sums, report and reals of the work space. Returns how
    far to go along p at last, whether there is a way done before, and the iterations (-1: given
    up).
    """
    share, threads = shares
    p, r, q, _ = vectors
    sums, report, reals = notes
    iterations, along, moved = 0, 0.0, False
    while not error <= goal:
        multiply(p, r if iterations else p, q, system, sums, share)
        meet(report, threads)
        pq = total(sums, PQ)
        if iterations == ITERATION_LIMIT or not pq > 0.0 or not error < np.inf:
            if share[0] == 0:
                reals[LEFT], reals[GOAL] = error, goal
                report[ITERATIONS] = iterations
            iterations = -1
            break
        along = error / pq
        squares = along * along * total(sums, QQ)
        expected = error - 2.0 * along * total(sums, RQ) + squares
        iterations += 1
        if expected <= goal:
            break
        turn = np.float32(expected / error)
        update(vectors, np.float32(along), turn, iterations == 1, sums, share)
        meet(report, threads)
        error, along, moved = total(sums, ERROR), 0.0, True
    return np.float32(along), moved, iterations
