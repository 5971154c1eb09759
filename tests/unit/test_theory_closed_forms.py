"""The paper's closed forms: derived from its definition, met by the general code, or a slip shown.

Every test has the printed expression, sympy's derivation of the same from the definition
(symbolic_acceleration.py), and cardiosurf's numbers at some places, equal to rounding.
"""

import numpy as np
import pytest
import sympy as sp
from symbolic_acceleration import derived, zero
from symbolic_jets import SymbolicNet, X, Y, evaluated, jet_of

from cardiosurf.analysis.relative_acceleration import (
    Front,
    diffusivity,
    front,
    gravitational,
    gravitational_as_printed,
    relative_acceleration,
    ricci_type,
)
from cardiosurf.analysis.smoothed_patches import SmoothedPatch, smoothed_factors
from cardiosurf.geometry.jets import constant
from cardiosurf.geometry.nets import FlatNet, gaussian_curvature, nets_of, vein_net
from cardiosurf.geometry.sphere import Sphere
from cardiosurf.geometry.torus import Torus

ONE = sp.Integer(1)
HALF = sp.Rational(1, 2)
S = sp.Function("s", positive=True)(X, Y)
SAMPLE = 3 + sp.sin(X) * sp.cos(2 * Y) + X * Y**2 / 5
"""Some anisotropy, above 0 at the places."""
PLACES = np.array([[0.3, 0.2], [0.9, -0.7], [1.3, 1.1], [0.6, 0.5]])
RADIUS, RING, TUBE = 50, 100, 50
NORTH = (0, 1)


def found(net, factors, covector, along):
    """Return cardiosurf's terms for sympy's factors, covector and direction."""
    count = len(PLACES)
    jets = tuple(jet_of(sp.sympify(one), PLACES) for one in factors)
    held = tuple(constant(float(one), count) for one in covector)
    towards = tuple(evaluated(one, PLACES) for one in along)
    tensor = diffusivity(net, PLACES, jets)
    return relative_acceleration(net, PLACES, tensor, Front(held, towards))


def assert_equal(numbers, terms, **substituted):
    """Compare cardiosurf's terms with symbolic ones, to rounding of the largest."""
    for name in ("velocity", "change", "spread"):
        expression = getattr(terms, name)
        known = {one: substituted.get(one.name, one) for one in expression.free_symbols}
        wanted = evaluated(expression.subs(known).doit(), PLACES)
        scale = max(1e-300, np.abs(wanted).max())
        np.testing.assert_allclose(
            getattr(numbers, f"of_{name}"), wanted, rtol=1e-11, atol=1e-12 * scale
        )


def sampled(terms):
    """Return the terms with the sample in the place of the unknown anisotropy."""
    return type(terms)(
        *(one.subs(S, SAMPLE).doit() for one in (terms.velocity, terms.change, terms.spread))
    )


def test_relplane1():
    terms = derived((ONE, ONE), (S, ONE), (1, 0), NORTH)
    assert zero(terms.change - sp.diff(sp.log(S), Y))
    assert zero(terms.velocity - sp.diff(S, X, Y) / S)
    assert_equal(found(FlatNet(), (SAMPLE, ONE), (1, 0), NORTH), sampled(terms))


def test_relplane2_holds_for_d_xx_of_s_cos_theta_but_for_one_factor():
    magnitude = sp.Symbol("m", positive=True)
    turn = sp.Function("a")(X, Y)
    terms = derived((ONE, ONE), (magnitude * sp.cos(turn), ONE), (1, 0), NORTH)
    printed_velocity = -sp.diff(turn, X) * sp.diff(turn, Y) - sp.tan(turn) * sp.diff(turn, X, Y)
    printed_change = -magnitude * sp.tan(turn) * sp.diff(turn, Y)
    assert zero(terms.velocity - printed_velocity)
    # the slip: a logarithm's derivative does not contain the magnitude
    assert zero(magnitude * terms.change - printed_change)
    fibre = X / 3 + Y**2 / 4
    numbers = found(FlatNet(), (8 * sp.cos(fibre), ONE), (1, 0), NORTH)
    assert_equal(
        numbers,
        type(terms)(
            *(
                one.subs({magnitude: 8}).subs(turn, fibre).doit()
                for one in (terms.velocity, terms.change, terms.spread)
            )
        ),
    )


def test_oblique_fibres_as_a_tensor():
    # d^xx = s cos^2 + sin^2 and d^xy = (s - 1) sin cos, which relplane2 leaves out
    fibre, ratio = X / 3 + Y**2 / 4, 8
    xx = ratio * sp.cos(fibre) ** 2 + sp.sin(fibre) ** 2
    xy = (ratio - 1) * sp.sin(fibre) * sp.cos(fibre)
    divergence = sp.diff(xx, X) + sp.diff(xy, Y)
    count = len(PLACES)
    net, turn = FlatNet(), jet_of(fibre, PLACES)
    factors = constant(float(ratio), count), constant(1.0, count)
    wave = front(net, PLACES, 0.0)
    numbers = relative_acceleration(net, PLACES, diffusivity(net, PLACES, factors, turn), wave)
    for name, wanted in (
        ("of_velocity", sp.diff(divergence, Y) / xx),
        ("of_change", sp.diff(xx, Y) / xx),
        ("of_spread", divergence / xx),
    ):
        np.testing.assert_allclose(
            getattr(numbers, name), evaluated(wanted, PLACES), rtol=1e-12, atol=1e-14
        )


def sphere():
    return sp.Integer(RADIUS), RADIUS * sp.sin(X)


def test_relaccsphere():
    terms = derived(sphere(), (S, ONE), (1, 0), NORTH)
    assert zero(terms.change - sp.diff(sp.log(S), Y))
    printed = sp.diff(S, X, Y) / S + sp.diff(sp.log(S), Y) * sp.cot(X)
    assert zero(terms.velocity - printed)
    (net,) = nets_of(Sphere(radius=RADIUS)).values()
    assert_equal(found(net, (SAMPLE, ONE), (1, 0), NORTH), sampled(terms))


def torus():
    q = RING + TUBE * sp.cos(X)
    return q, (sp.Integer(TUBE), q)


def test_relacctorus1_has_lost_symbols():
    eta, theta_n = sp.symbols("eta theta_n", real=True)
    q, scales = torus()
    covector = (sp.cos(eta), sp.sin(eta))
    terms = derived(scales, (ONE, ONE), covector, (theta_n, 0))
    weight = q / (covector[0] ** 2 * q**2 + covector[1] ** 2 * TUBE**2)
    # printed: weight [cos a (R cos + r)/q v - cos a sin dv/dlambda]
    velocity = weight * sp.cos(eta) * (RING * sp.cos(X) + TUBE) / q
    other = -weight * sp.cos(eta) * sp.sin(X)
    # its first term: the factor r and -d theta / d n are lost, a is eta
    assert zero(terms.velocity + TUBE * theta_n * velocity)
    # its second multiplies dv/dn, not dv/dlambda, and has lost r too
    assert zero(terms.spread - TUBE * other)
    # what multiplies dv/dlambda is not printed
    change = 2 * TUBE**3 * sp.sin(eta) ** 2 * sp.sin(X) * theta_n / q**2 * weight
    assert zero(terms.change - change)
    (net,) = nets_of(Torus(ring_radius=RING, tube_radius=TUBE)).values()
    angle = 0.7
    numbers = found(net, (ONE, ONE), (np.cos(angle), np.sin(angle)), (-np.sin(angle), 0))
    assert_equal(numbers, terms, eta=angle, theta_n=-np.sin(angle))


def test_relacctorus2_is_multiplied_by_s_from_its_second_term_on():
    theta_n = sp.Symbol("theta_n", real=True)
    q, scales = torus()
    terms = derived(scales, (ONE, S), (0, 1), (theta_n, 0))
    bend = 2 * TUBE * sp.sin(X) / q * theta_n
    printed_change = theta_n * sp.diff(sp.log(S), X) + bend * S
    printed_velocity = theta_n * sp.diff(S, X, Y) + bend * sp.diff(S, Y)
    assert zero(S * terms.velocity - printed_velocity)
    assert zero(terms.change - theta_n * sp.diff(sp.log(S), X) - bend)
    assert not zero(terms.change - printed_change)
    (net,) = nets_of(Torus(ring_radius=RING, tube_radius=TUBE)).values()
    # d theta / d n = 1: n = theta
    numbers = found(net, (ONE, SAMPLE), (0, 1), (1, 0))
    assert_equal(numbers, sampled(terms), theta_n=1)


ARC, TIP = sp.symbols("R r", positive=True)


def vein():
    q = ARC * (1 - sp.sin(X)) + TIP
    return q, (ARC, q)


def test_relacc1():
    theta_n, phi_n = sp.symbols("theta_n phi_n", real=True)
    _, scales = vein()
    terms = derived(scales, (ONE, S), (1, 0), (theta_n, phi_n))
    ratio = TIP / ARC
    reach = 1 - sp.sin(X) + ratio
    assert zero(terms.velocity + (1 - sp.sin(X) * (1 + ratio)) / reach**2 * theta_n)
    assert zero(terms.spread + sp.cos(X) / reach)
    assert terms.change == 0
    numbers = found(vein_net(105.0, 35.0), (ONE, SAMPLE), (1, 0), (0.4, 0.6))
    assert_equal(numbers, terms, R=70, r=35, theta_n=0.4, phi_n=0.6)


def test_theta_anisotropy_at_the_root_keeps_terms_that_its_assumptions_make_zero():
    # section 5.3 (2): s depends on theta alone, theta_n = 0, theta = 0
    phi_n = sp.Symbol("phi_n", real=True)
    along = sp.Function("s", positive=True)(X)
    _, scales = vein()
    terms = derived(scales, (along, ONE), (1, 0), (0, phi_n))
    # printed besides: d_n log s dv/dlambda and (1/s) d^2 s / d theta^2 v
    assert terms.change == 0
    assert terms.velocity == 0
    at_root = (terms.spread - sp.diff(sp.log(along), X)).subs(X, 0)
    assert zero(sp.simplify(at_root.doit()) + ARC / (ARC + TIP))
    # with theta_n: the mixed derivative of relplane1 becomes d^2 s / d theta^2, times theta_n
    theta_n = sp.Symbol("theta_n", real=True)
    turned = derived(scales, (along, ONE), (1, 0), (theta_n, phi_n))
    flat = derived((ONE, ONE), (along, ONE), (1, 0), (theta_n, phi_n))
    assert zero(flat.velocity - theta_n * sp.diff(along, X, 2) / along)
    extra = turned.velocity - flat.velocity
    assert zero(
        extra.subs(sp.diff(along, X), 0).doit()
        - derived(scales, (ONE, ONE), (1, 0), (theta_n, phi_n)).velocity
    )


def printed_case_two(first, second, angle):
    """Return the two terms of section 5.4's Case II, as printed."""
    q, _ = vein()
    weight = (
        ARC**2
        * sp.sin(angle)
        / (first * q**2 * sp.cos(angle) ** 2 + second * ARC**2 * sp.sin(angle) ** 2)
    )
    velocity = weight * first * sp.cos(angle) * (ARC * (1 - sp.sin(X)) - TIP * sp.sin(X))
    return velocity, -weight * 2 * second * sp.sin(angle) ** 2 * ARC * sp.cos(X) / q


def test_case_two_has_lost_a_radius_and_a_sign():
    angle = sp.Symbol("A", real=True)
    first, second = sp.symbols("s_theta s_phi", positive=True)
    _, scales = vein()
    covector, along = (sp.cos(angle), sp.sin(angle)), (-sp.sin(angle), sp.cos(angle))
    terms = derived(scales, (first, second), covector, along)
    velocity, change = printed_case_two(first, second, angle)
    # printed as + d^2 n / d lambda^2: it is the right-hand side of - d^2 n / d lambda^2
    assert zero(terms.change - change)
    # and the first term is too large by the factor R: they agree where R = 1
    assert zero(ARC * terms.velocity - velocity)
    net = vein_net(105.0, 35.0)
    wave = front(net, PLACES, 0.8, reading="coordinate")
    factors = constant(5.0, 4), constant(3.0, 4)
    numbers = relative_acceleration(net, PLACES, diffusivity(net, PLACES, factors), wave)
    assert_equal(numbers, terms, R=70, r=35, A=0.8, s_theta=5, s_phi=3)


@pytest.mark.parametrize(
    ("angle", "root", "middle"),
    [(np.pi / 6, 0.095, -0.207), (np.pi / 3, -0.124, -0.759), (np.pi / 2, -1.0, -1.096)],
)
def test_case_two_numbers(angle, root, middle):
    # r/R = 1, both 4, v = dv/dlambda = 1; the paper read theta = pi/4 off a sampled curve
    net, places = vein_net(2.0, 1.0), np.array([[0.0, 0.0], [np.pi / 4, 0.0]])
    factors = constant(4.0, 2), constant(4.0, 2)
    wave = front(net, places, angle, reading="coordinate")
    numbers = relative_acceleration(net, places, diffusivity(net, places, factors), wave).total()
    assert numbers[0] == pytest.approx(root, abs=5e-4)
    assert numbers[1] == pytest.approx(middle, rel=0.02)


@pytest.mark.parametrize("angle", [0.3, np.pi / 6, np.pi / 3, np.pi / 2])
def test_case_two_with_the_angle_measured_on_the_surface(angle):
    # Lambda = (R cos A, q sin A): d_n E = 0, what is left is the first term, by R sin A / E
    places = np.stack([np.linspace(0, np.pi / 2, 7), np.zeros(7)], axis=1)
    net, theta = vein_net(105.0, 35.0), places[:, 0]
    factors = constant(5.0, 7), constant(3.0, 7)
    wave = front(net, places, angle)
    numbers = relative_acceleration(net, places, diffusivity(net, places, factors), wave)
    q, energy = 105 - 70 * np.sin(theta), 5 * np.cos(angle) ** 2 + 3 * np.sin(angle) ** 2
    wanted = 5 * np.sin(angle) * np.cos(angle) * (70 - 105 * np.sin(theta)) / (70 * q**2 * energy)
    np.testing.assert_allclose(numbers.of_change, 0.0, atol=1e-17)
    np.testing.assert_allclose(numbers.of_velocity, wanted, rtol=1e-10, atol=1e-17)


SURFACES = {
    "plane": (FlatNet(), (ONE, ONE)),
    "sphere": (nets_of(Sphere(radius=RADIUS))["sphere"], sphere()),
    "torus": (nets_of(Torus(ring_radius=RING, tube_radius=TUBE))["torus"], torus()[1]),
    "vein": (vein_net(105.0, 35.0), tuple(g.subs({ARC: 70, TIP: 35}) for g in vein()[1])),
}


@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.parametrize("k", [0, 1])
def test_ricci_type_and_gravitational_tensor(name, k):
    net, scales = SURFACES[name]
    m, axes = 1 - k, (X, Y)
    inner = sp.diff(scales[m] / scales[k], axes[k]) / (scales[0] * scales[1])
    ricci = sp.simplify(scales[k] ** 2 * sp.diff(inner, axes[m]))
    # nothing depends on phi: the paper's S_kk is zero on every surface of revolution
    assert ricci == 0
    np.testing.assert_allclose(ricci_type(net, PLACES, k), 0.0, atol=1e-18)
    # G_kk is what is left of the curvature flow with anisotropy, eq. curvatureflow3
    covector, along = [0, 0], [0, 0]
    covector[k], along[m] = 1, 1
    terms = sampled(derived(scales, (S, S), covector, along))
    factor = jet_of(SAMPLE, PLACES)
    np.testing.assert_allclose(
        gravitational(net, PLACES, factor, k),
        evaluated(terms.velocity, PLACES),
        rtol=1e-11,
        atol=1e-13,
    )


def test_the_ricci_type_tensor_of_a_net_without_symmetry():
    # g_11 = exp(x y), g_22 = 1 + x^2 y^2: not of revolution, so S_kk is not zero
    metric = sp.exp(X * Y), 1 + X**2 * Y**2
    root = sp.sqrt(metric[0] * metric[1])
    for k, m, axes in ((0, 1, (X, Y)), (1, 0, (Y, X))):
        inner = sp.diff(metric[m] / root, axes[0]) / root
        wanted = evaluated(metric[k] * sp.diff(inner, axes[1]), PLACES)
        assert np.abs(wanted).min() > 1e-3
        np.testing.assert_allclose(ricci_type(SymbolicNet(*metric), PLACES, k), wanted, rtol=1e-11)


def test_tensordef2_as_printed_does_not_give_the_papers_own_sphere():
    (net,) = nets_of(Sphere(radius=RADIUS)).values()
    factor = jet_of(SAMPLE, PLACES)
    sphere_term = evaluated(
        sp.diff(SAMPLE, X, Y) / SAMPLE + sp.diff(sp.log(SAMPLE), Y) * sp.cot(X), PLACES
    )
    np.testing.assert_allclose(gravitational(net, PLACES, factor, 0), sphere_term, rtol=1e-12)
    # half of d_theta g, not of d_theta log g: r^4 sin theta cos theta in the place of cot theta
    slope = evaluated(sp.diff(sp.log(SAMPLE), X), PLACES)
    theta = PLACES[:, 0]
    bracket = RADIUS**4 * np.sin(theta) * np.cos(theta) - 2 / np.tan(theta)
    mixed = evaluated(sp.diff(SAMPLE, X, Y) / SAMPLE, PLACES)
    np.testing.assert_allclose(
        gravitational_as_printed(net, PLACES, factor, 0), mixed + bracket * slope, rtol=1e-10
    )
    # on the plane, and along phi on surfaces of revolution, it makes no difference
    np.testing.assert_allclose(
        gravitational(net, PLACES, factor, 1),
        gravitational_as_printed(net, PLACES, factor, 1),
        rtol=1e-12,
    )
    flat = FlatNet()
    np.testing.assert_array_equal(
        gravitational(flat, PLACES, factor, 0), gravitational_as_printed(flat, PLACES, factor, 0)
    )


def test_the_equation_does_not_see_the_curvature_of_a_sphere():
    # from the pole: trajectories are geodesics, -n'' = K n with K = 1/R^2; both terms kept are 0
    (net,) = nets_of(Sphere(radius=RADIUS)).values()
    ones = constant(1.0, len(PLACES)), constant(1.0, len(PLACES))
    wave = front(net, PLACES, 0.0)
    numbers = relative_acceleration(net, PLACES, diffusivity(net, PLACES, ones), wave)
    np.testing.assert_allclose(numbers.of_velocity, 0.0, atol=1e-18)
    np.testing.assert_allclose(numbers.of_change, 0.0, atol=1e-18)
    np.testing.assert_allclose(gaussian_curvature(net, PLACES), RADIUS**-2.0, rtol=1e-12)
    # the front's own curvature is in the term that the paper drops
    cotangent = 1 / np.tan(PLACES[:, 0])
    np.testing.assert_allclose(numbers.of_spread, cotangent / RADIUS, rtol=1e-12)


def test_the_face_of_a_block_is_in_the_dropped_term_only():
    # a plane wave in -x on the block of problem 1, across its face x = 50 at y = 0
    x = np.linspace(40.0, 60.0, 2001)
    places = np.stack([x, np.zeros_like(x)], axis=1)
    net, width, anisotropy = FlatNet(), 12.0, 10.0
    block = SmoothedPatch((-50.0, 50.0), (-50.0, 50.0), (anisotropy, 1.0), width)
    tensor = diffusivity(net, places, smoothed_factors(net, places, [block]))
    numbers = relative_acceleration(net, places, tensor, front(net, places, np.pi))
    # what is left of the sides, 50 su away, is exp(-2 ln 9 50 / 12) = 1e-8; rounding of sin pi
    assert np.abs(numbers.of_velocity).max() < 1e-8
    assert np.abs(numbers.of_change).max() < 1e-8
    # greatest slope of log(1 + (s - 1) / (1 + exp(k x)))
    root = np.sqrt(anisotropy)
    greatest = 2 * np.log(9.0) / width * (root - 1) / (root + 1)
    assert np.abs(numbers.of_spread).max() == pytest.approx(greatest, rel=1e-5)
