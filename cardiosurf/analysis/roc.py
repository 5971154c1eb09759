"""How well a number tells two kinds of cases apart: the receiver operating characteristic."""

from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.errors import InputError

DRAWS = 2000
"""Resamplings behind an error."""


@dataclass(frozen=True)
class Roc:
    """The curve of a score.

    Attributes
    ----------
    false, true : (k,) float
        Shares of the negative and of the positive cases above a falling threshold, from (0, 0) to
        (1, 1).
    area : float
        AUC: how likely a positive case has the higher score, ties counted half.
    error : float
        Standard deviation of the area over resampled groups.
    """

    false: Floats
    true: Floats
    area: float
    error: float


def auc(score: Floats, positive: Mask) -> float:
    """Return the area under the curve, (mean rank of the positive - (p + 1)/2)/n.

    Parameters
    ----------
    score : (k,) float
        Higher for what is expected to be positive.
    positive : (k,) bool
        What is.

    Raises
    ------
    InputError
        All cases are of one kind.
    """
    count = int(positive.sum())
    others = len(score) - count
    if not count * others:
        raise InputError("cases", "are all of one kind", "some of either kind")
    ranks = scipy.stats.rankdata(score)[positive]
    return float((ranks.mean() - 0.5 * (count + 1)) / others)


def roc(score: Floats, positive: Mask, groups: Ints, *, seed: int = 0) -> Roc:
    """Return the curve of a score, its area and the error of that.

    Cases of one geometry are no independent samples: whole groups are drawn again.

    Parameters
    ----------
    score : (k,) float
        Higher for what is expected to be positive.
    positive : (k,) bool
        What is.
    groups : (k,) int
        Which cases belong together.
    seed : int
        Of the random numbers.
    """
    area = auc(score, positive)
    order = np.argsort(-score, kind="stable")
    last = np.append(np.diff(score[order]) != 0.0, True)
    true = np.append(0.0, np.cumsum(positive[order])[last] / positive.sum())
    false = np.append(0.0, np.cumsum(~positive[order])[last] / (~positive).sum())
    generator = np.random.default_rng(seed)
    members = [np.flatnonzero(groups == one) for one in np.unique(groups)]
    areas: list[float] = []
    while len(areas) < DRAWS:
        drawn = generator.integers(len(members), size=len(members))
        chosen = np.concatenate([members[one] for one in drawn])
        own = positive[chosen]
        if own.any() and not own.all():
            areas.append(auc(score[chosen], own))
        elif len(members) == 1:
            break
    return Roc(false, true, area, float(np.std(areas)) if areas else 0.0)


def permuted(score: Floats, positive: Mask, *, seed: int = 0) -> float:
    """Return how often an area as far from 1/2 comes of outcomes dealt out at random.

    Parameters
    ----------
    score : (k,) float
        The score.
    positive : (k,) bool
        The outcomes.
    seed : int
        Of the random numbers.
    """
    generator = np.random.default_rng(seed)
    away = abs(auc(score, positive) - 0.5)
    dealt = [abs(auc(score, generator.permutation(positive)) - 0.5) for _ in range(DRAWS)]
    return (1 + sum(one >= away for one in dealt)) / (1 + DRAWS)
