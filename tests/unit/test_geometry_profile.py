"""Profiles of arcs and lines against the formulas of circles and lines."""

import numpy as np
import pytest

from cardiosurf.geometry.atrium import Atrium
from cardiosurf.geometry.profile import Profile
from cardiosurf.geometry.torus import Torus

CIRCLE = Torus(ring_radius=100.0, tube_radius=50.0).sheet(1.0).profile
ATRIUM = Atrium().sheet(1.0).profile


def test_a_circle_is_a_circle() -> None:
    s = np.linspace(-400.0, 400.0, 101)
    rho, z = CIRCLE.at(s)
    np.testing.assert_allclose(rho, 100.0 + 50.0 * np.cos(s / 50.0), atol=1e-12)
    np.testing.assert_allclose(z, 50.0 * np.sin(s / 50.0), atol=1e-12)
    outward, upward = CIRCLE.tangent(s)
    np.testing.assert_allclose(outward, -np.sin(s / 50.0), atol=1e-13)
    np.testing.assert_allclose(upward, np.cos(s / 50.0), atol=1e-13)


@pytest.mark.parametrize(("ring", "tube"), [(100.0, 20.0), (100.0, 50.0), (100.0, 80.0)])
def test_the_chart_of_a_torus_has_its_known_period(ring: float, tube: float) -> None:
    # int_0^2pi r dt / (R + r cos t) = 2 pi r / sqrt(R^2 - r^2); two-point Gauss on 4096 pieces
    profile = Torus(ring_radius=ring, tube_radius=tube).sheet(1.0).profile
    exact = 2.0 * np.pi * tube / np.sqrt(ring**2 - tube**2)
    assert profile.period == pytest.approx(exact, rel=1e-12)
    s = np.linspace(-np.pi * tube, np.pi * tube, 333)[:-1]
    # linear interpolation there and back
    np.testing.assert_allclose(profile.arclength(profile.conformal(s)), s, atol=1e-9)


def test_the_nearest_point_of_a_circle_lies_on_the_ray_from_its_centre() -> None:
    angle = np.linspace(-3.1, 3.1, 63)
    for radius in (1.0, 49.0, 50.0, 90.0):
        s = CIRCLE.nearest(100.0 + radius * np.cos(angle), radius * np.sin(angle))
        np.testing.assert_allclose(s, 50.0 * angle, atol=1e-12)


def test_the_nearest_point_is_nearest() -> None:
    rng = np.random.default_rng(3)
    rho, z = rng.uniform(0.0, 200.0, 50), rng.uniform(-200.0, 90.0, 50)
    _, on_rho, on_z = ATRIUM.sampled(ATRIUM.limits)
    brute = np.hypot(on_rho[:, None] - rho, on_z[:, None] - z).min(axis=0)
    found_rho, found_z = ATRIUM.at(ATRIUM.nearest(rho, z))
    away = np.hypot(found_rho - rho, found_z - z)
    assert (away <= brute + 1e-12).all()
    # samples are 0.1 su apart, so half of that from the nearest point at most
    assert (away >= brute - 0.06).all()


def test_bows_run_on_into_each_other() -> None:
    s = np.array(Atrium().sheet(1.0).stations)
    joints = np.array([*s, s[1] + 31.715728752538098 * np.pi / 4.0])
    before, after = ATRIUM.at(joints - 1e-9), ATRIUM.at(joints + 1e-9)
    np.testing.assert_allclose(before, after, atol=4e-9)
    np.testing.assert_allclose(
        ATRIUM.tangent(joints - 1e-9), ATRIUM.tangent(joints + 1e-9), atol=1e-9
    )


def test_heights_are_met() -> None:
    rings = CIRCLE.heights(30.0, (-50.0 * np.pi, 50.0 * np.pi))
    np.testing.assert_allclose(
        rings, 50.0 * np.array([np.arcsin(0.6), np.pi - np.arcsin(0.6)]), atol=1e-9
    )
    assert len(CIRCLE.heights(51.0, (-50.0 * np.pi, 50.0 * np.pi))) == 0


def test_a_straight_bow_is_a_line() -> None:
    line = Profile(start=(3.0, 4.0), heading=np.pi / 2, bows=((0.0, 10.0),))
    rho, z = line.at(np.array([0.0, 2.5, 10.0]))
    np.testing.assert_allclose(rho, 3.0, atol=1e-12)
    np.testing.assert_allclose(z, [4.0, 6.5, 14.0], atol=1e-12)
    np.testing.assert_allclose(
        line.nearest(np.array([9.0, 1.0]), np.array([5.0, 99.0])), [1.0, 10.0], atol=1e-12
    )
    # ds / rho with rho = 3 throughout
    assert line.period == pytest.approx(10.0 / 3.0, rel=1e-12)
