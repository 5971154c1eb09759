"""TorchCor on the CPU: its own monodomain solver as shipped, with these kinetics as a model of its.

TorchCor solves  Cm M u' = -K u / Chi + M f / 100  with Cm = 0.01 and Chi = 140, so that a
conductivity of 1.4 d makes it ours. Diffusion is Crank-Nicolson, the reaction forward Euler,
conjugate gradients with Jacobi start from the linear extrapolation; tolerances are those of its
README. Its activation map interpolates between snapshots, whose spacing is its user's choice.
"""

import contextlib
import io
import tempfile
from importlib.metadata import version
from pathlib import Path

import numpy as np
import torch
from common import B1, B2, C1, C2, THRESHOLD, A, Stopwatch, arguments, report

torch.set_num_threads(1)
with contextlib.redirect_stdout(io.StringIO()):
    from torchcor.simulator import Monodomain

CONDUCTIVITY = 1.4


def options(parser) -> None:
    parser.add_argument("--lumped", action="store_true", help="its option mass_lumping")
    parser.add_argument("--tolerance", type=float, default=1e-5, help="a_tol and r_tol")
    parser.add_argument("--every", type=float, default=8.0, help="tu between snapshots, at most")
    parser.add_argument("--compile", action="store_true", help="the kinetics by torch.compile")


class RogersMcCulloch:
    """The kinetics with the interface of TorchCor's models: v by forward Euler inside."""

    def __init__(self, dt: float, initial: np.ndarray, watch: Stopwatch, *, compiled: bool) -> None:
        self.dt, self.region_ids, self.node_indices = dt, None, None
        self.device, self.dtype = torch.device("cpu"), torch.float64
        self._initial, self._watch = torch.from_numpy(initial), watch
        self._rates = torch.compile(self._eager) if compiled else self._eager
        self.v = torch.zeros(len(initial), dtype=torch.float64)

    def initialize(self, n_nodes: int) -> torch.Tensor:
        """Return the initial u. TorchCor asks for it when all is assembled: its loop begins."""
        self._rates(self._initial, self.v)
        self._watch.start()
        return self._initial

    def _eager(self, u: torch.Tensor, v: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        rate = u * (C1 * (u - A) * (1.0 - u) - C2 * v)
        return rate, v + (B1 * self.dt) * (u - B2 * v)

    def differentiate(self, u: torch.Tensor) -> torch.Tensor:
        rate, self.v = self._rates(u, self.v)
        return rate


def principal(tensor: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the larger and the smaller tangential diffusivity (m, 2), and the fibre (m, 3)."""
    values, vectors = np.linalg.eigh(tensor)
    # ascending, and the first belongs to the normal: d has no part along it
    return values[:, [2, 1]], vectors[:, :, 2]


def write_mesh(problem, folder: Path) -> np.ndarray:
    """Write the mesh as TorchCor reads it; return the diffusivities of its regions, (r, 2)."""
    along, fibre = principal(problem.tensor)
    kinds, region = np.unique(np.round(along, 9), axis=0, return_inverse=True)
    region = region.ravel()
    np.savetxt(folder / "m.pts", problem.points, header=str(len(problem.points)), comments="")
    rows = [f"Tr {a} {b} {c} {r}" for (a, b, c), r in zip(problem.triangles, region, strict=True)]
    (folder / "m.elem").write_text("\n".join([str(len(rows)), *rows]) + "\n")
    np.savetxt(folder / "m.lon", fibre, header="1", comments="")
    return kinds


def spacing(dt: float, most: float) -> float:
    """Return the time between snapshots: whole steps, and a bit more so that int() finds them."""
    return max(1, int(most / dt + 1e-9)) * dt


def main() -> None:
    """Run the problem of the command line."""
    watch = Stopwatch()
    problem, given = arguments(__doc__, options)
    model = RogersMcCulloch(given.dt, problem.initial, watch, compiled=given.compile)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        kinds = write_mesh(problem, folder)
        # nt = int(T / dt) drops a step to rounding
        code = Monodomain(
            [model], T=problem.end + 0.01 * given.dt, dt=given.dt, mass_lumping=given.lumped
        )
        code.load_mesh(folder, unit_conversion=1)
        for number, (along, across) in enumerate(kinds):
            code.add_conductivity([number], il=CONDUCTIVITY * along, it=CONDUCTIVITY * across)
        every = spacing(given.dt, given.every)
        voltages = code.solve(
            a_tol=given.tolerance,
            r_tol=given.tolerance,
            max_iter=1000,
            # its int(interval / dt) drops a step to rounding as well
            snapshot_interval=every * (1.0 + 1e-9),
            verbose=False,
            result_path=name,
        )
        lat = code.compute_activation_map(
            voltages, snapshot_interval=every, threshold=THRESHOLD, interpolate=True
        )
        watch.stop()
    lat = lat.numpy()
    lat[problem.initial > THRESHOLD] = 0.0
    label = "torchcor_lumped" if given.lumped else "torchcor"
    report(given, problem, label, version("torchcor"), watch, lat, snapshot_every=every)


if __name__ == "__main__":
    main()
