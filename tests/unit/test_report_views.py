import numpy as np
import pytest
from recording_samples import square_surface

from cardiosurf.geometry import build_surface
from cardiosurf.geometry.atrium import Atrium
from cardiosurf.geometry.sphere import Sphere
from cardiosurf.geometry.t_domain import TDomain
from cardiosurf.geometry.torus import Torus
from cardiosurf.report.layers import isochrone_levels, middles, roomiest_spot
from cardiosurf.report.views import (
    flat_views,
    has_vein,
    outlines,
    seen,
    unrolled_revolved,
    unrolled_sphere,
    unrolled_vein,
)

T_DOMAIN = build_surface(TDomain(), 8.0, {})
SPHERE = build_surface(Sphere(), 8.0, {})
TORUS = build_surface(Torus(), 8.0, {})
ATRIUM = build_surface(Atrium(), 8.0, {})


def signed_area(points):
    x, y = points.T
    return 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))


def turned_over(view):
    """Number of the view's triangles whose corners run against those of the first."""
    a, b, c = (view.points[view.triangles[:, k]] for k in range(3))
    sides = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    return int((np.sign(sides) != np.sign(sides[0])).sum())


def test_flat_view_of_a_plane_and_of_the_t_domain():
    (view,) = flat_views(square_surface())
    assert view.labels == ("x [su]", "y [su]")
    assert np.array_equal(view.points, square_surface().points[:, :2])
    (view,) = flat_views(T_DOMAIN)
    assert view.labels == ("y [su]", "z [su]")
    assert np.array_equal(view.points, T_DOMAIN.points[:, 1:])
    assert view.limits.tolist() == [[-150.0, 150.0], [-150.0, 150.0]]


def test_no_triangle_of_the_t_domain_hides_another_in_its_flat_view():
    # A triangle turned over, or an area that is not that of the picture's outline, would overlap:
    # two rectangles, minus the open tip's disc (its polygon of edges <= 8 su is 0.3 % smaller)
    (view,) = flat_views(T_DOMAIN)
    assert turned_over(view) == 0
    area = sum(abs(signed_area(view.points[triangle])) for triangle in view.triangles)
    assert area == pytest.approx(150 * 300 + 150 * 140 - np.pi * 35**2, rel=3e-3)


def test_unrolled_vein_puts_every_vertex_at_its_angle_and_arc_length():
    view = unrolled_vein(T_DOMAIN)
    phi, theta = np.radians(view.points[:, 0]), view.points[:, 1] / 35.0
    rho = 35.0 * (1 - np.sin(theta)) + 35.0
    expected = np.column_stack((35 * (1 - np.cos(theta)), rho * np.sin(phi), rho * np.cos(phi)))
    # arccos near 1 turns round-off of 1e-16 into 1e-8 in theta, so 1e-6 in su
    assert T_DOMAIN.points[view.vertex_of] == pytest.approx(expected, abs=1e-5)
    assert view.limits[1] == pytest.approx([0.0, 35 * np.pi / 2])
    assert has_vein(T_DOMAIN)


@pytest.mark.parametrize("view", [unrolled_vein(T_DOMAIN), unrolled_sphere(SPHERE)])
def test_unrolled_maps_cover_the_whole_turn_once(view):
    middles = view.points[view.triangles].mean(axis=1)
    once = (middles[:, 0] >= -180.0 - 1e-6) & (middles[:, 0] < 180.0 - 1e-6)
    # every triangle of the mesh is drawn with its middle inside exactly once
    assert np.unique(view.triangle_of[once], return_counts=True)[1].max() == 1
    assert set(view.triangle_of) == set(view.triangle_of[once])
    # those across the cut reach over both ends
    assert view.points[:, 0].min() < -180.0
    assert view.points[:, 0].max() > 180.0


def test_unrolled_sphere_puts_every_vertex_at_its_angles():
    view = unrolled_sphere(SPHERE)
    phi, theta = np.radians(view.points).T
    expected = 50 * np.column_stack(
        (np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta))
    )
    assert SPHERE.points[view.vertex_of] == pytest.approx(expected, abs=1e-5)


def test_unrolled_sphere_follows_its_pole():
    shape = Sphere(pole=(1.0, 2.0, -1.0))
    view = unrolled_sphere(build_surface(shape, 8.0, {}))
    pole, first = np.array([1.0, 2.0, -1.0]) / np.sqrt(6.0), np.array([5.0, -2.0, 1.0])
    first = first / np.linalg.norm(first)
    points = build_surface(shape, 8.0, {}).points[view.vertex_of] / 50.0
    phi, theta = np.radians(view.points).T
    assert np.cos(theta) == pytest.approx(points @ pole, abs=1e-9)
    assert np.sin(theta) * np.cos(phi) == pytest.approx(points @ first, abs=1e-9)
    assert np.sin(theta) * np.sin(phi) == pytest.approx(points @ np.cross(pole, first), abs=1e-9)


def test_unrolled_torus_and_atrium_put_every_vertex_at_its_angles():
    for surface, shape, axis in ((TORUS, Torus(), 0.0), (ATRIUM, Atrium(), -20.0)):
        view = unrolled_revolved(surface)
        points = surface.points[view.vertex_of]
        exact = shape.sheet(8.0).net(points, np.zeros(len(points), dtype=int))
        phi = np.arctan2(points[:, 1], points[:, 0] - axis)
        off = np.radians(view.points) - np.stack([phi, exact[:, 0]], axis=1)
        off -= 2 * np.pi * np.round(off / (2 * np.pi))
        # theta is carried from the triangles' middles to their corners: h^2 / r^2 / 24 = 1e-3
        assert np.abs(off[:, 0]).max() < 1e-9
        assert np.abs(off[:, 1]).max() < 4e-3


def test_the_map_of_a_torus_is_closed_both_ways():
    view = unrolled_revolved(TORUS)
    assert turned_over(view) == 0
    assert view.limits.tolist() == [[-180.0, 180.0], [-180.0, 180.0]]
    middles = view.points[view.triangles].mean(axis=1)
    once = ((middles >= -180.0) & (middles < 180.0)).all(axis=1)
    assert np.array_equal(np.sort(view.triangle_of[once]), np.arange(len(TORUS.triangles)))
    area = sum(abs(signed_area(view.points[one])) for one in view.triangles[once])
    # what is drawn inside once tiles a rectangle of 360 by 360 degrees
    assert area == pytest.approx(360.0**2, rel=1e-9)
    assert not has_vein(ATRIUM)
    assert len(flat_views(ATRIUM)) == 1


def test_outlines_enclose_exactly_the_region_with_its_holes():
    surface = square_surface(count=10, width=10.0)
    (view,) = flat_views(surface)
    x, y = surface.net.T
    ring = (np.abs(x - 5) < 4) & (np.abs(y - 5) < 4) & ~((np.abs(x - 5) < 1) & (np.abs(y - 5) < 1))
    loops = outlines(seen(view, ring))
    areas = sorted(signed_area(view.points[loop]) for loop in loops)
    assert areas == pytest.approx([-4.0, 64.0])


def test_outlines_of_regions_that_meet_in_a_corner():
    surface = square_surface(count=2, width=2.0)
    (view,) = flat_views(surface)
    x, y = surface.net.T
    corners = (x < 1) == (y < 1)
    loops = outlines(seen(view, corners))
    assert sum(signed_area(view.points[loop]) for loop in loops) == pytest.approx(2.0)
    assert outlines(seen(view, np.zeros(8, dtype=bool))) == []


@pytest.mark.parametrize(
    ("low", "high", "step"),
    [(0, 950, 100), (0, 700, 50), (3, 260, 25), (10, 12, 1), (0, 2400, 250)],
)
def test_isochrones_are_round_and_few(low, high, step):
    levels = isochrone_levels(np.array([np.nan, low, high, (low + high) / 2]))
    assert np.diff(levels) == pytest.approx(np.full(len(levels) - 1, step))
    assert (levels % step == 0).all()
    assert low < levels.min() <= low + step
    assert high - step <= levels.max() < high


def test_no_isochrones_where_nothing_was_activated():
    assert isochrone_levels(np.array([np.nan, np.nan])).size == 0
    assert isochrone_levels(np.array([3.0, 3.0])).size == 0


def test_names_stand_in_the_middle_and_apart():
    surface = square_surface(count=12, width=12.0)
    (view,) = flat_views(surface)
    block = (np.abs(surface.net - 6.0) < 4).all(axis=1)
    first = roomiest_spot(view, block, [])
    assert first == pytest.approx([6.0, 6.0], abs=0.5)
    second = roomiest_spot(view, block, [first])
    assert np.abs(second - 6.0).max() < 4
    assert (np.abs(second - first) > (1.5, 0.4)).any()


def test_a_site_on_the_seam_is_marked_on_both_sides_of_it():
    (view,) = flat_views(TORUS)
    away = np.linalg.norm(TORUS.points - (-150.0, 0.0, 0.0), axis=1)
    found = np.array(middles(view, np.exp(-((away / 20.0) ** 2))[view.vertex_of]))
    # theta = 0, phi = -180 and 180; a disc of radius 17 has some 20 vertices at edge 8
    assert np.sort(found[:, 0]) == pytest.approx([-180.0, 180.0], abs=3.0)
    assert found[:, 1] == pytest.approx([0.0, 0.0], abs=6.0)
