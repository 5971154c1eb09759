"""One step in time of M u' = -K u + R f(u, v) + M s, v' = g(u, v), whatever the scheme."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from time import perf_counter
from typing import NamedTuple, Protocol

import numpy as np
from scipy.sparse import csr_array

from cardiosurf.arrays import Floats, Mask, Matrix
from cardiosurf.fem.operators import Operators
from cardiosurf.kinetics import Kinetics
from cardiosurf.stepping.schemes import SCHEMES, Scheme
from cardiosurf.stepping.solvers import Solve, SolverFactory

# extrapolation from the last one, two, three or four states; four save a fifth of the iterations
GUESS_WEIGHTS = ((1.0,), (2.0, -1.0), (3.0, -3.0, 1.0), (4.0, -6.0, 4.0, -1.0))

START = 0.01
"""Factor on the solver's tolerance in starting steps: their guess is poor, and what they leave
stands in all that comes after."""


class Past(NamedTuple):
    """The last states and their reactions, (2, n) each, newest first."""

    states: tuple[Floats, ...]
    reactions: tuple[Floats, ...]


class Advance(NamedTuple):
    """The state (2, n) after a step, the solver's iterations and seconds."""

    state: Floats
    iterations: int
    seconds: float


class Single(Protocol):
    """Does a step of a scheme."""

    def __call__(
        self, scheme: Scheme, past: Past, dt: float, current: Floats | None, strictness: float = 1.0
    ) -> Advance:
        """Return the state one step on; ``strictness`` is a factor on the solver's tolerance."""
        ...


@dataclass(frozen=True)
class Stepper:
    """The step rule of one problem.

    Attributes
    ----------
    kinetics : Kinetics
        f and g.
    scheme : Scheme
        The coefficients.
    excitable : (n,) bool
        Nodes with a reaction; v stays at the others.
    single : callable
        Does a step of a scheme: ``Multistep`` in NumPy, or the compiled march.
    """

    kinetics: Kinetics
    scheme: Scheme
    excitable: Mask
    single: Single

    def begin(self, state: Floats) -> Past:
        """Return a past that consists of one state."""
        state.setflags(write=False)
        return Past((state,), (self.reaction(state),))

    def extend(self, past: Past, state: Floats) -> Past:
        """Return the past with a new state, cut to what steps and guesses need."""
        state.setflags(write=False)
        return Past(
            (state, *past.states)[: max(self.scheme.depth, len(GUESS_WEIGHTS))],
            (self.reaction(state), *past.reactions)[: len(self.scheme.explicit)],
        )

    def reaction(self, state: Floats) -> Floats:
        """Return f and g, (2, n); g is 0 where nothing is excitable."""
        reaction = np.array(self.kinetics.rates(state[0], state[1]))
        reaction[1, ~self.excitable] = 0.0
        return reaction

    def is_deep(self, past: Past) -> bool:
        """Return whether the past is deep enough for the scheme."""
        scheme = self.scheme
        deep = len(past.states) >= scheme.depth
        return deep and len(past.reactions) >= len(scheme.explicit)

    def advance(self, past: Past, dt: float, current: Floats | None) -> Advance:
        """Return the state one step on.

        Until the past is deep enough for the scheme, the step is one of implicit-explicit Euler
        and two of half its length, extrapolated: its error is of third order in dt, so a fixed
        number of them leaves the order of the whole alone.
        """
        if self.is_deep(past):
            return self.single(self.scheme, past, dt, current)
        euler = SCHEMES["imex_euler"]
        newest = Past(past.states[:1], past.reactions[:1])
        half = self.single(euler, newest, dt / 2, current, START)
        both = self.single(euler, self.begin(half.state), dt / 2, current, START)
        whole = self.single(euler, newest, dt, current, START)
        # memory: in place
        state = both.state
        state *= 2.0
        state -= whole.state
        return Advance(
            state,
            whole.iterations + half.iterations + both.iterations,
            whole.seconds + half.seconds + both.seconds,
        )


@dataclass(frozen=True)
class Multistep:
    """Steps in NumPy: the reference.

    Attributes
    ----------
    operators : Operators
        M, R and K.
    solve_for : callable
        Takes the weight w, in tu, and returns the solve of (M + w K) x = b; remembers a few.
    lumped : (n,) float
        Row sums of M, in su^2.
    """

    operators: Operators
    solve_for: Callable[[float], Solve]
    lumped: Floats

    @classmethod
    def of(cls, operators: Operators, factory: SolverFactory) -> "Multistep":
        """Return the steps; matrices are made, and factorised, when first asked for."""

        @lru_cache(maxsize=6)
        def solve_for(weight: float) -> Solve:
            return factory(_system(operators, weight))

        lumped = np.asarray(operators.mass.sum(axis=1), dtype=np.float64)
        return cls(operators, solve_for, lumped)

    def __call__(
        self, scheme: Scheme, past: Past, dt: float, current: Floats | None, strictness: float = 1.0
    ) -> Advance:
        """Return the state one step of the scheme on, everything divided by its first a_j."""
        mass, reaction_mass = self.operators.mass, self.operators.reaction_mass
        a0 = scheme.state[0]
        known = _combine([-a / a0 for a in scheme.state[1:]], past.states)
        pushed = _combine([dt * c / a0 for c in scheme.explicit], past.reactions)
        if current is not None:
            known[0] += dt / a0 * current
        if reaction_mass is mass:
            known += pushed
            rhs = mass @ known[0]
        else:
            rhs = mass @ known[0] + reaction_mass @ pushed[0]
            known += pushed
        scale = strictness * self.lumped * known[0]
        if len(scheme.implicit) > 1:
            earlier = [state[0] for state in past.states]
            weights = [dt * b / a0 for b in scheme.implicit[1:]]
            rhs -= self.operators.stiffness @ _combine(weights, earlier)
        guesses = [state[0] for state in past.states[: len(GUESS_WEIGHTS)]]
        guess = _combine(GUESS_WEIGHTS[len(guesses) - 1], guesses)
        solve = self.solve_for(dt * scheme.implicit[0] / a0)
        begun = perf_counter()
        known[0], iterations = solve(rhs, guess, scale)
        return Advance(known, iterations, perf_counter() - begun)


def _system(operators: Operators, weight: float) -> Matrix:
    """Return M + w K; where the two share their pattern so does it, and is quickly made."""
    mass, stiffness = operators.mass, operators.stiffness
    if mass.indices is not stiffness.indices or mass.indptr is not stiffness.indptr:
        return mass + weight * stiffness
    system: Matrix = csr_array(mass.shape)
    # set, because the constructor copies them
    system.data = mass.data + weight * stiffness.data
    system.indices, system.indptr = mass.indices, mass.indptr
    system.has_canonical_format = True
    return system


def _combine(weights: Sequence[float], arrays: Sequence[Floats]) -> Floats:
    """Return the weighted sum of as many arrays as there are weights."""
    total = weights[0] * arrays[0]
    for weight, array in zip(weights[1:], arrays[1:], strict=False):
        total += weight * array
    return total
