"""Conjugate gradients, and how threads meet."""

from typing import Any

import numpy as np

from cardiosurf.stepping.compiled.keep import apart
from cardiosurf.stepping.compiled.machine import atomic_add, pause
from cardiosurf.stepping.compiled.passes import (
    ERROR,
    INVERSE,
    PQ,
    QQ,
    RQ,
    P,
    Q,
    R,
    multiply,
    update,
)

REASON, CROSSINGS, STEPS, ITERATIONS, MOST, ARRIVED, MET = range(7)
GAIN, LEFT, GOAL = range(3)
"""Places in ``work.report`` and ``work.reals``."""

ITERATION_LIMIT = 1000
SPINS = 2000


@apart
def meet(report: Any, threads: int) -> None:
    """Wait until all threads are here."""
    if threads > 1:
        met = atomic_add(report, MET, 0)
        if atomic_add(report, ARRIVED, 1) == threads - 1:
            atomic_add(report, ARRIVED, -threads)
            atomic_add(report, MET, 1)
        else:
            spins = 0
            while atomic_add(report, MET, 0) == met:
                spins += 1
                if spins > SPINS:
                    pause()


@apart
def total(sums: Any, column: Any) -> float:
    """Return the sum over the blocks, in their order."""
    found = 0.0
    for k in range(len(sums)):
        found += sums[k, column]
    return found


@apart
def solve(rows: Any, work: Any, u: Any, shares: Any, error: float, goal: float) -> Any:
    """Iterate conjugate gradients from the residual's square ``error`` down to the goal.

    With the products r q and q q the new residual is known before it is written: one pass over
    the matrix and one over the vectors an iteration. Returns how far u is to go along p at last,
    and the iterations (-1: given up).
    """
    share, threads = shares
    p, r, q, report = work.fields[P], work.fields[R], work.fields[Q], work.report
    inverse, system = rows.nodal[INVERSE], (rows.start, rows.longer, rows.columns, rows.system)
    iterations, along = 0, 0.0
    while not error <= goal:
        multiply(p, r if iterations else p, q, system, work.sums, share)
        meet(report, threads)
        pq = total(work.sums, PQ)
        if iterations == ITERATION_LIMIT or not pq > 0.0 or not error < np.inf:
            if share[0] == 0:
                work.reals[LEFT], work.reals[GOAL] = error, goal
                report[ITERATIONS] = iterations
            iterations = -1
            break
        along = error / pq
        squares = along * along * total(work.sums, QQ)
        expected = error - 2.0 * along * total(work.sums, RQ) + squares
        iterations += 1
        if expected <= goal:
            break
        streams = (p, r, q, u, inverse)
        update(streams, along, expected / error, iterations == 1, work.sums, share)
        meet(report, threads)
        error, along = total(work.sums, ERROR), 0.0
    return along, iterations
