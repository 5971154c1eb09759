"""The paper's relative acceleration on a triangulated surface, for any direction field.

    - d^2 n / d lambda^2 = (d_n B / E) v + (B / E) dv/dn + (d_n E / E) dv/dlambda,
    B = div(d p),  E = p . d p

(see ``relative_acceleration``) without coordinates: p is the unit vector in which the wave runs,
d the diffusivity tensor, n = normal x p. Unlike the closed forms of the paper nothing is held
fixed: B has the curvature of the front in it, div p where d = 1.

The tensor jumps at a patch's edge, and a field that jumps has no derivatives: both fields are
smoothed over ``width`` first. The result at an edge goes with 1/width for d_n E and with 1/width^2
for d_n B, so it means something only together with the width.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.analysis.origins import triangle_gradients
from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.errors import InputError
from cardiosurf.geometry.surface import Surface
from cardiosurf.recording.recording import Recording

GAUSSIAN_WIDTH = 2.5631
"""Distance over which a jump smoothed by a Gaussian of unit deviation rises from 10 to 90 %."""
STEPS = 4
"""Implicit steps of the heat equation that take the place of the Gaussian."""
FEWEST_EDGES = 2.0
"""Widths below so many edge lengths show the mesh."""
AGREEMENT = 0.8
"""Where the mean direction is shorter than this, the wave has no single one: a collision."""


@dataclass(frozen=True)
class AccelerationMap:
    """The terms of the relative acceleration, a triangle; NaN where there is no direction.

    Attributes
    ----------
    angle : (m,) float
        Angle A from the first net axis to the smoothed direction, in radians.
    of_velocity : (m,) float
        d_n B / E in 1/su^2, what v is multiplied by.
    of_change : (m,) float
        d_n E / E in 1/su, what dv/dlambda is multiplied by.
    of_spread : (m,) float
        B / E in 1/su, what dv/dn is multiplied by.
    width : float
        Over what jumps were smoothed (10 to 90 %), in su.
    """

    angle: Floats
    of_velocity: Floats
    of_change: Floats
    of_spread: Floats
    width: float

    @property
    def together(self) -> Floats:
        """Return of_velocity + of_change, (m,): v = dv/dlambda = 1, dv/dn = 0 as in Case II."""
        return self.of_velocity + self.of_change


class Smoothing:
    """Smoothing of triangle fields to the vertices of a surface, over a stated width.

    Four implicit steps of the heat equation, no flux through open edges. A jump across a straight
    line rises from 10 to 90 % over ``width``, to 3 %.

    Parameters
    ----------
    points : (n, 3) float
        Vertices, in su.
    triangles : (m, 3) int
        Vertex numbers.
    width : float
        In su.
    """

    def __init__(self, points: Floats, triangles: Ints, width: float) -> None:
        count, corners = len(points), points[triangles]
        twice = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        areas = 0.5 * np.linalg.norm(twice, axis=1)
        owners = np.repeat(np.arange(len(triangles)), 3)
        self._gather = scipy.sparse.csr_array(
            (np.repeat(areas / 3.0, 3), (triangles.ravel(), owners)), shape=(count, len(triangles))
        )
        self._mass = self._gather @ np.ones(len(triangles))
        opposite = corners[:, [2, 0, 1]] - corners[:, [1, 2, 0]]
        local = np.einsum("mid,mjd->mij", opposite, opposite) / (4.0 * areas)[:, None, None]
        rows, columns = np.repeat(triangles, 3, axis=1), np.tile(triangles, (1, 3))
        stiffness = scipy.sparse.csc_array(
            (local.ravel(), (rows.ravel(), columns.ravel())), shape=(count, count)
        )
        step = (width / GAUSSIAN_WIDTH) ** 2 / (2.0 * STEPS)
        matrix = scipy.sparse.diags_array(self._mass) + step * stiffness
        self._solve = scipy.sparse.linalg.splu(scipy.sparse.csc_array(matrix)).solve

    def mean(self, field: Floats) -> Floats:
        """Return the mean (n, c) over each vertex's triangles of a field (m, c), unsmoothed."""
        return np.asarray((self._gather @ field) / self._mass[:, None])

    def smoothed(self, field: Floats) -> Floats:
        """Return a field (m, c) smoothed, at the vertices, (n, c)."""
        values = self.mean(field)
        for _ in range(STEPS):
            values = self._solve(self._mass[:, None] * values)
        return values


def lat_direction(surface: Surface, lat: Floats) -> Floats:
    """Return the unit vectors of the LAT's gradient, (m, 3); NaN where it is not known.

    Parameters
    ----------
    surface : Surface
        The mesh.
    lat : (n,) float
        First activation, NaN = never, in tu.
    """
    gradient = triangle_gradients(surface.points, surface.triangles, lat)
    steepness = np.linalg.norm(gradient, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where((steepness > 0.0)[:, None], gradient / steepness[:, None], np.nan)


def angle_direction(surface: Surface, angle: Floats) -> Floats:
    """Return the unit vectors at angles from the first net axis towards the second, (m, 3).

    Parameters
    ----------
    surface : Surface
        The mesh.
    angle : (m,) float
        Angle A of each triangle, in radians.
    """
    first, second = surface.frame[:, 0], surface.frame[:, 1]
    return np.asarray(np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second)


def acceleration_map(
    surface: Surface, tensor: Floats, direction: Floats, width: float
) -> AccelerationMap:
    """Return the terms of the relative acceleration on each triangle.

    Parameters
    ----------
    surface : Surface
        The mesh.
    tensor : (m, 3, 3) float
        Diffusivity of its triangles, in su^2/tu.
    direction : (m, 3) float
        Unit vectors in which the wave runs, NaN where there are none.
    width : float
        Over what tensor and direction are smoothed: a jump rises from 10 to 90 %, in su.

    Raises
    ------
    InputError
        If the width is less than two edge lengths or wider than the surface.
    """
    _check_width(surface, width)
    points, triangles = surface.points, surface.triangles
    smoothing = Smoothing(points, triangles, width)
    normals = smoothing.mean(np.cross(surface.frame[:, 0], surface.frame[:, 1]))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    heading, known = _headings(smoothing, direction, normals)
    smooth = _tangential(smoothing, surface, tensor, normals)
    flow = np.einsum("nij,nj->ni", smooth, heading)
    energy = np.einsum("ni,ni->n", heading, flow)
    angle = _angles(surface, heading[triangles].sum(axis=1))
    sideways = angle_direction(surface, angle + 0.5 * np.pi)

    def by_n(field: Floats) -> Floats:
        gradient = triangle_gradients(points, triangles, field)
        return np.asarray(np.einsum("md,md->m", gradient, sideways))

    spread = _divergence(points, triangles, flow)
    evened = smoothing.smoothed(spread[:, None])[:, 0]
    # NaN in the divisor where the direction is not known
    here = np.where(known[triangles].all(axis=1), energy[triangles].mean(axis=1), np.nan)
    return AccelerationMap(
        angle=np.where(np.isfinite(here), angle, np.nan),
        of_velocity=by_n(evened) / here,
        of_change=by_n(energy) / here,
        of_spread=spread / here,
        width=width,
    )


def recorded_acceleration(recording: Recording, width: float) -> AccelerationMap:
    """Return the relative acceleration of the first wave of a run.

    Parameters
    ----------
    recording : Recording
        A finished run.
    width : float
        Over what patch edges and directions are smoothed (10 to 90 %), in su.

    Raises
    ------
    InputError
        If the width is less than two edge lengths.
    """
    direction = lat_direction(recording.surface, recording.first_activation)
    return acceleration_map(recording.surface, recording.tissue.tensor, direction, width)


def _check_width(surface: Surface, width: float) -> None:
    """Refuse a width that the mesh cannot show, or that leaves nothing to be seen."""
    edge = float(np.sqrt(surface.areas().mean() * 4.0 / np.sqrt(3.0)))
    if not width >= FEWEST_EDGES * edge:
        raise InputError(
            "width",
            f"{width:g} su with edges of {edge:.3g} su",
            f"at least {FEWEST_EDGES:g} edge lengths",
            "a greater width, or a finer mesh",
        )
    across = float(np.ptp(surface.points, axis=0).max())
    if width > across:
        raise InputError(
            "width",
            f"{width:g} su on a surface {across:.3g} su across: every patch is smoothed away",
            "at most the surface's own width",
            "the width of a front, 12 su",
        )


def _angles(surface: Surface, direction: Floats) -> Floats:
    """Return the angles (m,) of vectors (m, 3) from the first net axis to the second."""
    along, across = np.einsum("mad,md->am", surface.frame, direction)
    return np.asarray(np.arctan2(across, along))


def _divergence(points: Floats, triangles: Ints, flow: Floats) -> Floats:
    """Return the surface divergence (m,) of a tangential field (n, 3)."""
    parts = [triangle_gradients(points, triangles, flow[:, i])[:, i] for i in range(3)]
    return np.asarray(np.sum(parts, axis=0))


def _headings(smoothing: Smoothing, direction: Floats, normals: Floats) -> tuple[Floats, Mask]:
    """Return the smoothed directions (n, 3), of unit length, and where they mean something."""
    given = np.asarray(np.isfinite(direction).all(axis=1))
    share = smoothing.smoothed(given[:, None].astype(np.float64))[:, 0]
    mean = smoothing.smoothed(np.where(given[:, None], direction, 0.0))
    mean -= normals * np.einsum("ni,ni->n", mean, normals)[:, None]
    length = np.linalg.norm(mean, axis=1)
    known = (length > AGREEMENT * share) & (share > 0.5)
    return mean / np.maximum(length, 1e-300)[:, None], known


def _tangential(smoothing: Smoothing, surface: Surface, tensor: Floats, normals: Floats) -> Floats:
    """Return the smoothed tensor, (n, 3, 3), tangential, and exact where it is isotropic.

    On a curved surface smoothing mixes tangential planes, and the tensor of d = 1 comes out as
    some W below 1. So the others are taken as W^-1/2 d W^-1/2.
    """

    def flat(field: Floats) -> Floats:
        mixed = smoothing.smoothed(field.reshape(-1, 9)).reshape(-1, 3, 3)
        return np.asarray(tangent @ mixed @ tangent)

    outward = normals[:, :, None] * normals[:, None, :]
    tangent = np.eye(3) - outward
    isotropic = np.einsum("mai,maj->mij", surface.frame, surface.frame)
    size, axes = np.linalg.eigh(flat(isotropic) + outward)
    root = (axes / np.sqrt(size)[:, None, :]) @ axes.transpose(0, 2, 1)
    return np.asarray(root @ flat(tensor) @ root)
