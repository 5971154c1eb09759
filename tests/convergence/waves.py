"""Small meshes and planar waves that the convergence tests share."""

from dataclasses import dataclass, field

import numpy as np

from cardiosurf.fem.operators import assemble
from cardiosurf.kinetics import RogersMcCulloch
from cardiosurf.stepping.march import Controls, Problem, march
from cardiosurf.stepping.rest import at_rest
from cardiosurf.stepping.schemes import SCHEMES
from cardiosurf.stepping.solvers import choose_solver
from cardiosurf.stepping.step_rule import StepChoice


@dataclass(frozen=True)
class Pulse:
    profile: np.ndarray
    time: float = 0.0
    duration: float = 0.0
    label: str = "test"


@dataclass
class Crossings:
    """First upward and first downward crossing of u = 0.5 at every node."""

    lat: np.ndarray = field(default_factory=lambda: np.empty(0))
    end: np.ndarray = field(default_factory=lambda: np.empty(0))

    def initialize(self, moment):
        self.lat = np.full(moment.state.shape[1], np.nan)
        self.end = self.lat.copy()

    def handle(self, moment):
        before, after = moment.previous_state[0] - 0.5, moment.state[0] - 0.5
        for times, crossed in (
            (self.lat, (before < 0) & (after >= 0)),
            (self.end, (before >= 0) & (after < 0)),
        ):
            new = crossed & np.isnan(times)
            part = before[new] / (before[new] - after[new])
            times[new] = moment.previous_time + part * (moment.time - moment.previous_time)

    def finalize(self, moment):
        pass


ROGERS_MCCULLOCH = RogersMcCulloch()


def strip(length, edge, rows=1):
    """A flat strip of right triangles with legs ``edge``, along x."""
    nx = round(length / edge) + 1
    i, j = (index.ravel() for index in np.meshgrid(range(nx), range(rows + 1), indexing="ij"))
    points = edge * np.column_stack((i, j, 0 * i)).astype(float)
    corner = (i * (rows + 1) + j)[(i < nx - 1) & (j < rows)]
    across = corner + rows + 1
    lower = np.column_stack((corner, across, across + 1))
    upper = np.column_stack((corner, across + 1, corner + 1))
    return points, np.vstack((lower, upper))


def operators(points, triangles, diffusivity=1.0, mass="blended"):
    tensor = np.broadcast_to(diffusivity * np.eye(3), (len(triangles), 3, 3))
    return assemble(points, triangles, tensor, np.ones(len(triangles), bool), mass=mass)


def controls(step, end, *, scheme=SCHEMES["sbdf2"], solver="direct"):
    return Controls(scheme, StepChoice(step, "test"), end, choose_solver(1, wanted=solver))


def wall_wave(x):
    """The plane stimulus of the paper: u = 1/(1 + exp((x - 4)/0.1))."""
    return 1.0 / (1.0 + np.exp(np.clip((x - 4.0) / 0.1, -500.0, 500.0)))


def travel(
    mesh,
    step,
    *,
    scheme=SCHEMES["sbdf2"],
    kinetics=ROGERS_MCCULLOCH,
    mass="blended",
    diffusivity=1.0,
    stop=None,
    initial=None,
    end=3000.0,
):
    """LAT and repolarisation times of a wave from the left wall, until it has met the right one."""
    points, triangles = mesh
    crossings = Crossings()
    problem = Problem(
        operators(points, triangles, diffusivity, mass),
        kinetics,
        (Pulse(wall_wave(points[:, 0])),) if initial is None else (),
        initial,
    )

    def arrived(moment):
        return bool(moment.state[0, -1] > 0.6) or at_rest(moment)

    march(problem, controls(step, end, scheme=scheme), (crossings,), stop=stop or arrived)
    return crossings


def speed(mesh, crossings, begin, end):
    """Slope of x over LAT between x = begin and x = end."""
    x = mesh[0][:, 0]
    inside = (x >= begin - 1e-9) & (x <= end + 1e-9)
    return 1.0 / np.polyfit(x[inside], crossings.lat[inside], 1)[0]


def icosphere(level):
    """Unit sphere: an icosahedron divided ``level`` times."""
    g = (1.0 + 5.0**0.5) / 2.0
    ring = [(0.0, s, t * g) for s in (-1, 1) for t in (-1, 1)]
    points = np.array([np.roll(p, k) for k in range(3) for p in ring])
    distance = np.linalg.norm(points[:, None] - points, axis=2)
    near = np.abs(distance - 2.0) < 1e-9
    triangles = np.array(
        [
            (a, b, c) if np.linalg.det(points[[a, b, c]]) > 0 else (a, c, b)
            for a in range(12)
            for b in range(a)
            for c in range(b)
            if near[a, b] and near[b, c] and near[a, c]
        ]
    )
    for _ in range(level):
        sides = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        edges, where = np.unique(sides, axis=0, return_inverse=True)
        a, b, c = triangles.T
        ab, bc, ca = where.reshape(-1, 3).T + len(points)
        points = np.vstack((points, points[edges].mean(axis=1)))
        triangles = np.column_stack((a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca)).reshape(-1, 3)
    return points / np.linalg.norm(points, axis=1)[:, None], triangles
