"""The map of the relative acceleration where it is known, in both ways of measuring it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from arrival_samples import (
    RADIUS,
    conductor,
    fibonacci_sphere,
    halves,
    square,
    through_halves,
)

from cardiosurf.analysis.conductor import Conductor
from cardiosurf.analysis.front_riccati import front_riccati
from cardiosurf.analysis.measured_acceleration import at_places, measured_acceleration
from cardiosurf.config import load
from cardiosurf.recording.hdf5 import read_recording
from cardiosurf.study.simulation import simulate

ROOT = Path(__file__).parents[2]
BORDER = 12.0
"""Within so many su (six edges) of an open edge pairs have no full window."""


def inner(points, half=50.0):
    return np.abs(points[:, :2]).max(axis=1) < half - BORDER


def check_zero(found, chosen, scale):
    """Both ways find none, within their errors, and these are small against ``scale``."""
    for way in (found, found.by_lat):
        value, error = way.relative[chosen], way.relative_error[chosen]
        known = np.isfinite(value)
        assert known.mean() > 0.75
        assert np.mean(np.abs(value) < 2.0 * error, where=known) > 0.95
        assert np.nanmedian(error) < scale
        assert abs(np.nanmedian(value)) < 0.2 * scale


def check_rate(found, exact, chosen):
    """Both ways find the rate within two errors, and the median to 2 %."""
    for way in (found, found.by_lat):
        apart = np.abs(way.rate - exact)[chosen]
        seen = np.isfinite(apart)
        assert np.mean((apart < 2.0 * way.rate_error[chosen])[seen]) > 0.9
        assert np.median((apart / exact[chosen])[seen]) < 0.02


def agreement(found, chosen):
    both = chosen & np.isfinite(found.relative) & np.isfinite(found.by_lat.relative)
    apart = np.abs(found.relative - found.by_lat.relative)[both]
    errors = np.hypot(found.relative_error, found.by_lat.relative_error)[both]
    return np.mean(apart < 2.0 * errors)


def test_circles_on_the_plane_have_none():
    points, triangles = square(2.0)
    tissue, radius = conductor(points, triangles), np.hypot(points[:, 0], points[:, 1])
    found = measured_acceleration(tissue, radius)
    chosen = inner(points) & (radius > 20.0)
    # against 1/r^2, what a separation that grows with sqrt(r) has four times of: 0.0025 to 0.0003
    check_zero(found, chosen, 3e-4)
    assert agreement(found, chosen) > 0.95
    # |n| grows like r
    check_rate(found, 1.0 / np.maximum(radius, 1.0), chosen)


def test_ellipses_in_anisotropic_tissue_have_none():
    points, triangles = square(2.0)
    times = np.sqrt(points[:, 0] ** 2 / 4.0 + points[:, 1] ** 2)
    found = measured_acceleration(conductor(points, triangles, np.diag([4.0, 1.0, 1.0])), times)
    # straight rays, evenly run through: |n| grows like T; time runs twice as fast along x
    check_zero(found, inner(points) & (times > 10.0), 6e-4)
    check_rate(found, 1.0 / np.maximum(times, 1.0), inner(points) & (times > 10.0))


def test_parallel_lines_have_none_to_rounding():
    points, triangles = square(4.0)
    found = measured_acceleration(conductor(points, triangles), points @ [4.0, 1.0, 0.0])
    assert np.nanmax(np.abs(found.relative)) < 1e-13
    assert np.nanmax(np.abs(found.by_lat.relative)) < 1e-13


def test_on_the_sphere_it_is_jacobis():
    points, triangles = fibonacci_sphere(8000)
    arc = RADIUS * np.arccos(np.clip(points[:, 2] / RADIUS, -1.0, 1.0))
    found = measured_acceleration(conductor(points, triangles), arc)
    chosen = (arc > 30.0) & (arc < 125.0)
    for way in (found, found.by_lat):
        relative = way.relative[chosen]
        assert np.isfinite(relative).all()
        assert np.median(relative) == pytest.approx(-1.0 / RADIUS**2, rel=0.01)
        within = np.abs(relative + 1.0 / RADIUS**2) < 2.0 * way.relative_error[chosen]
        assert np.mean(within) > 0.95
        # q = cot(s/R)/R
        exact = 1.0 / (np.tan(arc / RADIUS) * RADIUS)
        np.testing.assert_allclose(way.rate[chosen], exact[chosen], atol=0.0015)
    assert agreement(found, chosen) > 0.95
    # the pairs' scatter is below a tenth of what is measured
    assert np.median(found.relative_error[chosen]) < 0.1 / RADIUS**2


def test_a_plane_wave_that_is_refracted_has_some_at_the_jump_only():
    points, triangles = square(2.0)
    # 20 degrees before x = 0, where c = 1; Snell: sin A / c stays
    along = np.sin(np.radians(20.0))
    fast = np.sqrt(0.25 - along**2)
    x, y = points[:, 0], points[:, 1]
    times = np.where(x < 0.0, x * np.cos(np.radians(20.0)), x * fast) + y * along
    labels = (points[triangles, 0].mean(axis=1) > 0.0).astype(np.int64)
    found = measured_acceleration(halves(points, triangles, 1.0, 4.0), times, labels)
    # pairs reach six levels, of two edges each on the fast side, and vertices take them from six su
    far = inner(points) & (np.abs(x) > 32.0)
    assert np.isfinite(found.relative[far]).any()
    assert np.nanmax(np.abs(found.relative[far])) < 1e-13
    # derivatives on either side by itself see nothing, and on the line itself give nothing
    assert np.nanmax(np.abs(found.by_lat.relative)) < 1e-12
    assert np.isnan(found.by_lat.relative[x == 0.0]).all()
    # n is shortened or stretched there: of either sign
    near = inner(points) & (np.abs(x) < 12.0)
    assert np.nanmin(found.relative[near]) < -1e-4
    assert np.nanmax(found.relative[near]) > 1e-4


def test_behind_a_jump_circles_part_faster_and_still_evenly():
    points, triangles = square(2.0)
    source, slow, fast = np.array([-30.0, 0.0, 0.0]), 1.0, 1.6
    times = through_halves(points, source, slow, fast)
    labels = (points[triangles, 0].mean(axis=1) > 0.0).astype(np.int64)
    tissue = halves(points, triangles, slow**2, fast**2)
    found = front_riccati(tissue, times, labels)
    # on the axis n = a (1 + c2^2 t/(c1 a)) behind it, t since x = 0: paraxial rays
    chosen = (np.abs(points[:, 1]) < 3.0) & (points[:, 0] > 8.0) & (points[:, 0] < 40.0)
    spread = fast**2 / slow
    exact = spread / (30.0 + spread * points[chosen, 0] / fast)
    # (y/a)^2 = 0.01 off the axis
    np.testing.assert_allclose(found.rate[chosen], exact, rtol=0.03)
    # straight rays: none, against q^2 = 0.0007 to 0.004
    assert np.median(np.abs(found.relative[chosen])) < 5e-5


def test_never_activated_tissue_has_no_value():
    points, triangles = square(2.0)
    times = np.where(points[:, 0] > 20.0, np.nan, points[:, 0] + 60.0)
    found = measured_acceleration(conductor(points, triangles), times)
    late = points[:, 0] > 20.0
    assert np.isnan(found.by_lat.relative[late]).all()
    # pairs end there, so a vertex beyond has none on its far side
    assert np.isnan(found.relative[points[:, 0] > 24.0]).all()


def test_where_nothing_moves_nothing_is_measured():
    points, triangles = square(4.0)
    times = np.where(points[:, 0] > 0.0, 1.0, np.nan)
    times[0] = 0.0
    found = measured_acceleration(conductor(points, triangles), times)
    assert np.isnan(found.relative).all()


def test_values_are_fitted_by_lines_and_only_between_their_places():
    rng = np.random.default_rng(3)
    places = np.c_[rng.uniform(-10.0, 10.0, (400, 2)), np.zeros(400)]
    values = (1.0 + 0.5 * places[:, 0] - places[:, 1])[:, None]
    points = np.array([[0.0, 0.0, 0.0], [3.0, -4.0, 0.0], [30.0, 0.0, 0.0]])
    fitted, scatter = at_places(points, np.tile([0.0, 0.0, 1.0], (3, 1)), places, values, 4.0)
    np.testing.assert_allclose(fitted[:2, 0], [1.0, 6.5], atol=1e-9)
    np.testing.assert_allclose(scatter[:2, 0], 0.0, atol=1e-9)
    assert np.isnan(fitted[2, 0])


@pytest.mark.slow
def test_on_a_simulated_sphere_both_ways_agree_and_are_jacobis_at_the_equator(tmp_path):
    options = ("tissue={}", "targets=[]", "record.frames_every=null")
    loaded = load(ROOT / "configs/sphere_block.yaml", options)
    simulate(loaded, tmp_path / "run")
    recording = read_recording(tmp_path / "run/recording.h5", with_frames=False)
    tissue = Conductor.of(recording.surface, recording.tissue)
    found = measured_acceleration(tissue, recording.first_activation)
    everywhere = np.ones(recording.node_count, dtype=bool)
    assert agreement(found, everywhere) > 0.95
    height = recording.surface.points[:, 2]
    equator = np.abs(height) < 5.0
    for way in (found, found.by_lat):
        # -c^2/R^2 with c = 0.2123; that of a wave that gains speed, by 3 % from here to there
        relative = np.median(way.relative[equator])
        assert relative == pytest.approx(-((0.2123 / RADIUS) ** 2), rel=0.06)


def test_time_in_other_units_scales_it():
    points, triangles = square(4.0)
    tissue, radius = conductor(points, triangles), np.hypot(points[:, 0], points[:, 1])
    fast, slow = (measured_acceleration(tissue, unit * radius) for unit in (1.0, 5.0))
    assert slow.window == pytest.approx(5.0 * fast.window)
    np.testing.assert_allclose(
        25.0 * slow.by_lat.relative, fast.by_lat.relative, rtol=1e-5, atol=1e-9
    )
    same = replace(fast, relative=25.0 * slow.relative)
    np.testing.assert_allclose(same.relative, fast.relative, rtol=1e-5, atol=1e-8)
