"""The passes over the rows that a step consists of, each over some of the blocks.

Sums and counts are kept block by block and added up in order, so they do not depend on how many
threads share the blocks. Rows are counted in unsigned numbers: a signed index may be negative to
numba, and asking costs as much as the work itself.
"""

from typing import Any

import numpy as np

from cardiosurf.stepping.compiled.keep import inlined
from cardiosurf.stepping.compiled.laws import rates
from cardiosurf.stepping.compiled.machine import one_pair, one_product, six_pairs, six_products
from cardiosurf.stepping.limits import BLOW_UP, REST_LEVEL, THRESHOLD

MASS, STIFFNESS, INVERSE, LUMPED = range(4)
"""Rows of ``rows.nodal``."""
U0, U1, U2, U3, NEW_U, V0, V1, NEW_V = range(8)
"""Places in the slots: the four newest potentials, the new one, two recoveries, the new one."""
R, P, Q, E, FIRST_STATE = range(5)
"""Rows of ``work.fields``: residual, direction, its image, the way so far; then the states."""
SIZE, ERROR, PQ, RQ, QQ, UNSOUND, BROKEN, WARM, CROSSED = range(9)
"""Columns of ``work.sums``."""

SIX = np.uint64(6)


@inlined
def prepare(rows: Any, rule: Any, work: Any, now: Any, first: int, last: int) -> None:
    """Write what is known, what is guessed, and the new recovery.

    known = sum of past states + dt times past reactions; ``work.vectors`` holds
    (known - guess, guess + earlier implicit terms).
    """
    fields, vectors, nodal, active = work.fields, work.vectors, rows.nodal, work.active
    extents, sums, s, g = rows.extents, work.sums, now.slots, now.guess
    i0, i1, i2, i3, new_u = s[U0], s[U1], s[U2], s[U3], s[NEW_U]
    j0, j1, new_v = s[V0], s[V1], s[NEW_V]
    a0, a1, f0, f1, b1 = rule.state0, rule.state1, rule.push0, rule.push1, rule.implicit1
    g0, g1, g2, g3, c = g[0], g[1], g[2], g[3], rule.constants
    for block in range(first, last):
        size, broken = 0.0, 0
        for i in range(extents[block], extents[block + 1]):
            u0, u1, v0, v1 = fields[i0, i], fields[i1, i], fields[j0, i], fields[j1, i]
            here, before = rates(c, u0, v0), rates(c, u1, v1)
            on = np.float64(active[i])
            known = a0 * u0 + a1 * u1 + on * (f0 * here[0] + f1 * before[0])
            guess = g0 * u0 + g1 * u1 + g2 * fields[i2, i] + g3 * fields[i3, i]
            v = a0 * v0 + a1 * v1 + on * (f0 * here[1] + f1 * before[1])
            fields[new_u, i] = guess
            fields[new_v, i] = v
            fields[Q, i] = known - guess
            fields[E, i] = guess + b1 * u0
            weighed = nodal[INVERSE, i] * nodal[LUMPED, i] * known
            size += weighed * weighed
            broken += not abs(v) < np.inf
        # numbers written side by side would keep the loop above from being done in vectors
        for i in range(extents[block], extents[block + 1]):
            vectors[i, 0] = fields[Q, i]
            vectors[i, 1] = fields[E, i]
        sums[block, SIZE] = size
        sums[block, UNSOUND] = broken


@inlined
def residual(rows: Any, rule: Any, work: Any, first: int, last: int) -> None:
    """Write the residual of the guess, M (known - guess) - w K guess, scaled by D^-1/2."""
    fields, vectors, nodal, sums, w = work.fields, work.vectors, rows.nodal, work.sums, rule.weight
    blocks, runs, pair, columns = rows.blocks, rows.runs, rows.pair, rows.columns
    for block in range(first, last):
        error = 0.0
        for run in range(blocks[block], blocks[block + 1]):
            width, entry = runs[run, 2], runs[run, 3]
            if width == SIX:
                for i in range(runs[run, 0], runs[run, 1]):
                    m, k = six_pairs(pair, vectors, columns, entry)
                    entry += SIX
                    m += nodal[MASS, i] * vectors[i, 0]
                    k += nodal[STIFFNESS, i] * vectors[i, 1]
                    value = nodal[INVERSE, i] * (m - w * k)
                    fields[R, i] = value
                    fields[P, i] = value
                    error += value * value
            else:
                for i in range(runs[run, 0], runs[run, 1]):
                    m, k = nodal[MASS, i] * vectors[i, 0], nodal[STIFFNESS, i] * vectors[i, 1]
                    for e in range(entry, entry + width):
                        more = one_pair(pair, vectors, columns, e)
                        m, k = m + more[0], k + more[1]
                    entry += width
                    value = nodal[INVERSE, i] * (m - w * k)
                    fields[R, i] = value
                    fields[P, i] = value
                    error += value * value
        sums[block, ERROR] = error


@inlined
def multiply(rows: Any, work: Any, first: int, last: int) -> None:
    """Write q = A p, and the products p q, r q and q q."""
    fields, sums, p = work.fields, work.sums, work.fields[P]
    blocks, runs, system, columns = rows.blocks, rows.runs, rows.system, rows.columns
    for block in range(first, last):
        pq, rq, qq = 0.0, 0.0, 0.0
        for run in range(blocks[block], blocks[block + 1]):
            width, entry = runs[run, 2], runs[run, 3]
            if width == SIX:
                for i in range(runs[run, 0], runs[run, 1]):
                    value = p[i] + six_products(system, p, columns, entry)
                    entry += SIX
                    fields[Q, i] = value
                    pq += value * p[i]
                    rq += value * fields[R, i]
                    qq += value * value
            else:
                for i in range(runs[run, 0], runs[run, 1]):
                    value = p[i]
                    for e in range(entry, entry + width):
                        value += one_product(system, p, columns, e)
                    entry += width
                    fields[Q, i] = value
                    pq += value * p[i]
                    rq += value * fields[R, i]
                    qq += value * value
        sums[block, PQ], sums[block, RQ], sums[block, QQ] = pq, rq, qq


@inlined
def update(rows: Any, work: Any, share: Any, along: float, turn: float, kept: float) -> None:
    """Go along p, and turn it: e = kept e + along p, r -= along q, p = r + turn p."""
    fields, sums, extents = work.fields, work.sums, rows.extents
    for block in range(share[0], share[1]):
        error = 0.0
        for i in range(extents[block], extents[block + 1]):
            p = fields[P, i]
            fields[E, i] = kept * fields[E, i] + along * p
            r = fields[R, i] - along * fields[Q, i]
            fields[R, i] = r
            fields[P, i] = r + turn * p
            error += r * r
        sums[block, ERROR] = error


@inlined
def finish(rows: Any, work: Any, now: Any, share: Any, along: float, kept: float) -> None:
    """Write the new potential, guess + D^-1/2 (kept e + along p), and count what matters of it."""
    fields, nodal, sums, extents = work.fields, rows.nodal, work.sums, rows.extents
    new, old = now.slots[NEW_U], now.slots[U0]
    for block in range(share[0], share[1]):
        warm, crossed, broken = 0, 0, 0
        for i in range(extents[block], extents[block + 1]):
            way = kept * fields[E, i] + along * fields[P, i]
            u = fields[new, i] + nodal[INVERSE, i] * way
            fields[new, i] = u
            warm += u > REST_LEVEL
            crossed += (u > THRESHOLD) != (fields[old, i] > THRESHOLD)
            broken += not abs(u) <= BLOW_UP
        sums[block, WARM], sums[block, CROSSED] = warm, crossed
        sums[block, BROKEN] = sums[block, UNSOUND] + broken


@inlined
def weigh_rows(rows: Any, w: float) -> None:
    """Set the system D^-1/2 (M + w K) D^-1/2, and D^-1/2."""
    nodal, runs = rows.nodal, rows.runs
    for i in range(nodal.shape[1]):
        nodal[INVERSE, i] = 1.0 / np.sqrt(nodal[MASS, i] + w * nodal[STIFFNESS, i])
    for run in range(len(runs)):
        width, entry = runs[run, 2], runs[run, 3]
        for i in range(runs[run, 0], runs[run, 1]):
            for e in range(entry, entry + width):
                scale = nodal[INVERSE, i] * nodal[INVERSE, rows.columns[e]]
                rows.system[e] = scale * (rows.pair[e, 0] + w * rows.pair[e, 1])
            entry += width
