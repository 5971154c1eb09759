"""The three problems every code solves, and the meshes they solve them on.

    python benchmarks/problems.py A 3.0 problem.npz

A file holds ``points`` (n, 3), ``triangles`` (m, 3), ``tensor`` (m, 3, 3), ``initial`` (n,) and
``end``, beside ``problem`` and ``edge``: all a finite-element code needs. Lengths in su, times in
tu.

The initial u has steep edges (a jump of 0.6 at r = 10, or 0.1 su wide). Taken at the vertices alone
it is larger or smaller by up to half an edge, by chance; LAT then shifts by 0.2 % even at an edge
of 0.7, and codes would be compared by their luck. So ``initial`` is the mean of the profile over
each vertex's hat function, which keeps its integral on every mesh.
"""

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import reverse_cuthill_mckee
from scipy.special import expit

from cardiosurf.config import load
from cardiosurf.config.sections import Config
from cardiosurf.study.setup import set_up

ROOT = Path(__file__).resolve().parent.parent


SUBDIVISION = 32  # pieces that an edge is cut into to average the profile


def wall(x: np.ndarray) -> np.ndarray:
    """Return the author's plane wave from the wall x = 100."""
    return expit((4.0 - (100.0 - x[..., 0])) / 0.1)


def disc(*centre: float) -> Callable[[np.ndarray], np.ndarray]:
    """Return the author's point stimulus about a centre."""

    def profile(x: np.ndarray) -> np.ndarray:
        r = np.linalg.norm(x - np.array(centre), axis=-1)
        return np.where(r < 10.0, np.exp(-(r**2) / 200.0), 0.0)

    return profile


@dataclass(frozen=True)
class Problem:
    """A shipped config, what is changed in it, its initial u, and how far it is marched (tu)."""

    title: str
    config: str
    overrides: tuple[str, ...]
    profile: Callable[[np.ndarray], np.ndarray]
    end: float


PROBLEMS = {
    "A": Problem(
        "plane with a block, d_xx = 4",
        "plane_block.yaml",
        ("tissue.patches.0.anisotropy.x=4",),
        wall,
        900.0,
    ),
    "B": Problem(
        "sphere, d = 1",
        "sphere_block.yaml",
        ("tissue.patches=[]", "targets=[]"),
        disc(0.0, 0.0, 50.0),
        800.0,
    ),
    "T": Problem("T-domain, anisotropy 8", "t_domain.yaml", (), disc(0.0, 100.0, 0.0), 1100.0),
}


def config_of(name: str, edge: float, *more: str) -> Config:
    """Return the decoded config of a problem at an edge length in su."""
    problem = PROBLEMS[name]
    options = (f"mesh.edge_length={edge:g}", f"time.end={problem.end:g}", *problem.overrides, *more)
    return load(ROOT / "configs" / problem.config, options).config


def initial_u(name: str, points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Return the mean of a problem's initial u over each vertex's hat function."""
    corners = points[triangles]
    profile = PROBLEMS[name].profile
    areas = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    weights = _quadrature()
    total = np.zeros(len(points))
    # a triangle whose corners and whose neighbours' corners see nothing has nothing
    near = _near(profile, points, triangles)
    for first in range(0, len(near), 4096):
        part = near[first : first + 4096]
        values = profile(np.einsum("qc,tcd->tqd", weights, corners[part]))
        shares = areas[part, None] * (values @ weights) / len(weights)
        np.add.at(total, triangles[part], shares)
    hats = np.bincount(triangles.ravel(), np.repeat(areas / 3.0, 3), len(points))
    return total / hats


def _near(profile, points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Return the triangles within one ring of a vertex where the profile is felt."""
    felt = profile(points) > 1e-12
    ring = np.zeros_like(felt)
    ring[triangles[felt[triangles].any(axis=1)]] = True
    return np.flatnonzero(ring[triangles].any(axis=1))


def _quadrature() -> np.ndarray:
    """Return the barycentres of the pieces of a triangle whose edges are cut evenly."""
    n = SUBDIVISION
    up = [(i + 1 / 3, j + 1 / 3) for i in range(n) for j in range(n - i)]
    down = [(i + 2 / 3, j + 2 / 3) for i in range(n - 1) for j in range(n - 1 - i)]
    pairs = np.array(up + down) / n
    return np.column_stack((1.0 - pairs.sum(axis=1), pairs))


def write_problem(name: str, edge: float, path: Path) -> None:
    """Mesh a problem and write it for the peers, which cannot import cardiosurf."""
    setup = set_up(config_of(name, edge))
    if not setup.tissue.excitable.all():
        raise ValueError("the peers react everywhere")
    points, triangles = setup.surface.points, setup.surface.triangles
    order = banded(triangles, len(points))
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    np.savez(
        path,
        problem=name,
        edge=edge,
        end=PROBLEMS[name].end,
        points=points[order],
        triangles=place[triangles],
        tensor=setup.tissue.tensor,
        initial=initial_u(name, points, triangles)[order],
    )


def banded(triangles: np.ndarray, count: int) -> np.ndarray:
    """Return the vertices in an order of small bandwidth: codes that keep it gain up to a third."""
    ends = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    graph = coo_array((np.ones(len(ends)), ends.T), shape=(count, count)).tocsr()
    return reverse_cuthill_mckee((graph + graph.T).tocsr(), symmetric_mode=True).astype(np.int64)


def main() -> None:
    """Write the file that is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("problem", choices=PROBLEMS)
    parser.add_argument("edge", type=float)
    parser.add_argument("out", type=Path)
    given = parser.parse_args()
    write_problem(given.problem, given.edge, given.out)


if __name__ == "__main__":
    main()
