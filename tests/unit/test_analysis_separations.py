"""Fronts, their curvature, and how trajectories part, where all three are known."""

import numpy as np
import pytest
from arrival_samples import RADIUS, conductor, fibonacci_sphere, square

from cardiosurf.analysis.separations import separations
from cardiosurf.analysis.wavefronts import front_curvature, wavefronts


def disc(step=2.0, tensor=None):
    points, triangles = square(step)
    return conductor(points, triangles, tensor), np.hypot(points[:, 0], points[:, 1])


def ball(count=8000):
    points, triangles = fibonacci_sphere(count)
    lat = RADIUS * np.arccos(np.clip(points[:, 2] / RADIUS, -1.0, 1.0))
    return conductor(points, triangles), lat


def test_a_circle_is_one_closed_front_of_its_length():
    tissue, lat = disc()
    (front,) = wavefronts(tissue, lat, 30.0)
    assert front.closed
    assert front.length() == pytest.approx(2.0 * np.pi * 30.0, rel=0.002)
    # of linear times the isochrone is off by h^2/(8 r) at the most, h <= 3.5 for the diagonals
    np.testing.assert_allclose(np.linalg.norm(front.points, axis=1), 30.0, atol=0.051)
    # later tissue on the left: round the middle clockwise
    x, y = front.points[:, 0], front.points[:, 1]
    assert np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) < 0.0
    np.testing.assert_allclose(front.places.points(tissue), front.points, atol=1e-12)


def test_an_open_front_and_one_in_two_pieces():
    points, triangles = square(4.0)
    tissue = conductor(points, triangles)
    (front,) = wavefronts(tissue, points[:, 0].copy(), 10.0)
    assert not front.closed
    assert front.length() == pytest.approx(100.0, abs=1e-9)
    pieces = wavefronts(tissue, np.abs(points[:, 0] - 8.0), 22.0)
    assert [piece.length() for piece in pieces] == pytest.approx([100.0, 100.0])
    assert wavefronts(tissue, points[:, 0].copy(), 60.0) == ()


def test_no_front_goes_through_what_was_never_activated():
    points, triangles = square(4.0)
    lat = np.where(points[:, 1] > 0.0, np.nan, points[:, 0])
    (front,) = wavefronts(conductor(points, triangles), lat, 10.0)
    assert front.points[:, 1].max() <= 0.0
    assert front.length() == pytest.approx(50.0, abs=4.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_curvature_of_circles_on_the_plane(sign):
    tissue, lat = disc(1.0)
    # inward, a circle is a front that converges
    (front,) = wavefronts(tissue, sign * lat, sign * 30.0)
    found = front_curvature(tissue, front)
    np.testing.assert_allclose(found.curvature, sign / 30.0, rtol=0.06)
    assert np.mean(found.curvature) == pytest.approx(sign / 30.0, rel=0.01)
    # what it says of its own error: right to a factor of two
    scatter = np.std(found.curvature)
    assert 0.5 < np.median(found.error) / scatter < 2.0


@pytest.mark.parametrize("s", [30.0, 0.5 * np.pi * RADIUS, 120.0])
def test_geodesic_curvature_of_circles_on_the_sphere(s):
    tissue, lat = ball()
    front = wavefronts(tissue, lat, s)[0]
    found = front_curvature(tissue, front)
    # cot(s/R)/R: 0 on the equator, negative beyond; the window of 8 su adds 0.2 (K 8)^2 of it
    exact = 1.0 / (np.tan(s / RADIUS) * RADIUS)
    assert np.mean(found.curvature) == pytest.approx(exact, abs=0.001)
    np.testing.assert_allclose(found.curvature, exact, atol=0.002)


def test_a_straight_front_has_none():
    points, triangles = square(4.0)
    tissue = conductor(points, triangles)
    (front,) = wavefronts(tissue, points @ np.array([1.0, 0.3, 0.0]), 10.0)
    found = front_curvature(tissue, front)
    assert np.nanmax(np.abs(found.curvature)) < 1e-12


def test_parallel_trajectories_stay_apart():
    points, triangles = square(4.0)
    tissue = conductor(points, triangles)
    lat = points[:, 0] / 0.2
    (front,) = wavefronts(tissue, lat, -200.0)
    found = separations(tissue, lat, front)
    assert np.isfinite(found.acceleration).any()
    assert np.nanmax(np.abs(found.rate)) < 1e-12
    assert np.nanmax(np.abs(found.acceleration)) < 1e-13


def test_circles_on_the_plane_part_evenly():
    tissue, lat = disc()
    (front,) = wavefronts(tissue, lat, 12.0)
    found = separations(tissue, lat, front, spacing=6.0)
    level = np.argmin(np.abs(found.times - 30.0))
    start = found.length[:, 0]
    # |n| = r times the angle between two rays, whose chord at r = 12 is known
    assert np.nanmean(found.rate[:, level] / start) == pytest.approx(1.0 / 12.0, rel=0.03)
    # no acceleration, within its error: |n|''/|n| against 1/r^2 = 0.0011
    seen = np.isfinite(found.acceleration)
    pull = np.abs(found.acceleration / found.acceleration_error)[seen]
    # measured 0.49: kinks partly cancel, so that the error is a bound more than an estimate
    assert np.mean(pull < 2.0) > 0.95
    assert 0.3 < np.sqrt(np.mean(pull**2)) < 1.2
    assert abs(np.nanmean(found.relative)) < 1e-4


def test_on_the_sphere_they_part_and_come_together_again():
    tissue, lat = ball()
    front = wavefronts(tissue, lat, 20.0)[0]
    found = separations(tissue, lat, front, spacing=8.0)
    mean = np.nanmean(found.length, axis=0)
    # sin(s/R), from 20 su on
    expected = mean[0] * np.sin(found.times / RADIUS) / np.sin(found.times[0] / RADIUS)
    seen = found.times < 125.0
    np.testing.assert_allclose(mean[seen], expected[seen], rtol=0.05)
    # Jacobi: |n|''/|n| = -1/R^2, before and after the equator
    for low, high in ((35.0, 75.0), (80.0, 115.0)):
        chosen = (found.times > low) & (found.times < high)
        relative = np.nanmedian(found.relative[:, chosen])
        assert relative == pytest.approx(-1.0 / RADIUS**2, rel=0.25)
    # and they part before it, and come together after
    assert np.nanmean(found.rate[:, np.argmin(np.abs(found.times - 50.0))]) > 0.0
    assert np.nanmean(found.rate[:, np.argmin(np.abs(found.times - 110.0))]) < 0.0


def test_relative_acceleration_scales_with_the_square_of_the_speed():
    tissue, lat = disc(4.0)
    (front,) = wavefronts(tissue, lat, 12.0)
    (slow_front,) = wavefronts(tissue, 5.0 * lat, 60.0)
    fast, slow = separations(tissue, lat, front), separations(tissue, 5.0 * lat, slow_front)
    np.testing.assert_allclose(25.0 * slow.relative, fast.relative, rtol=1e-6, atol=1e-9)
    assert slow.window == pytest.approx(5.0 * fast.window)
