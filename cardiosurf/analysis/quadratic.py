"""A vertex field about single vertices: quadratics fitted in the tangent plane.

The tangent plane differs from normal coordinates of the surface by terms of third order, so that
gradient and second derivatives of the fit are the surface's own.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from cardiosurf.arrays import Floats, Ints, Mask

FEWEST = 9
"""Places around one that a fit of six coefficients takes."""


@dataclass(frozen=True)
class Fit:
    """What the fits about the vertices of a surface have in common.

    Attributes
    ----------
    points : (n, 3) float
        Vertices, in su.
    normals : (n, 3) float
        Of the surface at each vertex; of length 0 where no triangle of the ground is.
    own : (g,) int
        The vertices that fields are fitted at.
    tree : cKDTree
        Of their places.
    radius : float
        Of the neighbourhood that is fitted, in su; places at its rim count a seventh of the middle.
    """

    points: Floats
    normals: Floats
    own: Ints
    tree: "scipy.spatial.cKDTree[None]"
    radius: float

    @classmethod
    def of(cls, points: Floats, ground: Ints, chosen: Mask, radius: float) -> "Fit":
        """Prepare fits over some vertices of a surface.

        Parameters
        ----------
        points : (n, 3) float
            Vertices, in su.
        ground : (g, 3) int
            The triangles that belong to it, consistently oriented.
        chosen : (n,) bool
            The vertices that fields are fitted at.
        radius : float
            Of the neighbourhoods, in su.
        """
        corners = points[ground]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals = np.zeros_like(points)
        for corner in range(3):
            np.add.at(normals, ground[:, corner], across)
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)
        own = np.flatnonzero(chosen & (length[:, 0] > 0.0))
        return cls(points, normals, own, scipy.spatial.cKDTree(points[own]), radius)

    def around(self, vertex: int, field: Floats) -> tuple[Floats, Floats, float] | None:
        """Return gradient (3,), Hessian (3, 3) and misfit of a field about a vertex.

        Both are tangential. The misfit is the weighted root mean square of what is left over.
        None: there are too few places.

        Parameters
        ----------
        vertex : int
            Where.
        field : (n,) float
            The field; where it is NaN it is not fitted.
        """
        normal = self.normals[vertex]
        near = self.own[self.tree.query_ball_point(self.points[vertex], self.radius)]
        # the other side of a fold is near, but does not belong to it
        near = near[np.isfinite(field[near]) & (self.normals[near] @ normal > 0.5)]
        if len(near) < FEWEST:
            return None
        basis = np.linalg.svd(normal[None, :])[2][1:]
        x, y = basis @ (self.points[near] - self.points[vertex]).T / self.radius
        weight = np.exp(-2.0 * (x * x + y * y))
        terms = np.column_stack((np.ones_like(x), x, y, 0.5 * x * x, x * y, 0.5 * y * y))
        found, _, rank, _ = np.linalg.lstsq(terms * weight[:, None], field[near] * weight)
        if rank < 6:
            return None
        left = terms @ found - field[near]
        misfit = float(np.sqrt(np.average(left * left, weights=weight)))
        second = np.array([[found[3], found[4]], [found[4], found[5]]]) / self.radius**2
        return found[1:3] @ basis / self.radius, basis.T @ second @ basis, misfit
