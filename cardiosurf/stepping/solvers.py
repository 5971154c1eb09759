"""Linear solvers of the diffusion step: factories that take a matrix and return a solve."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import scipy

from cardiosurf.arrays import Floats, Matrix
from cardiosurf.errors import InputError, NumericalError

Solve: TypeAlias = Callable[[Floats, Floats, Floats], tuple[Floats, int]]
"""(right-hand side, guess, scale) -> (solution, iterations).

The scale is what a tolerance is relative to: about the right-hand side, but with the lumped mass.
"""

SolverFactory: TypeAlias = Callable[[Matrix], Solve]

LOOSEST_TOLERANCE = 1e-5
ITERATION_LIMIT = 1000
UNDERFLOW = 1e-200
PIECE = 8192


@dataclass(frozen=True)
class SolverChoice:
    """A linear solver, and why it was taken.

    Attributes
    ----------
    name : str
        "cg", "direct" or a foreign one's.
    reason : str
        One line for the record.
    factory : callable
        Takes a symmetric positive definite matrix, returns the solve.
    tolerance : float or None
        Of the conjugate gradients that the compiled march has too; None for all other solvers.
    """

    name: str
    reason: str
    factory: SolverFactory
    tolerance: float | None = None


def conjugate_gradients(tolerance: float = 1e-7) -> SolverFactory:
    """Return the factory of conjugate gradients with Jacobi preconditioning.

    It stops at |b - A x| <= tolerance |scale| in the norm |x|^2 = x . D^-1 x, D the diagonal of A.

    The loop is the project's own because its sums do not depend on the number of BLAS threads, as
    those of scipy's do; it is about as fast (benchmarks/README.md).

    Parameters
    ----------
    tolerance : float
        Relative residual, at most 1e-5: looser ones can delay fronts without a sign.

    Raises
    ------
    InputError
        The tolerance is not in (0, 1e-5].
    NumericalError
        From the solve: no convergence within 1000 iterations, a matrix that is not positive, or
        numbers that are not finite.
    """
    if not 0.0 < tolerance <= LOOSEST_TOLERANCE:
        raise InputError(
            "time.tolerance",
            f"{tolerance:g} is not a tolerance that keeps the front's speed",
            f"0 < tolerance <= {LOOSEST_TOLERANCE:g}",
            "1e-7, the default",
        )

    def factory(matrix: Matrix) -> Solve:
        inverse_diagonal = 1.0 / matrix.diagonal()

        def solve(rhs: Floats, guess: Floats, scale: Floats) -> tuple[Floats, int]:
            # the floor ends the solve where squares underflow, in tissue long at rest
            goal = tolerance**2 * _dot(scale, inverse_diagonal * scale) + UNDERFLOW
            return _iterate(matrix, inverse_diagonal, rhs, guess, goal)

        return solve

    return factory


def _iterate(
    matrix: Matrix, inverse_diagonal: Floats, rhs: Floats, guess: Floats, goal: float
) -> tuple[Floats, int]:
    """Return the solution and the number of iterations of preconditioned conjugate gradients."""
    x = guess.copy()
    r = rhs - matrix @ x
    z = inverse_diagonal * r
    p = z.copy()
    rho = _dot(r, z)
    iteration = 0
    # a right-hand side that is not finite must not pass for solved
    while np.isfinite(goal) and iteration < ITERATION_LIMIT:
        if 0.0 <= rho <= goal:
            return x, iteration
        q = matrix @ p
        curvature = _dot(p, q)
        if not curvature > 0.0:
            break
        alpha = rho / curvature
        x += alpha * p
        r -= alpha * q
        np.multiply(inverse_diagonal, r, out=z)
        rho, previous = _dot(r, z), rho
        p *= rho / previous
        p += z
        iteration += 1
    raise not_converged(iteration, rho, goal)


def not_converged(iterations: int, error: float, goal: float) -> NumericalError:
    """Return the error of conjugate gradients that stopped at a square residual above the goal."""
    return NumericalError(
        f"conjugate gradients stopped after {iterations} iterations at a residual of "
        f"{np.sqrt(np.abs(error)):.1e} instead of {np.sqrt(np.abs(goal)):.1e}",
        "a smaller time.step, or time.solver: direct",
    )


def _dot(a: Floats, b: Floats) -> float:
    """Return the scalar product, summed over pieces.

    BLAS shares longer products out to threads: their number would then show in the last digits,
    and on cores that are busy a step took twenty times as long.
    """
    return sum(float(a[k : k + PIECE] @ b[k : k + PIECE]) for k in range(0, len(a), PIECE))


def direct() -> SolverFactory:
    """Return the factory of the sparse direct solver: one factorisation, then back-solves.

    The permutation is minimum degree on A + A^T with diagonal pivots, which suits symmetric
    matrices (SuperLU).
    """

    def factory(matrix: Matrix) -> Solve:
        try:
            factors = scipy.sparse.linalg.splu(
                matrix.tocsc(),
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )
        except RuntimeError as error:
            raise NumericalError(
                f"the matrix of a step cannot be factorised: {error}",
                "diffusivities and factors nearer to 1, or time.solver: cg",
            ) from error

        def solve(rhs: Floats, guess: Floats, scale: Floats) -> tuple[Floats, int]:
            return factors.solve(rhs), 0

        return solve

    return factory


def choose_solver(
    nodes: int,
    *,
    stiffness: float = 1.0,
    steps: float = np.inf,
    wanted: Literal["auto", "cg", "direct"] = "auto",
    tolerance: float = 1e-7,
    compiled: bool = True,
) -> SolverChoice:
    """Return the linear solver for a mesh, with the reason.

    The measured rule (docs/numerics.md) counts in iterations of conjugate gradients: a step takes
    1.5 + 2.5 sqrt(s) of them. In NumPy a back-solve costs sqrt(n) / 14 and the three
    factorisations of a run 6 sqrt(n). In machine code an iteration costs much less, and direct
    gives that up for the rest of the step too: 13 + 24,000 / n + sqrt(n) / 4 iterations, and
    40 sqrt(n) for the factorisations.

    Parameters
    ----------
    nodes : int
        Number of vertices n.
    stiffness : float
        s, the mean of w K_ii / M_ii, in the matrix M + w K.
    steps : float
        Number of steps ahead.
    wanted : {"auto", "cg", "direct"}
        "auto" leaves the choice to the rule.
    tolerance : float
        Relative residual of conjugate gradients.
    compiled : bool
        Whether machine code marches with conjugate gradients; with direct it never does.
    """
    iterations = 1.5 + 2.5 * stiffness**0.5
    if compiled:
        equivalent = 13.0 + 24e3 / nodes + nodes**0.5 * (0.25 + 40.0 / steps)
    else:
        equivalent = nodes**0.5 * (1.0 / 14.0 + 6.0 / steps)
    name = wanted
    reason = "asked for"
    if wanted == "auto":
        name = "direct" if equivalent < iterations else "cg"
        reason = (
            f"{nodes} nodes: a step is estimated at {iterations:.1f} iterations of cg, "
            f"or as much work as {equivalent:.1f} with direct"
        )
    if name == "direct":
        return SolverChoice(name, reason, direct())
    return SolverChoice(name, reason, conjugate_gradients(tolerance), tolerance)
