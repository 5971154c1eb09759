"""Nearest points, quality figures and exported meshes."""

from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest

from cardiosurf.errors import InputError
from cardiosurf.geometry import Plane, Sphere, Surface, TDomain, build_surface, points_inside
from cardiosurf.geometry.export import write_mesh
from cardiosurf.geometry.nearest import nearest_point
from cardiosurf.geometry.quality import quality
from cardiosurf.geometry.regions import Ball, BallLimits, Box, BoxLimits, Part


@pytest.fixture(scope="module")
def plane() -> Surface:
    block = Box(BoxLimits(x=(-10.0, 10.0)))
    return build_surface(Plane(x=(-30.0, 30.0), y=(-20.0, 20.0)), 5.0, {"block": block})


def test_nearest_point_above_the_plane(plane: Surface) -> None:
    nearest = nearest_point(plane, np.array([3.7, -11.2, 4.0]))
    np.testing.assert_allclose(nearest.point, [3.7, -11.2, 0.0], atol=1e-12)
    assert nearest.distance == pytest.approx(4.0)
    corners = plane.points[plane.triangles[nearest.triangle]]
    np.testing.assert_allclose(nearest.weights @ corners, nearest.point, atol=1e-12)
    assert nearest.weights.min() >= 0.0
    assert nearest.weights.sum() == pytest.approx(1.0)


def test_nearest_point_beside_the_plane_is_on_its_edge(plane: Surface) -> None:
    nearest = nearest_point(plane, np.array([33.0, 24.0, 0.0]))
    np.testing.assert_allclose(nearest.point, [30.0, 20.0, 0.0], atol=1e-12)
    assert nearest.distance == pytest.approx(5.0)
    side = nearest_point(plane, np.array([33.0, 7.3, 4.0]))
    np.testing.assert_allclose(side.point, [30.0, 7.3, 0.0], atol=1e-12)


def test_nearest_points_on_the_sphere_match_brute_force() -> None:
    sphere = build_surface(Sphere(radius=10.0), 2.0, {})
    rng = np.random.default_rng(1)
    weights = rng.dirichlet(np.ones(3), size=400)
    samples = np.einsum("wk,mkd->mwd", weights, sphere.points[sphere.triangles]).reshape(-1, 3)
    for target in rng.normal(scale=12.0, size=(10, 3)):
        nearest = nearest_point(sphere, target)
        brute = np.linalg.norm(samples - target, axis=1).min()
        # random samples of a triangle of edge 2 come within about 0.1 of any of its points
        assert nearest.distance <= brute + 1e-12
        assert np.linalg.norm(samples - nearest.point, axis=1).min() < 0.3


def test_quality_counts_what_is_wrong(plane: Surface) -> None:
    good = quality(plane)
    assert (good.components, good.duplicates, good.orphans, good.crossed) == (1, 0, 0, 0)
    assert (good.euler, good.loops) == (1, 1)
    assert good.area == pytest.approx(2400.0)
    twice = replace(plane, points=np.concatenate([plane.points, plane.points[:1]]))
    assert (quality(twice).orphans, quality(twice).duplicates) == (1, 1)
    turned = plane.triangles.copy()
    turned[0] = turned[0][::-1]
    assert quality(replace(plane, triangles=turned)).crossed > 0


def test_quality_of_closed_and_pierced_surfaces() -> None:
    assert quality(build_surface(Sphere(), 10.0, {})).euler == 2
    assert quality(build_surface(Sphere(), 10.0, {})).loops == 0
    pierced = quality(build_surface(TDomain(), 10.0, {}))
    assert (pierced.euler, pierced.loops) == (0, 2)


@pytest.mark.parametrize("ending", ["vtu", "vtk", "ply", "stl", "off", "obj", "xdmf"])
def test_exported_meshes_read_back(plane: Surface, tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"mesh.{ending}"
    write_mesh(plane, path)
    back = meshio.read(path)
    assert sum(len(block.data) for block in back.cells if block.type == "triangle") == len(
        plane.triangles
    )
    np.testing.assert_allclose(np.ptp(back.points, axis=0), [60.0, 40.0, 0.0], atol=1e-4)


def test_export_carries_parts_regions_and_frame(plane: Surface, tmp_path: Path) -> None:
    write_mesh(plane, tmp_path / "mesh.vtu")
    data = meshio.read(tmp_path / "mesh.vtu").cell_data
    np.testing.assert_array_equal(data["region_block"][0], plane.regions["block"])
    np.testing.assert_array_equal(data["part"][0], plane.part_of)
    np.testing.assert_allclose(data["e2"][0], plane.frame[:, 1])


def test_export_refuses_what_it_cannot_write(plane: Surface, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="names no mesh format"):
        write_mesh(plane, tmp_path / "mesh.nonsense")
    # what the system refuses stays the system's error, so that the command line can name it
    with pytest.raises(FileNotFoundError):
        write_mesh(plane, tmp_path / "no" / "such" / "folder" / "mesh.vtu")


def test_points_inside_a_region() -> None:
    points = np.array([[0.0, 100.0, 0.0], [0.0, -100.0, 0.0], [0.0, 0.0, 150.0]])
    left = points_inside(Part("left_rectangle"), TDomain(), points)
    np.testing.assert_array_equal(left, [False, True, False])
    ball = Ball(BallLimits((0.0, 100.0, 3.0), 3.0))
    np.testing.assert_array_equal(points_inside(ball, TDomain(), points), [True, False, False])
