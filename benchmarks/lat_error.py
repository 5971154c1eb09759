"""How far a LAT map is from the converged one, at the same points for every code."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

REFERENCE = Path(__file__).resolve().parent / "reference"
EARLIEST = 20.0  # earlier than that, in tu, a LAT tells of the stimulus rather than of the wave


@dataclass(frozen=True)
class LatError:
    """Relative errors of LAT at the sample points.

    ``rms`` is the root of the mean square over that of the reference, ``largest`` the largest
    error over that point's own LAT, ``disagree`` the fraction of points where only one of the two
    has a LAT at all.
    """

    rms: float
    largest: float
    disagree: float


class Locator:
    """Linear interpolation on a triangulated surface at given points near it."""

    def __init__(self, points: np.ndarray, triangles: np.ndarray, at: np.ndarray) -> None:
        corners = points[triangles]
        tree = cKDTree(corners.mean(axis=1))
        _, near = tree.query(at, k=min(24, len(triangles)))
        weights = _weights(corners[near], at[:, None, :])
        places = np.einsum("skc,skcd->skd", weights, corners[near])
        best = np.argmin(np.linalg.norm(places - at[:, None, :], axis=2), axis=1)
        rows = np.arange(len(at))
        self._corners = triangles[near[rows, best]]
        self._weights = weights[rows, best]
        self.distance = np.linalg.norm(places[rows, best] - at, axis=1)

    def __call__(self, field: np.ndarray) -> np.ndarray:
        """Return the field's values at the points."""
        return np.einsum("sc,sc->s", self._weights, field[self._corners])


def _weights(corners: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return barycentric weights (..., 3) of the points' projections, clipped to the triangles."""
    first = corners[..., 1, :] - corners[..., 0, :]
    second = corners[..., 2, :] - corners[..., 0, :]
    offset = at - corners[..., 0, :]
    a, b, c = (
        np.sum(p * q, axis=-1) for p, q in ((first, first), (first, second), (second, second))
    )
    d, e = np.sum(first * offset, axis=-1), np.sum(second * offset, axis=-1)
    u, v = (c * d - b * e) / (a * c - b * b), (a * e - b * d) / (a * c - b * b)
    # clipping is exact inside, and off the true nearest point by far less than an edge outside
    inside = np.clip(np.stack([1.0 - u - v, u, v], axis=-1), 0.0, None)
    return inside / inside.sum(axis=-1, keepdims=True)


def load_reference(problem: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the sample points (s, 3) of a problem and the converged LAT (s,) there."""
    with np.load(REFERENCE / f"{problem}.npz") as stored:
        return stored["points"], stored["lat"].astype(np.float64)


def lat_error(lat: np.ndarray, reference: np.ndarray) -> LatError:
    """Compare LAT at the sample points with the reference; both in tu, NaN for never."""
    # NaN compares false: points that the reference never reaches are left out with the early ones
    counts = reference >= EARLIEST
    lat, reference = lat[counts], reference[counts]
    both = np.isfinite(lat)
    if not both.any():
        return LatError(np.inf, np.inf, 1.0)
    off = lat[both] - reference[both]
    return LatError(
        float(np.sqrt(np.mean(off**2) / np.mean(reference[both] ** 2))),
        float(np.max(np.abs(off) / reference[both])),
        float(np.mean(~both)),
    )
