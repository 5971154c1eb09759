"""Measures of a front before an entrance, on profiles whose numbers are plain."""

import numpy as np
import pytest

from cardiosurf.report.front_measures import MEASURES, rank_correlation

# a front that meets 20 su at 0, 10, ..., 50 degrees, later and more curved from place to place
PIECE = {
    "position": [2.0, 5.0, 8.0, 11.0, 14.0, 17.0],
    "angle": np.radians([0.0, 10.0, 20.0, 30.0, 40.0, 50.0]).tolist(),
    "curvature": [0.01, 0.02, 0.03, 0.04, 0.05, 0.06],
    "lat": [100.0, 115.0, 130.0, 145.0, 160.0, 175.0],
    "length": 20.0,
}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        # each place stands for the way half to its neighbours, the first from 0 on: 3.5 and 3 su
        ("length met within 5 deg", 3.5),
        ("length met within 15 deg", 6.5),
        ("length met within 45 deg", 15.5),
        ("mean abs(angle)", np.radians(25.0)),
        ("abs(angle) where met first", 0.0),
        ("mean curvature", 0.035),
        ("median curvature", 0.035),
        ("curvature where met first", 0.01),
        ("mean curvature within 15 deg", 0.015),
        # 5 tu a su, of which the grid of 401 places misses at most one
        ("length met within 15 tu", 3.0),
        ("length met within 45 tu", 9.0),
        ("spread of arrival", 75.0),
    ],
)
def test_measures(name, value):
    assert MEASURES[name](PIECE) == pytest.approx(value, abs=0.06)


def test_a_front_that_meets_nothing_head_on_has_no_curvature_there():
    piece = PIECE | {"angle": [1.0] * 6}
    assert np.isnan(MEASURES["mean curvature within 15 deg"](piece))


def test_rank_correlation():
    # Spearman's rho of five pairs with squared rank differences 1, 1, 0, 1, 1: 1 - 6 * 4 / 120
    assert rank_correlation([1, 2, 3, 4, 5], [20, 10, 30, 50, 40]) == pytest.approx(0.8)
    assert rank_correlation([1, 2, 3], [9, 4, 1]) == pytest.approx(-1.0)
    # equal values share their ranks: 1, 2.5, 2.5, 4 against 1, 2, 3, 4
    assert rank_correlation([1, 5, 5, 9], [1, 2, 3, 4]) == pytest.approx(4.5 / np.sqrt(4.5 * 5.0))
    assert np.isnan(rank_correlation([1, 1, 1], [1, 2, 3]))
    assert np.isnan(rank_correlation([1, np.nan, 2], [1, 2, 3]))
