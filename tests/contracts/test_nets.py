"""The net of every part of every shape against finite differences of the shape's own surface."""

import numpy as np
import pytest

from cardiosurf.geometry import SHAPES, AnyShape
from cardiosurf.geometry.nets import (
    NETS,
    Net,
    christoffel,
    gaussian_curvature,
    lemma_d_sides,
    mean_curvature,
    nets_of,
)
from cardiosurf.geometry.sphere import Sphere
from cardiosurf.geometry.t_domain import TDomain
from cardiosurf.geometry.torus import Torus

STEP = 0.25
"""Spacing of the stencils in su: 4th order on radii of 35 su leaves 1e-10, rounding as much."""
TOLERANCE = 1e-8
OFFSETS = np.arange(-2, 3)
FIRST = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0
SECOND = np.array([-1.0, 16.0, -30.0, 16.0, -1.0]) / 12.0


def shapes() -> list[AnyShape]:
    others = (
        TDomain(root_radius=105.0),
        Sphere(pole=(1.0, 2.0, -1.0)),
        Torus(tube_radius=20.0),
    )
    return [*(shape() for shape in SHAPES.values()), *others]


def wrapped(difference):
    return difference - 2 * np.pi * np.round(difference / (2 * np.pi))


def interior(sheet, number: int, net: Net):
    """Return points of a part whose stencils stay on it and on one bow of its profile."""
    points = sheet.seeds(9.0)
    points = points[sheet.part_of(points) == number]
    for level in sheet.levels():
        points = points[np.abs(level.value(points)) > 1.5]
    places = sheet.net(points, np.full(len(points), number))
    first, second = (g.value for g in net.metric(places))
    clear = second > 100.0 if sheet.axes[number][0] == "theta" else second > 0
    shift = np.zeros_like(places)
    shift[:, 0] = 1.5 / np.sqrt(first)
    bend = [net.curvatures(places + side * shift)[0] for side in (-1, 1)]
    return points[clear & (bend[0] == bend[1])][::5]


def placed(sheet, number: int, net: Net, start, target):
    """Return the surface's points with the net coordinates ``target``, by its own ``net``."""
    points, part = start.copy(), np.full(len(start), number)
    flat = sheet.axes[number][0] != "theta"
    for _ in range(8):
        away = target - sheet.net(points, part)
        away = away if flat else wrapped(away)
        scales = np.sqrt(np.stack([g.value for g in net.metric(target)], axis=1))
        step = np.einsum("nk,nkd->nd", away * scales, sheet.frame(points, part))
        points = sheet.project(points + step)
    away = target - sheet.net(points, part)
    assert np.abs(away if flat else wrapped(away)).max() < 1e-12 * (200.0 if flat else 1.0)
    return points


def differences(sheet, number: int, net: Net, points):
    """Return net coordinates, x_k (n, 2, 3) and x_ij (n, 2, 2, 3) of the surface itself."""
    places = sheet.net(points, np.full(len(points), number))
    steps = STEP / np.sqrt(np.stack([g.value for g in net.metric(places)], axis=1))
    grid = np.empty((5, 5, len(points), 3))
    for i, a in enumerate(OFFSETS):
        for j, b in enumerate(OFFSETS):
            grid[i, j] = placed(sheet, number, net, points, places + steps * np.array([a, b]))
    first = np.stack(
        [np.einsum("i,ind->nd", FIRST, grid[:, 2]), np.einsum("j,jnd->nd", FIRST, grid[2])], axis=1
    )
    mixed = np.einsum("i,j,ijnd->nd", FIRST, FIRST, grid)
    second = np.stack(
        [
            np.stack([np.einsum("i,ind->nd", SECOND, grid[:, 2]), mixed], axis=1),
            np.stack([mixed, np.einsum("j,jnd->nd", SECOND, grid[2])], axis=1),
        ],
        axis=1,
    )
    return (
        places,
        first / steps[:, :, None],
        second / (steps[:, :, None, None] * steps[:, None, :, None]),
    )


CASES = [
    pytest.param(shape, number, part, id=f"{shape.kind}-{part}")
    for shape in shapes()
    for number, part in enumerate(shape.sheet(5.0).parts)
]


def test_every_shape_has_nets():
    assert set(NETS) == set(SHAPES)
    for shape in shapes():
        assert tuple(nets_of(shape)) == shape.sheet(5.0).parts


@pytest.mark.parametrize(("shape", "number", "part"), CASES)
def test_metric_symbols_and_curvatures(shape: AnyShape, number: int, part: str):
    sheet, net = shape.sheet(5.0), nets_of(shape)[part]
    points = interior(sheet, number, net)
    assert len(points) >= 8
    places, tangents, bends = differences(sheet, number, net, points)
    found = np.einsum("nid,njd->nij", tangents, tangents)
    first, second = (g.value for g in net.metric(places))
    scales = np.sqrt(np.stack([first, second], axis=1))
    unit = found / (scales[:, :, None] * scales[:, None, :])
    np.testing.assert_allclose(unit, np.broadcast_to(np.eye(2), unit.shape), atol=TOLERANCE)
    # Gamma^k_ij = x_ij . x_k / g_kk, compared in units of the frame: times h_k / (h_i h_j) is 1/su
    symbols = np.einsum("nijd,nkd->nkij", bends, tangents) / found[:, [0, 1], [0, 1], None, None]
    to_unit = scales[:, :, None, None] / (scales[:, None, :, None] * scales[:, None, None, :])
    np.testing.assert_allclose(
        christoffel(net, places) * to_unit, symbols * to_unit, atol=TOLERANCE
    )
    normal = sheet.normal(points)
    bent = np.einsum("nijd,nd->nij", bends, normal) / (scales[:, :, None] * scales[:, None, :])
    np.testing.assert_allclose(bent[:, 0, 1], 0.0, atol=TOLERANCE)
    np.testing.assert_allclose(
        mean_curvature(net, places), 0.5 * (bent[:, 0, 0] + bent[:, 1, 1]), atol=TOLERANCE
    )
    np.testing.assert_allclose(
        gaussian_curvature(net, places), bent[:, 0, 0] * bent[:, 1, 1], atol=TOLERANCE
    )


@pytest.mark.parametrize(("shape", "number", "part"), CASES)
@pytest.mark.parametrize("k", [0, 1])
def test_lemma_d_holds_on_the_nets_that_are_shipped(shape, number, part, k):
    sheet, net = shape.sheet(5.0), nets_of(shape)[part]
    points = interior(sheet, number, net)
    places = sheet.net(points, np.full(len(points), number))
    left, right, missing = lemma_d_sides(net, places, k)
    # x^k is even in arclength on all of them, so nothing is missing; rounding only
    np.testing.assert_allclose(missing, 0.0, atol=1e-18)
    np.testing.assert_allclose(left, right, rtol=1e-12, atol=1e-16)
