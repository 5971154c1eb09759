"""Mass and stiffness of a triangulated surface, assembled by scikit-fem."""

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from scipy.sparse import csr_array, diags_array
from skfem import Basis, BilinearForm, ElementTriP1
from skfem.helpers import dot, grad, mul

from cardiosurf.arrays import Floats, Ints, Mask, Matrix
from cardiosurf.fem.mapping import SurfaceMapping, surface_mesh

Mass: TypeAlias = Literal["blended", "lumped", "consistent"]


@dataclass(frozen=True)
class Operators:
    """The matrices of M u' = -K u + R f, one row a vertex.

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
    at_centre = _basis(mesh, mapping, 1)
    d = np.ascontiguousarray(np.moveaxis(tensor, 0, -1))[..., None]
    stiffness = _tidy(BilinearForm(diffusion).assemble(at_centre, tensor=d))
    whole = _mass(_basis(mesh, mapping, 2), mass)
    if excitable.all():
        return Operators(whole, whole, stiffness)
    part = _basis(mesh, mapping, 2, elements=np.flatnonzero(excitable))
    return Operators(whole, _mass(part, mass), stiffness)


def _basis(
    mesh: Any, mapping: SurfaceMapping, degree: int, *, elements: Ints | None = None
) -> Basis:
    """Return the hat functions with a quadrature exact up to ``degree``."""
    return Basis(
        mesh,
        ElementTriP1(),
        mapping=mapping,
        intorder=degree,
        elements=elements,
        disable_doflocs=True,
    )


def _mass(basis: Basis, kind: Mass) -> Matrix:
    """Return the mass matrix of the basis's triangles."""
    consistent = _tidy(BilinearForm(product).assemble(basis))
    if kind == "consistent":
        return consistent
    lumped = diags_array(consistent.sum(axis=1)).tocsr()
    return _tidy(lumped if kind == "lumped" else (lumped + consistent) / 2.0)


def _tidy(matrix: Any) -> Matrix:
    """Return the matrix as a csr_array with sorted indices and no stored zeros."""
    tidy = csr_array(matrix)
    tidy.sum_duplicates()
    tidy.eliminate_zeros()
    return tidy
