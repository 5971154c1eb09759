import numpy as np
import pytest
from recording_samples import moments, potentials, recorded, recorders, square_surface

from cardiosurf.errors import InputError
from cardiosurf.recording.growing import FIRST_ROWS, GrowingTable
from cardiosurf.recording.observers import Activation, Frames, Probes
from cardiosurf.recording.spool import Spool
from cardiosurf.stepping.moment import Moment


def watch(observer, times, states):
    """Let an observer see a march."""
    seen = list(moments(np.asarray(times, dtype=float), states))
    observer.initialize(seen[0])
    for moment in seen[1:]:
        observer.handle(moment)
    observer.finalize(seen[-1])
    return observer


def test_lat_of_a_travelling_front_is_interpolated_inside_the_step():
    speed, length, step = 0.2123, 2.7735, 1.3
    x = np.linspace(5.0, 100.0, 60)
    times = np.arange(0.0, 1200.0, step)

    def front(t):
        return 1.0 / (1.0 + np.exp((x - speed * t[:, None]) / length))

    u = front(times) - front(times - 400.0)
    activation = watch(Activation(), times, np.stack((u, u), axis=1))
    # With h = step c / L, a line through two points of the logistic meets 0.5 within h^3/100 of
    # where the logistic does (its second derivative is zero there), in units of L / c.
    tolerance = (step * speed / length) ** 3 / 100 * length / speed
    assert activation.activations().first(60) == pytest.approx(x / speed, abs=tolerance)
    assert activation.repolarisations().first(60) == pytest.approx(x / speed + 400, abs=tolerance)
    assert tolerance < 1e-3 * step


def test_events_of_signals_that_touch_pass_and_start_at_the_threshold():
    states = potentials(
        [0.0, 0.4, 0.6, 0.2, 0.9, 0.1],  # twice up, twice down
        [0.0, 0.5, 0.0, 0.5, 1.0, 1.0],  # a touch is no crossing; 0.5 then up: at the touch
        [0.7, 0.7, 0.5, 0.3, 0.5, 0.5],  # active at the start; falls through 0.5 at a step
        [0.1, 0.2, 0.3, 0.4, 0.4, 0.0],  # never
    )
    activation = watch(Activation(), [0, 1, 2, 4, 5, 6], states)
    up, down = activation.activations(), activation.repolarisations()
    assert list(zip(up.nodes, up.times, strict=True)) == [
        (2, 0.0),
        (0, pytest.approx(1.5)),
        (1, 4.0),
        (0, pytest.approx(4 + 3 / 7)),
    ]
    assert list(zip(down.nodes, down.times, strict=True)) == [
        (2, 2.0),
        (0, pytest.approx(2.5)),
        (0, pytest.approx(5.5)),
    ]
    assert up.count(4).tolist() == [2, 1, 1, 0]
    assert up.last(4)[:3] == pytest.approx([4 + 3 / 7, 4.0, 0.0])
    assert np.isnan([up.first(4)[3], up.last(4)[3], down.first(4)[1], down.first(4)[3]]).all()


def test_nodes_that_a_pulse_lifts_above_the_threshold_are_activated_at_its_time():
    states = potentials([0.0, 0.0, 1.0, 0.9], [0.0, 0.0, 0.3, 0.6])
    activation = watch(Activation(), [0.0, 7.0, 7.0, 8.0], states)
    assert activation.activations().times.tolist() == [7.0, pytest.approx(7 + 2 / 3)]


def test_probes_are_exact_for_linear_fields():
    surface = square_surface()
    rng = np.random.default_rng(1)
    weights = rng.dirichlet((1.0, 1.0, 1.0), size=5)
    nodes = surface.triangles[rng.integers(len(surface.triangles), size=5)]
    places = np.einsum("pc,pcx->px", weights, surface.points[nodes])
    times = np.linspace(0.0, 3.0, 7)
    x, y, _ = surface.points.T
    states = np.stack([np.stack((2 + 3 * x - y + t, x + t * y)) for t in times])
    probes = watch(Probes(tuple("abcde"), places, nodes, weights), times, states).traces()
    px, py, _ = places.T
    # round-off of numbers up to 200
    assert probes.u == pytest.approx(2 + 3 * px - py + times[:, None], abs=1e-11)
    assert probes.v == pytest.approx(px + times[:, None] * py, abs=1e-11)
    assert probes.times.tolist() == times.tolist()


def test_frames_come_at_the_first_step_at_or_beyond_each_multiple_and_at_the_end(tmp_path):
    times = np.cumsum(np.full(45, 0.7)) - 0.7
    states = potentials(np.linspace(0, 1, 45).tolist(), np.linspace(1, 0, 45).tolist())
    frames = Frames(7.0, Spool(tmp_path / "frames.spool", 2))
    series = watch(frames, times, states).series()
    expected = [0, 10, 20, 30, 40, 44]
    assert series.times.tolist() == times[expected].tolist()
    assert np.array_equal(series.u, states[expected, 0].astype(np.float32))
    assert np.array_equal(series.v, states[expected, 1].astype(np.float32))


def test_steps_longer_than_the_frame_interval_give_one_frame_each(tmp_path):
    states = potentials([0.0, 0.1, 0.2, 0.3])
    frames = Frames(1.0, Spool(tmp_path / "frames.spool", 1))
    assert watch(frames, [0, 2.5, 5.0, 7.5], states).series().times.tolist() == [
        0,
        2.5,
        5,
        7.5,
    ]


def test_a_pulse_at_the_time_of_a_frame_is_in_the_frame(tmp_path):
    frames = Frames(5.0, Spool(tmp_path / "frames.spool", 1))
    states = potentials([0.0, 1.0, 0.9, 0.8])
    series = watch(frames, [0.0, 0.0, 4.0, 6.0], states).series()
    assert series.times.tolist() == [0.0, 6.0]
    assert series.u[:, 0].tolist() == [np.float32(1.0), np.float32(0.8)]


def test_a_spool_that_lost_frames_is_refused(tmp_path):
    spool = Spool(tmp_path / "frames.spool", 3)
    spool.append(0.0, np.zeros((2, 3)))
    with pytest.raises(InputError, match="fewer than the 2 frames"):
        spool.truncate(2)


def test_a_spool_in_an_unwritable_place_is_refused(tmp_path):
    with pytest.raises(InputError, match="cannot be written"):
        Spool(tmp_path / "nowhere" / "frames.spool", 3)


def test_growing_table_keeps_all_rows_beyond_its_first_room():
    table = GrowingTable(2)
    rows = np.arange(8.0 * FIRST_ROWS).reshape(-1, 2)
    for block in np.array_split(rows, 7):
        table.append(block)
    assert np.array_equal(table.rows(), rows)
    table.append(np.array([1.0, 2.0]))
    assert len(table) == len(rows) + 1


@pytest.mark.parametrize("cut", [1, 9, 10, 23, 40])
def test_observers_restored_in_mid_run_record_bit_for_bit_the_same(tmp_path, cut):
    surface = square_surface()
    rng = np.random.default_rng(3)
    times = np.cumsum(rng.uniform(0.1, 1.0, 50))
    states = rng.uniform(0.0, 1.0, (50, 2, len(surface.points)))
    whole = recorders(tmp_path / "whole", surface)
    for observer in whole.values():
        watch(observer, times, states)
    first = recorders(tmp_path / "parts", surface)
    seen: list[Moment] = list(moments(times, states))
    for observer in first.values():
        observer.initialize(seen[0])
        for moment in seen[1 : cut + 1]:
            observer.handle(moment)
    memory = {name: dict(observer.snapshot()) for name, observer in first.items()}
    for observer in first.values():  # it goes on a little before it dies
        for moment in seen[cut + 1 : cut + 6]:
            observer.handle(moment)
    second = recorders(tmp_path / "parts", surface)
    for name, observer in second.items():
        observer.restore(memory[name])
        observer.initialize(seen[cut])
        for moment in seen[cut + 1 :]:
            observer.handle(moment)
        observer.finalize(seen[-1])
    for expected, found in zip(recorded(whole), recorded(second), strict=True):
        assert np.array_equal(expected, found)
        assert len(expected) > 3
