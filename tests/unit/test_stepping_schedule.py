from dataclasses import dataclass

import numpy as np
import pytest

from cardiosurf.stepping.schedule import Segment, current, pending, schedule, switch_on


@dataclass(frozen=True)
class Pulse:
    time: float
    duration: float = 0.0
    profile: np.ndarray = None
    label: str = "test"


def test_steps_fall_on_every_switch_and_on_the_end():
    pulses = (Pulse(0.0), Pulse(10.3, 2.0), Pulse(11.0), Pulse(999.0))
    plan = schedule(pulses, step=1.0, end=40.5)
    marks = [(segment.start, segment.stop) for segment in plan]
    assert marks == [(0.0, 10.3), (10.3, 11.0), (11.0, 12.3), (12.3, 40.5)]
    assert [segment.count for segment in plan] == [11, 1, 2, 29]
    assert all(segment.step <= 1.0 for segment in plan)
    assert plan[0].time(11) == 10.3


def test_a_step_that_fits_is_not_divided():
    # 0.1 is not exact in binary: 300 / 0.1 must not become 3001 steps
    (segment,) = schedule((), step=0.1, end=300.0)
    assert segment.count == 3000
    assert segment.step == 0.1


def test_a_regular_train_has_one_step_length():
    pulses = tuple(Pulse(k * 100.7 / 3.0) for k in range(12))
    plan = schedule(pulses, step=1.5, end=12 * 100.7 / 3.0)
    assert len({segment.step for segment in plan}) == 1


def test_switches_that_differ_by_rounding_are_one():
    plan = schedule((Pulse(0.1 + 0.2), Pulse(0.3)), step=1.0, end=1.0)
    assert len(plan) == 2


def test_nothing_is_left_at_the_end():
    assert schedule((), step=1.0, end=5.0, begin=5.0) == ()


def test_an_instantaneous_pulse_raises_u_and_never_lowers_it():
    state = np.array([[0.2, 0.9, 0.0], [0.5, 0.5, 0.5]])
    pulse = Pulse(3.0, profile=np.array([0.5, 0.5, 0.0]))
    segment = Segment(3.0, 4.0, 1)
    raised = switch_on((pulse,), segment, state)
    assert raised.tolist() == [[0.5, 0.9, 0.0], [0.5, 0.5, 0.5]]
    assert switch_on((pulse,), segment, raised) is raised
    assert switch_on((pulse,), Segment(4.0, 5.0, 1), state) is state


def test_currents_add_up_while_they_last():
    pulses = (Pulse(0.0, 2.0, np.ones(2)), Pulse(1.0, 2.0, np.array([0.0, 3.0])))
    assert current(pulses, Segment(0.0, 1.0, 1)) == pytest.approx([1.0, 1.0])
    assert current(pulses, Segment(1.0, 2.0, 1)) == pytest.approx([1.0, 4.0])
    assert current(pulses, Segment(3.0, 9.0, 1)) is None


def test_pending_until_the_last_switch():
    pulses = (Pulse(0.0), Pulse(5.0, 2.0), Pulse(60.0))
    end = 50.0
    assert pending(pulses, Segment(0.0, 5.0, 5), end)
    assert pending(pulses, Segment(5.0, 7.0, 2), end)
    # the pulse at 60 comes after the end and is not waited for
    assert not pending(pulses, Segment(7.0, 50.0, 43), end)
