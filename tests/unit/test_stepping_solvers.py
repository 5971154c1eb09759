import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array

from cardiosurf.errors import InputError, NumericalError
from cardiosurf.stepping.solvers import choose_solver, conjugate_gradients, direct


@pytest.fixture
def matrix():
    """A diffusion step on a line with diffusivities from 1 to 1000, symmetric positive definite."""
    d = np.geomspace(1.0, 1000.0, 201)
    inner = diags_array([d[:-1] + d[1:] + 1.0, -d[1:-1], -d[1:-1]], offsets=[0, 1, -1])
    return csr_array(inner)


@pytest.mark.parametrize("factory", [conjugate_gradients(1e-12), direct()], ids=["cg", "direct"])
def test_both_solve(matrix, factory):
    exact = np.sin(np.arange(200.0))
    x, _ = factory(matrix)(matrix @ exact, np.zeros(200), matrix @ exact)
    # condition number 4000 times the tolerance
    assert x == pytest.approx(exact, abs=1e-8)


def test_cg_stops_at_the_tolerance_and_uses_the_guess(matrix):
    exact = np.cos(np.arange(200.0))
    rhs = matrix @ exact
    solve = conjugate_gradients(1e-7)(matrix)
    x, cold = solve(rhs, np.zeros(200), rhs)
    # in the norm that divides squares by the diagonal
    weight = 1.0 / np.sqrt(matrix.diagonal())
    residual = np.linalg.norm(weight * (rhs - matrix @ x))
    assert residual <= 1e-7 * np.linalg.norm(weight * rhs)
    _, warm = solve(rhs, exact * (1.0 + 1e-5), rhs)
    assert 0 < warm < cold
    assert solve(rhs, exact, rhs)[1] == 0


def test_cg_leaves_its_arguments_alone(matrix):
    rhs, guess = np.ones(200), np.zeros(200)
    conjugate_gradients()(matrix)(rhs, guess, rhs)
    assert (rhs == 1.0).all()
    assert (guess == 0.0).all()


def test_zero_right_hand_side(matrix):
    x, iterations = conjugate_gradients()(matrix)(*np.zeros((3, 200)))
    assert iterations == 0
    assert (x == 0.0).all()


def test_tissue_long_at_rest_does_not_underflow(matrix):
    # squares of 1e-155 are subnormal: no division by them may happen
    for size in (1e-120, 1e-155, 1e-170, 1e-300):
        x, _ = conjugate_gradients()(matrix)(*np.outer((size, 0.0, size), np.ones(200)))
        assert np.abs(x).max() <= size


@pytest.mark.parametrize("tolerance", [1e-3, 1.1e-5, 0.0, -1e-7, float("nan")])
def test_a_loose_tolerance_is_refused(tolerance):
    with pytest.raises(InputError, match="tolerance"):
        conjugate_gradients(tolerance)


def test_a_matrix_that_is_not_positive_is_found():
    with pytest.raises(NumericalError, match="stopped after 0 iterations"):
        conjugate_gradients()(csr_array(np.diag([1.0, -2.0])))(
            np.array([0.0, 1.0]), np.zeros(2), np.ones(2)
        )


def test_cg_that_does_not_converge_says_so():
    # bending of a line without inertia: conditioned like n^4 = 2.6e13, hopeless at 1e-12
    line = diags_array([2.0, -1.0, -1.0], offsets=[0, 1, -1], shape=(2000, 2000))
    with pytest.raises(NumericalError, match=r"after 1000 iterations at a residual of .* instead"):
        conjugate_gradients(1e-12)(csr_array(line @ line))(
            *np.outer((1.0, 0.0, 1.0), np.ones(2000))
        )


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_cg_refuses_numbers_that_are_not_finite(matrix, wrong):
    with pytest.raises(NumericalError, match="after 0 iterations"):
        conjugate_gradients()(matrix)(*np.outer((wrong, 0.0, 1.0), np.ones(200)))


@pytest.mark.parametrize(
    ("nodes", "stiffness", "steps", "name"),
    [
        (150, 1.0, 1000.0, "direct"),  # measured: 0.02 ms instead of 0.1 ms a step
        (12_000, 0.8, 1000.0, "cg"),  # edge 2.5: 3 iterations, as much as 0.4 of a back-solve
        (12_000, 60.0, 1000.0, "direct"),  # edge 0.3: 20 iterations, more than two back-solves
        (12_000, 20.0, 10.0, "cg"),  # too few steps to pay for the factorisation
        (200_000, 5.0, 1000.0, "cg"),
    ],
)
def test_the_choice_follows_the_measured_rule_in_numpy(nodes, stiffness, steps, name):
    choice = choose_solver(nodes, stiffness=stiffness, steps=steps, compiled=False)
    assert choice.name == name
    assert f"{nodes} nodes" in choice.reason


@pytest.mark.parametrize(
    ("nodes", "stiffness", "steps", "name"),
    [
        (150, 1.0, 1000.0, "cg"),  # 5 us a step in machine code, 80 in NumPy
        (12_000, 60.0, 1000.0, "cg"),  # 20 iterations, 27 us each; a back-solve takes 0.8 ms
        (10_000, 500.0, 1e5, "direct"),  # 57 iterations
        (10_000, 500.0, 100.0, "cg"),  # too few steps to pay for the factorisation
        (160_000, 500.0, 1e5, "cg"),  # a back-solve takes as long as a hundred iterations
    ],
)
def test_the_choice_follows_the_measured_rule_in_machine_code(nodes, stiffness, steps, name):
    choice = choose_solver(nodes, stiffness=stiffness, steps=steps)
    assert choice.name == name


@pytest.mark.parametrize("name", ["cg", "direct"])
def test_the_user_has_the_last_word(name):
    choice = choose_solver(10, wanted=name)
    assert (choice.name, choice.reason) == (name, "asked for")


def test_a_matrix_that_cannot_be_factorised_is_a_numerical_failure():
    with pytest.raises(NumericalError, match="cannot be factorised"):
        direct()(csr_array(np.zeros((2, 2))))
