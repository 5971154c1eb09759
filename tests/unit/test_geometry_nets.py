"""Nets against the paper: Appendix E, Lemma D and where they hold."""

import numpy as np
import pytest
import sympy as sp
from symbolic_jets import SymbolicNet, X, Y, evaluated, jet_of

from cardiosurf.geometry.nets import (
    FlatNet,
    christoffel,
    gaussian_curvature,
    lemma_d_sides,
    mean_curvature,
    nets_of,
    vein_net,
)
from cardiosurf.geometry.sphere import Sphere
from cardiosurf.geometry.torus import Torus

ARC, TIP = 70, 35
PLACES = np.array([[0.0, 0.3], [0.4, -2.0], [np.pi / 4, 1.0], [1.2, 2.5], [np.pi / 2, 0.0]])


def vein_symbols():
    """Return what Appendix E gives, from its parametrisation, with theta = x and phi = y."""
    q = ARC * (1 - sp.sin(X)) + TIP
    place = sp.Matrix([ARC * (1 - sp.cos(X)), q * sp.sin(Y), q * sp.cos(Y)])
    return q, place.diff(X), place.diff(Y)


def test_appendix_e_metric():
    q, along_theta, along_phi = vein_symbols()
    assert sp.simplify(along_theta.dot(along_theta)) == ARC**2
    assert sp.simplify(along_phi.dot(along_phi) - q**2) == 0
    assert sp.simplify(along_theta.dot(along_phi)) == 0
    first, second = vein_net(ARC + TIP, TIP).metric(PLACES)
    np.testing.assert_allclose(first.value, ARC**2, rtol=1e-15)
    wanted = jet_of(q**2, PLACES)
    np.testing.assert_allclose(second.value, wanted.value, rtol=1e-14)
    np.testing.assert_allclose(second.first, wanted.first, rtol=1e-13, atol=1e-10)
    np.testing.assert_allclose(second.second, wanted.second, rtol=1e-13, atol=1e-10)


def test_appendix_e_symbols():
    ratio = sp.Rational(TIP, ARC)
    found = christoffel(vein_net(ARC + TIP, TIP), PLACES)
    up = evaluated(sp.cos(X) * (1 - sp.sin(X) + ratio), PLACES)
    across = evaluated(-sp.cos(X) / (1 - sp.sin(X) + ratio), PLACES)
    # cos(pi/2) is 6e-17, on either side
    np.testing.assert_allclose(found[:, 0, 1, 1], up, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(found[:, 1, 0, 1], across, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(found[:, 1, 1, 0], across, rtol=1e-13, atol=1e-15)
    others = found.copy()
    others[:, 0, 1, 1] = others[:, 1, 0, 1] = others[:, 1, 1, 0] = 0.0
    assert not others.any()


def test_appendix_e_slips_in_one_derivative():
    q, _, _ = vein_symbols()
    ratio = sp.Rational(TIP, ARC)
    inverse = 1 / sp.Integer(ARC) ** 2
    symbol = -sp.cos(X) / (1 - sp.sin(X) + ratio)
    # printed last line: right
    assert sp.simplify(sp.diff(1 / q**2, X) - 2 * ARC * sp.cos(X) / q**3) == 0
    # printed: (1 - sin theta (r/R)) / q^2, its square lost; what it is:
    derived = -(1 - sp.sin(X) * (1 + ratio)) / q**2
    assert sp.simplify(sp.diff(inverse * symbol, X) - derived) == 0
    printed = (1 - sp.sin(X) * ratio) / q**2
    assert sp.simplify(sp.diff(inverse * symbol, X) - printed) != 0
    # at the root only the sign differs, at the tip sin theta (1 + r/R) - 1 = r/R against 1 - r/R
    assert sp.simplify((printed + derived).subs(X, 0)) == 0


def test_sphere_whose_pole_is_the_place():
    (net,) = nets_of(Sphere(radius=50.0)).values()
    places = np.array([[0.0, 0.0], [0.5, 1.0], [np.pi / 2, -2.0], [np.pi, 0.0]])
    _, second = net.metric(places)
    np.testing.assert_allclose(second.value, (50 * np.sin(places[:, 0])) ** 2, atol=1e-11)
    # cot theta is not defined at the poles, the curvatures of a sphere are
    between = places[1:3]
    np.testing.assert_allclose(
        christoffel(net, between)[:, 1, 0, 1], 1 / np.tan(between[:, 0]), atol=1e-15
    )
    np.testing.assert_allclose(mean_curvature(net, between), -1 / 50, rtol=1e-13)
    np.testing.assert_allclose(gaussian_curvature(net, between), 1 / 2500, rtol=1e-13)


def test_torus_is_saddle_shaped_inside():
    (net,) = nets_of(Torus(ring_radius=100.0, tube_radius=50.0)).values()
    theta = np.linspace(-3.1, 3.1, 9)
    places = np.stack([theta, theta], axis=1)
    wanted = np.cos(theta) / (50 * (100 + 50 * np.cos(theta)))
    np.testing.assert_allclose(gaussian_curvature(net, places), wanted, rtol=1e-10, atol=1e-18)
    # e_theta x e_phi points into the tube, and the tube bends towards its inside
    bent = 0.5 * (1 / 50 + np.cos(theta) / (100 + 50 * np.cos(theta)))
    np.testing.assert_allclose(mean_curvature(net, places), bent, rtol=1e-12)


# metrics without any symmetry, with a Killing direction, and flat ones
ORTHOGONAL = {
    "height on a sphere": SymbolicNet(25 / (25 - X**2), 25 - X**2),
    "polar with r = x^2": SymbolicNet(4 * X**2, X**4),
    "elliptic coordinates": SymbolicNet(
        sp.sinh(X) ** 2 + sp.sin(Y) ** 2, sp.sinh(X) ** 2 + sp.sin(Y) ** 2
    ),
    "none": SymbolicNet(sp.exp(X * Y) + 1, 2 + sp.sin(X + Y)),
}
INSIDE = np.array([[0.5, 0.7], [1.3, -0.4], [2.1, 1.9]])


@pytest.mark.parametrize("name", ORTHOGONAL)
@pytest.mark.parametrize("k", [0, 1])
def test_the_identity_before_lemma_d_holds_on_every_orthogonal_net(name, k):
    left, right, missing = lemma_d_sides(ORTHOGONAL[name], INSIDE, k)
    np.testing.assert_allclose(left, right + missing, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("name", ["height on a sphere", "polar with r = x^2"])
def test_a_killing_direction_is_not_enough_for_lemma_d(name):
    net = ORTHOGONAL[name]
    # x^2 is the Killing direction of both: nothing depends on it
    assert not any(g.first[1].any() for g in net.metric(INSIDE))
    left, right, missing = lemma_d_sides(net, INSIDE, 0)
    assert np.abs(left - right).min() > 0.01
    np.testing.assert_allclose(left - right, missing, rtol=1e-12)


def test_lemma_d_on_a_sphere_by_height():
    # x = z: g_11 = R^2 / (R^2 - z^2), g_22 = R^2 - z^2: left -2 z / R^2, right -z / R^2
    left, right, _ = lemma_d_sides(ORTHOGONAL["height on a sphere"], INSIDE, 0)
    np.testing.assert_allclose(left, -2 * INSIDE[:, 0] / 25, rtol=1e-13)
    np.testing.assert_allclose(right, -INSIDE[:, 0] / 25, rtol=1e-13)


def test_the_plane_has_nothing():
    assert not christoffel(FlatNet(), INSIDE).any()
    assert not gaussian_curvature(FlatNet(), INSIDE).any()
    assert not mean_curvature(FlatNet(), INSIDE).any()
