"""The front before a patch, on waves that formulas give."""

import numpy as np
import pytest

from cardiosurf.analysis.entrance import BEFORE, HEAD_ON, entrance_profiles, head_on_length
from cardiosurf.analysis.route import Map
from cardiosurf.geometry import build_surface
from cardiosurf.geometry.plane import Plane
from cardiosurf.geometry.regions import Box, BoxLimits
from cardiosurf.geometry.sphere import Sphere

SPEED = 0.2
EDGE = 2.5


@pytest.fixture(scope="module")
def plane():
    """Return a plane of 120 x 120 su and its block x <= -20, met at the line x = -20."""
    region = Box(BoxLimits(x=(-60.0, -20.0)))
    return build_surface(Plane(x=(-60.0, 60.0), y=(-60.0, 60.0)), EDGE, {"block": region})


def profiles(surface, distance, lat=None):
    """Return the profiles before the block for a wave that has come ``distance`` su at a vertex."""
    count = len(surface.triangles)
    given = Map(
        surface.points,
        surface.triangles,
        np.broadcast_to(np.eye(3), (count, 3, 3)),
        np.ones(count, dtype=bool),
        distance / SPEED if lat is None else lat,
        lambda: distance,
    )
    return entrance_profiles(given, surface.regions["block"])


@pytest.mark.parametrize("angle", [0.0, 0.4, -0.9])
def test_a_plane_wave_meets_a_straight_edge_at_its_own_angle(plane, angle):
    # it runs along (-cos, sin), and the edge's positions count from y = -60 on
    x, y, _ = plane.points.T
    (found,) = profiles(plane, -np.cos(angle) * x + np.sin(angle) * y)
    assert found.length == pytest.approx(120.0, abs=1e-9)
    np.testing.assert_allclose(found.start, [-20.0, -60.0, 0.0], atol=1e-9)
    # a fit by quadratics is exact for linear fields; the way to the edge is one at 12 su from it
    # only up to the first-order distance, off by about 0.2 % near the edge's ends
    np.testing.assert_allclose(found.angle, angle, atol=5e-3)
    np.testing.assert_allclose(found.curvature, 0.0, atol=1e-12)
    np.testing.assert_allclose(found.speed, SPEED, rtol=1e-9)
    np.testing.assert_allclose(found.points[:, 1] + 60.0, found.position, atol=1.5 * EDGE)


@pytest.mark.parametrize("far", [40.0, 70.0])
def test_a_circular_wave_has_curvature_one_over_r_and_the_angle_of_its_ray(plane, far):
    x, y, _ = plane.points.T
    centre = far - 20.0
    (found,) = profiles(plane, np.hypot(x - centre, y))
    away = np.hypot(found.points[:, 0] - centre, found.points[:, 1])
    # terms of third and fourth order, which the quadratic leaves out, are (8/r)^2 of the second
    bound = (8.0 / (far - BEFORE)) ** 2
    # beside an open edge half of a neighbourhood is missing
    inner = np.abs(found.points[:, 1]) < 60.0 - 8.0
    np.testing.assert_allclose((found.curvature * away)[inner], 1.0, atol=bound)
    np.testing.assert_allclose(found.curvature * away, 1.0, atol=2.0 * bound)
    np.testing.assert_allclose(found.speed, SPEED, rtol=bound)
    ray = np.arcsin(found.points[:, 1] / away)
    np.testing.assert_allclose(found.angle, ray, atol=0.02)
    np.testing.assert_allclose(found.lat, away / SPEED, rtol=1e-12)


def test_a_front_that_shrinks_has_negative_curvature(plane):
    # a wave that closes in on the centre (-80, 0), beyond the edge
    x, y, _ = plane.points.T
    away = np.hypot(x + 80.0, y)
    (found,) = profiles(plane, 200.0 - away)
    middle = np.abs(found.points[:, 1]) < 30.0
    distance = np.hypot(found.points[:, 0] + 80.0, found.points[:, 1])
    np.testing.assert_allclose((found.curvature * distance)[middle], -1.0, atol=0.02)


def test_on_a_sphere_the_curvature_is_geodesic():
    # from the north pole the isochrones are parallels: cot(theta)/R, 0 at the equator, negative
    # beyond it, though in space they are circles
    radius = 50.0
    for below, sign in ((0.0, 1.0), (-38.0, -1.0)):
        surface = build_surface(
            Sphere(radius=radius), EDGE, {"block": Box(BoxLimits(z=(-60.0, below)))}
        )
        theta = np.arccos(np.clip(surface.points[:, 2] / radius, -1.0, 1.0))
        (found,) = profiles(surface, radius * theta)
        there = np.arccos(found.points[:, 2] / radius)
        exact = 1.0 / (radius * np.tan(there))
        assert np.sign(exact).min() == np.sign(exact).max() == sign
        # the quadratic's error is of second order in radius/R = 0.16
        np.testing.assert_allclose(found.curvature, exact, atol=0.03 / radius)
        np.testing.assert_allclose(found.angle, 0.0, atol=0.02)


def test_where_the_wave_does_not_come_there_is_no_angle(plane):
    x, y, _ = plane.points.T
    lat = np.where(y > 0.0, (60.0 - x) / SPEED, np.nan)
    (found,) = profiles(plane, 60.0 - x, lat)
    never = found.points[:, 1] < -10.0
    assert np.isnan(found.angle[never]).all()
    assert np.isnan(found.lat[never]).all()
    assert np.isfinite(found.angle[found.points[:, 1] > 10.0]).all()


def test_late_tissue_at_the_very_edge_does_not_disturb_the_fit(plane):
    # a blocked front leaves a few su before the edge that a later wave activates
    x = plane.points[:, 0]
    late = np.where(x < -16.0, 500.0, 0.0)
    (found,) = profiles(plane, 60.0 - x, (60.0 - x) / SPEED + late)
    np.testing.assert_allclose(found.angle, 0.0, atol=5e-3)


def test_two_waves_that_collide_before_the_edge_have_no_angle_there(plane):
    # one from above, one from below; they meet at y = 0, where the gradient is of neither
    x, y, _ = plane.points.T
    lat = (60.0 - x + 2.0 * (60.0 - np.abs(y))) / SPEED
    (found,) = profiles(plane, 60.0 - x, lat)
    assert np.isnan(found.angle[np.abs(found.points[:, 1]) < 1.0]).all()
    assert np.isfinite(found.angle[np.abs(found.points[:, 1]) > 12.0]).all()


def test_a_patch_that_the_wave_does_not_meet_has_no_entrance(plane):
    # it starts at the block's far end, and leaves the block by the line
    assert profiles(plane, plane.points[:, 0] + 60.0) == ()


@pytest.mark.parametrize(("angle", "share"), [(0.1, 1.0), (-0.25, 1.0), (0.4, 0.0)])
def test_a_plane_wave_meets_all_of_an_edge_head_on_or_nothing(plane, angle, share):
    x, y, _ = plane.points.T
    (found,) = profiles(plane, -np.cos(angle) * x + np.sin(angle) * y)
    assert head_on_length(found.position, found.angle, found.length) == pytest.approx(120 * share)


def test_a_circular_wave_meets_what_lies_within_15_degrees_head_on(plane):
    far = 70.0
    (found,) = profiles(plane, np.hypot(plane.points[:, 0] - (far - 20.0), plane.points[:, 1]))
    # at 12 su before the edge rays within that angle have spread over 2 (far - 12) tan(15 deg)
    exact = 2.0 * (far - BEFORE) * np.tan(HEAD_ON)
    length = head_on_length(found.position, found.angle, found.length)
    # each end is known to an edge length
    assert length == pytest.approx(exact, abs=2.0 * EDGE)


def test_where_no_front_came_nothing_is_met():
    nowhere = np.array([np.nan, np.nan])
    assert head_on_length(np.array([0.0, 5.0]), nowhere, 5.0) == 0.0
    assert head_on_length(np.zeros(0), np.zeros(0), 5.0) == 0.0
