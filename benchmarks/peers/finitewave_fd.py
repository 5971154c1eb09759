"""Finitewave: explicit finite differences on a square grid, so the plane (problem A) alone.

Cells of its grid are squares whose edges fall on the walls and on the block's edge; it uses forward
Euler throughout. The kinetics are plugged in as its own models are: functions that it compiles.
LAT is found by one of its observers, a line inside its compiled loop; its ActivationTimeTracker
would give whole steps and cost more.
"""

import os
import sys

os.environ["NUMBA_NUM_THREADS"] = "1"

from importlib.metadata import version
from types import SimpleNamespace

import finitewave
import numpy as np
from common import B1, B2, C1, C2, THRESHOLD, A, Stopwatch, arguments, report, steps_of
from finitewave.core.model.ionic_kernel_generator import IonicKernelGenerator
from finitewave.cpuwave.model._kernel_builder import build_kernel
from finitewave.cpuwave.model._registry import wrap_calc

HALF, BLOCK = 100.0, 50.0
D_BLOCK, D_ACROSS = 4.0, 1.0
CROSSING = (
    "if lat[i_, j_] < 0.0 and u_new[i_, j_] > 0.5: "
    "lat[i_, j_] = dt * (step + (0.5 - u[i_, j_]) / (u_new[i_, j_] - u[i_, j_]))"
)


def calc_rhs(u, v, a, c1, c2):
    """Return the reaction of u."""
    return u * (c1 * (u - a) * (1.0 - u) - c2 * v)


def calc_dv(u, v, b1, b2):
    """Return the rate of v."""
    return b1 * (u - b2 * v)


OPERATIONS = SimpleNamespace(
    get_variables=lambda: {"u": 0.0, "v": 0.0},
    get_parameters=lambda: {"a": A, "b1": B1, "b2": B2, "c1": C1, "c2": C2},
    calc_rhs=calc_rhs,
    calc_dv=calc_dv,
)


class Kernel(IonicKernelGenerator):
    """The body of Finitewave's compiled loop over the cells."""

    def __init__(self) -> None:
        super().__init__()
        self.args_order = ["u", "v", "a", "b1", "b2", "c1", "c2"]

    def generate_body(self) -> str:
        """Return the forward Euler step of a cell; u_new holds the diffused u."""
        return """
        before, recovery = u[i_, j_], v[i_, j_]
        u_new[i_, j_] += dt * calc_rhs(before, recovery, a, c1, c2)
        v[i_, j_] = recovery + dt * calc_dv(before, recovery, b1, b2)
"""


class RogersMcCulloch(finitewave.CardiacModel):
    """The kinetics as a model of Finitewave's."""

    def __init__(self) -> None:
        super().__init__()
        self.prog_bar = False
        # its warning takes the diffusivity for 1 in all directions
        self.D_model = 1.0
        self._initialize_variables_and_parameters(OPERATIONS)

    def initialize(self) -> None:
        """Make the grid's arrays and compile the loop."""
        super().initialize()
        functions = wrap_calc(OPERATIONS)
        self.observers = [{"name": "lat", "expr": CROSSING}]
        self._kernel, _ = build_kernel(
            gen=self._initialize_kernel(Kernel),
            glb=functions,
            dimensions=2,
            observers=self.observers,
        )
        self._buffs = self._form_and_verify_observers()

    def run_ionic_kernel(self) -> None:
        """Do the reaction of one step."""
        self._kernel(
            self.u_new,
            self.cardiac_tissue.myo_indexes,
            self.dt,
            self.step,
            *(getattr(self, name) for name in self._kernel_args_order),
            *self._buffs,
        )

    def select_stencil(self, cardiac_tissue):
        """Return Finitewave's stencil for fibres."""
        stencil = finitewave.AsymmetricStencil2D()
        stencil.D_al, stencil.D_ac = D_BLOCK, D_ACROSS
        return stencil


def grid(edge: float) -> np.ndarray:
    """Return the centres of the cells along one axis; the block's edge falls between two."""
    count = 4 * round(HALF / 2.0 / edge)
    return (np.arange(count) + 0.5) * (2.0 * HALF / count) - HALF


def mean_initial(x: np.ndarray) -> np.ndarray:
    """Return the mean over each cell of 1/(1 + exp((s - 4)/0.1)), s = 100 - x."""
    half = 0.5 * (x[1] - x[0])
    s = HALF - x

    def integral(at: np.ndarray) -> np.ndarray:
        return at - 0.1 * np.logaddexp(0.0, (at - 4.0) / 0.1)

    return (integral(s + half) - integral(s - half)) / (2.0 * half)


def model_of(x: np.ndarray, dt: float) -> RogersMcCulloch:
    """Return the model of problem A. Finitewave wants a ring of cells that are no tissue."""
    count = len(x)
    tissue = finitewave.CardiacTissue((count + 2, count + 2))
    inside = np.zeros(count + 2, dtype=bool)
    inside[1:-1] = np.abs(x) < BLOCK
    # fibres along x in the block; none elsewhere leaves the diffusivity across in all directions
    tissue.fibers = np.zeros((count + 2, count + 2, 2))
    tissue.fibers[(*np.ix_(inside, inside), 0)] = 1.0
    model = RogersMcCulloch()
    model.cardiac_tissue = tissue
    model.dt, model.dr = dt, x[1] - x[0]
    model.init_u = np.zeros((count + 2, count + 2))
    model.init_u[1:-1, 1:-1] = mean_initial(x)[:, None]
    return model


def lat_mesh(x: np.ndarray, lat: np.ndarray):
    """Return points, triangles and LAT up to the walls, which lie half a cell beyond the centres.

    LAT goes on linearly from the last two cells.
    """
    for axis in (0, 1):
        lat = np.moveaxis(lat, axis, 0)
        low, high = 1.5 * lat[0] - 0.5 * lat[1], 1.5 * lat[-1] - 0.5 * lat[-2]
        lat = np.moveaxis(np.concatenate((low[None], lat, high[None])), 0, axis)
    x = np.concatenate(([-HALF], x, [HALF]))
    n = len(x)
    points = np.zeros((n, n, 3))
    points[..., 0], points[..., 1] = x[:, None], x
    number = np.arange(n * n).reshape(n, n)
    a, b, c, d = (
        p.ravel() for p in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    )
    triangles = np.concatenate((np.stack((a, b, c), 1), np.stack((a, c, d), 1)))
    return points.reshape(-1, 3), triangles, lat.ravel()


def main() -> None:
    """Run the problem of the command line."""
    watch = Stopwatch()
    problem, given = arguments(__doc__)
    if problem.problem != "A":
        sys.exit("Finitewave's grids are flat")
    x = grid(problem.edge)
    model = model_of(x, given.dt)
    steps = steps_of(problem, given.dt)
    start = model.init_u.copy()
    # two steps compile all there is to compile
    for end in (2.0 * given.dt, (steps - 0.5) * given.dt):
        model.init_u, model.lat = start.copy(), np.where(start > THRESHOLD, 0.0, -1.0)
        model.t_max = end
        model.initialize()
        watch.start()
        model.run(initialize=False, num_of_threads=1)
        watch.stop()
    lat = np.where(model.lat < 0.0, np.nan, model.lat)[1:-1, 1:-1]
    *mesh, lat = lat_mesh(x, lat)
    own = {"nodes": len(x) ** 2, "spacing": x[1] - x[0]}
    report(given, problem, "finitewave", version("finitewave"), watch, lat, mesh=tuple(mesh), **own)


if __name__ == "__main__":
    main()
