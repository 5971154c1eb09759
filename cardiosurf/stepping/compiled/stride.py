"""Many steps in one go: what each thread runs."""

from typing import Any, NamedTuple

import numpy as np

from cardiosurf.arrays import Floats, Ints
from cardiosurf.stepping.compiled.gradients import (
    CROSSINGS,
    GAIN,
    ITERATIONS,
    MOST,
    REASON,
    STEPS,
    meet,
    solve,
    total,
)
from cardiosurf.stepping.compiled.keep import apart, compiled, inlined
from cardiosurf.stepping.compiled.laws import rates
from cardiosurf.stepping.compiled.passes import (
    BROKEN,
    CROSSED,
    ERROR,
    INVERSE,
    LUMPED,
    NEW_U,
    NEW_V,
    SIZE,
    U0,
    U1,
    U2,
    U3,
    V0,
    V1,
    WARM,
    Q,
    R,
    X,
    finish,
    prepare,
    residual,
)
from cardiosurf.stepping.limits import THRESHOLD

DONE, REST_CHANGED, FULL, FULL_AND_REST_CHANGED, UNSOUND, UNSOLVED = range(6)
"""Why a stride ended: all steps done; rest began or ended; no room for this step's crossings; both;
numbers that are not finite or too large; conjugate gradients without success."""

UNDERFLOW = 1e-60
"""Square of a residual that is as good as none: below it single precision runs out of digits."""
TRUSTED = 1e-4
"""What conjugate gradients in single precision make of a residual at best, with some to spare."""
AS_IT_STANDS = np.zeros(4)
"""Weights of the guess that is there."""


class Now(NamedTuple):
    """What turns from step to step.

    Attributes
    ----------
    slots : (8,) int
        Rows of ``work.fields``: see ``passes.U0``.
    guess : (4,) float
        Weights of the last four potentials in the guess of the next.
    """

    slots: Ints
    guess: Floats


@apart
def add_current(streams: Any, nodal: Any, rule: Any, sums: Any, share: Any) -> None:
    """Add a stimulus's current to what is known, and to its size."""
    changed, new, current = streams
    first, last, extents = share
    for block in range(first, last):
        more = 0.0
        for i in range(extents[block], extents[block + 1]):
            push = rule.current_step * current[i]
            # changed = known - guess, and the new potential is the guess still
            known = changed[i] + new[i]
            scale = nodal[LUMPED, i] * nodal[INVERSE, i]
            more += scale * scale * push * (2.0 * known + push)
            changed[i] += push
        sums[block, SIZE] += more


@apart
def spare_scar(rows: Any, rule: Any, work: Any, scar: Any, now: Any) -> float:
    """Take the reaction's share on passive triangles out of the residual; return what r r gains.

    R = M - S, with S the mass of the passive triangles: S times the reaction is taken away, at
    the few rows where it is not zero.
    """
    gain, fields, s, c = 0.0, work.fields, now.slots, rule.constants
    for k in range(len(scar.rows)):
        share = 0.0
        for entry in range(scar.start[k], scar.start[k + 1]):
            i = scar.columns[entry]
            here = rates(c, fields[s[U0], i], fields[s[V0], i])
            earlier = rates(c, fields[s[U1], i], fields[s[V1], i])
            share += scar.values[entry] * (rule.push0 * here[0] + rule.push1 * earlier[0])
        i = scar.rows[k]
        before = np.float64(work.direction[i])
        work.direction[i] = before - rows.nodal[INVERSE, i] * share
        after = np.float64(work.direction[i])
        gain += after * after - before * before
    return gain


@apart
def highest(potential: Any, nodes: Any) -> Any:
    """Return the largest of the nodes' potentials."""
    found = potential[0]
    for i in range(nodes):
        found = max(found, potential[i])
    return found


@apart
def note_crossings(rows: Any, work: Any, now: Any, begun: float, ended: float) -> None:
    """Write row, time and direction of each crossing of 0.5 in this step."""
    fields, new, old = work.fields, now.slots[NEW_U], now.slots[U0]
    count = work.report[CROSSINGS]
    for block in range(len(work.sums)):
        if work.sums[block, CROSSED] > 0.0:
            for i in range(rows.extents[block], rows.extents[block + 1]):
                after, before = fields[new, i], fields[old, i]
                if (after > THRESHOLD) != (before > THRESHOLD):
                    rise = (THRESHOLD - before) / (after - before)
                    work.crossings[count, 0] = i
                    work.crossings[count, 1] = begun + rise * (ended - begun)
                    work.crossings[count, 2] = after > THRESHOLD
                    count += 1
    work.report[CROSSINGS] = count


@inlined
def note_watched(work: Any, now: Any, step: int) -> None:
    """Write u and v of the watched rows after a step."""
    for k in range(len(work.watch)):
        work.watched[step, 0, k] = work.fields[now.slots[NEW_U], work.watch[k]]
        work.watched[step, 1, k] = work.fields[now.slots[NEW_V], work.watch[k]]


@inlined
def turn(now: Any) -> None:
    """Make the new state the newest, and extrapolate the next guess from one state more."""
    slots, guess = now.slots, now.guess
    new_u, new_v = slots[NEW_U], slots[NEW_V]
    for k in range(NEW_U, U0, -1):
        slots[k] = slots[k - 1]
    slots[U0] = new_u
    slots[NEW_V], slots[V1], slots[V0] = slots[V1], slots[V0], new_v
    if guess[3] == 0.0:
        if guess[2] != 0.0:
            guess[0], guess[1], guess[2], guess[3] = 4.0, -6.0, 4.0, -1.0
        elif guess[1] != 0.0:
            guess[0], guess[1], guess[2] = 3.0, -3.0, 1.0
        else:
            guess[0], guess[1] = 2.0, -1.0


@apart
def known_and_guess(nodal: Any, rule: Any, spaces: Any, now: Any, share: Any) -> None:
    """Write what is known, what is guessed, and the new recovery.

    ``spaces`` are fields, pairs, active, current and sums of the work space.
    """
    (f, pairs, active, current, sums), s = spaces, now.slots
    potentials = (f[s[U0]], f[s[U1]], f[s[U2]], f[s[U3]], f[s[NEW_U]])
    recoveries = (f[s[V0]], f[s[V1]], f[s[NEW_V]])
    streams = (*potentials, *recoveries, nodal[LUMPED], nodal[INVERSE], pairs[0], pairs[1])
    prepare(streams, active, rule, now.guess, sums, share)
    if len(current) > 0:
        add_current((pairs[0], f[s[NEW_U]], current), nodal, rule, sums, share)


@apart
def correct(rows: Any, rule: Any, work: Any, scar: Any, now: Any, share: Any) -> Any:
    """Correct a guess of the new state; return the iterations (-1: given up), and what is left.

    Single precision corrects to ``TRUSTED`` of the residual at best. What is left is the square of
    the residual over that of the goal, at least 1 where the guess is to be corrected once more.
    """
    fields, sums, threads = work.fields, work.sums, rule.threads
    spaces = (fields, work.pairs, work.active, work.current, sums)
    known_and_guess(rows.nodal, rule, spaces, now, share)
    meet(work.report, threads)
    p, singles, nodal = work.direction, work.singles, rows.nodal
    layout, pairs = (rows.start, rows.window, rows.place), work.pairs
    both = (layout, (rows.mass, rows.stiffness), rule.weight)
    residual(p, (pairs[0], pairs[1]), (nodal[LUMPED], nodal[INVERSE]), both, sums, share)
    meet(work.report, threads)
    error = total(sums, ERROR)
    if len(scar.rows) > 0:
        if share[0] == 0:
            work.reals[GAIN] = spare_scar(rows, rule, work, scar, now)
        meet(work.report, threads)
        error += work.reals[GAIN]
    goal = rule.tolerance * rule.tolerance * total(sums, SIZE) + UNDERFLOW
    system = (layout, rows.system)
    notes = (sums, work.report, work.reals)
    vectors = (p, singles[R], singles[Q], singles[X])
    nearer = max(goal, TRUSTED * TRUSTED * error)
    along, moved, iterations = solve(vectors, system, notes, (share, threads), error, nearer)
    if iterations >= 0:
        new, old = fields[now.slots[NEW_U]], fields[now.slots[U0]]
        finish((p, singles[X], moved), new, old, nodal[INVERSE], along, (sums, share))
        meet(work.report, threads)
    return iterations, nearer / goal


@inlined
def step(rows: Any, rule: Any, work: Any, scar: Any, now: Any, share: Any) -> Any:
    """Compute the new state; return the iterations, -1 if conjugate gradients gave up."""
    iterations, left = correct(rows, rule, work, scar, now, share)
    before, again = np.inf, Now(now.slots, AS_IT_STANDS)
    # a tolerance below rounding is reached as far as it can be
    while iterations >= 0 and 1.0 < left < 0.25 * before:
        before = left
        more, left = correct(rows, rule, work, scar, again, share)
        iterations = iterations + more if more >= 0 else more
    return iterations


@inlined
def rests(work: Any, now: Any, warm: float, resting: bool) -> Any:
    """Return whether all tissue is at rest after a step (see ``stepping.rest``).

    It begins where no node is above 0.05 and the highest falls, and ends above 0.05.
    """
    falls = True
    if warm == 0.0 and not resting:
        nodes, new, old = len(work.active), now.slots[NEW_U], now.slots[U0]
        falls = highest(work.fields[new], nodes) <= highest(work.fields[old], nodes)
    return warm == 0.0 and falls


@inlined
def copy(one: Any, other: Any) -> None:
    """Copy slots and guess."""
    for k in range(8):
        other.slots[k] = one.slots[k]
    for k in range(4):
        other.guess[k] = one.guess[k]


@apart
def judge(rows: Any, rule: Any, work: Any, now: Any, span: Any) -> Any:
    """Look at a new state: return a reason to end the stride, and the crossings with this step's.

    ``span`` is (begun, ended, steps done before, crossings before, thread).
    """
    begun, ended, done, noted, thread = span
    if total(work.sums, BROKEN) > 0.0:
        return UNSOUND, noted
    reason, crossed = DONE, total(work.sums, CROSSED)
    noted += crossed
    if noted > len(work.crossings):
        reason = FULL
    if thread == 0:
        note_watched(work, now, done)
        if reason == DONE and crossed > 0.0:
            note_crossings(rows, work, now, begun, ended)
    if rule.watch_rest and rests(work, now, total(work.sums, WARM), rule.resting) != rule.resting:
        reason = FULL_AND_REST_CHANGED if reason == FULL else REST_CHANGED
    return reason, noted


@compiled
def stride(rows: Any, rule: Any, work: Any, scar: Any, times: Any, thread: int) -> None:
    """Do a step for each of the times after the first, or fewer: see the reasons above.

    Every thread runs this with its own number; they share the blocks and take the same decisions.
    ``work.report`` and ``work.reals`` tell what came of it.
    """
    threads, blocks = rule.threads, len(rows.extents) - 1
    first = blocks * thread // threads
    share = (first, blocks * (thread + 1) // threads, rows.extents)
    now = Now(np.empty(8, np.int64), np.empty(4))
    copy(work, now)
    # of one type from the start: else what they are handed to is compiled twice
    reason, done, noted = DONE, np.int64(0), 0.0
    iterations, most = np.int64(0), np.int64(0)
    while done < len(times) - 1 and reason == DONE:
        needed = step(rows, rule, work, scar, now, share)
        if needed < 0:
            reason = UNSOLVED
        else:
            iterations, most = iterations + needed, max(most, needed)
            span = (times[done], times[done + 1], done, noted, thread)
            reason, noted = judge(rows, rule, work, now, span)
        if reason < UNSOUND:
            turn(now)
            done += 1
    meet(work.report, threads)
    if thread == 0:
        copy(now, work)
        work.report[REASON], work.report[STEPS] = reason, done
        if reason != UNSOLVED:
            work.report[ITERATIONS], work.report[MOST] = iterations, most
