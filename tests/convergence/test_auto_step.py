"""The automatic step keeps the LAT error of a planar wave in its share, and not by much."""

import numpy as np
import pytest
from waves import strip, travel

from cardiosurf.kinetics import FitzHughNagumo, RogersMcCulloch
from cardiosurf.stepping.schemes import SCHEMES
from cardiosurf.stepping.step_rule import ACCURACY, SHARE, auto_step

MESH = strip(120.0, 1.0)
FAR = MESH[0][:, 0] >= 60.0  # where the wave has left its stimulus behind


def far_lat(scheme, kinetics, step):
    return travel(MESH, step, scheme=scheme, kinetics=kinetics).lat[FAR]


def lat_error(name, kinetics, factor, reference):
    scheme = SCHEMES[name]
    step = factor * auto_step(scheme, kinetics).step
    return np.abs(far_lat(scheme, kinetics, step) / reference - 1.0).max()


@pytest.fixture(scope="module")
def reference():
    """LAT at a step whose own error is 0.001 %."""
    return far_lat(SCHEMES["sbdf2"], RogersMcCulloch(), 0.125)


@pytest.mark.parametrize("name", SCHEMES)
def test_auto_step_is_accurate_and_not_needlessly_small(name, reference):
    kinetics = RogersMcCulloch()
    assert lat_error(name, kinetics, 1.0, reference) < SHARE * ACCURACY
    # the rule must hold for the bistable front too, which is 2.5 times as sensitive
    assert lat_error(name, kinetics, 2.5, reference) > SHARE * ACCURACY


@pytest.mark.slow
@pytest.mark.parametrize("name", SCHEMES)
def test_a_quarter_of_the_auto_step_changes_lat_by_less_than_its_share(name):
    kinetics, scheme = RogersMcCulloch(), SCHEMES[name]
    quarter = far_lat(scheme, kinetics, auto_step(scheme, kinetics).step / 4.0)
    assert lat_error(name, kinetics, 1.0, quarter) < SHARE * ACCURACY


@pytest.mark.slow
@pytest.mark.parametrize("name", SCHEMES)
@pytest.mark.parametrize(
    "kinetics",
    [
        RogersMcCulloch(a=0.05),
        RogersMcCulloch(c1=0.5),
        RogersMcCulloch(c2=0.05),
        RogersMcCulloch(c1=1.0, c2=0.2, b1=0.03),
        FitzHughNagumo(c2=0.05),
    ],
    ids=["a=0.05", "c1=0.5", "c2=0.05", "four-times-faster", "fitzhugh_nagumo"],
)
def test_the_rule_holds_for_other_constants(name, kinetics):
    fine = far_lat(SCHEMES["sbdf2"], kinetics, auto_step(SCHEMES["sbdf2"], kinetics).step / 12.0)
    assert lat_error(name, kinetics, 1.0, fine) < SHARE * ACCURACY
