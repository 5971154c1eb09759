"""Exact arrival times, and how well the relative acceleration is measured on them.

``python tests/convergence/acceleration_cases.py`` prints the table of docs/theory.md.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "unit"))

from arrival_samples import RADIUS, conductor, fibonacci_sphere, square

from cardiosurf.analysis.measured_acceleration import measured_acceleration

BORDER = 6.0
"""Edges from an open edge within which pairs have no full window."""


@dataclass(frozen=True)
class Case:
    """Arrival times on a mesh, the true relative acceleration, and the vertices to look at."""

    name: str
    tissue: object
    times: np.ndarray
    truth: float
    seen: np.ndarray


def on_plane(name, step, tensor=None, *, beyond):
    points, triangles = square(step)
    inverse = np.eye(3) if tensor is None else np.diag(1.0 / np.diag(tensor))
    times = np.sqrt(np.einsum("ni,ij,nj->n", points, inverse, points))
    inside = np.abs(points[:, :2]).max(axis=1) < 50.0 - BORDER * step
    return Case(name, conductor(points, triangles, tensor), times, 0.0, inside & (times > beyond))


def on_sphere(name, count):
    points, triangles = fibonacci_sphere(count)
    arc = RADIUS * np.arccos(np.clip(points[:, 2] / RADIUS, -1.0, 1.0))
    seen = (arc > 25.0) & (arc < 130.0)
    return Case(name, conductor(points, triangles), arc, -1.0 / RADIUS**2, seen)


def cases():
    yield on_plane("circles on the plane, edges 2", 2.0, beyond=20.0)
    yield on_plane("circles on the plane, edges 1", 1.0, beyond=20.0)
    yield on_plane("ellipses, ratio 4, edges 2", 2.0, np.diag([4.0, 1.0, 1.0]), beyond=10.0)
    yield on_sphere("circles on the sphere, edges 2.1", 8000)
    yield on_sphere("circles on the sphere, edges 1.1", 32000)


def row(case):
    """The case's row of the table: what is off, what is stated, how often it is within two."""
    found = measured_acceleration(case.tissue, case.times)
    cells = [case.name, f"{1e5 * case.truth:.2g}"]
    for way in (found, found.by_lat):
        known = case.seen & np.isfinite(way.relative)
        off, error = way.relative[known] - case.truth, way.relative_error[known]
        within = np.mean(np.abs(off) < 2.0 * error)
        cells += [f"{1e5 * np.sqrt(np.mean(off**2)):.3g}", f"{1e5 * np.median(error):.3g}"]
        cells.append(f"{within:.1%}")
    both = case.seen & np.isfinite(found.relative) & np.isfinite(found.by_lat.relative)
    apart = np.abs(found.relative - found.by_lat.relative)[both]
    errors = np.hypot(found.relative_error, found.by_lat.relative_error)[both]
    return [*cells, f"{np.mean(apart < 2.0 * errors):.1%}"]


if __name__ == "__main__":
    for each in cases():
        sys.stdout.write(f"| {' | '.join(row(each))} |\n")
