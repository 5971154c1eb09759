"""Fronts with c = c0 - d K against the ordinary differential equations of circles."""

import numpy as np
import pytest
import scipy
from arrival_samples import RADIUS, conductor, fibonacci_sphere, rings, square

from cardiosurf.analysis import curvature_system
from cardiosurf.analysis.compiled.incomplete import solve
from cardiosurf.analysis.eikonal import arrival
from cardiosurf.analysis.eikonal_curvature import curved_arrival
from cardiosurf.analysis.sources import Sources
from cardiosurf.errors import InputError

SPEED = 0.2123


def circle_times(radius, start, factor=1.0):
    """When a circle has a radius: dr/dt = c0 - g/r from ``start`` on."""
    grown = np.log((SPEED * radius - factor) / (SPEED * start - factor))
    return (radius - start) / SPEED + factor / SPEED**2 * grown


def rms(error):
    return np.sqrt(np.mean(error**2))


def from_circle(step, tensor, factor=1.0):
    """Errors with and without curvature on a ring, where r is measured by the tensor."""
    points, triangles = square(step, 70.0)
    r = np.sqrt(np.einsum("ij,jk,ik->i", points, np.linalg.inv(tensor), points))
    exact = circle_times(np.maximum(r, 10.0), 15.0, factor)
    held = np.flatnonzero(r <= 19.0)
    tissue = conductor(points, triangles, tensor)
    found = curved_arrival(tissue, Sources.at(held, exact[held]), SPEED, factor=factor)
    # the square's sides disturb it: their no-flux condition is not that of a circle
    ring = (r > 20.0) & (np.abs(points[:, :2]).max(axis=1) < 50.0) & (r < 50.0)
    return rms((found.times - exact)[ring]), rms((found.straight - exact)[ring])


def test_a_circle_on_the_plane_is_slowed_by_its_curvature():
    coarse, _ = from_circle(4.0, np.eye(3))
    fine, without = from_circle(2.0, np.eye(3))
    # the wave takes 165 tu over the ring; without curvature it is early by d/c0^2 log(...)
    assert without > 35.0
    # measured 0.21 and 0.07 tu, and 0.03 at edges of 1 su
    assert fine < 0.1
    assert np.log2(coarse / fine) > 1.0


def test_an_ellipse_across_fibres_is_a_circle_in_their_metric():
    # with lengths along x halved the equation is that of isotropic tissue
    error, without = from_circle(2.0, np.diag([4.0, 1.0, 1.0]))
    # measured 0.27 tu, from the sides of the square: the same at edges of 1 su
    assert without > 25.0
    assert error < 0.35


def test_a_pulse_is_slowed_by_more_than_the_diffusivity():
    error, without = from_circle(2.0, np.eye(3), 1.335)
    # measured 0.13 tu, and 0.07 at edges of 1 su
    assert without > 55.0
    assert error < 0.25


def test_it_does_not_matter_what_it_begins_from():
    points, triangles = square(2.0, 70.0)
    r = np.hypot(points[:, 0], points[:, 1])
    held, tissue = np.flatnonzero(r <= 19.0), conductor(points, triangles)
    sources = Sources.at(held, circle_times(np.maximum(r[held], 10.0), 15.0))
    first = curved_arrival(tissue, sources, SPEED, enough=1e-6)
    straight = arrival(tissue, sources, SPEED).times
    second = curved_arrival(tissue, sources, SPEED, enough=1e-6, straight=straight)
    assert np.array_equal(second.straight, straight)
    # up to eight times what each leaves, of 400 tu
    assert rms(first.times - second.times) < 8e-6 * 400.0


def test_a_factor_must_be_positive():
    points, triangles = square(10.0)
    with pytest.raises(InputError, match="factor"):
        curved_arrival(conductor(points, triangles), Sources.at(np.array([0])), 1.0, factor=0.0)


def test_a_circle_on_the_sphere_speeds_up_beyond_the_equator():
    # ds/dt = c0 - d cot(s/R)/R
    points, triangles = fibonacci_sphere(4000)
    s = RADIUS * np.arccos(np.clip(points[:, 2] / RADIUS, -1.0, 1.0))
    grid = np.linspace(15.0, 130.0, 2001)
    rate = 1.0 / (SPEED - 1.0 / (np.tan(grid / RADIUS) * RADIUS))
    times = scipy.integrate.cumulative_simpson(rate, x=grid, initial=0.0)
    held = np.flatnonzero(s <= 20.0)
    sources = Sources.at(held, np.interp(s[held], grid, times))
    found = curved_arrival(conductor(points, triangles), sources, SPEED)
    seen = (s > 22.0) & (s < 125.0)
    error = (found.times - np.interp(s, grid, times))[seen]
    # edges are 3 su; the wave takes 550 tu, and without curvature is 30 tu early: measured 0.10
    assert rms((found.straight - np.interp(s, grid, times))[seen]) > 20.0
    assert rms(error) < 0.15


def test_a_straight_front_is_not_changed():
    points, triangles = square(2.0)
    left = np.flatnonzero(points[:, 0] == -50.0)
    found = curved_arrival(conductor(points, triangles), Sources.at(left), SPEED)
    exact = (points[:, 0] + 50.0) / SPEED
    # at the far wall the front meets its mirror image, and is early from some 15 su before it on
    seen = points[:, 0] < 35.0
    np.testing.assert_allclose(found.times[seen], exact[seen], atol=0.3)


def test_times_scale_with_the_rates():
    # all rates times k: c0 and 1/length go as sqrt(k); here the same mesh with d k and c0 sqrt(k)
    points, triangles = square(5.0)
    near = np.flatnonzero(np.hypot(points[:, 0], points[:, 1]) <= 16.0)
    ones = curved_arrival(conductor(points, triangles), Sources.at(near), SPEED)
    fast = curved_arrival(
        conductor(points, triangles, 4.0 * np.eye(3)), Sources.at(near), 2.0 * SPEED
    )
    np.testing.assert_allclose(4.0 * fast.times, ones.times, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("scar", [False, True])
def test_what_no_wave_reaches_has_no_time(scar):
    points, triangles = square(5.0)
    left = points[triangles, 0].max(axis=1) <= 0.0
    chosen = triangles[left] if scar else triangles
    near = np.flatnonzero(np.hypot(points[:, 0] + 30.0, points[:, 1]) <= 12.0)
    found = curved_arrival(conductor(points, chosen), Sources.at(near), SPEED)
    np.testing.assert_array_equal(np.isfinite(found.times), (points[:, 0] <= 0.0) | (not scar))


def on_rings(step, radius):
    """Mean error 8 su beyond the source on a mesh of circles from 20 to 60 su about the centre."""
    points, triangles, r = rings(step, 20.0, 60.0, radius)
    grid = np.linspace(20.0, 60.0, 4001)
    bend = 1.0 / grid if np.isinf(radius) else 1.0 / (radius * np.tan(grid / radius))
    times = scipy.integrate.cumulative_simpson(1.0 / (SPEED - bend), x=grid, initial=0.0)
    held = Sources.at(np.flatnonzero(r == 20.0))
    found = curved_arrival(conductor(points, triangles), held, SPEED, enough=1e-6)
    seen = np.abs(r - 28.0) < 1e-9
    return float((found.times - np.interp(r, grid, times))[seen].mean())


@pytest.mark.parametrize("radius", [np.inf, RADIUS])
def test_circles_converge_at_second_order(radius):
    coarse, fine = (abs(on_rings(step, radius)) for step in (2.0, 1.0))
    # what w lacks at the rim makes an offset a few su behind it: 0.087 and 0.022 tu of 43
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.1)
    assert fine < 0.025


def advection(count, speed, seed=0):
    """A five-point matrix of diffusion and a flow along the rows' order, with few fixed ends."""
    line = scipy.sparse.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(count, count))
    line = line.tolil()
    line[-1, -1] = 1.0
    drift = scipy.sparse.diags_array([-1.0, 1.0], offsets=[-1, 0], shape=(count, count))
    across = line.copy()
    across[0, 0] = 1.0
    one = scipy.sparse.eye_array(count)
    matrix = scipy.sparse.kron(line + speed * drift, one) + scipy.sparse.kron(one, across)
    given = np.random.default_rng(seed).normal(size=count * count)
    return scipy.sparse.csr_array(matrix), given


@pytest.mark.parametrize("speed", [0.0, 0.3, 3.0])
def test_iterations_solve_the_system_to_what_is_asked_for(speed):
    matrix, given = advection(40, speed)
    matrix.sort_indices()
    parts = (matrix.indptr.astype(np.int64), matrix.indices.astype(np.int32), matrix.data)
    found, rounds = solve(*parts, given, 1e-9, 100)
    assert np.linalg.norm(matrix @ found - given) <= 1.01e-9 * np.linalg.norm(given)
    # measured 27, 33, 12
    assert 0 < rounds < 40
    assert solve(*parts, given, 1e-9, 2)[1] == -1
    assert solve(*parts, 0.0 * given, 1e-9, 2)[1] == 0


def test_complete_factors_take_over_where_iterations_do_not_end(monkeypatch):
    points, triangles = square(5.0)
    near = np.flatnonzero(np.hypot(points[:, 0], points[:, 1]) <= 16.0)
    across = conductor(points, triangles, np.diag([16.0, 1.0, 1.0]))
    found = curved_arrival(across, Sources.at(near), SPEED, enough=1e-7)
    monkeypatch.setattr(curvature_system, "PATIENCE", 0)
    exact = curved_arrival(across, Sources.at(near), SPEED, enough=1e-7)
    # both are at the fixed point to some 1e-7 of 300 tu
    np.testing.assert_allclose(found.times, exact.times, atol=1e-3)
