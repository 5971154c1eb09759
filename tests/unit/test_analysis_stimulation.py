"""Which stimuli captured, and where their waves would go, on a square of right angles."""

import numpy as np
import pytest
from recording_samples import square_surface

from cardiosurf.analysis.capture import is_far_out
from cardiosurf.analysis.sources import Sources
from cardiosurf.analysis.stimulation import Stimulation

SURFACE = square_surface(30, 60.0)


@pytest.mark.parametrize(("front", "far"), [(19.0, False), (21.0, True)])
def test_a_wave_is_far_out_once_it_is_20_su_from_the_box_about_its_source(front, far):
    x = SURFACE.points[:, 0]
    assert is_far_out(SURFACE.points, x <= 10.0 + front, x <= 10.0) is far


def test_nothing_is_far_from_a_source_that_surrounds_it():
    # 30 su from every side: only the way through the tissue tells
    source = (np.abs(SURFACE.points[:, :2] - 30.0) == 30.0).any(axis=1)
    assert not is_far_out(SURFACE.points, np.ones(len(source), dtype=bool), source)
    assert not is_far_out(SURFACE.points, source, np.zeros(len(source), dtype=bool))


def test_of_two_waves_the_earlier_counts_everywhere():
    # straight fronts from both sides, the right one 20 su later: first order is exact for them
    x = SURFACE.points[:, 0]
    left, right = np.flatnonzero(x == 0.0), np.flatnonzero(x == 60.0)
    starts = Sources.at(np.r_[left, right], np.r_[np.zeros(31), np.full(31, 20.0)])
    found = Stimulation((True, True), SURFACE.points, SURFACE.triangles, starts).unperturbed()
    np.testing.assert_allclose(found, np.minimum(x, 80.0 - x), atol=1e-9)
