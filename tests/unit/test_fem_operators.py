import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from skfem import Basis, BilinearForm, ElementTriP1
from skfem.helpers import dot, grad, mul

from cardiosurf.fem.mapping import SurfaceMapping, surface_mesh
from cardiosurf.fem.operators import assemble

MASSES = ["blended", "lumped", "consistent"]


def sheet(nx, ny, edge, *, jitter=0.0):
    """A rectangle of right triangles; inner vertices moved by up to ``jitter`` edges."""
    i, j = (index.ravel() for index in np.meshgrid(range(nx + 1), range(ny + 1), indexing="ij"))
    shift = np.random.default_rng(5).uniform(-jitter, jitter, (2, len(i)))
    shift[:, (i == 0) | (i == nx) | (j == 0) | (j == ny)] = 0.0
    points = edge * np.column_stack((i + shift[0], j + shift[1], 0 * i))
    corner = (i * (ny + 1) + j)[(i < nx) & (j < ny)]
    across = corner + ny + 1
    lower = np.column_stack((corner, across, across + 1))
    return points, np.vstack((lower, np.column_stack((corner, across + 1, corner + 1))))


def rolled(points, radius):
    """The sheet rolled on a cylinder about the y axis: distances along it stay."""
    angle = points[:, 0] / radius
    return np.column_stack((radius * np.sin(angle), points[:, 1], radius * np.cos(angle)))


def constant(tensor, triangles):
    return np.broadcast_to(np.asarray(tensor, dtype=float), (len(triangles), 3, 3))


def operators(points, triangles, tensor=None, mass="blended"):
    tensor = constant(np.eye(3) if tensor is None else tensor, triangles)
    return assemble(points, triangles, tensor, np.ones(len(triangles), bool), mass=mass)


@pytest.mark.parametrize("mass", MASSES)
def test_mass_sums_to_the_area_and_stiffness_kills_constants(mass):
    points, triangles = sheet(12, 9, 0.7, jitter=0.2)
    op = operators(rolled(points, 5.0), triangles, np.diag([1.0, 4.0, 2.0]), mass)
    corners = rolled(points, 5.0)[triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    # rounding: 1e-13 of the sums
    assert op.mass.sum() == pytest.approx(np.linalg.norm(cross, axis=1).sum() / 2, rel=1e-13)
    assert abs(op.stiffness - op.stiffness.T).max() < 1e-13
    assert np.abs(op.stiffness @ np.ones(len(points))).max() < 1e-12
    assert op.mass.has_sorted_indices
    assert op.stiffness.has_sorted_indices


def test_blended_is_the_mean_and_lumped_the_row_sums():
    points, triangles = sheet(5, 4, 1.0, jitter=0.2)
    blended, lumped, consistent = (operators(points, triangles, mass=m).mass for m in MASSES)
    assert abs(blended - (lumped + consistent) / 2).max() < 1e-15
    assert lumped.diagonal() == pytest.approx(consistent.sum(axis=1), rel=1e-14)
    assert lumped.count_nonzero() == len(points)


def test_one_triangle_by_hand():
    # legs 2 and 1: mass A/12 (1 + delta_ij); stiffness from gradients (-1/2,-1), (1/2,0), (0,1)
    points = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    op = operators(points, np.array([[0, 1, 2]]), np.diag([3.0, 5.0, 7.0]), "consistent")
    assert op.mass.toarray() == pytest.approx((np.ones((3, 3)) + np.eye(3)) / 12.0)
    gradients = np.array([[-0.5, -1.0], [0.5, 0.0], [0.0, 1.0]])
    expected = gradients @ np.diag([3.0, 5.0]) @ gradients.T
    assert op.stiffness.toarray() == pytest.approx(expected)


def test_anisotropic_energy_of_a_linear_function_is_exact():
    points, triangles = sheet(10, 6, 0.5, jitter=0.25)
    tensor = np.array([[8.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 99.0]])
    u = 3.0 * points[:, 0] - 2.0 * points[:, 1]
    gradient = np.array([3.0, -2.0, 0.0])
    energy = u @ (operators(points, triangles, tensor).stiffness @ u)
    # (grad u . d grad u) times the area 15; the normal part of d plays no part
    assert energy == pytest.approx(15.0 * gradient @ tensor @ gradient, rel=1e-13)


def test_anisotropic_plane_mode_has_its_eigenvalue():
    # cos(pi x) cos(pi y) on the unit square, d = diag(8, 2): rate 10 pi^2
    points, triangles = sheet(40, 40, 1.0 / 40.0)
    op = operators(points, triangles, np.diag([8.0, 2.0, 0.0]))
    u = np.cos(np.pi * points[:, 0]) * np.cos(np.pi * points[:, 1])
    # Rayleigh quotient: error (k h)^2 / 12 at most, 0.1 % at 40 edges
    rate = (u @ (op.stiffness @ u)) / (u @ (op.mass @ u))
    assert rate == pytest.approx(10.0 * np.pi**2, rel=1e-3)


@pytest.mark.parametrize("mass", MASSES)
def test_rotating_mesh_and_tensor_together_changes_nothing(mass):
    points, triangles = sheet(8, 8, 1.0, jitter=0.2)
    bent = rolled(points, 6.0)
    rng = np.random.default_rng(1)
    factor = rng.normal(size=(len(triangles), 3, 3))
    tensor = factor @ factor.transpose(0, 2, 1) + np.eye(3)
    turn = Rotation.from_euler("xyz", [0.4, 1.1, -2.0]).as_matrix()
    everywhere = np.ones(len(triangles), bool)
    before = assemble(bent, triangles, tensor, everywhere, mass=mass)
    turned = turn @ tensor @ turn.T
    after = assemble(bent @ turn.T + [5.0, -3.0, 2.0], triangles, turned, everywhere, mass=mass)
    # entries are of size 1 to 10, rounding of size 1e-14
    assert abs(before.stiffness - after.stiffness).max() < 1e-12
    assert abs(before.mass - after.mass).max() < 1e-13


def test_scikit_fems_own_basis_gives_the_same_matrices():
    points, triangles = sheet(8, 6, 1.0, jitter=0.25)
    bent = rolled(points, 6.0)
    factor = np.random.default_rng(3).normal(size=(len(triangles), 3, 3))
    tensor = factor @ factor.transpose(0, 2, 1)
    op = operators(bent, triangles, tensor, "consistent")
    mesh = surface_mesh(bent, triangles)
    basis = Basis(mesh, ElementTriP1(), mapping=SurfaceMapping(mesh), intorder=2)
    mass = BilinearForm(lambda u, v, _: u * v).assemble(basis)
    d = np.moveaxis(tensor, 0, -1)[..., None]
    rates = BilinearForm(lambda u, v, w: dot(grad(u), mul(w["d"], grad(v))))
    # entries are of size 1 to 10, rounding of size 1e-15; the stiffness has three points here
    assert abs(op.mass - mass).max() < 1e-15
    assert abs(op.stiffness - rates.assemble(basis, d=d)).max() < 1e-13


def test_a_rolled_sheet_is_isometric():
    # chords instead of arcs: lengths differ by (h / R)^2 / 24 = 4e-6
    points, triangles = sheet(30, 4, 0.1)
    flat, bent = operators(points, triangles), operators(rolled(points, 10.0), triangles)
    assert abs(flat.stiffness - bent.stiffness).max() < 1e-4
    assert flat.mass.sum() == pytest.approx(bent.mass.sum(), rel=1e-5)


@pytest.mark.parametrize("mass", MASSES)
def test_reaction_mass_is_that_of_the_excitable_triangles(mass):
    points, triangles = sheet(6, 3, 1.0)
    excitable = points[triangles][:, :, 0].max(axis=1) <= 4.0
    tensor = constant(np.eye(3), triangles)
    op = assemble(points, triangles, tensor, excitable, mass=mass)
    assert op.reaction_mass.sum() == pytest.approx(12.0)
    assert op.mass.sum() == pytest.approx(18.0)
    assert op.reaction_mass.shape == op.mass.shape
    rest = assemble(points, triangles, tensor, ~excitable, mass=mass)
    assert abs(op.reaction_mass + rest.reaction_mass - op.mass).max() < 1e-14
    assert (op.excitable_nodes == (points[:, 0] <= 4.0)).all()


def test_without_scar_there_is_one_mass():
    op = operators(*sheet(3, 3, 1.0))
    assert op.reaction_mass is op.mass
    assert op.excitable_nodes.all()


@pytest.mark.parametrize("mass", MASSES)
def test_the_matrices_share_one_entry_for_each_vertex_and_each_edge(mass):
    points, triangles = sheet(7, 4, 1.0)
    excitable = points[triangles][:, :, 0].max(axis=1) <= 4.0
    tensor = constant(np.eye(3), triangles)
    op = assemble(points, triangles, tensor, excitable, mass=mass)
    for other in (op.reaction_mass, op.stiffness):
        assert other.indices is op.mass.indices
        assert other.indptr is op.mass.indptr
    # Euler: 8 * 5 vertices and 56 triangles have 40 + 56 - 1 edges
    assert op.mass.nnz == 40 + 2 * 95
    # the diagonals of squares of right triangles carry no flux, and stay as entries
    assert op.stiffness.count_nonzero() < op.stiffness.nnz
