"""Views of a surface in space, shaded, coloured by a map."""

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import Normalize, to_rgb
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from cardiosurf.arrays import Floats
from cardiosurf.geometry.surface import Surface
from cardiosurf.report.canvas import INK, NEVER
from cardiosurf.report.layers import COLOURS


def viewpoints(surface: Surface) -> tuple[tuple[float, float], ...]:
    """Return where to look from: (elevation, azimuth) in degrees; nowhere for a plane."""
    if np.ptp(surface.points[:, 2]) == 0:
        return ()
    if surface.parts == ("sphere",):
        return ((22.0, 25.0), (22.0, 205.0))
    if surface.parts in (("torus",), ("vein", "body")):
        # the stimulated side and the one across the hole or behind the vein
        return ((40.0, 25.0), (40.0, 205.0))
    return ((25.0, 40.0),)


def triangle_colours(
    surface: Surface,
    values: Floats,
    norm: Normalize,
    viewpoint: tuple[float, float],
    colours: str = COLOURS,
) -> Floats:
    """Return the shaded colour of each triangle, (m, 3); grey where the field (n,) is NaN."""
    corners = surface.points[surface.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    # sheets are seen from both sides: light falls on the side that is turned to it
    elevation, azimuth = np.radians(np.add(viewpoint, (25.0, -30.0)))
    sun = np.cos(elevation) * np.array([np.cos(azimuth), np.sin(azimuth), np.tan(elevation)])
    shade = 0.75 + 0.25 * np.abs(normals @ sun)[:, None]
    middle = values[surface.triangles].mean(axis=1)
    known = np.isfinite(middle)
    found = np.tile(to_rgb(NEVER), (len(middle), 1))
    found[known] = colormaps[colours](norm(middle[known]))[:, :3]
    return np.asarray(found * shade)


def draw_solid(
    figure: Figure,
    place: SubplotSpec,
    surface: Surface,
    colours: Floats,
    viewpoint: tuple[float, float],
) -> Axes3D:
    """Draw the surface in space.

    Parameters
    ----------
    figure, place : Figure, SubplotSpec
        Where to draw.
    surface : Surface
        What to draw.
    colours : (m, 3) float
        Colour of each triangle.
    viewpoint : pair of float
        Elevation and azimuth, in degrees.
    """
    axes = figure.add_subplot(place, projection="3d")
    if not isinstance(axes, Axes3D):
        raise TypeError("matplotlib gave flat axes for a 3d projection")
    axes.add_collection3d(
        Poly3DCollection(
            surface.points[surface.triangles],
            facecolors=colours,
            edgecolors=colours,
            linewidths=0.2,
            rasterized=True,
        )
    )
    low, high = surface.points.min(axis=0), surface.points.max(axis=0)
    limits: Sequence[tuple[float, float]] = list(zip(low, high, strict=True))
    axes.set(xlim=limits[0], ylim=limits[1], zlim=limits[2])
    axes.set_box_aspect(tuple(high - low), zoom=1.0)
    axes.set_proj_type("ortho")
    axes.view_init(*viewpoint)
    axes.set(xlabel="x [su]", ylabel="y [su]", zlabel="z [su]")
    for axis, extent in zip((axes.xaxis, axes.yaxis, axes.zaxis), high - low, strict=True):
        axis.set_major_locator(MaxNLocator(2 if extent < 0.3 * max(high - low) else 5))
    axes.tick_params(labelsize=7, colors=INK)
    return axes
