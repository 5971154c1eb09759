"""Trajectories of maps whose characteristics are known."""

import numpy as np
import pytest
from arrival_samples import RADIUS, conductor, fibonacci_sphere, halves, square

from cardiosurf.analysis.eikonal import arrival
from cardiosurf.analysis.sources import point_source
from cardiosurf.analysis.trajectories import Places, trajectories


def turn(one, other):
    return one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]


def places_at(tissue, points):
    """The places of flat points: the triangle that holds each."""
    corners = tissue.points[tissue.triangles]
    triangles, shares = [], []
    for point in np.atleast_2d(points):
        a, b, c = (corners[:, k, :2] for k in range(3))
        whole = turn(b - a, c - a)
        pairs = ((b, c), (c, a), (a, b))
        parts = np.stack([turn(p - point[:2], q - point[:2]) for p, q in pairs])
        weights = (parts / whole).T
        triangles.append(np.argmax(weights.min(axis=1)))
        shares.append(weights[triangles[-1]])
    return Places(np.array(triangles), np.array(shares))


def bearing(points):
    return np.unwrap(np.arctan2(points[:, 1], points[:, 0]))


@pytest.mark.parametrize("forward", [True, False])
def test_trajectories_of_a_plane_wave_are_straight_and_of_exact_length(forward):
    points, triangles = square(4.0)
    tissue, k = conductor(points, triangles), np.array([4.0, 1.2, 0.0])
    path = trajectories(tissue, points @ k, places_at(tissue, [-10.0, -20.0]), forward=forward)[0]
    assert path.end == "edge"
    # it leaves through the right side, or the left one or the bottom
    end = np.array([50.0, -2.0, 0.0]) if forward else np.array([-50.0, -32.0, 0.0])
    np.testing.assert_allclose(path.points[-1], end, atol=1e-9)
    np.testing.assert_allclose(path.times, path.points @ k, atol=1e-9)
    np.testing.assert_allclose(np.cross(path.points - path.points[0], k)[:, 2], 0.0, atol=1e-9)


def test_in_anisotropic_tissue_they_run_along_d_grad_t():
    points, triangles = square(4.0)
    tensor = np.array([[5.0, 3.0, 0.0], [3.0, 4.0, 0.0], [0.0, 0.0, 1.0]])
    tissue, k = conductor(points, triangles, tensor), np.array([1.0, 0.2, 0.0])
    path = trajectories(tissue, points @ k, places_at(tissue, [-40.0, -40.0]))[0]
    way = path.points[-1] - path.points[0]
    np.testing.assert_allclose(np.cross(way, tensor @ k)[2], 0.0, atol=1e-9)


def test_refraction_at_a_jump_of_the_diffusivity_is_snell_s():
    # speeds 1 and 2: sin(beta) = 2 sin(alpha), and the map is linear on both sides
    points, triangles = square(4.0)
    tissue = halves(points, triangles, 1.0, 4.0)
    alpha = np.radians(20.0)
    beta = np.arcsin(2.0 * np.sin(alpha))
    x, y, _ = points.T
    lat = y * np.sin(alpha) + np.where(x < 0.0, x * np.cos(alpha), x * np.cos(beta) / 2.0)
    path = trajectories(tissue, lat, places_at(tissue, [-30.0, -20.0]))[0]
    left, right = path.points[path.points[:, 0] < 1e-9], path.points[path.points[:, 0] > -1e-9]
    for part, angle in ((left, alpha), (right, beta)):
        way = part[-1] - part[0]
        assert np.arctan2(way[1], way[0]) == pytest.approx(angle, abs=1e-9)


def test_rays_of_a_point_source_are_straight_and_go_back_to_it():
    points, triangles = square(2.0)
    tissue = conductor(points, triangles)
    angles = np.linspace(0.1, 6.0, 12)
    ring = np.c_[np.cos(angles), np.sin(angles)]
    lat = np.hypot(points[:, 0], points[:, 1])
    out = trajectories(tissue, lat, places_at(tissue, 10.0 * ring))
    # the direction on a triangle is that of the chords of circles: off by up to h/(2 r), and
    # either way, so that rays drift by a fraction of an edge
    for path, angle in zip(out, angles, strict=True):
        assert path.end == "edge"
        drift = np.angle(np.exp(1j * (bearing(path.points) - angle)))
        assert np.abs(drift * np.linalg.norm(path.points, axis=1)).max() < 2.5
        # linear times are late by up to h^2/(8 r)
        np.testing.assert_allclose(path.times, np.linalg.norm(path.points, axis=1), atol=0.15)
    back = trajectories(tissue, lat, places_at(tissue, 40.0 * ring), forward=False)
    assert {path.end for path in back} == {"meeting"}
    assert max(np.linalg.norm(path.points[-1]) for path in back) < 2.0


def test_they_end_where_fronts_meet_and_where_nothing_was_activated():
    points, triangles = square(4.0)
    tissue = conductor(points, triangles)
    lat = 50.0 - np.abs(points[:, 0])
    for start in ([-40.0, -20.0], [40.0, 33.3]):
        path = trajectories(tissue, lat, places_at(tissue, start))[0]
        assert path.end == "meeting"
        np.testing.assert_allclose(path.points[-1], [0.0, start[1], 0.0], atol=1e-9)
    lat = np.where(points[:, 0] > 20.0, np.nan, points[:, 0])
    path = trajectories(tissue, lat, places_at(tissue, [-40.0, 7.0]))[0]
    assert path.end == "still"
    assert 12.0 < path.points[-1, 0] <= 20.0


def test_flows_that_join_run_on_along_the_edge():
    # both sides lead to x = 0, and the map grows along it
    points, triangles = square(4.0)
    lat = points[:, 1] - 0.2 * np.abs(points[:, 0])
    tissue = conductor(points, triangles)
    path = trajectories(tissue, lat, places_at(tissue, [-5.0, -40.0]))[0]
    # the last vertex is a corner of the map: there is no way on
    assert path.end == "meeting"
    np.testing.assert_allclose(path.points[-1], [0.0, 50.0, 0.0], atol=1e-9)
    # it meets x = 0 at y = -40 + 5/0.2
    joined = path.points[np.flatnonzero(np.abs(path.points[:, 0]) < 1e-9)[0]]
    np.testing.assert_allclose(joined, [0.0, -15.0, 0.0], atol=1e-9)


def test_scar_ends_a_trajectory():
    points, triangles = square(4.0)
    tissue = conductor(points, triangles[points[triangles, 0].max(axis=1) <= 20.0])
    path = trajectories(tissue, points[:, 0].copy(), places_at(tissue, [-40.0, 7.0]))[0]
    assert path.end == "edge"
    assert 12.0 < path.points[-1, 0] <= 20.0


def test_the_arrivals_of_the_eikonal_equation_have_the_rays_they_came_by():
    # from the source in the slow half to a place in the fast one, back along the refracted ray
    points, triangles = square(1.0)
    tissue, source = halves(points, triangles, 1.0, 4.0), np.array([-20.0, -10.0, 0.0])
    found = arrival(tissue, point_source(tissue, source, 1.0, radius=10.0), 1.0)
    path = trajectories(tissue, found.times, places_at(tissue, [30.0, 20.0]), forward=False)[0]
    assert np.linalg.norm(path.points[-1] - source) < 1.5
    crossing = path.points[np.argmin(np.abs(path.points[:, 0]))]
    into, out = crossing - source, np.array([30.0, 20.0, 0.0]) - crossing
    sines = [way[1] / np.linalg.norm(way) for way in (into, out)]
    # Snell: sin(out) = 2 sin(into); directions on edges of 1 su are good to some 0.02
    assert sines[1] == pytest.approx(2.0 * sines[0], abs=0.04)


def test_great_circles():
    points, triangles = fibonacci_sphere(8000)
    tissue = conductor(points, triangles)
    lat = RADIUS * np.arccos(np.clip(points[:, 2] / RADIUS, -1.0, 1.0))
    starts = np.argsort(np.abs(lat[triangles].mean(axis=1) - 15.0))[:20]
    found = trajectories(tissue, lat, Places(starts, np.full((20, 3), 1.0 / 3.0)))
    for path in found:
        polar = RADIUS * np.arccos(path.points[:, 2] / np.linalg.norm(path.points, axis=1))
        seen = polar < 130.0
        drift = np.angle(np.exp(1j * (bearing(path.points) - bearing(path.points)[0])))
        # meridians, to a fraction of an edge (2.1 su)
        assert np.abs(drift * RADIUS * np.sin(polar / RADIUS))[seen].max() < 2.5
        np.testing.assert_allclose(path.times[seen], polar[seen], atol=0.1)


@pytest.mark.parametrize("seed", range(5))
def test_on_a_rough_map_times_grow_and_every_trajectory_ends(seed):
    # noise of twice what a front takes for an edge: flows meet, join and stop everywhere
    points, triangles = square(4.0, seed=seed)
    random = np.random.default_rng(seed)
    tensor = np.diag([6.0, 1.0, 1.0])
    lat = points[:, 0] + random.normal(0.0, 8.0, len(points))
    starts = Places(np.arange(len(triangles)), np.full((len(triangles), 3), 1.0 / 3.0))
    for forward in (True, False):
        for path in trajectories(
            conductor(points, triangles, tensor), lat, starts, forward=forward
        ):
            assert path.end in {"edge", "meeting"}
            grown = np.diff(path.times) if forward else -np.diff(path.times)
            assert grown.min(initial=0.0) > -1e-9


def test_where_all_is_activated_at_once_there_is_no_direction():
    points, triangles = square(10.0)
    path = trajectories(
        conductor(points, triangles),
        np.full(len(points), 3.0),
        places_at(conductor(points, triangles), [1.0, 2.0]),
    )[0]
    assert (path.end, len(path.points)) == ("still", 1)


def test_a_place_is_told_at_any_time_of_a_trajectory():
    points, triangles = square(4.0)
    tissue, lat = conductor(points, triangles), 5.0 * points[:, 0]
    for forward in (True, False):
        path = trajectories(tissue, lat, places_at(tissue, [2.0, 7.0]), forward=forward)[0]
        (early, now, late) = path.at(np.array([-30.0, 10.0, 50.0]))
        np.testing.assert_allclose(now, [2.0, 7.0, 0.0], atol=1e-9)
        known, unknown = (late, early) if forward else (early, late)
        np.testing.assert_allclose(known, [10.0 if forward else -6.0, 7.0, 0.0], atol=1e-9)
        assert np.isnan(unknown).all()
