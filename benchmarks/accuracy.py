"""Measure what the automatic mesh and step achieve: LAT against converged runs, config by config.

    python benchmarks/accuracy.py [--accuracies 0.01 0.005] [--configs t_domain ...]

Every shipped config runs with ``mesh.edge_length: auto`` and ``time.step: auto`` and is compared
with a run on edges 2.5 times and steps 6 times as short. Errors are relative, at the vertices of
the automatic mesh whose LAT is at least 20 tu: the root of the mean square over that of the
converged LAT. Writes benchmarks/results/accuracy.json.
"""

import argparse
from dataclasses import replace
from pathlib import Path
from time import perf_counter

import numpy as np
from lat_error import Locator, lat_error
from results import write

from cardiosurf.config import load
from cardiosurf.recording.observers import Activation
from cardiosurf.stepping.march import march
from cardiosurf.stepping.step_rule import StepChoice
from cardiosurf.study.setup import Setup, set_up

CONFIGS = Path(__file__).resolve().parent.parent / "configs"
FINER, SHORTER = 2.5, 6.0


def lat_of(setup: Setup) -> tuple[np.ndarray, float]:
    """Return the first activation of every vertex, and the seconds of the march."""
    activation = Activation()
    begun = perf_counter()
    march(setup.problem, setup.controls, [activation])
    seconds = perf_counter() - begun
    return activation.activations().first(len(setup.surface.points)), seconds


def converged(config: Path, auto: Setup) -> tuple[Setup, np.ndarray]:
    """Return a run of the config that is finer than the automatic one in space and time."""
    edge = auto.edge.edge_length / FINER
    fine = set_up(load(config, (f"mesh.edge_length={edge:g}",)).config)
    step = StepChoice(auto.controls.step.step / SHORTER, "converged")
    fine = replace(fine, controls=replace(fine.controls, step=step))
    return fine, lat_of(fine)[0]


def measure(config: Path, accuracies: list[float]) -> list[dict]:
    """Return a row for each accuracy; the tightest one's converged run serves them all."""
    options = ("mesh.edge_length=auto", "time.step=auto")
    setups = {a: set_up(load(config, (*options, f"accuracy={a:g}")).config) for a in accuracies}
    fine, reference = converged(config, setups[min(accuracies)])
    rows = []
    for accuracy, setup in setups.items():
        lat, seconds = lat_of(setup)
        at = setup.surface.points
        error = lat_error(lat, Locator(fine.surface.points, fine.surface.triangles, at)(reference))
        rows.append(
            {
                "config": config.stem,
                "accuracy": accuracy,
                "edge": setup.edge.edge_length,
                "step": setup.controls.step.step,
                "vertices": len(at),
                "expected": setup.edge.lat_error + setup.controls.step.lat_error,
                "error": error.rms,
                "disagree": error.disagree,
                "march_seconds": seconds,
                "kept": error.rms < accuracy,
            }
        )
        print(f"{config.stem:20} {accuracy:.2%}: {error.rms:.3%}, edge {rows[-1]['edge']:g}")
    return rows


def main() -> None:
    """Measure all configs and say whether any misses its target."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--accuracies", type=float, nargs="+", default=[0.01, 0.005])
    parser.add_argument("--configs", nargs="+")
    given = parser.parse_args()
    files = sorted(CONFIGS.glob("*.yaml"))
    chosen = [file for file in files if not given.configs or file.stem in given.configs]
    rows = [row for file in chosen for row in measure(file, given.accuracies)]
    write("accuracy", {"finer": FINER, "shorter": SHORTER, "rows": rows})
    missed = [f"{row['config']} at {row['accuracy']:.2%}" for row in rows if not row["kept"]]
    print("all below their accuracy" if not missed else f"missed: {', '.join(missed)}")


if __name__ == "__main__":
    main()
