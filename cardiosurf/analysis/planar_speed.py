"""The speed c0 of a straight front at d = 1, and how much curvature slows it down."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.sparse import csr_array

from cardiosurf.arrays import Floats
from cardiosurf.fem.operators import Operators
from cardiosurf.kinetics import Kinetics
from cardiosurf.recording.observers import Activation
from cardiosurf.stepping.march import Controls, Moment, Problem, march
from cardiosurf.stepping.rest import at_rest
from cardiosurf.stepping.schemes import SCHEMES
from cardiosurf.stepping.solvers import choose_solver
from cardiosurf.stepping.step_rule import StepChoice, reaction_rate
from cardiosurf.tissue.stimuli import Pulse

STEP = 0.1
"""Step relative to the fastest rate of the reaction: 0.45 tu for the default kinetics."""
EDGE, LENGTH, WALL = 0.4, 100.0, 4.0
"""Edge and length of the line, and what is stimulated of it, in lengths sqrt(d/rate)."""
BEGIN, END = 0.4, 0.75
"""Where on the line the speed is taken: settled, and before the front meets the far end."""
PATIENCE = 2000.0
"""When to give up, in units of 1/rate: a front ten times as slow as the default's is still seen."""

SHIFT = 0.05
"""By how much recovery is made faster and slower to see what it does to the speed."""


@dataclass(frozen=True)
class _Hastened:
    """A kinetics model whose recovery is faster by a factor."""

    kinetics: Kinetics
    factor: float

    def rates(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Return f and the factor times g."""
        f, g = self.kinetics.rates(u, v)
        return f, self.factor * g


@cache
def curvature_factor(kinetics: Kinetics) -> float:
    """Return g of c = c0 - g d K for gently curved fronts; 1 where there is no wave.

    A front of curvature K that moves at c is a straight one with d u'' + (c + d K) u' + f = 0,
    but c v' + r = 0 (r the rate of v): to its recovery it is slower than to its potential. So
    c + d K is the speed of a straight front whose recovery is faster by (c + d K)/c, and to first
    order in K

        g = 1 - d log c0/d log(rate of recovery).

    It is 1 without recovery and 1.335 for the default kinetics; d is not the coefficient of K for
    a pulse.

    Parameters
    ----------
    kinetics : Kinetics
        The reaction; hashable.
    """
    fast, slow = (planar_speed(_Hastened(kinetics, 1.0 + shift)) for shift in (SHIFT, -SHIFT))
    if not fast * slow > 0.0:
        return 1.0
    return float(1.0 - np.log(fast / slow) / np.log((1.0 + SHIFT) / (1.0 - SHIFT)))


@cache
def planar_speed(kinetics: Kinetics) -> float:
    """Return the speed of a straight front at d = 1, in su/tu; 0 where there is no wave.

    A front is marched along a line with the scheme and the blended mass of a run, at a step and an
    edge that put the speed off by 0.02 %. It takes a tenth of a second, once for each kinetics.

    Parameters
    ----------
    kinetics : Kinetics
        The reaction; hashable, as the sections of a config are.
    """
    rate = reaction_rate(kinetics)
    unit = 1.0 / np.sqrt(rate)
    x = unit * EDGE * np.arange(round(LENGTH / EDGE) + 1)
    end = round(END * len(x))
    stimulus = Pulse(0.0, 0.0, np.where(x <= WALL * unit, 1.0, 0.0), "planar speed")
    controls = Controls(
        SCHEMES["sbdf2"],
        StepChoice(STEP / rate, "planar speed"),
        PATIENCE / rate,
        choose_solver(len(x), wanted="direct"),
    )
    seen = Activation()

    def arrived(moment: Moment) -> bool:
        return bool(moment.state[0, end] > 0.6) or at_rest(moment)

    march(Problem(_line(x), kinetics, (stimulus,)), controls, (seen,), stop=arrived)
    lat = seen.activations().first(len(x))
    chosen = slice(round(BEGIN * len(x)), end)
    if not np.isfinite(lat[chosen]).all():
        return 0.0
    return float(1.0 / np.polyfit(x[chosen], lat[chosen], 1)[0])


def _line(x: Floats) -> Operators:
    """Return the matrices of a line of equal edges, linear elements with the blended mass."""
    count, edge = len(x), float(x[1] - x[0])
    own = np.ones(count)
    own[[0, -1]] = 0.5
    next_to = np.eye(count, k=1) + np.eye(count, k=-1)
    stiffness = (np.diag(2.0 * own) - next_to) / edge
    # the consistent mass has 2/3 and 1/6, the lumped one 1 and 0
    mass = csr_array((np.diag(5.0 / 6.0 * own) + next_to / 12.0) * edge)
    return Operators(mass, mass, csr_array(stiffness))
