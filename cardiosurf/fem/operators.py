"""Mass and stiffness of a triangulated surface, assembled by scikit-fem."""

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from scipy.sparse import coo_array, csr_array
from skfem import BilinearForm, ElementTriP1
from skfem.helpers import dot, grad, mul

from cardiosurf.arrays import Floats, Ints, Mask, Matrix
from cardiosurf.fem.hats import Hats, HatValues
from cardiosurf.fem.mapping import SurfaceMapping, surface_mesh

Mass: TypeAlias = Literal["blended", "lumped", "consistent"]
# one point is exact for what is constant; scikit-fem's own rule of order 1 has three
_CENTRE = np.full((2, 1), 1.0 / 3.0), np.array([0.5])


@dataclass(frozen=True)
class Operators:
    """The matrices of M u' = -K u + R f, one row a vertex.

    All three have an entry for each vertex and each edge of the mesh, zeros included, in sorted
    order, and share the arrays ``indices`` and ``indptr``: one loop over rows can serve them all.

    Attributes
    ----------
    mass : (n, n) csr_array
        M, in su^2: integrals of products of hat functions, lumped, consistent or their mean.
    reaction_mass : (n, n) csr_array
        R, the mass of the excitable triangles alone; the same object as ``mass`` if all are.
    stiffness : (n, n) csr_array
        K, in su^2/tu: integrals of grad . d grad; symmetric, K 1 = 0.
    """

    mass: Matrix
    reaction_mass: Matrix
    stiffness: Matrix

    @property
    def excitable_nodes(self) -> Mask:
        """Vertices of the excitable triangles, (n,): the nodes where the reaction acts."""
        return np.asarray(self.reaction_mass.diagonal() > 0.0)


def product(u: Any, v: Any, w: Any) -> Any:
    """Return the integrand u v of the mass matrix."""
    return u * v


def diffusion(u: Any, v: Any, w: Any) -> Any:
    """Return the integrand grad u . d grad v of the stiffness matrix."""
    return dot(grad(u), mul(w["tensor"], grad(v)))


def assemble(
    points: Floats, triangles: Ints, tensor: Floats, excitable: Mask, *, mass: Mass = "blended"
) -> Operators:
    """Return mass and anisotropic stiffness for linear elements on triangles in space.

    Lumped is the diagonal of the consistent mass's row sums; blended is the mean of the two,
    which cancels the leading error of a front's speed (docs/numerics.md).

    Parameters
    ----------
    points : (n, 3) float
        Vertices, in su.
    triangles : (m, 3) int
        Vertex numbers; every vertex is in one of them.
    tensor : (m, 3, 3) float
        Diffusivity of each triangle in ambient coordinates, in su^2/tu; only its tangential part
        counts.
    excitable : (m,) bool
        Triangles with a reaction.
    mass : {"blended", "lumped", "consistent"}
        The quadrature of the mass.

    Raises
    ------
    InputError
        A triangle has no area.
    """
    mesh = surface_mesh(points, triangles)
    mapping = SurfaceMapping(mesh)
    # gradients are constant on a triangle, products of two hat functions are quadratic
    at_centre = _basis(mesh, mapping, ElementTriP1(), quadrature=_CENTRE)
    d = np.ascontiguousarray(np.moveaxis(tensor, 0, -1))[..., None]
    rates = BilinearForm(diffusion).coo_data(at_centre, tensor=d)
    products = BilinearForm(product).coo_data(
        _basis(mesh, mapping, HatValues(), intorder=2, dofs=at_centre.dofs)
    )
    # the real and the imaginary part of one matrix: both are summed into its entries at once
    values = np.empty(len(rates.data), dtype=np.complex128)
    # plus 0 turns -0 into 0
    values.real, values.imag = products.data, rates.data + 0.0
    both = _summed(products, values)
    whole = _with_values(both, _blended(both, both.data.real, mass))
    stiffness = _with_values(both, both.data.imag)
    if excitable.all():
        return Operators(whole, whole, stiffness)
    part = _summed(products, (products.data.reshape(-1, len(triangles)) * excitable).ravel())
    return Operators(whole, _with_values(both, _blended(both, part.data, mass)), stiffness)


def _basis(mesh: Any, mapping: SurfaceMapping, hats: ElementTriP1, **options: Any) -> Hats:
    """Return the hat functions with a quadrature."""
    return Hats(mesh, hats, mapping=mapping, disable_doflocs=True, **options)


def _summed(form: Any, values: Any) -> Any:
    """Return the matrix of local values (9 m,) in the order of an assembled form's."""
    matrix = coo_array((values, tuple(form.indices)), shape=form.shape).tocsr()
    matrix.sum_duplicates()
    return matrix


def _with_values(pattern: Any, values: Floats) -> Matrix:
    """Return the matrix with the entries of another one and these values."""
    matrix: Matrix = csr_array(pattern.shape)
    # set, because the constructor copies them
    matrix.data = np.ascontiguousarray(values)
    matrix.indices, matrix.indptr = pattern.indices, pattern.indptr
    matrix.has_canonical_format = True
    return matrix


def _blended(pattern: Any, consistent: Floats, kind: Mass) -> Floats:
    """Return the values of the mass of a kind, given those of the consistent one."""
    if kind == "consistent":
        return consistent
    lumped = np.zeros_like(consistent)
    row = np.repeat(np.arange(pattern.shape[0]), np.diff(pattern.indptr))
    lumped[pattern.indices == row] = np.bincount(row, consistent)
    return lumped if kind == "lumped" else 0.5 * lumped + 0.5 * consistent
