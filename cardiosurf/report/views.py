"""Flat views of a surface: projections that overlap nothing, and maps that unroll it.

A view has vertices of its own: along the cut of an unrolled map triangles appear on both sides.
"""

from dataclasses import dataclass, replace

import numpy as np

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.surface import Surface
from cardiosurf.report.angles import revolved_angles, sphere_angles

_ATRIUM = ("vein", "body")


@dataclass(frozen=True)
class View:
    """A flat picture of (a part of) a triangulated surface.

    Attributes
    ----------
    title : str
        What it shows.
    labels : pair of str
        Labels of the two axes, with units.
    points : (k, 2) float
        Places of the view's vertices.
    triangles : (t, 3) int
        The view's vertices of each of its triangles.
    vertex_of : (k,) int
        The mesh vertex of each of the view's.
    triangle_of : (t,) int
        The mesh triangle of each of the view's.
    limits : (2, 2) float
        Least and greatest value on each axis; what an unrolled map draws beyond its cut is outside.
    equal : bool
        Whether both axes have the same unit and are drawn to the same scale.
    """

    title: str
    labels: tuple[str, str]
    points: Floats
    triangles: Ints
    vertex_of: Ints
    triangle_of: Ints
    limits: Floats
    equal: bool


def has_vein(surface: Surface) -> bool:
    """Return whether the surface has a vein that needs a map of its own.

    The atrium's vein is seen in the map of the whole atrium.
    """
    return "vein" in surface.parts and surface.parts != _ATRIUM


def flat_views(surface: Surface) -> tuple[View, ...]:
    """Return the flat views in which the whole surface is seen.

    Planes are seen from above, vein and T-domain along the vein's axis x; sphere, torus and atrium
    are unrolled.
    """
    if surface.parts == ("sphere",):
        return (unrolled_sphere(surface),)
    if surface.parts in (("torus",), _ATRIUM):
        return (unrolled_revolved(surface),)
    solid = bool(np.ptp(surface.points[:, 2]) > 0)
    # the vein narrows all the way from its root to its tip, so that from +x nothing hides anything
    across = (1, 2) if solid else (0, 1)
    points = surface.points[:, across]
    return (
        View(
            title="seen from +x" if solid else "seen from +z",
            labels=("y [su]", "z [su]") if solid else ("x [su]", "y [su]"),
            points=points,
            triangles=surface.triangles,
            vertex_of=np.arange(len(points)),
            triangle_of=np.arange(len(surface.triangles)),
            limits=np.column_stack((points.min(axis=0), points.max(axis=0))),
            equal=True,
        ),
    )


def unrolled_vein(surface: Surface) -> View:
    """Return the vein unrolled: phi to the right, arc length from the root upward.

    Source of the parametrisation: docs/physics.md; x = A (1 - cos theta), the arc length is
    A theta, and the tip, theta = pi/2, lies at x = A.
    """
    inside = np.flatnonzero(surface.part_of == surface.parts.index("vein"))
    nodes = surface.points[surface.triangles[inside]]
    x, y, z = np.moveaxis(nodes, 2, 0)
    radius = float(x.max())
    arc = radius * np.arccos(np.clip(1.0 - x / radius, -1.0, 1.0))
    middle = nodes.mean(axis=1)
    phi = _unwrapped(np.arctan2(y, z), np.arctan2(middle[:, 1], middle[:, 2]))
    return _unrolled(
        surface, inside, (phi, arc), "vein unrolled", ("phi [deg]", "arc length from the root [su]")
    )


def unrolled_sphere(surface: Surface) -> View:
    """Return the sphere unrolled: azimuth phi to the right, polar angle theta downward."""
    inside = np.arange(len(surface.triangles))
    theta, phi = sphere_angles(surface)
    corners = _unwrapped(phi, surface.net[:, 1]), np.degrees(theta)
    return _unrolled(surface, inside, corners, "sphere unrolled", ("phi [deg]", "theta [deg]"))


def unrolled_revolved(surface: Surface) -> View:
    """Return a torus or an atrium unrolled: azimuth phi to the right, theta downward."""
    inside = np.arange(len(surface.triangles))
    theta, phi = revolved_angles(surface)
    corners = _unwrapped(phi, surface.net[:, 1]), np.degrees(theta)
    title = "torus unrolled" if surface.parts == ("torus",) else "atrium unrolled"
    view = _unrolled(surface, inside, corners, title, ("phi [deg]", "theta [deg]"))
    return view if surface.edges else _repeated_upward(view)


def _repeated_upward(view: View) -> View:
    """Return the view of a surface that theta goes round, both ends of it drawn across the cut."""
    height = view.points[view.triangles, 1]
    rows = [np.flatnonzero(out.any(axis=1)) for out in (height > 180.0, height < -180.0)]
    points, triangles, vertices = [view.points], [view.triangles], [view.vertex_of]
    start = len(view.points)
    for row, shift in zip(rows, (-360.0, 360.0), strict=True):
        used, local = np.unique(view.triangles[row], return_inverse=True)
        points.append(view.points[used] + [0.0, shift])
        triangles.append(start + local.reshape(-1, 3))
        vertices.append(view.vertex_of[used])
        start += len(used)
    return replace(
        view,
        points=np.concatenate(points),
        triangles=np.concatenate(triangles),
        vertex_of=np.concatenate(vertices),
        triangle_of=np.concatenate([view.triangle_of, *(view.triangle_of[row] for row in rows)]),
        limits=np.array([[-180.0, 180.0], [-180.0, 180.0]]),
    )


def _unwrapped(angles: Floats, middle: Floats) -> Floats:
    """Return corner angles (t, 3) next to those of the triangles' middles (t,), in degrees."""
    turns = np.round((angles - middle[:, None]) / (2 * np.pi))
    return np.asarray(np.degrees(angles - 2 * np.pi * turns))


def _unrolled(
    surface: Surface,
    inside: Ints,
    corners: tuple[Floats, Floats],
    title: str,
    labels: tuple[str, str],
) -> View:
    """Return the view whose triangles have these corners (t, 3), joined where they agree."""
    phi, upward = corners
    # triangles across the cut at +-180 degrees are drawn at both ends
    right, left = (
        np.flatnonzero(out) for out in ((phi > 180).any(axis=1), (phi < -180).any(axis=1))
    )
    again = np.concatenate((np.arange(len(phi)), right, left))
    shift = np.repeat([0.0, -360.0, 360.0], [len(phi), len(right), len(left)])
    across = (phi[again] + shift[:, None]).ravel()
    vertices = surface.triangles[inside[again]].ravel()
    # a vertex of the mesh is one of the view's for every place that it is drawn at
    height = upward[again].ravel()
    keys = np.column_stack((vertices, np.round(across * 1e6), np.round(height * 1e3)))
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    points = np.column_stack((across, height))[first]
    return View(
        title=title,
        labels=labels,
        points=points,
        triangles=inverse.reshape(-1, 3),
        vertex_of=vertices[first],
        triangle_of=inside[again],
        limits=np.array([[-180.0, 180.0], [points[:, 1].min(), points[:, 1].max()]]),
        equal=False,
    )


def outlines(triangles: Ints) -> list[Ints]:
    """Return the closed outlines of a set of consistently oriented triangles.

    Parameters
    ----------
    triangles : (t, 3) int
        Vertex numbers.

    Returns
    -------
    list of (length,) int
        Each outline's vertices in turn, the set on the same side of all of them.
    """
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    shared = set(map(tuple, sides[:, ::-1].tolist()))
    following: dict[int, list[int]] = {}
    for start, end in sides.tolist():
        if (start, end) not in shared:
            following.setdefault(start, []).append(end)
    loops = []
    while following:
        start = next(iter(following))
        loop, here = [start], _step(following, start)
        while here != start:
            loop.append(here)
            here = _step(following, here)
        loops.append(np.array(loop))
    return loops


def _step(following: dict[int, list[int]], here: int) -> int:
    ways = following[here]
    there = ways.pop()
    if not ways:
        del following[here]
    return there


def seen(view: View, mask: Mask) -> Ints:
    """Return the view's triangles (t', 3) that a mask of the mesh's triangles (m,) selects."""
    return view.triangles[mask[view.triangle_of]]
