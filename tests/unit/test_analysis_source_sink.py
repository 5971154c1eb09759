"""Flux needed and flux available, and the jump that a straight front passes."""

import numpy as np
import pytest

from cardiosurf.analysis import critical_jump as jumps
from cardiosurf.analysis.critical_jump import DEFAULT, critical_jump, passes, search
from cardiosurf.analysis.source_sink import Edge, curvature_number, flux_ratio, with_curvature
from cardiosurf.errors import InputError
from cardiosurf.kinetics.fitzhugh_nagumo import FitzHughNagumo
from cardiosurf.kinetics.rogers_mcculloch import RogersMcCulloch


def edge(normal, tangential, mixed=0.0):
    return Edge(*(np.atleast_1d(np.asarray(one, float)) for one in (normal, tangential, mixed)))


def test_head_on_the_ratio_is_that_of_a_line():
    assert flux_ratio(edge(1, 1), edge(8, 3), np.zeros(1)) == pytest.approx(np.sqrt(8))


def test_fibres_along_the_normal_have_the_same_ratio_at_every_angle():
    trace = np.sin(np.radians([0.0, 20.0, 40.0, 60.0]))
    ratio = flux_ratio(edge(np.ones(4), np.ones(4)), edge(8 * np.ones(4), np.ones(4)), trace)
    assert ratio == pytest.approx(np.sqrt(8) * np.ones(4))


def test_the_ratio_follows_snell():
    # isotropic 1 to 4: sin B = 2 sin A, flux sqrt(d) cos
    a = np.radians(20.0)
    b = np.arcsin(2.0 * np.sin(a))
    expected = 2.0 * np.cos(b) / np.cos(a)
    assert flux_ratio(edge(1, 1), edge(4, 4), np.sin([a])) == pytest.approx(expected)
    # nothing is left of it at the critical angle
    assert flux_ratio(edge(1, 1), edge(4, 4), np.array([0.5])) == pytest.approx(0.0, abs=1e-7)


def test_equal_tissue_needs_what_there_is_whatever_its_fibres():
    random = np.random.default_rng(2)
    factor = random.normal(size=(5, 2, 2))
    tensor = factor @ factor.transpose(0, 2, 1) + np.eye(2)
    same = edge(tensor[:, 0, 0], tensor[:, 1, 1], tensor[:, 0, 1])
    assert flux_ratio(same, same, np.full(5, 0.1)) == pytest.approx(np.ones(5))


def test_a_front_that_curvature_stops_brings_nothing():
    number = curvature_number(4.0, np.array([0.0, 0.0265, 0.1]), 1.335, 0.2123)
    # g sqrt(d) K/c0 by hand
    assert number[1] == pytest.approx(1.335 * 2 * 0.0265 / 0.2123)
    ratio = with_curvature(np.full(3, 2.0), number)
    assert ratio[0] == 2.0
    assert ratio[1] == pytest.approx(2.0 / (1.0 - number[1]))
    assert ratio[2] == np.inf


def test_the_stored_jump_is_the_one_of_the_search():
    assert critical_jump(RogersMcCulloch()) == DEFAULT
    # half the bracket at which the search ends
    assert passes(RogersMcCulloch(), DEFAULT * 0.995)
    assert not passes(RogersMcCulloch(), DEFAULT * 1.005)


@pytest.mark.slow
def test_without_recovery_the_jump_is_that_of_a_front_at_rest():
    # 1 + F(1)/|F(a)| of the cubic
    a = 0.3
    exact = 1.0 + (1.0 - 2.0 * a) / (a**3 * (2.0 - a))
    # near it fronts wait for long: the march gives up a little below, and the edge is 0.4 lengths
    assert search(RogersMcCulloch(a=a, c2=1e-9)) == pytest.approx(exact, rel=0.01)


@pytest.mark.slow
def test_the_jump_does_not_hang_on_the_line(monkeypatch):
    monkeypatch.setattr(jumps, "EDGE", 0.2)
    monkeypatch.setattr(jumps, "STEP", 0.05)
    assert search(RogersMcCulloch()) == pytest.approx(DEFAULT, rel=0.005)


def test_a_model_without_a_wave_has_no_jump():
    with pytest.raises(InputError, match="no wave"):
        search(FitzHughNagumo())
