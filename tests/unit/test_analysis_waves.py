"""Activations are traced back to their beats on event lists whose history is known."""

import numpy as np
import pytest
from scipy.spatial import Delaunay

from cardiosurf.analysis.waves import trace_waves, usual_duration
from cardiosurf.recording.recording import Events
from cardiosurf.tissue.stimuli import Pulse

APD = 140.0


@pytest.fixture(scope="module")
def square():
    line = np.arange(-40.0, 41.0, 4.0)
    x, y = np.meshgrid(line, line, indexing="ij")
    points = np.c_[x.ravel(), y.ravel()]
    return points, Delaunay(points).simplices.astype(np.int64)


def events(*maps):
    """Return all activations of some LAT maps, and the repolarisations one APD later."""
    nodes = np.concatenate([np.flatnonzero(np.isfinite(lat)) for lat in maps])
    times = np.concatenate([lat[np.isfinite(lat)] for lat in maps])
    order = np.argsort(times, kind="stable")
    return Events(nodes[order], times[order]), Events(nodes[order], times[order] + APD)


def pulse(profile, time=0.0, duration=0.0):
    return Pulse(time, duration, np.asarray(profile, dtype=float), "stimulus.0")


def trace(square, maps, *pulses):
    points, triangles = square
    return trace_waves(*events(*maps), triangles, pulses, len(points))


def test_the_usual_duration_is_the_median(square):
    points, _ = square
    assert usual_duration(*events(points[:, 0] + 40.0), len(points)) == pytest.approx(APD)
    empty = Events(np.empty(0, dtype=np.int64), np.empty(0))
    assert usual_duration(empty, empty, 5) == float("inf")


def test_a_plane_wave_goes_back_to_its_pulse(square):
    points, _ = square
    waves = trace(square, [(points[:, 0] + 40) / 0.2], pulse(points[:, 0] < -39))
    assert set(waves.beats) == {0}
    assert set(waves.pulses) == {0}
    assert len(waves.nodes) == len(points)


def test_paced_waves_are_beats_of_their_own(square):
    points, _ = square
    first = (points[:, 0] + 40) / 0.2
    wall = points[:, 0] < -39
    pulses = [pulse(wall, 500.0 * beat) for beat in range(3)]
    waves = trace(square, [first, first + 500.0, first + 1000.0], *pulses)
    np.testing.assert_array_equal(waves.pulses.reshape(-1, 3), np.tile([0, 1, 2], (len(points), 1)))


def test_a_rotating_wave_goes_back_to_one_beat_however_many_pulses_there_were(square):
    # a rigid rotor of period 250 set off at time 0, and a train elsewhere that captures nothing
    points, _ = square
    angle = np.arctan2(points[:, 1], points[:, 0]) % (2 * np.pi)
    hole = np.hypot(*points.T) < 10.0
    lat = np.where(hole, np.nan, 250.0 * angle / (2 * np.pi))
    started = pulse((angle == 0.0) & ~hole)
    idle = [pulse(np.zeros(len(points)), 20.0 * beat) for beat in range(1, 5)]
    waves = trace(square, [lat + 250.0 * turn for turn in range(4)], started, *idle)
    counts = np.bincount(waves.nodes[waves.beats == waves.beats[0]], minlength=len(points))
    assert (counts[~hole] == 4).all()


def test_a_wave_and_its_echo_share_a_beat_and_a_new_stimulus_does_not(square):
    points, _ = square
    first = (points[:, 0] + 40) / 0.2
    # the echo runs back from the far wall, where the wave ended at 400, after a wait of 100
    echo = 500.0 + (40 - points[:, 0]) / 0.2
    echo[points[:, 0] > 39] = np.nan
    last = points[:, 0] > 35
    echo[last & (points[:, 0] < 39)] = 500.0
    waves = trace(square, [first, echo, first + 2000.0], pulse(first < 1), pulse(first < 1, 2000.0))
    beats = waves.beats[waves.nodes == np.flatnonzero(points[:, 0] == 0)[0]]
    assert beats[0] == beats[1]
    assert beats[2] != beats[0]


def test_a_rim_that_dips_below_threshold_is_one_activation(square):
    points, _ = square
    lat = np.hypot(*points.T) / 0.2
    rim = np.where(np.hypot(*points.T) < 15, 12.0, np.nan)
    waves = trace(square, [np.where(lat < 75, 0.0, lat), rim], pulse(lat < 75))
    assert len(waves.nodes) == len(points)


def test_a_long_current_that_fires_again_makes_beats(square):
    points, _ = square
    first = (points[:, 0] + 40) / 0.2
    wall = 0.02 * (points[:, 0] < -39)
    waves = trace(square, [first + 20, first + 620], pulse(wall, 0.0, 2000.0))
    assert len(set(waves.beats)) == 2
    assert set(waves.pulses) == {0}
