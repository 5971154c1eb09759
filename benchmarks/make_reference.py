"""Compute the converged LAT of every problem at its sample points (minutes to an hour).

    python benchmarks/make_reference.py A B T

Each problem is marched at two edge lengths and at two steps; what they differ by at the sample
points is printed and stored beside the finer one, which is the reference.
"""

import sys
from dataclasses import replace
from time import perf_counter

import numpy as np
from lat_error import REFERENCE, Locator, lat_error
from problems import config_of, initial_u

from cardiosurf.recording.observers import Activation
from cardiosurf.stepping.march import march
from cardiosurf.stepping.rest import never
from cardiosurf.study.setup import set_up

SAMPLES = 2000
# (edge, step) of the reference, of the coarser mesh and of the longer step
RUNS = {
    "A": ((0.5, 0.2), (0.7, 0.2), (0.7, 0.4)),
    "B": ((0.5, 0.2), (0.7, 0.2), (0.7, 0.4)),
    "T": ((0.6, 0.2), (0.85, 0.2), (0.85, 0.4)),
}


def run(problem: str, edge: float, step: float):
    """March a problem; return its surface and its LAT at the vertices."""
    setup = set_up(config_of(problem, edge, f"time.step={step:g}", "time.tolerance=1e-8"))
    start = initial_u(problem, setup.surface.points, setup.surface.triangles)
    pulse = replace(setup.pulses[0], profile=start)
    activation = Activation()
    begun = perf_counter()
    march(replace(setup.problem, pulses=(pulse,)), setup.controls, [activation], stop=never)
    print(f"{problem} {edge=} {step=}: {perf_counter() - begun:.0f} s", flush=True)
    return setup.surface, activation.activations().first(len(setup.surface.points))


def sample(surface) -> np.ndarray:
    """Return points spread evenly over the surface's area, the same at every call."""
    generator = np.random.default_rng(2026)
    area = np.cumsum(surface.areas())
    # one point in each of equal shares of the area, in the order of the triangles
    share = (np.arange(SAMPLES) + generator.random(SAMPLES)) / SAMPLES * area[-1]
    corners = surface.points[surface.triangles[np.searchsorted(area, share)]]
    weights = generator.dirichlet((1.0, 1.0, 1.0), SAMPLES)
    return np.einsum("sc,scd->sd", weights, corners)


def main() -> None:
    """Write the reference of every problem that is named."""
    for problem in sys.argv[1:] or RUNS:
        fine, coarse, slow = RUNS[problem]
        surface, lat = run(problem, *fine)
        at = sample(surface)
        finest = Locator(surface.points, surface.triangles, at)(lat)
        values = [finest]
        for edge, step in (coarse, slow):
            surface, lat = run(problem, edge, step)
            values.append(Locator(surface.points, surface.triangles, at)(lat))
        space, time = lat_error(values[1], finest), lat_error(values[2], values[1])
        print(f"{problem}: edge {coarse[0]} against {fine[0]}: {space}")
        print(f"{problem}: step {slow[1]} against {coarse[1]}: {time}", flush=True)
        np.savez_compressed(
            REFERENCE / f"{problem}.npz",
            points=at,
            lat=finest.astype(np.float32),
            run=np.array(fine),
            coarser=np.array([*coarse, space.rms, space.largest]),
            slower=np.array([*slow, time.rms, time.largest]),
        )


if __name__ == "__main__":
    main()
