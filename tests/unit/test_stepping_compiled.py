"""The compiled march against the same march in NumPy and SciPy."""

import os
import platform
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array

from cardiosurf.errors import NumericalError
from cardiosurf.fem.operators import Operators, assemble
from cardiosurf.kinetics import KINETICS, FitzHughNagumo, RogersMcCulloch
from cardiosurf.recording.observers import Activation, Probes
from cardiosurf.recording.quiescence import Quiescence
from cardiosurf.stepping.compiled.laws import constants_of, rates
from cardiosurf.stepping.compiled.machine import GROUP, WINDOW
from cardiosurf.stepping.compiled.rows import BLOCK, arrange, weigh
from cardiosurf.stepping.compiled.work import LEAST_CROSSINGS
from cardiosurf.stepping.controls import NODES_A_THREAD, Controls, Execution
from cardiosurf.stepping.march import Problem, march
from cardiosurf.stepping.rest import never
from cardiosurf.stepping.schemes import SCHEMES
from cardiosurf.stepping.solvers import choose_solver
from cardiosurf.stepping.step_rule import StepChoice


@dataclass(frozen=True)
class Pulse:
    profile: np.ndarray
    time: float = 0.0
    duration: float = 0.0
    label: str = "test"


def sheet(nx, ny, edge=2.0, *, tensor=(1.0, 1.0), scar=None, mass="blended"):
    """Points and operators of a distorted rectangle; its vertices are numbered at random."""
    rng = np.random.default_rng(5)
    i, j = (index.ravel() for index in np.meshgrid(range(nx + 1), range(ny + 1), indexing="ij"))
    points = edge * np.column_stack((i, j, 0 * i)).astype(float)
    points[:, :2] += rng.uniform(-0.15, 0.15, (len(points), 2)) * edge
    corner = (i * (ny + 1) + j)[(i < nx) & (j < ny)]
    across = corner + ny + 1
    lower = np.column_stack((corner, across, across + 1))
    triangles = np.vstack((lower, np.column_stack((corner, across + 1, corner + 1))))
    order = rng.permutation(len(points))
    new = np.argsort(order)
    points, triangles = points[order], new[triangles]
    centre = points[triangles].mean(axis=1)
    active = np.ones(len(triangles), bool) if scar is None else ~scar(centre)
    d = np.broadcast_to(np.diag([*tensor, 0.0]), (len(triangles), 3, 3))
    return points, assemble(points, triangles, d, active, mass=mass)


def wall(points, time=0.0):
    return Pulse(1.0 / (1.0 + np.exp(np.clip((points[:, 0] - 6.0) / 0.5, -99, 99))), time)


def controls(end, *, jit=True, scheme="sbdf2", threads=1, tolerance=1e-7):
    solver = choose_solver(1, wanted="cg", tolerance=tolerance)
    execution = Execution(jit, threads)
    return Controls(SCHEMES[scheme], StepChoice(1.0, "test"), end, solver, execution)


def activations(problem, how, **more):
    activation = Activation()
    outcome = march(problem, how, (activation,), **more)
    return activation, outcome


def assert_same_events(ours, reference, *, rel):
    assert len(ours.activations().nodes) > 0
    for kind in ("activations", "repolarisations"):
        mine, theirs = getattr(ours, kind)(), getattr(reference, kind)()
        assert len(mine.nodes) == len(theirs.nodes)
        mine, theirs = (e.times[np.lexsort((e.times, e.nodes))] for e in (mine, theirs))
        assert mine == pytest.approx(theirs, rel=rel)


def assert_same_march(problem, end, *, rel=1e-6, counts=True, **how):
    """Both do the same operations in another order.

    But for rounding they could differ only where a residual meets its goal within rounding: by one
    iteration, worth a part of the solver's tolerance of 1e-7.
    """
    ours, outcome = activations(problem, controls(end, **how))
    reference, expected = activations(problem, controls(end, jit=False, **how))
    assert (outcome.engine, expected.engine) == ("compiled", "numpy")
    assert (outcome.end_time, outcome.reason) == (expected.end_time, expected.reason)
    if counts:
        assert outcome.iterations == pytest.approx(expected.iterations, rel=0.2)
    assert_same_events(ours, reference, rel=rel)


@pytest.fixture(scope="module")
def wave():
    points, op = sheet(40, 30)
    return points, Problem(op, RogersMcCulloch(), (wall(points),))


# ---------------------------------------------------------------- the same numbers


@pytest.mark.parametrize("scheme", SCHEMES)
def test_every_scheme_marches_as_in_numpy(wave, scheme):
    assert_same_march(wave[1], 700.0, scheme=scheme)


def rounded(matrix, row_sums):
    """The matrix with entries in single precision beside the diagonal, and the given row sums."""
    beside = matrix - diags_array(matrix.diagonal())
    beside = csr_array(beside.astype(np.float32), dtype=float)
    return csr_array(beside + diags_array(row_sums - beside.sum(axis=1)))


@pytest.mark.parametrize("scheme", SCHEMES)
def test_only_rounding_is_different_where_the_solver_leaves_nothing(wave, scheme):
    _, problem = wave
    op = problem.operators
    mass = rounded(op.mass, op.mass.sum(axis=1))
    single = Operators(mass, mass, rounded(op.stiffness, np.zeros(mass.shape[0])))
    problem = replace(problem, operators=single)
    # the matrices are rounded to 6e-8, but all else is not, conjugate gradients included
    assert_same_march(problem, 300.0, scheme=scheme, tolerance=1e-13, rel=1e-10, counts=False)


def test_matrices_in_single_precision_move_activation_by_less_than_their_rounding(wave):
    # 6e-8 in each entry, of either sign
    assert_same_march(wave[1], 300.0, tolerance=1e-13, rel=3e-7, counts=False)


@pytest.mark.parametrize("mass", ["blended", "lumped", "consistent"])
def test_every_mass_and_an_anisotropic_tensor(mass):
    points, op = sheet(30, 20, tensor=(1.0, 8.0), mass=mass)
    assert_same_march(Problem(op, RogersMcCulloch(), (wall(points),)), 600.0)


def test_scar_is_spared_the_reaction():
    def scar(centre):
        return np.linalg.norm(centre[:, :2] - (40.0, 30.0), axis=1) < 14.0

    points, op = sheet(40, 30, scar=scar)
    assert op.reaction_mass is not op.mass
    assert_same_march(Problem(op, RogersMcCulloch(), (wall(points),)), 600.0)


def test_currents_and_pulses_between_steps(wave):
    points, problem = wave
    corner = (np.linalg.norm(points[:, :2] - (80.0, 0.0), axis=1) < 12.0) * 0.2
    pulses = (Pulse(corner, 3.3, 9.4), wall(points, 301.25))
    assert_same_march(replace(problem, pulses=pulses), 900.0)


@pytest.mark.parametrize("model", KINETICS)
def test_laws_are_those_of_the_models(model):
    kinetics = KINETICS[model](a=0.11, b1=0.02, b2=0.9, c1=0.3, c2=0.07)
    u, v = np.random.default_rng(1).uniform(-0.2, 1.2, (2, 20))
    f, g = kinetics.rates(u, v)
    one_by_one = np.array([rates(constants_of(kinetics), *pair) for pair in zip(u, v, strict=True)])
    assert one_by_one == pytest.approx(np.column_stack((f, g)), rel=1e-14)


def test_another_model_is_another_machine_code(wave):
    _, problem = wave
    printed = replace(problem, kinetics=FitzHughNagumo(c2=0.03))
    assert_same_march(printed, 600.0)


def test_foreign_kinetics_march_in_numpy(wave):
    class Foreign:
        def rates(self, u, v):
            return RogersMcCulloch().rates(u, v)

    _, problem = wave
    outcome = march(replace(problem, kinetics=Foreign()), controls(20.0))
    assert outcome.engine == "numpy"


# ---------------------------------------------------------------- strides and threads


class Impatient:
    """An observer that wants to see every step."""

    def __init__(self):
        self.moments = []

    def initialize(self, moment):
        pass

    def handle(self, moment):
        self.moments.append(moment)

    def finalize(self, moment):
        pass


def test_long_strides_tell_what_single_steps_tell(wave):
    points, problem = wave
    second = replace(problem, pulses=(*problem.pulses, wall(points, 300.3)))
    nodes = np.array([[5, 900, 17], [900, 33, 2]])
    weights = np.full((2, 3), 1.0 / 3.0)

    def watch():
        return Activation(), Quiescence(), Probes(("a", "b"), np.zeros((2, 3)), nodes, weights)

    single, long, each = watch(), watch(), Impatient()
    one = march(second, controls(1500.0), (*single, each))
    other = march(second, controls(1500.0), long)
    assert (one.end_time, one.steps, one.iterations) == (
        other.end_time,
        other.steps,
        other.iterations,
    )
    assert len([m for m in each.moments if m.time > m.previous_time]) == one.steps
    for a, b in zip(single[0].snapshot().values(), long[0].snapshot().values(), strict=True):
        assert np.array_equal(np.sort(a, axis=0), np.sort(b, axis=0))
    assert single[1].since == long[1].since == one.end_time
    assert np.array_equal(single[2].traces().u, long[2].traces().u)
    assert np.array_equal(single[2].traces().times, long[2].traces().times)


def test_rest_that_begins_and_ends_in_a_long_stride(wave):
    points, problem = wave
    # a current just below what excites: u rises above the level of rest, and falls again
    weak = Pulse(np.full(len(points), 0.004), 20.0, 30.0)
    found = {}
    for jit in (True, False):
        rest = Quiescence()
        march(replace(problem, pulses=(weak,)), controls(900.0, jit=jit), (rest,), stop=never)
        found[jit] = rest.since
    assert found[True] == found[False]
    assert found[True] > 50.0


def test_more_crossings_in_a_step_than_there_is_room_for():
    # uniform tissue under a current: every vertex crosses 0.5 in the same step
    points, op = sheet(80, 80)
    assert len(points) > LEAST_CROSSINGS + len(points) // 16
    pulse = Pulse(np.full(len(points), 0.1), 0.0, 20.0)
    ours, _ = activations(Problem(op, RogersMcCulloch(), (pulse,)), controls(60.0))
    times = ours.activations().first(len(points))
    # the solver's tolerance, 1e-7, over a rise of about 0.1/tu
    assert times == pytest.approx(np.full(len(points), times[0]), abs=1e-5)
    assert 3.0 < times[0] < 7.0


@pytest.mark.parametrize("threads", [2, 3])
def test_threads_change_no_digit(threads):
    points, op = sheet(70, 60, tensor=(2.0, 1.0))
    assert len(points) > 3 * BLOCK
    problem = Problem(op, RogersMcCulloch(), (wall(points),))
    one, _ = activations(problem, controls(150.0))
    more, _ = activations(problem, controls(150.0, threads=threads))
    assert np.array_equal(one.activations().times, more.activations().times)


def test_threads_come_with_the_size_and_heed_their_bound(monkeypatch):
    monkeypatch.setattr("os.sched_getaffinity", lambda _: set(range(8)))
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    assert Execution().fit(NODES_A_THREAD).threads == 1
    assert Execution().fit(3 * NODES_A_THREAD).threads == 3
    assert Execution().fit(100 * NODES_A_THREAD).threads == 8
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    assert Execution().fit(100 * NODES_A_THREAD).threads == 2
    assert Execution(threads=5).fit(10).threads == 5


def test_tissue_long_at_rest_does_not_stop_conjugate_gradients():
    # u falls by exp(-a c1 t) = exp(-0.034 t): below what single precision holds after 2,600 tu
    points, op = sheet(40, 30, tensor=(8.0, 8.0))
    found = Impatient()
    problem = Problem(op, RogersMcCulloch(), (wall(points),))
    outcome = march(problem, controls(4000.0), (found,), stop=never)
    assert (outcome.engine, outcome.end_time) == ("compiled", 4000.0)
    assert np.abs(found.moments[-1].state[0]).max() < 1e-25


# ---------------------------------------------------------------- checkpoints and failures


def test_a_checkpoint_is_to_be_had_until_the_march_goes_on(wave):
    class Keeper(Impatient):
        def due(self):
            return np.inf

    keeper = Keeper()
    march(wave[1], controls(400.0), (keeper,))
    assert len(keeper.moments) < 100
    assert keeper.moments[-1].checkpoint().time == 400.0
    with pytest.raises(LookupError, match="gone on"):
        keeper.moments[-2].checkpoint()


@pytest.mark.parametrize("first", [True, False], ids=["compiled first", "numpy first"])
def test_each_march_goes_on_from_the_others_checkpoint(wave, first):
    _, problem = wave
    keeper, whole = Impatient(), Impatient()
    march(problem, controls(200.0, jit=first), (keeper,), stop=lambda moment: moment.time >= 80.0)
    start = keeper.moments[-1].checkpoint()
    rest = Impatient()
    march(problem, controls(200.0, jit=not first), (rest,), start=start)
    march(problem, controls(200.0), (whole,))
    # u rises by 1 over 10 tu, and matrices in single precision move LAT by 1e-7 of 200 tu
    assert rest.moments[-1].state == pytest.approx(whole.moments[-1].state, abs=1e-6)


def test_a_matrix_that_is_not_positive_ends_the_march():
    n = 50
    mass = csr_array(diags_array([np.where(np.arange(n) == 30, -1.0, 1.0)], offsets=[0]))
    stiffness = csr_array((n, n))
    problem = Problem(Operators(mass, mass, stiffness), RogersMcCulloch(), (), np.full((2, n), 0.5))
    with pytest.raises(NumericalError, match=r"conjugate gradients stopped after 0 .*step 1,"):
        march(problem, controls(10.0, scheme="imex_euler"))


# ---------------------------------------------------------------- the layout


def entries(rows, n, values):
    """The matrix (n, n) of the entries beside the diagonal."""
    slots = np.diff(rows.start.astype(int))
    assert (slots >= 1).all()
    assert (rows.place < WINDOW).all()
    owner = np.repeat(GROUP * np.arange(len(slots)), slots)[:, None] + np.arange(GROUP)
    column = rows.window.astype(int)[:, None] + rows.place
    assert (values[owner >= n] == 0.0).all()
    size = rows.nodal.shape[1]
    # a window that begins with the last row is in the vectors as well
    assert rows.window.max() + WINDOW <= size
    found = np.zeros((size, size))
    np.add.at(found, (owner, column), values)
    return found[:n, :n]


def test_rows_hold_the_matrices_in_another_order():
    _, op = sheet(50, 45, tensor=(3.0, 1.0))
    arrangement = arrange(op)
    rows, vertex = arrangement.rows, arrangement.vertex
    weigh(rows, 0.7)
    n = len(vertex)
    assert n % GROUP > 0
    assert np.array_equal(np.sort(vertex), np.arange(n))
    assert np.array_equal(vertex[arrangement.row], np.arange(n))
    mass = op.mass[vertex][:, vertex].toarray()
    system = mass + 0.7 * op.stiffness[vertex][:, vertex].toarray()
    root = np.sqrt(system.diagonal())
    lumped = mass.sum(axis=1)
    stiffness = op.stiffness[vertex][:, vertex].toarray()
    scaled = system / root / root[:, None]
    for values, matrix in (
        (rows.mass, mass),
        (rows.stiffness, stiffness),
        (rows.system, scaled),
    ):
        beside = matrix - np.diag(matrix.diagonal())
        # single precision: 6e-8 of an entry, of M and w K where their sum is small
        np.testing.assert_allclose(entries(rows, n, values), beside, rtol=1.3e-7, atol=1e-8)
    assert rows.nodal[0, :n] == pytest.approx(lumped, rel=1e-14)
    # the diagonal follows from entries in single precision
    assert rows.nodal[1, :n] == pytest.approx(1.0 / root, rel=1e-7)


def test_rows_of_matrices_with_different_patterns():
    stiffness = csr_array(np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 0.0]]))
    mass = csr_array(np.array([[1.0, 0.0, 0.25], [0.0, 1.0, 0.0], [0.25, 0.0, 1.0]]))
    arrangement = arrange(Operators(mass, mass, stiffness))
    weigh(arrangement.rows, 1.0)
    order, rows = arrangement.vertex, arrangement.rows
    system = (mass + stiffness).toarray()[order][:, order]
    root = 1.0 / rows.nodal[1, :3]
    assert root**2 == pytest.approx(system.diagonal())
    beside = system - np.diag(system.diagonal())
    assert entries(rows, 3, rows.system) * root * root[:, None] == pytest.approx(beside)


# ---------------------------------------------------------------- other processors

MARCH = """
import numpy as np
from test_stepping_compiled import RogersMcCulloch, Problem, activations, controls, sheet, wall
points, op = sheet(40, 30, tensor=(1.0, 3.0))
found, _ = activations(Problem(op, RogersMcCulloch(), (wall(points),)), controls(150.0))
np.save("times.npy", found.activations().first(len(points)))
"""


@pytest.mark.slow
@pytest.mark.parametrize("features", ["", "+avx,+avx2,+fma"], ids=["oldest", "avx2"])
def test_processors_that_pick_in_other_ways_march_alike(wave, tmp_path, features):
    if platform.machine() not in ("x86_64", "AMD64"):
        features = ""
    points, op = sheet(40, 30, tensor=(1.0, 3.0))
    here, _ = activations(Problem(op, RogersMcCulloch(), (wall(points),)), controls(150.0))
    told = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": features}
    paths = os.pathsep.join((str(Path(__file__).parent), *sys.path))
    environment = {**os.environ, **told, "PYTHONPATH": paths, "NUMBA_CACHE_DIR": str(tmp_path)}
    subprocess.run([sys.executable, "-c", MARCH], check=True, cwd=tmp_path, env=environment)
    there = np.load(tmp_path / "times.npy")
    # sums in another order: less than what the solver's tolerance of 1e-7 leaves
    assert there == pytest.approx(here.activations().first(len(points)), rel=1e-6, nan_ok=True)
