"""What the geometry refuses, and how it says so."""

import pytest

from cardiosurf.errors import InputError
from cardiosurf.geometry import AnyShape, Plane, Sphere, TDomain, Vein, build_surface
from cardiosurf.geometry.atrium import Atrium
from cardiosurf.geometry.regions import (
    All,
    AnyOf,
    Ball,
    BallLimits,
    Box,
    BoxLimits,
    HalfSpace,
    HalfSpaceLimits,
    Not,
    Part,
    PatchReference,
    Polar,
    PolarLimits,
    Region,
)
from cardiosurf.geometry.torus import Torus


def refused(shape: AnyShape, region: Region | None = None, edge: float = 10.0) -> InputError:
    regions = {} if region is None else {"mark": region}
    with pytest.raises(InputError) as caught:
        build_surface(shape, edge, regions)
    return caught.value


def test_a_region_beside_the_surface_is_empty() -> None:
    error = refused(Plane(), Box(BoxLimits(x=(200.0, 300.0))))
    assert error.where == "region mark"
    assert "x: [-100, 100], y: [-100, 100], z: [0, 0]" in error.allowed
    assert error.hint


def test_a_misspelt_part_gets_the_nearest_one() -> None:
    error = refused(TDomain(), AnyOf((Part("vein"), Not(Part("left_rectange")))))
    assert error.where == "region mark: surface"
    assert error.allowed == "vein, right_rectangle, left_rectangle"
    assert "left_rectangle" in error.hint


def test_polar_needs_angles() -> None:
    polar = Polar(PolarLimits(theta=(0.0, 1.0)))
    assert "no part of the shape has theta and phi" in str(refused(Plane(), polar))
    error = refused(Vein(), All((Part("square"), polar)))
    assert "square has no theta and phi" in error.problem
    assert error.allowed == "polar on vein"


@pytest.mark.parametrize(
    ("region", "where"),
    [
        (Box(BoxLimits(y=(3.0, -3.0))), "region mark: box: y"),
        (Polar(PolarLimits(phi=(1.0, 0.5))), "region mark: polar: phi"),
        (Ball(BallLimits((0.0, 0.0, 0.0), 0.0)), "region mark: ball: radius"),
        (HalfSpace(HalfSpaceLimits((0.0, 0.0, 0.0))), "region mark: half_space: normal"),
        (PatchReference("scar"), "region mark"),
    ],
)
def test_regions_that_mean_nothing(region: Region, where: str) -> None:
    assert refused(Sphere(), region).where == where


@pytest.mark.parametrize(
    ("shape", "where"),
    [
        (Plane(x=(5.0, 5.0)), "geometry.x"),
        (Sphere(radius=-1.0), "geometry.radius"),
        (Vein(tip_radius=105.0), "geometry.tip_radius"),
        (Vein(tip_radius=1.0), "geometry.tip_radius"),
        (Vein(half_width=100.0), "geometry.root_radius"),
        (TDomain(root_radius=30.0), "geometry.tip_radius"),
        (TDomain(length=60.0), "geometry.root_radius"),
        (TDomain(right_half_width=70.0), "geometry.root_radius"),
        (TDomain(left_half_width=160.0), "geometry.left_half_width"),
        (Sphere(pole=(0.0, 0.0, 0.0)), "geometry.pole"),
        (Torus(tube_radius=100.0), "geometry.tube_radius"),
        (Torus(tube_radius=97.0), "geometry.tube_radius"),
        (Torus(tube_radius=9.0), "geometry.tube_radius"),
        (Torus(tube_radius=94.0), "geometry.ring_radius"),
        (Atrium(tip_radius=100.0), "geometry.tip_radius"),
        (Atrium(root_radius=115.0), "geometry.ring_radius"),
        (Atrium(bottom_angle=0.5), "geometry.bottom_angle"),
        (Atrium(bottom_angle=4.6), "geometry.bottom_angle"),
        (Atrium(bottom_angle=6.0), "geometry.bottom_angle"),
    ],
)
def test_shapes_that_contradict_themselves(shape: AnyShape, where: str) -> None:
    assert refused(shape).where == where


@pytest.mark.parametrize("edge", [0.0, -2.0, float("nan"), float("inf"), 1e-3])
def test_edge_lengths_that_make_no_mesh(edge: float) -> None:
    assert refused(Plane(), edge=edge).where == "mesh.edge_length"
