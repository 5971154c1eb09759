"""Geodesics of the nets, against great circles, straight lines and Clairaut's quadrature."""

import numpy as np
import pytest
import scipy

from cardiosurf.errors import InputError
from cardiosurf.geometry.geodesics import StretchedNet, circle_curvature, clairaut, geodesic
from cardiosurf.geometry.nets import FlatNet, nets_of, vein_net
from cardiosurf.geometry.sphere import Sphere
from cardiosurf.geometry.torus import Torus

ROOT, TIP = 70.0, 35.0
ARC = ROOT - TIP
RIM = 0.5 * np.pi
VEIN = vein_net(ROOT, TIP)
# what an integration to 1e-12 a step keeps over a few hundred su
KEPT = 1e-10


def radius(theta):
    return ROOT - ARC * np.sin(theta)


def test_lines_of_a_flat_net_are_straight():
    line = geodesic(FlatNet(), (1.0, 2.0), 0.3, 50.0)
    expected = np.array([1.0, 2.0]) + line.arclength[:, None] * [np.cos(0.3), np.sin(0.3)]
    np.testing.assert_allclose(line.places, expected, rtol=0, atol=KEPT)


def test_geodesics_of_the_sphere_are_great_circles():
    (net,) = nets_of(Sphere(radius=50.0)).values()
    line = geodesic(net, (1.0, 0.4), 2.0, 150.0)
    theta, phi = line.places.T
    points = np.stack(
        [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=1
    )
    east = np.array([-np.sin(0.4), np.cos(0.4), 0.0])
    south = np.cross(east, points[0])
    away = np.cos(2.0) * south + np.sin(2.0) * east
    turn = line.arclength[:, None] / 50.0
    expected = points[0] * np.cos(turn) + away * np.sin(turn)
    np.testing.assert_allclose(points, expected, rtol=0, atol=KEPT)


@pytest.mark.parametrize("tip", [14.0, 35.0, 60.0])
def test_circles_of_the_vein_are_geodesics_at_the_tip_only(tip):
    theta = np.linspace(0.0, RIM, 181)
    curvature = circle_curvature(vein_net(ROOT, tip), theta)
    expected = -np.cos(theta) / (ROOT - (ROOT - tip) * np.sin(theta))
    np.testing.assert_allclose(curvature, expected, rtol=1e-12, atol=1e-16)
    # bent towards the tip everywhere else
    assert (curvature[:-1] < 0).all()
    assert abs(curvature[-1]) < 1e-16


def test_the_torus_has_two_circles_that_are_geodesics():
    (net,) = nets_of(Torus(tube_radius=30.0, ring_radius=60.0)).values()
    theta = np.array([0.0, 0.5, RIM, 2.0, np.pi])
    expected = -np.sin(theta) / (60.0 + 30.0 * np.cos(theta))
    np.testing.assert_allclose(circle_curvature(net, theta), expected, rtol=1e-12, atol=1e-16)


@pytest.mark.parametrize("factors", [(8.0, 1.0), (1.0, 8.0), (4.0, 4.0)])
def test_even_anisotropy_makes_no_other_circle_a_geodesic(factors):
    theta = np.linspace(0.0, RIM, 31)
    waves = circle_curvature(StretchedNet(VEIN, factors), theta)
    # in the wave's own metric g_11 / s_1 the curvature is sqrt(s_1) times that of the surface
    expected = np.sqrt(factors[0]) * circle_curvature(VEIN, theta)
    np.testing.assert_allclose(waves, expected, rtol=1e-12, atol=1e-16)


@pytest.mark.parametrize("theta", [0.3, 0.8, 1.2, 1.5])
def test_a_geodesic_along_a_circle_leaves_it_towards_the_root(theta):
    line = geodesic(VEIN, (theta, 0.0), RIM, 300.0, within=(0.0, RIM))
    assert (np.diff(line.places[:, 0]) < 0).all()
    # to second order by kappa s²/2: dtheta = -cos(theta) s² / (2 A rho)
    first = geodesic(VEIN, (theta, 0.0), RIM, 0.1)
    drop = -np.cos(theta) * first.arclength[1:] ** 2 / (2 * ARC * radius(theta))
    # what is left is of order (s/A)²
    np.testing.assert_allclose(first.places[1:, 0] - theta, drop, rtol=1e-3, atol=1e-13)
    assert line.places[-1, 0] == pytest.approx(0.0, abs=1e-10)


@pytest.mark.parametrize("angle", [0.4, 1.0, RIM, 2.2])
@pytest.mark.parametrize("factors", [(1.0, 1.0), (8.0, 1.0)])
def test_clairauts_relation_and_the_speed_are_kept(angle, factors):
    net = StretchedNet(VEIN, factors)
    line = geodesic(net, (0.9, 0.0), angle, 150.0, within=(0.0, RIM))
    moment = clairaut(net, line)
    np.testing.assert_allclose(moment, moment[0], rtol=1e-8)
    g11, g22 = net.metric(line.places)
    speed = g11.value * line.velocity[:, 0] ** 2 + g22.value * line.velocity[:, 1] ** 2
    np.testing.assert_allclose(speed, 1.0, rtol=1e-8)
    # g_22 dphi/ds at the start is sqrt(g_22) sin(angle)
    assert moment[0] == pytest.approx(radius(0.9) / np.sqrt(factors[1]) * np.sin(angle), rel=1e-12)


@pytest.mark.parametrize("theta", [0.5, 1.0, 1.4])
def test_the_angle_swept_down_to_the_root_is_clairauts_integral(theta):
    line = geodesic(VEIN, (theta, 0.0), RIM, 400.0, within=(0.0, RIM))
    c = radius(theta)

    # dphi = c A dt / (rho sqrt(rho² - c²)), with t = theta - w² to take the root out
    def swept(w):
        rho = radius(theta - w**2)
        return 2 * w * c * ARC / (rho * np.sqrt(rho**2 - c**2))

    expected, _ = scipy.integrate.quad(swept, 1e-9, np.sqrt(theta), epsabs=1e-12, epsrel=1e-12)
    # rho² - c² loses digits near w = 0
    assert line.places[-1, 1] == pytest.approx(expected, abs=1e-6)


def test_the_tips_circle_is_a_geodesic_that_others_leave_exponentially():
    along = geodesic(VEIN, (RIM, 0.0), RIM, TIP * np.pi)
    np.testing.assert_allclose(along.places[:, 0], RIM, atol=1e-12)
    assert along.places[-1, 1] == pytest.approx(np.pi, abs=KEPT)
    # Jacobi: the distance grows like cosh(s sqrt(-K)), K = -1/(A tip) at the tip
    near = geodesic(VEIN, (RIM - 1e-5, 0.0), RIM, 60.0)
    grown = (RIM - near.places[:, 0]) / 1e-5
    np.testing.assert_allclose(grown, np.cosh(near.arclength / np.sqrt(ARC * TIP)), rtol=1e-4)


def test_a_start_outside_is_refused():
    with pytest.raises(InputError, match="not within the range"):
        geodesic(VEIN, (2.0, 0.0), 0.0, 1.0, within=(0.0, RIM))
