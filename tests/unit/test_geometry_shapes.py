"""The shapes' meshes against their formulas."""

import numpy as np
import pytest
from geometry_integrals import vein_whole

from cardiosurf.geometry import Plane, Sphere, Surface, TDomain, Vein, build_surface
from cardiosurf.geometry.t_domain import TDomainSheet


def lengths(surface: Surface, edge: str) -> float:
    ends = surface.points[surface.edges[edge]]
    return float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum())


def frame_of_vein(theta: np.ndarray, phi: np.ndarray, root: float, arc: float) -> np.ndarray:
    """Unit tangents by central differences of the parametrisation."""

    def place(t: np.ndarray, p: np.ndarray) -> np.ndarray:
        rho = root - arc * np.sin(t)
        return np.stack([arc * (1 - np.cos(t)), rho * np.sin(p), rho * np.cos(p)], axis=1)

    step = 1e-5
    along = place(theta + step, phi) - place(theta - step, phi)
    around = place(theta, phi + step) - place(theta, phi - step)
    both = np.stack([along, around], axis=1)
    return both / np.linalg.norm(both, axis=2, keepdims=True)


@pytest.fixture(scope="module")
def vein() -> Surface:
    return build_surface(Vein(root_radius=70, tip_radius=35, half_width=90), 5.0, {})


def test_a_plane_is_exact() -> None:
    plane = build_surface(Plane(x=(-3.0, 40.0), y=(7.0, 20.0)), 2.5, {})
    assert plane.areas().sum() == pytest.approx(43.0 * 13.0, rel=1e-12)
    assert np.array_equal(plane.points[:, 2], np.zeros(len(plane.points)))
    for edge, axis, value in (("left", 0, -3), ("right", 0, 40), ("bottom", 1, 7), ("top", 1, 20)):
        np.testing.assert_allclose(plane.points[plane.edges[edge]][..., axis], value, atol=1e-9)
    np.testing.assert_allclose(plane.net, plane.points[plane.triangles].mean(axis=1)[:, :2])
    np.testing.assert_array_equal(plane.frame, np.tile(np.eye(3)[:2], (len(plane.net), 1, 1)))


def test_vertices_of_a_vein_lie_on_the_torus_and_the_plane(vein: Surface) -> None:
    x, y, z = vein.points.T
    rho = np.hypot(y, z)
    inside = rho < 70.0 - 1e-9
    # the meridian is a circle of radius 35 about (x, rho) = (35, 70)
    np.testing.assert_allclose(np.hypot(x - 35.0, rho - 70.0)[inside], 35.0, atol=1e-9)
    np.testing.assert_allclose(x[~inside], 0.0, atol=1e-9)
    assert x.max() == pytest.approx(35.0, abs=1e-9)


def test_open_edges_of_a_vein(vein: Surface) -> None:
    assert set(vein.edges) == {"right", "left", "bottom", "top", "tip"}
    for edge, axis, value in (
        ("right", 1, 90),
        ("left", 1, -90),
        ("bottom", 2, -90),
        ("top", 2, 90),
    ):
        np.testing.assert_allclose(vein.points[vein.edges[edge]][..., axis], value, atol=1e-9)
        assert lengths(vein, edge) == pytest.approx(180.0)
    tip = vein.points[vein.edges["tip"]].reshape(-1, 3)
    np.testing.assert_allclose(np.hypot(tip[:, 1], tip[:, 2]), 35.0, atol=1e-9)
    np.testing.assert_allclose(tip[:, 0], 35.0, atol=1e-9)


def test_net_of_a_vein(vein: Surface) -> None:
    assert vein.parts == ("square", "vein")
    assert vein.axes == (("y", "z"), ("theta", "phi"))
    curved = vein.part_of == 1
    theta, phi = vein.net[curved].T
    centre = vein.points[vein.triangles[curved]].mean(axis=1)
    np.testing.assert_allclose(np.arctan2(centre[:, 1], centre[:, 2]), phi, atol=1e-9)
    assert theta.min() > 0.0
    assert theta.max() < np.pi / 2
    exact = frame_of_vein(theta, phi, 70.0, 35.0)
    # chords of 5 su on radii of 35 lean by up to about 5 / 35 / sqrt 3 from the tangent plane
    assert np.abs(vein.frame[curved] - exact).max() < 0.1
    flat = vein.frame[~curved]
    np.testing.assert_allclose(flat, np.tile(np.eye(3)[1:], (len(flat), 1, 1)), atol=1e-12)


def test_frame_of_the_sphere_points_south_and_east() -> None:
    sphere = build_surface(Sphere(radius=20.0), 2.0, {})
    theta, phi = sphere.net.T
    south = np.stack(
        [np.cos(theta) * np.cos(phi), np.cos(theta) * np.sin(phi), -np.sin(theta)], axis=1
    )
    east = np.stack([-np.sin(phi), np.cos(phi), np.zeros_like(phi)], axis=1)
    # next to the poles a triangle's plane leans by its size over the radius
    assert np.einsum("mk,mk->m", sphere.frame[:, 0], south).min() > 0.99
    assert np.einsum("mk,mk->m", sphere.frame[:, 1], east).min() > 0.99


def test_area_of_the_sphere_converges_with_slope_2() -> None:
    edges = np.array([5.0, 2.5])
    exact = 4.0 * np.pi * 2500.0
    surfaces = [build_surface(Sphere(), h, {}) for h in edges]
    missing = [1.0 - surface.areas().sum() / exact for surface in surfaces]
    assert np.log2(missing[0] / missing[1]) == pytest.approx(2.0, abs=0.05)
    # an equilateral triangle of edge h in a sphere of radius R loses 5/24 h^2 / R^2: 1/8 by the
    # spherical excess, 1/12 by chords; uneven triangles lose 1 % more of it
    squares = [surface.areas().mean() * 4.0 / np.sqrt(3.0) for surface in surfaces]
    np.testing.assert_allclose(missing, 5.0 / 24.0 * np.array(squares) / 2500.0, rtol=0.03)


def test_area_of_a_vein_converges_with_slope_2() -> None:
    exact = 180.0**2 - np.pi * 4900.0 + vein_whole(70.0, 35.0)
    shape = Vein(root_radius=70, tip_radius=35, half_width=90)
    off = [abs(build_surface(shape, h, {}).areas().sum() - exact) for h in (10.0, 5.0)]
    assert np.log2(off[0] / off[1]) == pytest.approx(2.0, abs=0.5)
    assert off[1] / exact < 1e-3


@pytest.mark.parametrize("root", [70.0, 105.0])
def test_t_domain_has_all_its_edges(root: float) -> None:
    surface = build_surface(TDomain(root_radius=root), 5.0, {})
    assert set(surface.edges) == {"right", "left", "bottom", "top", "tip", "inner"}
    assert lengths(surface, "right") == pytest.approx(300.0)
    assert lengths(surface, "left") == pytest.approx(140.0)
    assert lengths(surface, "tip") == pytest.approx(2 * np.pi * 35.0, rel=5e-3)
    # the sides: 150 on the right; on the left from y = -150 to the cusp, or to the circle
    stop = np.sqrt(root**2 - 67.0**2) if root == 70.0 else np.sqrt(root**2 - 70.0**2)
    assert lengths(surface, "top") == pytest.approx(150.0 + 150.0 - stop)
    assert lengths(surface, "bottom") == pytest.approx(lengths(surface, "top"))


def test_cusp_of_the_t_domain_vanishes_with_the_edge_length() -> None:
    # the sides touch the circle; what is cut off there is 2/3 w sqrt(2 w root) to leading order,
    # and the chords of the root circle give the flat parts pi h^2 / 6 back
    exact = 300.0 * 150.0 + 140.0 * 150.0 - np.pi * 4900.0
    for edge in (10.0, 5.0):
        surface = build_surface(TDomain(), edge, {})
        lost = exact - surface.areas()[surface.part_of != 0].sum()
        cusps = 2.0 / 3.0 * 0.6 * edge * np.sqrt(140.0 * 0.6 * edge)
        assert lost == pytest.approx(cusps - np.pi * edge**2 / 6.0, rel=0.15)


def test_wide_left_rectangles_have_no_cusp() -> None:
    sheet = TDomain(left_half_width=90.0).sheet(2.5)
    assert isinstance(sheet, TDomainSheet)
    assert sheet.cusp is None
    whole = build_surface(TDomain(left_half_width=150.0), 10.0, {})
    assert "inner" not in whole.edges


def test_vertex_areas_sum_to_the_area(vein: Surface) -> None:
    assert vein.vertex_areas().shape == (len(vein.points),)
    assert vein.vertex_areas().sum() == pytest.approx(vein.areas().sum(), rel=1e-12)
    assert vein.vertex_areas().min() > 0.0


def test_same_input_same_mesh(vein: Surface) -> None:
    again = build_surface(Vein(root_radius=70, tip_radius=35, half_width=90), 5.0, {})
    np.testing.assert_array_equal(again.points, vein.points)
    np.testing.assert_array_equal(again.triangles, vein.triangles)
