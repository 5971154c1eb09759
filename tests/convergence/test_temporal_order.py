"""Order in time, measured on a sphere, where a discrete eigenvector removes the error in space."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.sparse.linalg import eigsh
from waves import Pulse, controls, icosphere, operators

from cardiosurf.kinetics import RogersMcCulloch
from cardiosurf.stepping.march import Problem, march
from cardiosurf.stepping.rest import never
from cardiosurf.stepping.schemes import SCHEMES, Scheme

END = 12.0
STEPS = (40, 80, 160)
RATES = np.array([[0.05, -0.3], [0.2, -0.05]])
START = np.array([1.0, 0.5])


class LinearKinetics:
    """f and g linear in u and v, so that the whole problem is a linear equation."""

    def rates(self, u, v):
        return RATES[0, 0] * u + RATES[0, 1] * v, RATES[1, 0] * u + RATES[1, 1] * v


class Last:
    def initialize(self, moment):
        pass

    def handle(self, moment):
        pass

    def finalize(self, moment):
        self.state = moment.state


@pytest.fixture(scope="module")
def sphere():
    """Operators on a sphere of radius 5, an eigenvector of (K, M) with l = 2, its eigenvalue."""
    points, triangles = icosphere(2)
    op = operators(5.0 * points, triangles)
    values, vectors = eigsh(
        op.stiffness.tocsc(),
        9,
        M=op.mass.tocsc(),
        sigma=-0.01,
        v0=points[:, 0] + points[:, 1] * points[:, 2],
    )
    k = np.argsort(values)[4]
    return op, vectors[:, k] / np.abs(vectors[:, k]).max(), values[k]


def final_state(problem, scheme, steps, end=END):
    last = Last()
    march(problem, controls(end / steps, end, scheme=scheme), (last,), stop=never)
    return last.state


def measured_order(problem, scheme, exact, steps=STEPS):
    errors = [np.abs(final_state(problem, scheme, n) - exact).max() for n in steps]
    return np.log2(errors[-2] / errors[-1])


@pytest.mark.parametrize("name", SCHEMES)
def test_order_on_a_sphere(sphere, name):
    op, mode, eigenvalue = sphere
    matrix = RATES - np.diag([eigenvalue, 0.0])
    exact = np.outer(expm(END * matrix) @ START, mode)
    problem = Problem(op, LinearKinetics(), (), np.outer(START, mode))
    # 0.15: what the next term of the error leaves at these steps
    assert measured_order(problem, SCHEMES[name], exact) == pytest.approx(
        SCHEMES[name].order, abs=0.15
    )


@pytest.mark.parametrize("name", SCHEMES)
def test_order_survives_the_switches_of_a_current(sphere, name):
    op, mode, eigenvalue = sphere

    # a current of 0.1 between a quarter and three quarters of the time: three linear equations,
    # one after another, the constant written as a third component
    def flow(time, strength):
        matrix = np.zeros((3, 3))
        matrix[:2, :2] = RATES - np.diag([eigenvalue, 0.0])
        matrix[0, 2] = strength
        return expm(time * matrix)

    whole = flow(END / 4, 0.0) @ flow(END / 2, 0.1) @ flow(END / 4, 0.0)
    exact = np.outer((whole @ [*START, 1.0])[:2], mode)
    pulse = Pulse(0.1 * mode, time=END / 4, duration=END / 2)
    problem = Problem(op, LinearKinetics(), (pulse,), np.outer(START, mode))
    assert measured_order(problem, SCHEMES[name], exact) == pytest.approx(
        SCHEMES[name].order, abs=0.15
    )


@pytest.mark.parametrize("name", SCHEMES)
def test_order_with_the_real_kinetics(sphere, name):
    op, mode, _ = sphere
    problem = Problem(op, RogersMcCulloch(c1=1.0), (), np.array((0.4 + 0.3 * mode, 0.1 * mode)))
    # thirty times finer than the finest step measured: its own error does not show
    reference = final_state(problem, SCHEMES["sbdf2"], 4800)
    assert measured_order(problem, SCHEMES[name], reference) == pytest.approx(
        SCHEMES[name].order, abs=0.15
    )


def test_a_foreign_scheme_of_third_order_keeps_its_order(sphere):
    third = Scheme(
        "sbdf3",
        3,
        (11 / 6, -3.0, 1.5, -1 / 3),
        (1.0,),
        (3.0, -3.0, 1.0),
        "Ascher, Ruuth and Wetton (1995)",
    )
    op, mode, eigenvalue = sphere
    exact = np.outer(expm(END * (RATES - np.diag([eigenvalue, 0.0]))) @ START, mode)
    problem = Problem(op, LinearKinetics(), (), np.outer(START, mode))
    # two starting steps of third-order error each do not spoil it
    assert measured_order(problem, third, exact) == pytest.approx(3.0, abs=0.15)
