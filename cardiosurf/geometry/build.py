"""From a shape and its regions to a surface."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.errors import InputError
from cardiosurf.geometry.membership import contains
from cardiosurf.geometry.mesher import mesh
from cardiosurf.geometry.regions import Region
from cardiosurf.geometry.sense import check_region
from cardiosurf.geometry.sheet import Sheet
from cardiosurf.geometry.skeleton import skeleton
from cardiosurf.geometry.surface import Surface
from cardiosurf.geometry.topology import area_vectors, centroids, open_edges

_MOST_TRIANGLES = 5e6


class Shape(Protocol):
    """What every shape can do, besides holding its numbers."""

    def check(self) -> None:
        """Raise InputError if the numbers do not make a surface."""
        ...

    def extents(self) -> dict[str, float]:
        """Return how far the surface reaches, in su, by the key that says so."""
        ...

    def sheet(self, edge_length: float) -> Sheet:
        """Return the exact surface."""
        ...


def check_size(shape: Shape, edge_length: float) -> None:
    """Refuse a shape that is smaller than a mesh edge in any direction.

    Parameters
    ----------
    shape : Shape
        A shape whose numbers do not contradict each other.
    edge_length : float
        Usual length of the mesh edges, in su.

    Raises
    ------
    InputError
        Naming the key of the shape.
    """
    for key, extent in shape.extents().items():
        if not extent >= edge_length:
            raise InputError(
                f"geometry.{key}",
                f"it reaches over {extent:.4g} su, less than one mesh edge of {edge_length:g} su",
                f"at least mesh.edge_length ({edge_length:g})",
                f"a larger {key}, or a smaller mesh.edge_length",
            )


def build_surface(shape: Shape, edge_length: float, regions: Mapping[str, Region]) -> Surface:
    """Return the shape's surface, its mesh edges along the edges of all regions.

    Parameters
    ----------
    shape : Shape
        One of ``SHAPES``.
    edge_length : float
        Usual length of the mesh edges, in su.
    regions : mapping of str to Region
        Regions by name, patch references already resolved. ``Surface.regions`` has the same names.

    Raises
    ------
    InputError
        If the shape's numbers contradict each other or it is smaller than a mesh edge, a region
        makes no sense on the shape or holds no part of it, or the edge length is not positive or
        would make too many triangles.
    """
    shape.check()
    if not 0 < edge_length < np.inf:
        raise InputError("mesh.edge_length", f"{edge_length}", "a positive number")
    check_size(shape, edge_length)
    sheet = shape.sheet(edge_length)
    if sheet.size**2 / edge_length**2 > 0.4 * _MOST_TRIANGLES:
        raise InputError(
            "mesh.edge_length",
            f"{edge_length} would make more than {_MOST_TRIANGLES:.0e} triangles",
            f"above {sheet.size / np.sqrt(0.4 * _MOST_TRIANGLES):.2g}",
        )
    for name, region in regions.items():
        check_region(region, sheet, f"region {name}")
    edge = min(edge_length, sheet.coarsest)
    points, triangles = mesh(sheet, skeleton(sheet, regions, edge), edge)
    return _labelled(sheet, points, triangles, regions)


def points_inside(region: Region, shape: Shape, points: Floats, where: str = "region") -> Mask:
    """Return which of the points (n, 3) of a shape's surface lie in the region, (n,).

    Raises
    ------
    InputError
        If the region makes no sense on the shape.
    """
    sheet = shape.sheet(0.0)
    check_region(region, sheet, where)
    exact = sheet.project(points)
    return contains(region, sheet, exact, sheet.part_of(exact))


def _labelled(
    sheet: Sheet, points: Floats, triangles: Ints, regions: Mapping[str, Region]
) -> Surface:
    centres = sheet.project(centroids(points, triangles))
    part = sheet.part_of(centres)
    masks = {name: contains(one, sheet, centres, part) for name, one in regions.items()}
    for name, mask in masks.items():
        if not mask.any():
            raise _empty(name, points)
    border = open_edges(triangles)
    number = sheet.edge_of(points[border].mean(axis=1))
    names = enumerate(sheet.edge_names)
    edges = {name: border[number == i] for i, name in names if (number == i).any()}
    return Surface(
        points=points,
        triangles=triangles,
        parts=sheet.parts,
        part_of=part,
        axes=sheet.axes,
        frame=_tangent(sheet.frame(centres, part), area_vectors(points, triangles)),
        net=sheet.net(centres, part),
        edges=edges,
        regions=masks,
    )


def _tangent(exact: Floats, normal: Floats) -> Floats:
    """Return the exact frames (m, 2, 3) turned into the triangles' planes, orthonormal."""
    n, e1, e2 = (list(one.T) for one in (normal, exact[:, 0], exact[:, 1]))
    # columns: sums over rows of three are slow
    n = _unit(n)
    along = _dot(e1, n)
    first = _unit([a - along * b for a, b in zip(e1, n, strict=True)])
    second = [n[k - 2] * first[k - 1] - n[k - 1] * first[k - 2] for k in range(3)]
    side = np.sign(_dot(second, e2))
    frame = np.empty((len(normal), 2, 3))
    for k in range(3):
        frame[:, 0, k], frame[:, 1, k] = first[k], second[k] * side
    return frame


def _dot(one: list[Floats], other: list[Floats]) -> Floats:
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


def _unit(vectors: list[Floats]) -> list[Floats]:
    length = np.sqrt(_dot(vectors, vectors))
    return [column / length for column in vectors]


def _empty(name: str, points: Floats) -> InputError:
    low, high = np.round(points.min(axis=0), 3) + 0.0, np.round(points.max(axis=0), 3) + 0.0
    box = ", ".join(f"{axis}: [{a:g}, {b:g}]" for axis, a, b in zip("xyz", low, high, strict=True))
    return InputError(
        f"region {name}",
        "it holds no part of the surface (or is thinner than 0.005 edge lengths)",
        f"the surface lies within {box}",
        "move or widen the region",
    )
