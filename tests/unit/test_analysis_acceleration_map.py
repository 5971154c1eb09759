"""Relative acceleration on triangles against the nets' exact derivatives."""

import numpy as np
import pytest
import sympy as sp
from recording_samples import sample_recording
from symbolic_jets import X, Y, jet_of

from cardiosurf.analysis.acceleration_map import (
    Smoothing,
    acceleration_map,
    angle_direction,
    lat_direction,
    recorded_acceleration,
)
from cardiosurf.analysis.relative_acceleration import diffusivity, front, relative_acceleration
from cardiosurf.analysis.smoothed_patches import SmoothedPatch, smoothed_factors
from cardiosurf.errors import InputError
from cardiosurf.geometry import build_surface
from cardiosurf.geometry.jets import constant
from cardiosurf.geometry.nets import FlatNet, nets_of, vein_net
from cardiosurf.geometry.plane import Plane
from cardiosurf.geometry.regions import Box, BoxLimits
from cardiosurf.geometry.sphere import Sphere
from cardiosurf.geometry.torus import Torus

TERMS = ("of_velocity", "of_change", "of_spread")


def tensor_of(surface, first, second):
    """Return the tensor with the factors along the net's axes, (m, 3, 3)."""
    e, f = surface.frame[:, 0], surface.frame[:, 1]
    return (
        first[:, None, None] * e[:, :, None] * e[:, None, :]
        + second[:, None, None] * f[:, :, None] * f[:, None, :]
    )


def errors(found, wanted, chosen):
    """Return each term's root mean square error over the wanted root mean square."""
    shares = []
    for name in TERMS:
        exact = getattr(wanted, name)[chosen]
        away = getattr(found, name)[chosen] - exact
        shares.append(np.sqrt(np.mean(away**2) / np.mean(exact**2)))
    return np.array(shares)


def on_plane(edge):
    surface = build_surface(Plane(x=(-60.0, 60.0), y=(-60.0, 60.0)), edge, {})
    factor = 3 + sp.sin(X / 20) * sp.cos(Y / 25)
    places = surface.net
    along = jet_of(factor, places)
    ones = constant(1.0, len(places))
    exact = relative_acceleration(
        FlatNet(),
        places,
        diffusivity(FlatNet(), places, (along, ones)),
        front(FlatNet(), places, 0),
    )
    found = acceleration_map(
        surface,
        tensor_of(surface, along.value, ones.value),
        angle_direction(surface, np.zeros(len(places))),
        4.0 * edge,
    )
    return errors(found, exact, np.abs(places).max(axis=1) < 45.0)


def test_a_plane_wave_in_varying_anisotropy():
    # the width shrinks with the edges: order one at the least, found 1.8, 1.6 and 1.9
    coarse, fine = on_plane(4.0), on_plane(2.0)
    assert (fine < 0.5 * coarse).all()
    assert (fine < 0.07).all()


def on_sphere(edge):
    radius = 50.0
    surface = build_surface(Sphere(radius=radius), edge, {})
    (net,) = nets_of(Sphere(radius=radius)).values()
    places = surface.net
    along = jet_of(3 + sp.sin(X) ** 2 * sp.cos(Y), places)
    ones = constant(1.0, len(places))
    exact = relative_acceleration(
        net, places, diffusivity(net, places, (along, ones)), front(net, places, 0.0)
    )
    # the wave from the pole: LAT = distance / 0.2
    lat = np.arccos(np.clip(surface.points[:, 2] / radius, -1, 1)) * radius / 0.2
    found = acceleration_map(
        surface,
        tensor_of(surface, along.value, ones.value),
        lat_direction(surface, lat),
        4.0 * edge,
    )
    clear = np.abs(places[:, 0] - np.pi / 2) < 0.9
    np.testing.assert_allclose(found.angle[clear], 0.0, atol=0.02)
    return errors(found, exact, clear)


def test_a_wave_from_the_pole_of_an_anisotropic_sphere():
    # found orders 1.2, 1.5 and 1.5
    coarse, fine = on_sphere(4.0), on_sphere(2.0)
    assert (fine < 0.5 * coarse).all()
    assert (fine < 0.07).all()


@pytest.fixture(scope="module")
def block():
    region = Box(BoxLimits(x=(-50, 50), y=(-50, 50)))
    return build_surface(Plane(), 2.5, {"block": region})


def test_a_jump_rises_over_the_width(block):
    inside = block.regions["block"].astype(float)
    share = Smoothing(block.points, block.triangles, 15.0).smoothed(inside[:, None])[:, 0]
    x, y = block.points[:, :2].T
    near = (np.abs(y) < 15) & (x < 0)
    low, high = np.interp([0.1, 0.9], np.sort(share[near]), np.sort(x[near]))
    # four implicit steps instead of a Gaussian, and the mean over a vertex's triangles: 3 %
    assert high - low == pytest.approx(15.0, rel=0.05)
    # nothing is lost: the integral stays
    assert block.vertex_areas() @ share == pytest.approx(100.0**2, rel=1e-9)


def test_a_block_along_its_sides_and_at_its_corners(block):
    # a plane wave in -x, as in problem 1
    inside = block.regions["block"]
    tensor = tensor_of(block, np.where(inside, 10.0, 1.0), np.ones(len(inside)))
    direction = angle_direction(block, np.full(len(inside), np.pi))
    found = acceleration_map(block, tensor, direction, 12.0)
    areas, (x, y) = block.areas(), block.net.T
    # whatever the kernel: the integral of d_n log s over an edge is log s; n is -y
    over = (np.abs(x) < 30) & (y > 20) & (y < 80)
    total = (areas * found.of_change)[over].sum() / areas[over].sum() * 60.0
    assert total == pytest.approx(np.log(10.0), rel=0.03)
    # and d_x d_y s is large at the corners only
    largest = np.argsort(-np.abs(found.of_velocity))[:40]
    assert np.abs(np.abs(block.net[largest]) - 50.0).max() < 12.0


def test_isotropic_tissue_has_the_front_alone():
    surface = build_surface(Sphere(radius=50.0), 4.0, {})
    tensor = 3.0 * tensor_of(surface, np.ones(len(surface.net)), np.ones(len(surface.net)))
    lat = np.arccos(surface.points[:, 2] / 50.0)
    found = acceleration_map(surface, tensor, lat_direction(surface, lat), 10.0)
    assert np.nanmax(np.abs(found.of_change)) < 1e-12
    clear = np.abs(surface.net[:, 0] - np.pi / 2) < 0.9
    # B / E is the geodesic curvature of the front, cot theta / R; errors of its pieces even out
    away = found.of_spread[clear] - 1 / (50 * np.tan(surface.net[clear, 0]))
    assert np.sqrt(np.mean(away**2)) < 1e-3


def test_collisions_and_silent_tissue_have_no_direction(block):
    x = block.points[:, 0]
    lat = np.where(np.abs(block.points[:, 1]) < 80, -np.abs(x), np.nan)
    tensor = tensor_of(block, np.ones(len(block.net)), np.ones(len(block.net)))
    found = acceleration_map(block, tensor, lat_direction(block, lat), 10.0)
    x, y = block.net.T
    assert np.isnan(found.angle[np.abs(x) < 1]).all()
    assert np.isnan(found.of_spread[np.abs(y) > 85]).all()
    seen = (np.abs(x) > 10) & (np.abs(y) < 75)
    np.testing.assert_allclose(
        np.abs(found.angle[seen]), np.where(x > 0, np.pi, 0)[seen], atol=0.01
    )


def test_the_first_wave_of_a_recording():
    # a front along x at 0.25 su/tu, d_xx 4 on x > 30: n = y, along which nothing varies
    recording = sample_recording()
    found = recorded_acceleration(recording, 25.0)
    assert found.width == 25.0
    seen = np.isfinite(found.angle)
    assert seen[recording.surface.net[:, 0] < 40].all()
    np.testing.assert_allclose(found.angle[seen], 0.0, atol=1e-12)
    # the mesh of right triangles is not symmetric in y: a tenth of the slope along x
    np.testing.assert_allclose(found.of_change[seen], 0.0, atol=0.1 * np.log(4) / 25)
    # B = d_x E: at x = 30 the slope of log E is log 4 within about the width
    edge = np.abs(recording.surface.net[:, 0] - 30) < 10
    assert found.of_spread[edge & seen].mean() == pytest.approx(np.log(4) / 25, rel=0.5)


def test_a_width_that_the_mesh_cannot_show_is_refused(block):
    tensor = tensor_of(block, np.ones(len(block.net)), np.ones(len(block.net)))
    direction = angle_direction(block, np.zeros(len(block.net)))
    with pytest.raises(InputError, match="at least 2 edge lengths"):
        acceleration_map(block, tensor, direction, 4.0)


def test_soft_patches_rise_over_their_width_on_the_surface():
    # on a vein at theta = 0.6: rho = 105 - 70 sin 0.6, edges in phi are rho dphi wide
    net, width = vein_net(105.0, 35.0), 8.0
    patch = SmoothedPatch(None, (np.pi - 0.5, np.pi + 0.5), (4.0, 9.0), width)
    rho = 105.0 - 70.0 * np.sin(0.6)
    phi = np.pi + 0.5 + np.array([-0.5, 0.0, 0.5]) * width / rho
    # the same angles as a net gives them, in (-pi, pi]
    places = np.stack([np.full(3, 0.6), phi - 2 * np.pi], axis=1)
    first, second = smoothed_factors(net, places, [patch])
    np.testing.assert_allclose((first.value - 1) / 3, [0.9, 0.5, 0.1], atol=1e-8)
    np.testing.assert_allclose((second.value - 1) / 8, [0.9, 0.5, 0.1], atol=1e-8)
    # the later patch wins where it is whole
    over = SmoothedPatch((0.0, 1.2), None, (2.0, 2.0), width)
    first, _ = smoothed_factors(net, places[:1], [patch, over])
    inside = over.share(net, places[:1]).value
    assert first.value[0] == pytest.approx(2.0 * inside[0] + 3.7 * (1 - inside[0]), rel=1e-6)


def test_soft_patches_go_across_the_seam_of_a_torus():
    (net,) = nets_of(Torus()).values()
    patch = SmoothedPatch((np.pi - 0.5, np.pi + 0.3), (3.0, 4.0), (8.0, 1.0), 4.0)
    # tube radius 50: 0.1 past the seam is 10 su inside, 0.4 past it 5 su outside
    places = np.array([[-np.pi + 0.1, 3.5], [np.pi - 0.1, 3.5 - 2 * np.pi], [-np.pi + 0.4, 3.5]])
    share = patch.share(net, places).value
    wanted = 1 / (1 + np.exp(-2 * np.log(9) / 4 * np.array([10.0, 20.0, -5.0])))
    # the other edges are 12 su away at the least: exp(-2 ln 9 12 / 4) = 2e-6
    np.testing.assert_allclose(share, wanted, atol=1e-5)
