import numpy as np
import pytest

from cardiosurf.analysis.planar_speed import curvature_factor, planar_speed
from cardiosurf.kinetics import FitzHughNagumo, RogersMcCulloch


def test_speed_of_the_default_kinetics():
    # 0.2123 from three independent programs (0.21234 at finer edges and steps)
    assert planar_speed(RogersMcCulloch()) == pytest.approx(0.21234, rel=3e-4)


def test_speed_of_the_exact_bistable_front():
    # v stays 0: sqrt(c1/2) (1 - 2a); the step's error is 0.03 %
    exact = np.sqrt(0.26 / 2.0) * (1.0 - 2.0 * 0.13)
    assert planar_speed(RogersMcCulloch(b1=0.0)) == pytest.approx(exact, rel=5e-4)


def test_speed_grows_as_the_root_of_all_rates():
    # ten times as fast in time is sqrt(10) as fast in space
    fast = planar_speed(RogersMcCulloch(b1=0.13, c1=2.6, c2=1.0))
    assert fast == pytest.approx(np.sqrt(10.0) * planar_speed(RogersMcCulloch()), rel=1e-6)


def test_where_there_is_no_wave_the_speed_is_zero():
    assert planar_speed(FitzHughNagumo()) == 0.0


def test_without_recovery_curvature_slows_a_front_by_the_diffusivity():
    assert curvature_factor(RogersMcCulloch(b1=0.0)) == pytest.approx(1.0, abs=1e-9)


def test_curvature_slows_a_pulse_by_more():
    # circles of the model 65 to 85 su from a point: (c0 - c) r = 1.343 and 1.340 at edges of 2 and
    # steps of 0.5, 1.341 and 1.336 at 1.4 and 0.25; at 90 to 110 su 1.335 +- 0.005
    assert curvature_factor(RogersMcCulloch()) == pytest.approx(1.337, abs=0.006)


def test_the_factor_does_not_depend_on_the_units_of_time():
    fast = curvature_factor(RogersMcCulloch(b1=0.13, c1=2.6, c2=1.0))
    assert fast == pytest.approx(curvature_factor(RogersMcCulloch()), rel=1e-5)
