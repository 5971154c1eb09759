"""Areas under ROC curves against known answers."""

import numpy as np
import pytest

from cardiosurf.analysis.roc import auc, permuted, roc
from cardiosurf.errors import InputError


def test_a_score_that_parts_the_cases_has_area_one_and_its_opposite_none():
    score, positive = np.arange(6.0), np.arange(6) > 2
    assert auc(score, positive) == 1.0
    assert auc(-score, positive) == 0.0


def test_ties_count_half():
    assert auc(np.ones(4), np.array([True, False, True, False])) == 0.5
    # 1 beats 0 and ties with 1, 2 beats both: (1.5 + 2) of 4 pairs
    score = np.array([1.0, 2.0, 0.0, 1.0])
    assert auc(score, np.array([True, True, False, False])) == 0.875


def test_the_area_is_the_share_of_pairs_in_order():
    random = np.random.default_rng(3)
    score, positive = random.integers(0, 9, 40).astype(float), random.random(40) < 0.4
    above = score[positive][:, None] - score[~positive][None, :]
    pairs = np.where(above > 0, 1.0, np.where(above == 0, 0.5, 0.0)).mean()
    assert auc(score, positive) == pytest.approx(pairs, abs=1e-12)


def test_the_curve_bounds_its_area():
    random = np.random.default_rng(5)
    score, positive = random.integers(0, 9, 60).astype(float), random.random(60) < 0.4
    curve = roc(score, positive, np.arange(60))
    assert (curve.false[0], curve.true[0]) == (0.0, 0.0)
    assert (curve.false[-1], curve.true[-1]) == (1.0, 1.0)
    assert np.trapezoid(curve.true, curve.false) == pytest.approx(curve.area, abs=1e-12)


def test_the_error_is_that_of_normal_scores():
    # two normal samples of 50, one deviation apart: Hanley and McNeil (Radiology 143:29, 1982)
    random = np.random.default_rng(1)
    score = np.concatenate([random.normal(1.0, 1.0, 50), random.normal(0.0, 1.0, 50)])
    curve = roc(score, np.arange(100) < 50, np.arange(100))
    area = curve.area
    first, second = area / (2 - area), 2 * area**2 / (1 + area)
    variance = area * (1 - area) + 49 * (first - area**2) + 49 * (second - area**2)
    # their formula is for exponential scores; 2000 draws know a deviation to 2 %
    assert curve.error == pytest.approx(np.sqrt(variance) / 50, rel=0.15)


def test_chance_is_told_from_a_signal():
    positive = np.arange(40) < 20
    assert permuted(-np.arange(40.0), positive) == pytest.approx(1 / 2001)
    # even and odd numbers alternate: the area is 0.5 + 1/40 or so, which any deal reaches
    assert permuted(np.arange(40.0) % 2, positive) == 1.0


def test_cases_of_one_kind_have_no_area():
    with pytest.raises(InputError, match="all of one kind"):
        auc(np.arange(3.0), np.ones(3, dtype=bool))
