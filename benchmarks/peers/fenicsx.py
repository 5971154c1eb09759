"""FEniCSx (dolfinx with PETSc): SBDF2, conjugate gradients with Jacobi.

``--style plain`` is what its users write: forms, the right-hand side assembled at every step.
``--style tuned`` multiplies with a mass that was assembled once and works in the vectors' own
memory. ``--mass blended`` is the mean of the lumped and the consistent mass.
"""

import numpy as np
import ufl
from common import B1, B2, C1, C2, A, Activation, Stopwatch, arguments, report, steps_of
from dolfinx import __version__, fem, mesh
from dolfinx.fem import petsc as fem_petsc
from mpi4py import MPI
from petsc4py import PETSc

# coefficients of the extrapolation of the last states, newest first, by its order
GUESSES = {0: (1.0,), 1: (2.0, -1.0), 2: (3.0, -3.0, 1.0), 3: (4.0, -6.0, 4.0, -1.0)}


def options(parser) -> None:
    parser.add_argument("--style", choices=["plain", "tuned"], default="plain")
    parser.add_argument("--mass", choices=["consistent", "blended"], default="consistent")
    parser.add_argument("--guess", type=int, choices=GUESSES, default=1, help="its order")
    parser.add_argument("--rtol", type=float, default=1e-6)
    parser.add_argument("--matrix", default="aij", help="PETSc's type of matrix (tuned)")


class Space:
    """Linear elements on the problem's triangles, and the way back to its vertices."""

    def __init__(self, problem) -> None:
        cell = ufl.Cell("triangle", geometric_dimension=3)
        shape = ufl.Mesh(ufl.VectorElement("Lagrange", cell, 1, dim=3))
        cells = problem.triangles.astype(np.int64)
        self.mesh = mesh.create_mesh(MPI.COMM_WORLD, cells, problem.points, shape)
        self.linear = fem.FunctionSpace(self.mesh, ("Lagrange", 1))
        geometry = self.mesh.geometry
        dofs = self.linear.dofmap.list.array.reshape(-1, 3)
        places = geometry.dofmap.array.reshape(-1, 3)
        self.vertex_of = np.empty(len(problem.points), dtype=np.int64)
        self.vertex_of[dofs] = np.asarray(geometry.input_global_indices)[places]
        self.tensor = fem.Function(fem.TensorFunctionSpace(self.mesh, ("DG", 0), shape=(3, 3)))
        order = np.asarray(self.mesh.topology.original_cell_index)
        self.tensor.x.array[:] = problem.tensor[order].ravel()

    def from_vertices(self, values: np.ndarray) -> np.ndarray:
        return values[self.vertex_of]

    def to_vertices(self, values: np.ndarray) -> np.ndarray:
        out = np.empty_like(values)
        out[self.vertex_of] = values
        return out


def mass_form(given, u, w):
    """Return the form of the mass; the vertices as quadrature points lump it."""
    consistent = u * w * ufl.dx
    if given.mass == "consistent":
        return consistent
    at_vertices = ufl.dx(metadata={"quadrature_rule": "vertex", "quadrature_degree": 1})
    return 0.5 * consistent + 0.5 * u * w * at_vertices


def assembled(form) -> PETSc.Mat:
    matrix = fem_petsc.assemble_matrix(fem.form(form))
    matrix.assemble()
    return matrix


def conjugate_gradients(matrix: PETSc.Mat, given) -> PETSc.KSP:
    ksp = PETSc.KSP().create(MPI.COMM_WORLD)
    ksp.setOperators(matrix)
    ksp.setType("cg")
    ksp.getPC().setType("jacobi")
    ksp.setTolerances(rtol=given.rtol)
    ksp.setInitialGuessNonzero(True)
    ksp.setErrorIfNotConverged(True)
    if given.style == "tuned":
        # the only norm that conjugate gradients get for free
        ksp.setNormType(PETSc.KSP.NormType.NATURAL)
    ksp.setUp()
    return ksp


class Plain:
    """The step as the tutorials have it."""

    def __init__(self, space: Space, given, initial: np.ndarray) -> None:
        # a constant of the form, not a number in it: one compilation serves every step length
        dt = fem.Constant(space.mesh, given.dt)
        u, w = ufl.TrialFunction(space.linear), ufl.TestFunction(space.linear)
        self.u, self.past, self.f, self.f_past = (fem.Function(space.linear) for _ in range(4))
        stiffness = ufl.inner(space.tensor * ufl.grad(u), ufl.grad(w)) * ufl.dx
        first = mass_form(given, self.u / dt + self.f, w)
        other = mass_form(
            given, (4.0 * self.u - self.past) / (2.0 * dt) + 2.0 * self.f - self.f_past, w
        )
        self.forms = [fem.form(first), fem.form(other)]
        self.solvers = [
            conjugate_gradients(assembled(mass_form(given, rate / dt * u, w) + stiffness), given)
            for rate in (1.0, 1.5)
        ]
        self.rhs = fem_petsc.create_vector(self.forms[0])
        self.solution = fem.Function(space.linear)
        self.dt, self.order, self.step = given.dt, given.guess, 0
        self.u.x.array[:] = initial
        self.v = np.zeros_like(initial)
        self.g_past = self.v_past = self.v

    @property
    def state(self) -> np.ndarray:
        return self.u.x.array.copy()

    def advance(self) -> None:
        later = min(self.step, 1)
        u, v, dt = self.u.x.array, self.v, self.dt
        self.f.x.array[:] = C1 * u * (u - A) * (1.0 - u) - C2 * u * v
        g = B1 * (u - B2 * v)
        with self.rhs.localForm() as local:
            local.set(0.0)
        fem_petsc.assemble_vector(self.rhs, self.forms[later])
        self.solution.x.array[:] = 2.0 * u - self.past.x.array if later and self.order else u
        self.solvers[later].solve(self.rhs, self.solution.vector)
        if later:
            self.v, self.v_past = (
                (4.0 * v - self.v_past + 2.0 * dt * (2.0 * g - self.g_past)) / 3.0,
                v,
            )
        else:
            self.v, self.v_past = v + dt * g, v
        self.g_past = g
        self.past.x.array[:] = u
        self.f_past.x.array[:] = self.f.x.array
        self.u.x.array[:] = self.solution.x.array
        self.step += 1


class Tuned:
    """The same step with few calls and no copies.

    ``history`` holds rows of past states: u four, p = u/(2 dt) + f two, w = C2 v two of them. The
    right-hand side before the mass, 2 p - p_past + u/dt, the next w and the extrapolated guess are
    sums of its rows, so one product gives all three. PETSc's vectors lie on the rows themselves.
    """

    def __init__(self, space: Space, given, initial: np.ndarray) -> None:
        u, w = ufl.TrialFunction(space.linear), ufl.TestFunction(space.linear)
        mass = assembled(mass_form(given, u, w))
        stiffness = assembled(ufl.inner(space.tensor * ufl.grad(u), ufl.grad(w)) * ufl.dx)
        systems = []
        for rate in (1.0 / given.dt, 1.5 / given.dt):
            system = stiffness.copy()
            system.axpy(rate, mass, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
            systems.append(system.convert(given.matrix))
        self.mass = mass.convert(given.matrix)
        self.solvers = [conjugate_gradients(system, given) for system in systems]
        self.dt, self.order, self.step = given.dt, given.guess, 0
        count = len(initial)
        self.history, self.sums = np.zeros((8, count)), np.zeros((3, count))
        self.history[0] = initial
        self.rows, self.source = list(self.history), PETSc.Vec().createWithArray(self.sums[0])
        self.solutions = [PETSc.Vec().createWithArray(row) for row in self.rows[:4]]
        self.rhs = PETSc.Vec().createSeq(count)
        # the rows take turns: after three steps the factors repeat every four
        self.factors = [self._factors(step) for step in range(8)]

    def _factors(self, step: int) -> np.ndarray:
        """Return the factors (3, 8) of a step's source, next w and guess."""
        dt, now, was = self.dt, step % 4, (step - 1) % 4
        p, p_past = 4 + step % 2, 4 + (step - 1) % 2
        w, w_past = 6 + step % 2, 6 + (step - 1) % 2
        source, recovery, guess = factors = np.zeros((3, 8))
        if step == 0:
            source[[p, now]] = 1.0, 0.5 / dt
            recovery[[w, now]] = 1.0 - dt * B1 * B2, dt * B1 * C2
        else:
            source[[p, p_past, now]] = 2.0, -1.0, 1.0 / dt
            pull = 2.0 * dt / 3.0 * B1
            recovery[[w, w_past]] = 4.0 / 3.0 - 2.0 * pull * B2, -1.0 / 3.0 + pull * B2
            recovery[[now, was]] = 2.0 * pull * C2, -pull * C2
        for age, factor in enumerate(GUESSES[min(step, self.order)]):
            guess[(step - age) % 4] = factor
        return factors

    @property
    def state(self) -> np.ndarray:
        return self.rows[self.step % 4]

    def advance(self) -> None:
        step, rows = self.step, self.rows
        u, p, w = rows[step % 4], rows[4 + step % 2], rows[6 + step % 2]
        # p = u (1/(2 dt) - C1 A + C1 (1 + A) u - C1 u^2 - w)
        np.multiply(u, -C1, out=p)
        p += C1 * (1.0 + A)
        p *= u
        p -= w
        p += 0.5 / self.dt - C1 * A
        p *= u
        np.matmul(self.factors[step if step < 4 else 4 + step % 4], self.history, out=self.sums)
        self.mass.mult(self.source, self.rhs)
        self.step = step = step + 1
        rows[6 + step % 2][:] = self.sums[1]
        rows[step % 4][:] = self.sums[2]
        solution = self.solutions[step % 4]
        # the array was written behind the vector's back
        solution.stateIncrease()
        self.solvers[min(step, 2) - 1].solve(self.rhs, solution)


def main() -> None:
    """Run the problem of the command line."""
    watch = Stopwatch()
    problem, given = arguments(__doc__, options)
    space = Space(problem)
    code = {"plain": Plain, "tuned": Tuned}[given.style](
        space, given, space.from_vertices(problem.initial)
    )
    activation = Activation(code.state)
    watch.start()
    for step in range(1, steps_of(problem, given.dt) + 1):
        before = code.state
        code.advance()
        activation.see(before, code.state, step * given.dt, given.dt)
    watch.stop()
    lat = space.to_vertices(activation.lat)
    name = "fenicsx" if given.style == "plain" else f"fenicsx_{given.mass}"
    report(given, problem, name, __version__, watch, lat)


if __name__ == "__main__":
    main()
