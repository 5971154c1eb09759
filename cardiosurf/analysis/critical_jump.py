"""The jump of diffusivity that a straight front just passes: marches along a line, for a kinetics.

Where d jumps from d1 to d2 across the way of a straight front, lengths are longer beyond the jump
by k = sqrt(d2/d1). In units of its own length each side is the same tissue, and what is left of
the jump is a line that becomes wider by the factor k: the front has to feed k times the membrane
that feeds it. Whether it can depends on the kinetics alone. Without recovery the critical ratio is
exact,

    d2/d1 = 1 + F(1)/|F(a)|,   F(u) = int_0^u f,

1 + (1 - 2a)/(a^3 (2 - a)) for a cubic: beyond it a front can stand still, losing by diffusion on
the far side what it gains on the near one. Recovery makes it much smaller.
"""

from functools import cache

import numpy as np
from scipy.sparse import csr_array

from cardiosurf.arrays import Floats
from cardiosurf.errors import InputError
from cardiosurf.fem.operators import Operators
from cardiosurf.kinetics import Kinetics
from cardiosurf.kinetics.rogers_mcculloch import RogersMcCulloch
from cardiosurf.recording.observers import Activation
from cardiosurf.stepping.march import Controls, Moment, Problem, march
from cardiosurf.stepping.rest import at_rest
from cardiosurf.stepping.schemes import SCHEMES
from cardiosurf.stepping.solvers import choose_solver
from cardiosurf.stepping.step_rule import StepChoice, reaction_rate
from cardiosurf.tissue.stimuli import Pulse

EDGE, BEFORE, BEYOND, WALL = 0.4, 40.0, 16.0, 4.0
"""Edge of the line, its lengths before and beyond the jump, what is stimulated: in sqrt(d/rate)."""
STEP, PATIENCE = 0.1, 600.0
"""Step, and when to give up, in units of 1/rate."""
SEEN = 10.0
"""A front that has come so far beyond the jump, in sqrt(d/rate), has passed."""
GREATEST = 1000.0
"""No jump above this is tried."""
TOLERANCE = 0.002
"""Half width of the last bracket, relative."""
DEFAULT = 7.492
"""Of the default kinetics; at half the edge and step the search ends in the same bracket."""


@cache
def critical_jump(kinetics: Kinetics) -> float:
    """Return the greatest ratio d2/d1 that a straight front passes; infinite above 1000.

    Parameters
    ----------
    kinetics : Kinetics
        The reaction; hashable, as the sections of a config are.

    Raises
    ------
    InputError
        There is no wave even in uniform tissue.
    """
    if kinetics == RogersMcCulloch():
        return DEFAULT
    return search(kinetics)


def search(kinetics: Kinetics) -> float:
    """Return ``critical_jump`` by bisection, some ten marches, whatever is known already.

    Parameters
    ----------
    kinetics : Kinetics
        The reaction.

    Raises
    ------
    InputError
        There is no wave even in uniform tissue.
    """
    if not passes(kinetics, 1.0):
        raise InputError("kinetics", "carries no wave", "a model whose front propagates")
    low, high = 1.0, 4.0
    while passes(kinetics, high):
        low, high = high, 2.0 * high
        if low > GREATEST:
            return np.inf
    while high - low > 2.0 * TOLERANCE * low:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if passes(kinetics, middle) else (low, middle)
    return 0.5 * (low + high)


def passes(kinetics: Kinetics, jump: float) -> bool:
    """Tell whether a straight front passes from d1 to d2 = jump x d1.

    Parameters
    ----------
    kinetics : Kinetics
        The reaction.
    jump : float
        The ratio d2/d1.
    """
    rate = reaction_rate(kinetics)
    edge = EDGE / np.sqrt(rate)
    before, beyond = round(BEFORE / EDGE), round(BEYOND / EDGE)
    x = edge * np.arange(before + beyond + 1)
    width = np.where(np.arange(before + beyond) < before, 1.0, np.sqrt(jump))
    stimulus = Pulse(0.0, 0.0, np.where(x <= WALL / np.sqrt(rate), 1.0, 0.0), "critical jump")
    controls = Controls(
        SCHEMES["sbdf2"],
        StepChoice(STEP / rate, "critical jump"),
        PATIENCE / rate,
        choose_solver(len(x), wanted="direct"),
    )
    seen, end = Activation(), before + round(SEEN / EDGE)

    def arrived(moment: Moment) -> bool:
        return bool(moment.state[0, end] > 0.6) or at_rest(moment)

    problem = Problem(_widening_line(width, edge), kinetics, (stimulus,))
    march(problem, controls, (seen,), stop=arrived)
    return bool(np.isfinite(seen.activations().first(len(x))[end]))


def _widening_line(width: Floats, edge: float) -> Operators:
    """Return the matrices of a line whose elements have these widths, with the blended mass."""
    count = len(width) + 1
    start = np.arange(len(width))
    rows = np.concatenate([start, start, start + 1, start + 1])
    columns = np.concatenate([start, start + 1, start, start + 1])

    def assembled(own: float, other: float) -> csr_array:
        values = np.concatenate([own * width, other * width, other * width, own * width])
        return csr_array((values, (rows, columns)), shape=(count, count))

    # half way between the consistent mass, (1/3, 1/6), and the lumped one, (1/2, 0)
    mass = assembled(edge * 5.0 / 12.0, edge / 12.0)
    return Operators(mass, mass, assembled(1.0 / edge, -1.0 / edge))
