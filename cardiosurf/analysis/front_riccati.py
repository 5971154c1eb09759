"""The relative acceleration from the LAT itself, without trajectories.

A front's points move with w = d grad T/(grad T . d grad T), by the time T. A neighbour along the
front, at the vector n, moves with w + D_n w, so |n| grows with the rate

    q = |n|'/|n| = t . D_t w,        |n|''/|n| = q' + q^2 = w . grad q + q^2,

t the unit tangent of the front, D the covariant derivative on the surface. Where d = 1 and the
speed c is the same everywhere, q = c K with the front's geodesic curvature K, and Riccati's
equation K' + K^2 = -K_G says that the relative acceleration is -c^2 K_G (Jacobi).
"""

from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.analysis.conductor import Conductor
from cardiosurf.analysis.local_fits import LocalFits
from cardiosurf.analysis.neighbours import neighbours
from cardiosurf.arrays import Floats, Ints

RINGS = 3
"""Edges to each side that a fit takes in."""


@dataclass(frozen=True)
class FrontRiccati:
    """Relative acceleration of neighbours at the vertices, by derivatives of the LAT.

    Attributes
    ----------
    rate : (n,) float
        |n|'/|n| in 1/tu: above 0 where neighbours part; NaN where a fit is not to be had, and on
        the edges between tissues, where it jumps.
    relative : (n,) float
        |n|''/|n| in 1/tu^2.
    rate_error, relative_error : (n,) float
        What they change by when fits reach one ring less far, the greatest change among a vertex
        and its neighbours, scaled up as errors of parabolas go: noise of the LAT and what parabolas
        leave out both show in it.
    """

    rate: Floats
    relative: Floats
    rate_error: Floats
    relative_error: Floats


def front_riccati(
    conductor: Conductor, lat: Floats, labels: Ints | None = None, *, rings: int = RINGS
) -> FrontRiccati:
    """Return the relative acceleration of neighbours on the fronts of an activation map.

    Three derivatives, each a fit of parabolas to the one before, over triangles of one tissue
    alone: across an edge between two of them w jumps.

    Parameters
    ----------
    conductor : Conductor
        The triangles and their diffusivity.
    lat : (n,) float
        Activation times, in tu; NaN where never.
    labels : (m,) int, optional
        The tissue of each triangle; without, there is one.
    rings : int
        How many edges a fit reaches; at least 2.
    """
    count = len(lat)
    kinds = np.zeros(len(conductor.triangles), dtype=np.int64) if labels is None else labels
    reached = np.isfinite(lat[conductor.triangles]).all(axis=1)
    found = np.full((4, count), np.nan)
    for kind in np.unique(kinds[reached]):
        chosen = reached & (kinds == kind)
        inside = np.ones(count, dtype=np.bool_)
        inside[conductor.triangles[~chosen]] = False
        used, corners = np.unique(conductor.triangles[chosen], return_inverse=True)
        piece = Conductor(conductor.points[used], corners.reshape(-1, 3), conductor.tensor[chosen])
        own = inside[used]
        found[:, used[own]] = _piece(piece, lat[used], rings)[:, own]
    return FrontRiccati(*found)


def _piece(piece: Conductor, lat: Floats, rings: int) -> Floats:
    """Return rate, relative acceleration and their errors in one tissue, (4, n)."""
    far = _derivatives(piece, lat, rings)
    near = _derivatives(piece, lat, rings - 1)
    around = neighbours(piece.triangles, len(lat))
    owners = np.repeat(np.arange(len(lat)), around.counts)
    # what a parabola leaves out goes with the square of how far it reaches
    scale = rings**2 / (rings**2 - (rings - 1) ** 2)
    errors = [
        scale * _greatest_around(np.abs(far[k] - near[k]), owners, around.items) for k in range(2)
    ]
    found = np.stack([*far, *errors])
    # a value without its error says nothing
    found[:, ~np.isfinite(found).all(axis=0)] = np.nan
    return found


def _derivatives(piece: Conductor, lat: Floats, rings: int) -> tuple[Floats, Floats]:
    """Return the rate at which neighbours part and their relative acceleration, (n,) each."""
    fits = LocalFits(piece.points, piece.triangles, rings)
    slope = fits.gradient(lat)
    flow = np.einsum("nij,nj->ni", _at_vertices(piece), slope)
    with np.errstate(divide="ignore", invalid="ignore"):
        wave = flow / np.einsum("ni,ni->n", slope, flow)[:, None]
        tangent = np.cross(fits.normals, slope)
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    rate = np.einsum("nj,njk,nk->n", tangent, fits.gradient(wave), tangent)
    change = np.einsum("ni,ni->n", wave, fits.gradient(rate))
    return rate, change + rate * rate


def _at_vertices(piece: Conductor) -> Floats:
    """Return the tensor at the vertices, (n, 3, 3): means over their triangles by area."""
    _, areas = piece.hat_gradients()
    corners, count = piece.triangles.ravel(), len(piece.points)
    owners = np.repeat(np.arange(len(areas)), 3)
    gather = scipy.sparse.csr_array(
        (np.repeat(areas, 3), (corners, owners)), shape=(count, len(areas))
    )
    total = np.asarray(gather @ piece.tangential().reshape(-1, 9))
    around = np.asarray(gather @ np.ones(len(areas)))
    return np.asarray((total / around[:, None]).reshape(-1, 3, 3))


def _greatest_around(values: Floats, owners: Ints, items: Ints) -> Floats:
    """Return the greatest over each vertex and its neighbours, (n,); NaN where it has none."""
    greatest = values.copy()
    np.fmax.at(greatest, owners, values[items])
    return np.where(np.isfinite(values), greatest, np.nan)
