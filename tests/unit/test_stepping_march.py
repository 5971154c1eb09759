from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from cardiosurf.errors import NumericalError
from cardiosurf.fem.operators import assemble
from cardiosurf.kinetics import RogersMcCulloch
from cardiosurf.stepping.march import Checkpoint, Controls, Moment, Problem, march
from cardiosurf.stepping.rest import at_rest, never
from cardiosurf.stepping.schemes import SCHEMES, Scheme
from cardiosurf.stepping.solvers import SolverChoice, choose_solver
from cardiosurf.stepping.step_rule import StepChoice


@dataclass(frozen=True)
class Pulse:
    profile: np.ndarray
    time: float = 0.0
    duration: float = 0.0
    label: str = "test"


@dataclass
class Witness:
    """An observer that keeps everything."""

    first: list = field(default_factory=list)
    moments: list = field(default_factory=list)
    last: list = field(default_factory=list)

    def initialize(self, moment):
        self.first.append(moment)

    def handle(self, moment):
        self.moments.append(moment)

    def finalize(self, moment):
        self.last.append(moment)


def sheet(nx, ny, edge, tensor=(1.0, 1.0), excitable=None):
    """Points and operators of a slightly distorted rectangle."""
    i, j = (index.ravel() for index in np.meshgrid(range(nx + 1), range(ny + 1), indexing="ij"))
    points = edge * np.column_stack((i + 0.1 * np.sin(7.0 * j), j, 0 * i)).astype(float)
    corner = (i * (ny + 1) + j)[(i < nx) & (j < ny)]
    across = corner + ny + 1
    lower = np.column_stack((corner, across, across + 1))
    triangles = np.vstack((lower, np.column_stack((corner, across + 1, corner + 1))))
    if excitable is None:
        active = np.ones(len(triangles), bool)
    else:
        active = excitable(points[triangles].mean(axis=1))
    d = np.broadcast_to(np.diag([*tensor, 0.0]), (len(triangles), 3, 3))
    return points, assemble(points, triangles, d, active)


def controls(step, end, *, scheme=SCHEMES["sbdf2"], solver="cg"):
    return Controls(scheme, StepChoice(step, "test"), end, choose_solver(1, wanted=solver))


def wall(points, time=0.0):
    return Pulse(1.0 / (1.0 + np.exp(np.clip((points[:, 0] - 6.0) / 0.5, -99, 99))), time)


@pytest.fixture(scope="module")
def wave():
    """A wave along a short strip."""
    points, op = sheet(30, 2, 2.0)
    return points, Problem(op, RogersMcCulloch(), (wall(points),))


# ---------------------------------------------------------------- what observers see


def test_observers_see_the_start_every_pulse_every_step_and_the_end(wave):
    points, problem = wave
    witness = Witness()
    second = replace(problem, pulses=(*problem.pulses, wall(points, 10.25)))
    outcome = march(second, controls(1.0, 20.0), (witness,))
    (first,), (last,) = witness.first, witness.last
    assert (first.step, first.time) == (0, 0.0)
    assert (first.state == 0.0).all()
    pulses = [m for m in witness.moments if m.time == m.previous_time]
    assert [(m.step, m.time) for m in pulses] == [(0, 0.0), (11, 10.25)]
    assert pulses[0].state[0] == pytest.approx(wall(points).profile)
    assert last is witness.moments[-1]
    assert (last.step, last.time) == (21, 20.0) == (outcome.steps, outcome.end_time)
    assert outcome.longest_step == pytest.approx(9.75 / 10)
    assert outcome.reason == "end"
    for earlier, later in zip(witness.moments, witness.moments[1:], strict=False):
        assert later.previous_time == earlier.time
        assert np.array_equal(later.previous_state, earlier.state)


def test_states_cannot_be_changed_by_observers(wave):
    _, problem = wave
    witness = Witness()
    march(problem, controls(1.0, 3.0), (witness,))
    with pytest.raises(ValueError, match="read-only"):
        witness.moments[1].state[0, 0] = 5.0


def test_a_current_has_no_moment_of_its_own_and_adds_what_it_should():
    # uniform tissue without reaction at u: u_t = s while it lasts, so u = strength * duration
    points, op = sheet(3, 3, 1.0)

    class Inert:
        def rates(self, u, v):
            return 0.0 * u, 0.0 * v

    witness = Witness()
    pulse = Pulse(np.full(len(points), 0.25), 1.3, 2.2)
    march(Problem(op, Inert(), (pulse,)), controls(0.5, 6.0), (witness,), stop=never)
    # tolerance of the solver, 1e-7 a step
    assert witness.last[0].state[0] == pytest.approx(0.25 * 2.2, rel=1e-5)
    assert all(m.time > m.previous_time for m in witness.moments)
    assert {1.3, 3.5} <= {m.time for m in witness.moments}


# ---------------------------------------------------------------- the seams


def test_a_foreign_scheme(wave):
    _, problem = wave
    modified = Scheme(
        "mcnab", 2, (1.0, -1.0), (9 / 16, 6 / 16, 1 / 16), (1.5, -0.5),
        "Ascher, Ruuth and Wetton (1995)",
    )  # fmt: skip
    ours, theirs = Witness(), Witness()
    march(problem, controls(0.25, 30.0), (ours,))
    march(problem, controls(0.25, 30.0, scheme=modified), (theirs,))
    # both of second order: they differ by a few times the error of either, 0.01 % of LAT
    assert theirs.last[0].state == pytest.approx(ours.last[0].state, abs=2e-3)


def test_a_foreign_solver(wave):
    _, problem = wave

    def factory(matrix):
        def solve(rhs, guess, scale):
            return spsolve(matrix.tocsc(), rhs), 1

        return solve

    ours, theirs = Witness(), Witness()
    march(problem, controls(1.0, 30.0, solver="direct"), (ours,))
    choice = SolverChoice("foreign", "test", factory)
    outcome = march(problem, replace(controls(1.0, 30.0), solver=choice), (theirs,))
    assert theirs.last[0].state == pytest.approx(ours.last[0].state, abs=1e-10)
    # one solve a step, three in the starting step
    assert (outcome.iterations, outcome.most_iterations) == (32, 3)
    assert outcome.controls.solver.name == "foreign"


def test_a_foreign_kinetics():
    # logistic growth of uniform tissue, v = 0: u = u0 e^t / (1 - u0 + u0 e^t)
    _, op = sheet(3, 3, 1.0)

    class Logistic:
        def rates(self, u, v):
            return u * (1.0 - u), 0.0 * v

    witness = Witness()
    n = op.mass.shape[0]
    start = np.array((np.full(n, 0.01), np.zeros(n)))
    march(Problem(op, Logistic(), (), start), controls(0.02, 4.0), (witness,), stop=never)
    grown = 0.01 * np.exp(4.0)
    # (0.02)^2 times a constant of order one
    assert witness.last[0].state[0] == pytest.approx(grown / (0.99 + grown), rel=4e-4)


def test_a_foreign_stopping_rule(wave):
    _, problem = wave
    outcome = march(problem, controls(1.0, 30.0), stop=lambda moment: moment.time >= 7.0)
    assert (outcome.end_time, outcome.reason) == (7.0, "rest")


# ---------------------------------------------------------------- both solvers, scars


def lat(problem, solver, nodes):
    witness = Witness()
    march(problem, controls(1.0, 250.0, solver=solver), (witness,))
    u = np.array([m.state[0, nodes] for m in witness.moments])
    times = np.array([m.time for m in witness.moments])
    k, all_of_them = np.argmax(u >= 0.5, axis=0), np.arange(u.shape[1])
    assert (k > 0).all()
    before, after = u[k - 1, all_of_them], u[k, all_of_them]
    return times[k - 1] + (0.5 - before) / (after - before) * (times[k] - times[k - 1])


def test_both_solvers_give_the_same_activation_times():
    points, op = sheet(24, 12, 2.0, tensor=(1.0, 4.0))
    pulse = wall(points)
    problem, nodes = Problem(op, RogersMcCulloch(), (pulse,)), pulse.profile < 0.4
    # conjugate gradients at 1e-7 shift LAT by 1e-6 to 1e-5 of itself
    iterated, solved = lat(problem, "cg", nodes), lat(problem, "direct", nodes)
    assert iterated == pytest.approx(solved, rel=2e-5)


def test_scar_has_diffusion_but_no_reaction():
    points, op = sheet(30, 2, 2.0, excitable=lambda centre: centre[:, 0] < 40.0)
    witness = Witness()
    march(Problem(op, RogersMcCulloch(), (wall(points),)), controls(1.0, 190.0), (witness,))
    # the wave (0.21 su/tu) has come to the scar by now
    u, v = witness.last[0].state
    scar = points[:, 0] > 41.0
    assert (v[scar] == 0.0).all()
    assert v[points[:, 0] < 20.0].min() > 0.1
    near, far = u[np.argsort(points[:, 0])][[-42, -1]]
    assert near > 0.5
    assert 1e-9 < far < 0.2


# ---------------------------------------------------------------- how it ends


def test_it_stops_by_itself_when_all_is_at_rest(wave):
    _, problem = wave
    witness = Witness()
    outcome = march(problem, controls(1.5, 5000.0), (witness,))
    assert outcome.reason == "rest"
    # last LAT about 270, then an APD of 136 and the tail down to 0.05
    assert 420.0 < outcome.end_time < 560.0
    assert witness.last[0].state[0].max() <= 0.05
    assert witness.moments[-2].state[0].max() > 0.05


def test_it_waits_for_a_pulse_to_come(wave):
    points, problem = wave
    later = replace(problem, pulses=(wall(points, 40.0),))
    outcome = march(later, controls(1.5, 45.0))
    assert (outcome.reason, outcome.end_time) == ("end", 45.0)


def test_without_a_stimulus_it_stops_at_once(wave):
    _, problem = wave
    outcome = march(replace(problem, pulses=()), controls(1.5, 45.0))
    assert (outcome.reason, outcome.steps) == ("rest", 1)


@pytest.mark.parametrize(
    ("before", "now", "pending", "verdict"),
    [
        (0.05, 0.04, False, True),
        (0.05, 0.04, True, False),
        (0.03, 0.04, False, False),
        (0.07, 0.06, False, False),
        (0.0, 0.0, False, True),
    ],
)
def test_rule_of_rest(before, now, pending, verdict):
    states = [np.array([[u, 0.0], [0.5, 0.5]]) for u in (now, before)]
    assert at_rest(Moment(1, 1.0, states[0], 0.0, states[1], pending)) is verdict


def test_steps_and_seconds_add_up(wave):
    _, problem = wave
    outcome = march(problem, controls(1.0, 30.0), (Witness(),))
    assert outcome.steps == 30
    assert outcome.iterations >= outcome.most_iterations > 0
    assert 0.0 < outcome.solve_seconds + outcome.observer_seconds < outcome.seconds


# ---------------------------------------------------------------- failures


def test_a_step_too_large_is_named_where_it_blows_up(wave):
    _, problem = wave
    witness = Witness()
    with pytest.raises(NumericalError) as caught:
        march(problem, controls(40.0, 4000.0), (witness,))
    done = witness.moments[-1]
    assert f"at step {done.step + 1}, t = {done.time + 40.0:g} tu" in caught.value.problem
    assert "blew up" in caught.value.problem
    assert caught.value.hint == "a time.step below 40, or time.step: auto"
    assert caught.value.exit_code == 3
    # the step before was still sound, and nothing was finalised
    assert np.abs(done.state[0]).max() <= 10.0
    assert witness.last == []


def test_a_stimulus_too_strong_is_what_the_hint_names(wave):
    _, problem = wave
    strong = replace(problem, pulses=(Pulse(10.0 * problem.pulses[0].profile),))
    # a step as short as auto's, so it is not at fault
    with pytest.raises(NumericalError) as caught:
        march(strong, controls(1.0, 40.0), ())
    assert caught.value.hint.startswith("a weaker stimulus")
    assert "auto" not in caught.value.hint


@pytest.mark.parametrize("solver", ["cg", "direct"])
@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)
def test_a_recovery_that_is_not_finite_is_found_at_once(solver, scheme):
    _, op = sheet(3, 3, 1.0)

    class Broken:
        def rates(self, u, v):
            return -v, np.full_like(v, np.inf)

    how = controls(1.0, 30.0, scheme=scheme, solver=solver)
    with pytest.raises(NumericalError, match=r"at step 1, t = 1 tu"):
        march(Problem(op, Broken()), how, stop=never)


def test_a_solver_that_gives_up_is_named_with_step_and_time(wave):
    _, problem = wave

    def factory(matrix):
        def solve(rhs, guess, scale):
            raise NumericalError("the solver gave up", "another one")

        return solve

    choice = SolverChoice("weak", "test", factory)
    with pytest.raises(NumericalError, match="the solver gave up, at step 1, t = 1 tu"):
        march(problem, replace(controls(1.0, 30.0), solver=choice))


# ---------------------------------------------------------------- taking up again


def stopped_at(problem, how, step):
    """The checkpoint of a march after some steps, as read back from a file."""
    witness = Witness()
    march(problem, how, (witness,), stop=lambda moment: moment.step == step)
    return Checkpoint.from_arrays(witness.last[0].checkpoint().to_arrays())


@pytest.mark.parametrize("solver", ["cg", "direct"])
@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)
@pytest.mark.parametrize("at", [1, 2, 33, 50])
def test_a_resumed_march_is_the_same_bit_for_bit(wave, scheme, solver, at):
    # a pulse falls on step 34, just after the third of these checkpoints
    points, problem = wave
    problem = replace(problem, pulses=(*problem.pulses, wall(points, 32.1)))
    how = controls(1.0, 90.0, scheme=scheme, solver=solver)
    whole, rest = Witness(), Witness()
    march(problem, how, (whole,))
    outcome = march(problem, how, (rest,), start=stopped_at(problem, how, at))
    same = [m for m in whole.moments if m.step >= at and m.time > rest.first[0].time]
    again = [m for m in rest.moments if m.time > rest.first[0].time]
    assert [(m.step, m.time) for m in same] == [(m.step, m.time) for m in again]
    assert all(np.array_equal(a.state, b.state) for a, b in zip(same, again, strict=True))
    assert outcome.steps == whole.last[0].step - at


def test_a_checkpoint_between_a_pulse_and_the_next_step(wave):
    _, problem = wave
    how = controls(1.0, 20.0)
    whole, rest = Witness(), Witness()
    march(problem, how, (whole,))
    just_after_the_pulse = whole.moments[0].checkpoint()
    assert just_after_the_pulse.time == 0.0
    march(problem, how, (rest,), start=just_after_the_pulse)
    assert np.array_equal(rest.last[0].state, whole.last[0].state)
    assert len(rest.moments) == len(whole.moments) - 1


def test_a_march_can_be_carried_on_beyond_its_end(wave):
    _, problem = wave
    first, longer, whole = Witness(), Witness(), Witness()
    march(problem, controls(1.0, 30.0), (first,))
    on = first.last[0].checkpoint()
    outcome = march(problem, controls(1.0, 60.0), (longer,), start=on)
    march(problem, controls(1.0, 60.0), (whole,))
    assert (outcome.end_time, outcome.steps) == (60.0, 30)
    # a new starting step at t = 30 is accurate to the scheme's order, not bit for bit
    assert longer.last[0].state == pytest.approx(whole.last[0].state, abs=2e-4)


def test_a_finished_march_has_nothing_left_to_do(wave):
    _, problem = wave
    witness = Witness()
    march(problem, controls(1.0, 30.0), (witness,))
    end = witness.last[0].checkpoint()
    outcome = march(problem, controls(1.0, 30.0), start=end)
    assert (outcome.steps, outcome.end_time) == (0, 30.0)


def test_a_moment_made_by_hand_has_no_checkpoint():
    with pytest.raises(LookupError):
        Moment(0, 0.0, np.zeros((2, 1)), 0.0, np.zeros((2, 1))).checkpoint()
