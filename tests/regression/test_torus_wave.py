"""A wave along the outer equator of an isotropic torus against the curvature of its front."""

from pathlib import Path

import numpy as np
import pytest

from cardiosurf.config import load
from cardiosurf.study.outcome import probe_lats
from cardiosurf.study.simulation import simulate

CONFIG = Path(__file__).parents[2] / "configs" / "torus.yaml"
SPEED = 0.2123  # of the planar pulse
RING, TUBE = 100.0, 50.0


def travel_time(start, end):
    """Time along the outer equator between two distances from the site, in tu.

    A circle of radius s about a point of curvature 1/k^2 has geodesic curvature cot(s/k)/k, and a
    front of curvature kappa runs at SPEED - kappa. The equator is a shortest path up to its first
    conjugate point at pi k, 104 degrees from the site here.
    """
    k = np.sqrt(TUBE * (RING + TUBE))
    s = np.linspace(start, end, 2001)
    return np.trapezoid(1.0 / (SPEED - 1.0 / (k * np.tan(s / k))), s)


@pytest.mark.slow
def test_the_front_on_the_outer_equator_is_as_fast_as_its_curvature_allows(tmp_path):
    overrides = ["mesh.edge_length=4", "time.end=820", "record.frames_every=null"]
    simulate(load(CONFIG, overrides), tmp_path / "run")
    lat = probe_lats(tmp_path / "run")
    found = lat["lat.at 60 deg"] - lat["lat.at 30 deg"]
    theory = travel_time(*((RING + TUBE) * np.radians((30.0, 60.0))))
    assert theory == pytest.approx(374.7, abs=0.1)
    # found at edges 4, 3, 2, 1.5: 377.5, 377.1, 376.3, 376.4; what remains, 0.5 %, is of second
    # order in the curvature; without it theory would give 369.9, 2 % less
    assert found == pytest.approx(theory, rel=0.01)
