"""The map from the reference triangle to flat triangles in space; scikit-fem has none."""

import numpy as np
from skfem import MeshTri
from skfem.mapping import Mapping

from cardiosurf.arrays import Floats, Ints
from cardiosurf.errors import InputError


def surface_mesh(points: Floats, triangles: Ints) -> MeshTri:
    """Return the triangles as a mesh of scikit-fem, its points in space.

    scikit-fem refuses such a mesh only because its own mapping is square; with ``SurfaceMapping``
    passed to ``Basis``, topology and dimension of the mesh (2) are all that it takes from here.

    Parameters
    ----------
    points : (n, 3) float
        Vertices, in su.
    triangles : (m, 3) int
        Vertex numbers.
    """
    return MeshTri(np.ascontiguousarray(points.T), np.ascontiguousarray(triangles.T), sort_t=False)


class SurfaceMapping(Mapping):  # type: ignore[misc]  # scikit-fem carries no types
    """The affine map x = x0 + J X of each triangle, J = (x1 - x0, x2 - x0) being 3x2.

    The gradient of a shape function on the surface is (J^+)^T times its reference gradient, with
    the pseudo-inverse J^+ = (J^T J)^-1 J^T; the area element is sqrt(det(J^T J)).
    Array shapes follow scikit-fem: components first, then triangles, then quadrature points.

    Source: Dziuk and Elliott, Acta Numerica 22:289 (2013).

    Raises
    ------
    InputError
        A triangle has no area.
    """

    def __init__(self, mesh: MeshTri) -> None:
        # all arrays have the triangles along contiguous memory, which einsum needs to be quick
        corners = np.take(mesh.p, mesh.t, axis=1)
        self.origin: Floats = corners[:, 0]
        self.jacobian: Floats = np.stack(
            (corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
        )
        gram = np.einsum("iak,ibk->abk", self.jacobian, self.jacobian)
        determinant = gram[0, 0] * gram[1, 1] - gram[0, 1] ** 2
        # relative to the longest edge: twice the area of a triangle of smallest angle 1e-10
        flat = np.flatnonzero(~(determinant > 1e-20 * (gram[0, 0] + gram[1, 1]) ** 2))
        if flat.size:
            raise InputError(
                "mesh",
                f"{flat.size} triangles have no area, the first of them is number {flat[0]}",
                "triangles whose three corners do not lie on a line",
            )
        self.area_element: Floats = np.sqrt(determinant)
        inverse = np.array([[gram[1, 1], -gram[0, 1]], [-gram[0, 1], gram[0, 0]]]) / determinant
        self.pseudo_inverse: Floats = np.einsum("abk,ibk->aik", inverse, self.jacobian, order="C")

    def F(self, X: Floats, tind: Ints | None = None) -> Floats:  # noqa: N802
        """Return the points in space of the reference points X (2, q), as (3, m, q)."""
        J, x0 = self._of(self.jacobian, tind), self._of(self.origin, tind)
        return np.asarray(np.einsum("iak,aq->ikq", J, X) + x0[..., None])

    def DF(self, X: Floats, tind: Ints | None = None) -> Floats:  # noqa: N802
        """Return the Jacobian J at the reference points X, as (3, 2, m, q)."""
        return self._at(self._of(self.jacobian, tind), X)

    def invDF(self, X: Floats, tind: Ints | None = None) -> Floats:  # noqa: N802
        """Return the pseudo-inverse J^+ at the reference points X, as (2, 3, m, q)."""
        return self._at(self._of(self.pseudo_inverse, tind), X)

    def detDF(self, X: Floats, tind: Ints | None = None) -> Floats:  # noqa: N802
        """Return the area element sqrt(det(J^T J)) at the reference points X, as (m, q)."""
        # triangles along contiguous memory: scikit-fem's sums over points are quick then
        return np.repeat(self._of(self.area_element, tind)[None], X.shape[-1], axis=0).T

    @staticmethod
    def _of(values: Floats, tind: Ints | None) -> Floats:
        """Return the values of the triangles asked for (all for None)."""
        return values if tind is None else values[..., tind]

    @staticmethod
    def _at(values: Floats, X: Floats) -> Floats:
        """Return what is constant on a triangle at each of the points X."""
        return np.broadcast_to(values[..., None], (*values.shape, X.shape[-1]))
