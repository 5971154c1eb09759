"""The eikonal equations against waves of the model (docs/theory.md has the table)."""

import numpy as np
import pytest
from eikonal_cases import CASES, KINETICS, Case, compare, simulated

from cardiosurf.analysis.planar_speed import curvature_factor, planar_speed
from cardiosurf.geometry import Plane
from cardiosurf.tissue.stimuli import PointStimulus

SMOOTH = {"sphere, point", "torus, point", "torus, point, phi 4 everywhere"}
"""Cases whose tissue does not jump, on surfaces without walls."""


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_curvature_explains_most_of_what_the_eikonal_equation_misses(case):
    found = compare(case, 2.0)
    assert found.reached == 1.0
    # a straight front's speed is an upper bound for one that diverges: too early on the whole
    assert found.mean[0] < 0.0
    assert found.rms[0] < 0.08 * found.last
    # what is left of that with c = c0 - d K: measured 0.2 to 0.5, 0.3 to 1.9 % of the latest LAT
    assert found.rms[1] < 0.55 * found.rms[0]
    assert found.rms[1] < 0.022 * found.last
    if case.name in SMOOTH:
        # with the coefficient of a pulse a third to two thirds of that, 0.3 to 0.5 % of the LAT
        assert found.rms[2] < 0.75 * found.rms[1]
        assert found.rms[2] < 0.007 * found.last


@pytest.mark.slow
def test_curvature_slows_a_pulse_as_its_recovery_says():
    # a quarter of a circle about a corner, seen before it meets the far walls
    case = Case(
        "corner", Plane(x=(0.0, 110.0), y=(0.0, 110.0)), PointStimulus(centre=(0.0, 0.0, 0.0))
    )
    surface, _, _, lat = simulated(case, 2.0)
    r = np.linalg.norm(surface.points, axis=1)
    ring = (r > 65.0) & (r < 85.0)
    speed = 1.0 / np.polyfit(r[ring], lat[ring], 1)[0]
    factor = (planar_speed(KINETICS) - speed) * r[ring].mean()
    # measured 1.341; what is of second order in K fades from 1.37 at 30 su to 1.335 at 100
    assert factor == pytest.approx(curvature_factor(KINETICS), rel=0.015)
