"""What every shape of the registry keeps, at every edge length."""

import numpy as np
import pytest

from cardiosurf.geometry import SHAPES, AnyShape, Surface, build_surface
from cardiosurf.geometry.quality import quality
from cardiosurf.geometry.regions import (
    All,
    Ball,
    BallLimits,
    Box,
    BoxLimits,
    HalfSpace,
    HalfSpaceLimits,
    Part,
    Polar,
    PolarLimits,
    Region,
)
from cardiosurf.geometry.sphere import Sphere
from cardiosurf.geometry.t_domain import TDomain
from cardiosurf.geometry.torus import Torus

# holes and open edges decide the Euler characteristic: disc 1, ring 0, sphere 2
EULER = {"plane": 1, "vein": 0, "t_domain": 0, "sphere": 2, "torus": 0, "atrium": 0}
LOOPS = {"plane": 1, "vein": 2, "t_domain": 2, "sphere": 0, "torus": 0, "atrium": 2}

MARKS: dict[str, dict[str, Region]] = {
    "plane": {
        "block": Box(BoxLimits(x=(-50, 50), y=(-50, 50))),
        "far_side": Box(BoxLimits(x=(-90, -50))),
        "tilted": HalfSpace(HalfSpaceLimits((1.0, 1.0, 0.0), 30.0)),
    },
    "vein": {
        "ring": Polar(PolarLimits(theta=(0.3, 0.9))),
        "sector": Polar(PolarLimits(phi=(2.6, 3.9))),
        "ball": Ball(BallLimits((0.0, 110.0, 0.0), 30.0)),
    },
    "t_domain": {
        "strip": All((Part("vein"), Box(BoxLimits(x=(0, 60), y=(-30, 0))))),
        "left": All((Part("left_rectangle"), Box(BoxLimits(y=(-150, -110))))),
    },
    "sphere": {
        "block": Polar(PolarLimits(theta=(np.pi / 4, 3 * np.pi / 4), phi=(-np.pi / 4, np.pi / 4))),
        "cap": HalfSpace(HalfSpaceLimits((-1.0, 1.0, 1.0), 35.0)),
    },
    "torus": {
        # its edge crosses itself where the planes touch the inner equator
        "block": Box(BoxLimits(x=(-50, 50), y=(0, 150))),
        "across_both_seams": Polar(PolarLimits(theta=(2.9, 3.6), phi=(-2.4, -1.0))),
        "tilted": HalfSpace(HalfSpaceLimits((1.0, -0.5, 0.7), 90.0)),
    },
    "atrium": {
        "strip_left": Box(BoxLimits(x=(-30, -10), y=(-200, 0), z=(0, 60))),
        "strip_right": Box(BoxLimits(x=(-30, -10), y=(0, 200), z=(0, 60))),
        "lowest": Box(BoxLimits(z=(-170, -150))),
        "patch": Polar(PolarLimits(theta=(1.8, 2.6), phi=(2.8, 3.6))),
        "ball": Ball(BallLimits((126.52, 0.0, -35.55), 30.0)),
    },
}


def shapes() -> list[AnyShape]:
    others = (
        TDomain(root_radius=105.0),
        Sphere(pole=(1.0, 2.0, -1.0)),
        Torus(tube_radius=20.0),
        Torus(tube_radius=80.0),
    )
    return [*(shape() for shape in SHAPES.values()), *others]


def marks(shape: AnyShape) -> dict[str, Region]:
    # the planes x = +-50 touch the inner equator of the usual torus only
    if isinstance(shape, Torus) and shape != Torus():
        return {name: one for name, one in MARKS["torus"].items() if name != "block"}
    return MARKS[shape.kind]


def assert_well_made(surface: Surface, shape: AnyShape, edge_length: float) -> None:
    found = quality(surface)
    assert (found.components, found.duplicates, found.orphans, found.crossed) == (1, 0, 0, 0)
    assert (found.euler, found.loops) == (EULER[shape.kind], LOOPS[shape.kind])
    assert found.smallest_angle >= 20.0
    assert found.mean_edge == pytest.approx(edge_length, rel=0.1)
    assert found.longest_edge <= 2.0 * edge_length
    sheet = shape.sheet(edge_length)
    off = np.linalg.norm(surface.points - sheet.project(surface.points), axis=1)
    assert off.max() < 1e-9


def assert_framed(surface: Surface) -> None:
    first, second = surface.frame[:, 0], surface.frame[:, 1]
    corners = surface.points[surface.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    # orthonormal, in the triangle's plane, and turning the same way as the triangle everywhere
    np.testing.assert_allclose(np.cross(first, second), normal, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(first, axis=1), 1.0, atol=1e-12)
    assert surface.net.shape == (len(surface.triangles), 2)
    assert len(surface.axes) == len(surface.parts)


def assert_bordered(surface: Surface) -> None:
    half = np.sort(surface.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    sides, uses = np.unique(half, axis=0, return_counts=True)
    named = [np.sort(edge, axis=1) for edge in surface.edges.values()]
    border = np.unique(np.concatenate([np.empty((0, 2), dtype=int), *named]), axis=0)
    np.testing.assert_array_equal(border, sides[uses == 1])
    assert sum(len(edge) for edge in named) == len(border)


@pytest.mark.parametrize("edge_length", [5.0, 10.0])
@pytest.mark.parametrize("shape", shapes(), ids=lambda shape: shape.kind)
def test_bare_meshes(shape: AnyShape, edge_length: float) -> None:
    surface = build_surface(shape, edge_length, {})
    assert_well_made(surface, shape, edge_length)
    assert_framed(surface)
    assert_bordered(surface)


@pytest.mark.parametrize("shape", shapes(), ids=lambda shape: shape.kind)
def test_marked_meshes(shape: AnyShape) -> None:
    surface = build_surface(shape, 5.0, marks(shape))
    assert list(surface.regions) == list(marks(shape))
    assert_well_made(surface, shape, 5.0)
    assert_framed(surface)
    assert_bordered(surface)


@pytest.mark.slow
@pytest.mark.parametrize("edge_length", [1.0, 1.7, 2.5, 3.3, 7.0, 10.0])
@pytest.mark.parametrize("shape", shapes(), ids=lambda shape: shape.kind)
def test_marked_meshes_at_every_edge_length(shape: AnyShape, edge_length: float) -> None:
    surface = build_surface(shape, edge_length, marks(shape))
    assert_well_made(surface, shape, edge_length)
    assert_framed(surface)
    assert_bordered(surface)
