"""Singularities followed along paths that are known."""

import numpy as np
import pytest
from rotor_samples import CENTRE, plane

from cardiosurf.analysis.singularities import Singularities, find_singularities
from cardiosurf.analysis.tracks import follow
from cardiosurf.recording.recording import FrameSeries

EDGE = 4.0


def seen_at(times, *paths):
    """Singularities (chirality, function of time, born, died) in every frame, in mixed order."""
    rows = []
    for frame, time in enumerate(times):
        for number, (chirality, place, born, died) in enumerate(paths):
            if born <= time <= died:
                rows.append((frame, (number + frame) % 3, chirality, *place(time), 0.0))
    table = np.array(sorted(rows))
    frames = table[:, 0].astype(int)
    return Singularities(times, frames, frames, table[:, 3:], table[:, 2].astype(int))


def test_two_that_cross_keep_their_chirality():
    times = np.arange(0.0, 200.0, 10.0)
    seen = seen_at(
        times,
        (1, lambda t: (0.2 * t - 20.0, 0.0), 0.0, 500.0),
        (-1, lambda t: (20.0 - 0.2 * t, 0.0), 0.0, 500.0),
    )
    tracks = follow(seen, speed=0.3, slack=1.0)
    assert sorted(track.chirality for track in tracks) == [-1, 1]
    for track in tracks:
        assert track.points[:, 0] == pytest.approx(track.chirality * (0.2 * times - 20.0))
        assert track.path_length == pytest.approx(0.2 * 190.0)
        assert (track.born, track.died, track.lifetime) == (0.0, None, 190.0)
        assert track.at_start


def test_birth_death_and_a_jump_too_far():
    times = np.arange(0.0, 100.0, 10.0)
    jump = (1, lambda t: (0.0 if t < 45.0 else 30.0, 0.0), 20.0, 70.0)
    first, second = follow(seen_at(times, jump), speed=1.0, slack=4.0)
    assert (first.born, first.died) == (20.0, 40.0)
    assert (second.born, second.died) == (50.0, 70.0)
    (whole,) = follow(seen_at(times, jump), speed=2.6, slack=4.0)
    assert (whole.lifetime, whole.path_length) == (50.0, 30.0)


def test_the_sum_of_distances_decides_not_the_nearest_first():
    # both move 4 su to the right; the first comes to lie 1 su from where the second was
    times = np.array([0.0, 10.0])
    paths = [(1, lambda t, x=x: (x + 0.4 * t, 0.0), 0.0, 10.0) for x in (0.0, 5.0)]
    tracks = follow(seen_at(times, *paths), speed=1.0, slack=0.0)
    assert [np.diff(track.points[:, 0]).tolist() for track in tracks] == [[4.0], [4.0]]


def test_the_core_of_a_circling_tip():
    times = np.arange(0.0, 400.0, 5.0)
    angle = 2 * np.pi * times / 100.0
    circle = (-1, lambda t: (7 + 12 * np.cos(np.pi * t / 50), 12 * np.sin(np.pi * t / 50)), 0, 400)
    (track,) = follow(seen_at(times, circle), speed=1.0, slack=1.0)
    middle, radius = track.core(100.0)
    assert middle == pytest.approx([7.0, 0.0, 0.0], abs=1e-9)
    assert radius == pytest.approx(12.0)
    # chords of 20 pieces a turn
    chord = 2 * 12.0 * np.sin((angle[1] - angle[0]) / 2)
    assert track.path_length == pytest.approx(79 * chord)


def test_a_pair_that_annihilates():
    # u - u* and v - v* are x^2 - c (t0 - t) and y: zeros at x = +-sqrt(c (t0 - t)) while t < t0
    square = plane(half=40.0, edge=EDGE)
    times, c, t0 = np.arange(0.0, 400.0, 10.0), 2.0, 305.0
    x, y = square.points[:, 0], square.points[:, 1]
    u = CENTRE.u + 1e-4 * (x * x - c * (t0 - times)[:, None])
    v = CENTRE.v + 1e-3 * np.broadcast_to(y, u.shape)
    series = FrameSeries(times, u.astype(np.float32), v.astype(np.float32))
    seen = find_singularities(series, square.points, square.triangles, CENTRE)
    tracks = follow(seen, speed=0.2, slack=EDGE)
    assert [track.chirality * np.sign(track.points[0, 0]) for track in tracks] == [-1.0, -1.0]
    for track in tracks:
        # x^2 taken linear along an edge of 4 su is off by up to 4 su^2, as if 2 tu had passed; the
        # last frame before t0 is at 300
        assert track.died == 300.0
        where = np.sqrt(c * (t0 - track.times))
        far = where > EDGE
        assert np.abs(np.abs(track.points[far, 0]) - where[far]).max() < EDGE / 2
    assert sum(track.chirality for track in tracks) == 0


def test_no_singularities_have_no_tracks():
    nothing = np.empty(0, dtype=np.int64)
    none = Singularities(np.arange(5.0), nothing, nothing, np.empty((0, 3)), nothing)
    assert follow(none, speed=1.0, slack=1.0) == ()
