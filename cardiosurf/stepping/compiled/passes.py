"""The passes over the rows that a step consists of, each over some of the blocks.

Sums and counts are kept block by block and added up in order, so they do not depend on how many
threads share the blocks. Rows are counted in unsigned numbers: a signed index may be negative to
numba, and asking costs as much as the work itself. The vectors of a loop are its function's
arguments, one by one or in a tuple: where they are taken out of a larger array beside the loop,
the compiler does not see that they are apart, and does one row at a time.
"""

from typing import Any

import numpy as np

from cardiosurf.stepping.compiled.keep import apart
from cardiosurf.stepping.compiled.laws import rates
from cardiosurf.stepping.compiled.machine import GROUP, differences, products
from cardiosurf.stepping.limits import BLOW_UP, REST_LEVEL, THRESHOLD

LUMPED, INVERSE = range(2)
"""Rows of ``rows.nodal``."""
U0, U1, U2, U3, NEW_U, V0, V1, NEW_V = range(8)
"""Places in the slots: the four newest potentials, the new one, two recoveries, the new one."""
R, Q, X = range(3)
"""Rows of ``work.singles``: residual, image of the direction, the way done from the guess."""
SIZE, ERROR, PQ, RQ, QQ, UNSOUND, BROKEN, WARM, CROSSED = np.arange(9)
"""Columns of ``work.sums``; of a type of their own, or ``total`` is compiled for each of them."""

ONE, EIGHT = np.uint64(1), np.uint64(GROUP)


@apart
def prepare(streams: Any, active: Any, rule: Any, guess: Any, sums: Any, share: Any) -> None:
    """Write what is known, what is guessed, and the new recovery.

    The guess is extrapolated from the last potentials, unless its weights are all zero: it is the
    new potential as it stands then.

    known = sum of past states + dt times past reactions. With e, the earlier implicit terms, the
    residual of the guess is M (known - guess) - w K (guess + e): M and K are applied to ``changed``
    and ``raised``.
    """
    u0, u1, u2, u3, new_u, v0, v1, new_v, lumped, inverse, changed, raised = streams
    a0, a1, f0, f1, b1 = rule.state0, rule.state1, rule.push0, rule.push1, rule.implicit1
    g0, g1, g2, g3, c = guess[0], guess[1], guess[2], guess[3], rule.constants
    first, last, extents = share
    given = g0 == 0.0
    for block in range(first, last):
        size, broken = 0.0, 0
        for i in range(extents[block], extents[block + 1]):
            here, before = rates(c, u0[i], v0[i]), rates(c, u1[i], v1[i])
            on = np.float64(active[i])
            known = a0 * u0[i] + a1 * u1[i] + on * (f0 * here[0] + f1 * before[0])
            extrapolated = g0 * u0[i] + g1 * u1[i] + g2 * u2[i] + g3 * u3[i]
            guessed = new_u[i] if given else extrapolated
            v = a0 * v0[i] + a1 * v1[i] + on * (f0 * here[1] + f1 * before[1])
            new_u[i] = guessed
            new_v[i] = v
            changed[i], raised[i] = known - guessed, guessed + b1 * u0[i]
            weighed = lumped[i] * inverse[i] * known
            size += weighed * weighed
            broken += not abs(v) < np.inf
        sums[block, SIZE] = size
        sums[block, UNSOUND] = broken


@apart
def residual(p: Any, pairs: Any, nodal: Any, rows: Any, sums: Any, share: Any) -> None:
    """Write the residual of the guess, scaled by D^-1/2: the first direction."""
    (start, window, place), both, weight = rows
    lumped, inverse = nodal
    first, last, extents = share
    for block in range(first, last):
        low, high = extents[block], extents[block + 1]
        for group in range(low // EIGHT, (high + EIGHT - ONE) // EIGHT):
            slots = (window, place, start[group], start[group + ONE] - start[group])
            differences((p, EIGHT * group), slots, both, pairs, (lumped, inverse, weight))
        error = 0.0
        for i in range(low, high):
            value = np.float64(p[i])
            error += value * value
        sums[block, ERROR] = error


@apart
def multiply(p: Any, r: Any, q: Any, rows: Any, sums: Any, share: Any) -> None:
    """Write q = A p, and the products p q, r q and q q."""
    (start, window, place), system = rows
    first, last, extents = share
    for block in range(first, last):
        low, high = extents[block], extents[block + 1]
        for group in range(low // EIGHT, (high + EIGHT - ONE) // EIGHT):
            slots = (window, place, start[group], start[group + ONE] - start[group])
            products((q, EIGHT * group), slots, system, p)
        pq, rq, qq = 0.0, 0.0, 0.0
        for i in range(low, high):
            value = p[i] + q[i]
            q[i] = value
            image = np.float64(value)
            pq += image * np.float64(p[i])
            rq += image * np.float64(r[i])
            qq += image * image
        sums[block, PQ], sums[block, RQ], sums[block, QQ] = pq, rq, qq


@apart
def update(streams: Any, along: Any, turn: Any, begins: bool, sums: Any, share: Any) -> None:
    """Go along p, and turn it: x += along p, r -= along q, p = r + turn p.

    Where it begins, the residual is the direction still, and no way is done.
    """
    p, r, q, x = streams
    first, last, extents = share
    for block in range(first, last):
        error = 0.0
        for i in range(extents[block], extents[block + 1]):
            old = p[i]
            way = along * old
            x[i] = way if begins else x[i] + way
            value = (old if begins else r[i]) - along * q[i]
            r[i] = value
            p[i] = value + turn * old
            error += np.float64(value) * np.float64(value)
        sums[block, ERROR] = error


@apart
def finish(way: Any, new: Any, old: Any, inverse: Any, along: Any, more: Any) -> None:
    """Write the new potential, u + D^-1/2 (x + along p), and count what matters of it."""
    p, x, moved = way
    sums, share = more
    first, last, extents = share
    for block in range(first, last):
        warm, crossed, broken = 0, 0, 0
        for i in range(extents[block], extents[block + 1]):
            way_done = along * p[i] + (x[i] if moved else np.float32(0.0))
            u = new[i] + inverse[i] * np.float64(way_done)
            new[i] = u
            warm += u > REST_LEVEL
            crossed += (u > THRESHOLD) != (old[i] > THRESHOLD)
            broken += not abs(u) <= BLOW_UP
        sums[block, WARM], sums[block, CROSSED] = warm, crossed
        sums[block, BROKEN] = sums[block, UNSOUND] + broken
