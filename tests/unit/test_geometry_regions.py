"""A region's triangles have its exact area: 0.1 % at edge length 2.5, the promise of the mesher."""

import numpy as np
import pytest
from geometry_integrals import arc_above, meshed, square_area, vein_area
from region_words import ball, box, half_space, polar

from cardiosurf.errors import NumericalError
from cardiosurf.geometry import Plane, Sphere, Surface, TDomain, Vein, build_surface
from cardiosurf.geometry.quality import quality
from cardiosurf.geometry.regions import (
    All,
    AnyOf,
    Ball,
    BallLimits,
    Not,
    Part,
)

EDGE = 2.5
PI = np.pi
ROOT, TIP, HALF = 70.0, 35.0, 80.0


@pytest.fixture(scope="module")
def plane() -> Surface:
    return build_surface(
        Plane(),
        EDGE,
        {
            "block": box(x=(-50, 50), y=(-50, 50)),
            "shares_a_face": box(x=(50, 80), y=(-60, 60)),
            "same_face_again": half_space((2.0, 0.0, 0.0), 50.0),
            "wider_than_the_plane": box(x=(-500, 500), y=(70, 500)),
            "tilted": half_space((1.0, 2.0, 0.0), 40.0),
            "disc": ball((-60.0, -60.0, 0.0), 7.0),
            "slice_of_a_ball": ball((20.0, 0.0, 12.0), 20.0),
            "frame": All((box(x=(-50, 50), y=(-50, 50)), Not(box(x=(-40, 40), y=(-40, 40))))),
            "either": AnyOf((box(x=(-90, -70)), ball((-70.0, 40.0, 0.0), 15.0))),
            "thin": box(x=(-95, 95), y=(-90, -89)),
            "small": ball((85.0, -70.0, 0.0), 0.5),
        },
    )


def test_plane_regions_have_their_exact_areas(plane: Surface) -> None:
    # the half plane x + 2 y >= 40 sqrt 5: the line enters at y = (40 sqrt 5 - x) / 2
    cut = 40.0 * np.sqrt(5.0)
    exact = {
        "block": 10000.0,
        "shares_a_face": 30.0 * 120.0,
        "same_face_again": 50.0 * 200.0,
        "wider_than_the_plane": 30.0 * 200.0,
        "tilted": 200.0 * 100.0 - 0.5 * 200.0 * cut,
        "disc": PI * 49.0,
        "slice_of_a_ball": PI * (400.0 - 144.0),
        "frame": 10000.0 - 6400.0,
        "either": 20.0 * 200.0 + 0.5 * PI * 225.0,
        "thin": 190.0,
        "small": PI * 0.25,
    }
    for name, area in exact.items():
        assert meshed(plane, name) == pytest.approx(area, rel=1e-3), name


def test_straight_edges_on_the_plane_are_exact(plane: Surface) -> None:
    # polygons are cut along their very edges, so only rounding is left
    for name, area in {"block": 10000.0, "frame": 3600.0, "thin": 190.0}.items():
        assert meshed(plane, name) == pytest.approx(area, rel=1e-12), name


def test_crossing_regions_leave_good_triangles(plane: Surface) -> None:
    assert quality(plane).smallest_angle >= 20.0


@pytest.fixture(scope="module")
def vein() -> Surface:
    return build_surface(
        Vein(root_radius=ROOT, tip_radius=TIP, half_width=HALF),
        EDGE,
        {
            "vein": Part("vein"),
            "square": Part("square"),
            "ring": polar(theta=(0.4, 1.0)),
            "across_pi": polar(theta=(0.2, 0.9), phi=(PI - 0.4, PI + 0.6)),
            "from_root_to_tip": polar(theta=(0.0, PI / 2), phi=(-0.3, 0.5)),
            "nearly_to_the_tip": polar(theta=(0.0, 1.5707), phi=(-0.3, 0.5)),
            "strip": All((Part("vein"), box(x=(0, 30), y=(-20, 0)))),
            "climbed": box(x=(20.0, 500.0)),
            "ball_across_the_root": ball((0.0, 0.0, -70.0), 25.0),
            "tilted": half_space((0.5, 1.0, 0.4), 45.0),
        },
    )


def vein_regions() -> dict[str, float]:
    arc = ROOT - TIP

    def patch(theta: tuple[float, float], phi: float) -> float:
        span = ROOT * (theta[1] - theta[0]) + arc * (np.cos(theta[1]) - np.cos(theta[0]))
        return arc * phi * span

    def in_ball(x: float, rho: float) -> float:
        # abs(p - c)^2 = x^2 + rho^2 + 70^2 - 2 rho 70 cos(angle from the centre's meridian)
        return arc_above((x**2 + rho**2 + 70.0**2 - 25.0**2) / (2.0 * rho * 70.0))

    size = np.sqrt(0.25 + 1.0 + 0.16)

    def tilted(x: float, rho: float) -> float:
        return arc_above((45.0 * size - 0.5 * x) / (rho * np.hypot(1.0, 0.4)))

    def disc(y: float) -> tuple[float, float]:
        reach = np.sqrt(max(625.0 - y**2, 0.0))
        return -70.0 - reach, -70.0 + reach

    top = float(np.arccos(1.0 - 30.0 / arc))
    return {
        "vein": patch((0.0, PI / 2), 2.0 * PI),
        "square": 4.0 * HALF**2 - PI * ROOT**2,
        "ring": patch((0.4, 1.0), 2.0 * PI),
        "across_pi": patch((0.2, 0.9), 1.0),
        "from_root_to_tip": patch((0.0, PI / 2), 0.8),
        "nearly_to_the_tip": patch((0.0, PI / 2), 0.8),
        "strip": vein_area(ROOT, TIP, lambda _, rho: 2.0 * np.arcsin(20.0 / rho), (0.0, top)),
        "climbed": patch((float(np.arccos(1.0 - 20.0 / arc)), PI / 2), 2.0 * PI),
        "ball_across_the_root": vein_area(ROOT, TIP, in_ball) + square_area(HALF, ROOT, disc),
        "tilted": vein_area(ROOT, TIP, tilted)
        + square_area(HALF, ROOT, lambda y: ((45.0 * size - y) / 0.4, np.inf)),
    }


def test_vein_regions_have_their_exact_areas(vein: Surface) -> None:
    for name, area in vein_regions().items():
        assert meshed(vein, name) == pytest.approx(area, rel=1e-3), name


def test_the_root_circle_is_made_of_mesh_edges(vein: Surface) -> None:
    # vertices shared by both parts lie on the circle x = 0, hypot(y, z) = root
    shared = np.intersect1d(*(vein.triangles[vein.part_of == part] for part in (0, 1)))
    assert len(shared) > 2.0 * PI * ROOT / (1.5 * EDGE)
    np.testing.assert_allclose(np.hypot(*vein.points[shared, 1:].T), ROOT, atol=1e-9)
    np.testing.assert_allclose(vein.points[shared, 0], 0.0, atol=1e-9)


@pytest.fixture(scope="module")
def t_domain() -> Surface:
    return build_surface(
        TDomain(),
        EDGE,
        {
            "strip": All((Part("vein"), box(x=(0, 60), y=(-30, 0)))),
            "left": All((Part("left_rectangle"), box(y=(-150, -110)))),
            "flat": box(x=(0.0, 0.0)),
            "not_flat": Not(box(x=(-1.0, 0.0))),
        },
    )


def test_t_domain_regions_have_their_exact_areas(t_domain: Surface) -> None:
    def strip(_: float, rho: float) -> float:
        return 2.0 * np.arcsin(min(1.0, 30.0 / rho))

    vein = 2.0 * PI * 35.0 * (70.0 * PI / 2 - 35.0)
    # the flat parts lose the two cusps, 2/3 w sqrt(2 w root) with w = 0.6 edge lengths
    width = 0.6 * EDGE
    cusps = 2.0 / 3.0 * width * np.sqrt(2.0 * width * 70.0)
    exact = {
        "strip": vein_area(70.0, 35.0, strip),
        "left": 40.0 * 140.0,
        "flat": 300.0 * 150.0 + 140.0 * 150.0 - PI * 70.0**2 - cusps,
        "not_flat": vein,
    }
    for name, area in exact.items():
        assert meshed(t_domain, name) == pytest.approx(area, rel=1e-3), name


@pytest.fixture(scope="module")
def sphere() -> Surface:
    return build_surface(
        Sphere(),
        EDGE,
        {
            "block": polar(theta=(PI / 4, 3 * PI / 4), phi=(-PI / 4, PI / 4)),
            "south": polar(theta=(3 * PI / 4, PI)),
            "across_pi": polar(phi=(2.8, 3.6)),
            "all_round": polar(theta=(0, PI), phi=(0, 2 * PI)),
            "octant": box(x=(0, 60), y=(0, 60), z=(0, 60)),
            "zone": box(z=(-20.0, -15.0)),
            "cap": half_space((1.0, -2.0, 2.0), 40.0),
            "ball": ball((0.0, 30.0, -40.0), 9.0),
            "small": ball((0.0, -30.0, 40.0), 0.5),
        },
    )


def test_sphere_regions_have_their_exact_areas(sphere: Surface) -> None:
    # a ball of radius r about a point of the sphere holds the area pi r^2, whatever the sphere
    exact = {
        "block": 2500.0 * PI / 2 * np.sqrt(2.0),
        "south": 2.0 * PI * 2500.0 * (1.0 - np.sqrt(0.5)),
        "across_pi": 2.0 * 2500.0 * 0.8,
        "all_round": 4.0 * PI * 2500.0,
        "octant": 0.5 * PI * 2500.0,
        "zone": 2.0 * PI * 50.0 * 5.0,
        "cap": 2.0 * PI * 50.0 * 10.0,
        "ball": PI * 81.0,
        "small": PI * 0.25,
    }
    for name, area in exact.items():
        assert meshed(sphere, name) == pytest.approx(area, rel=1e-3), name


def test_balanced_chords_stay_near_the_edge_of_the_region(sphere: Surface) -> None:
    # points stand out by kappa l^2 / 12 where the edge has curvature kappa and length l <= 1.5 EDGE
    inside = sphere.triangles[sphere.regions["ball"]]
    outside = sphere.triangles[~sphere.regions["ball"]]
    rim = np.intersect1d(inside, outside)
    away = np.linalg.norm(sphere.points[rim] - [0.0, 30.0, -40.0], axis=1) - 9.0
    assert np.abs(away).max() < (1.5 * EDGE) ** 2 / (12.0 * 9.0)
    np.testing.assert_allclose(np.linalg.norm(sphere.points[rim], axis=1), 50.0, atol=1e-9)


def test_a_region_given_twice_changes_nothing() -> None:
    once = build_surface(Plane(), 10.0, {"a": box(x=(-20, 30))})
    twice = build_surface(Plane(), 10.0, {"a": box(x=(-20, 30)), "b": box(x=(-20, 30))})
    np.testing.assert_array_equal(once.points, twice.points)
    np.testing.assert_array_equal(twice.regions["a"], twice.regions["b"])


def test_an_edge_that_grazes_the_root_circle_ends_with_an_error():
    # the ball's edge meets the circle at a hundredth of a radian
    grazing = Ball(BallLimits((22.357019409086966, 0.6026926481065331, 0.0), 29.606345920952062))
    shape = Vein(root_radius=20.0, tip_radius=10.0, half_width=30.0)
    with pytest.raises(NumericalError, match="graze"):
        build_surface(shape, 9.011287957509994, {"spot": grazing})
