"""Profiles against the author's formulas, and the times of trains."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cardiosurf.errors import InputError
from cardiosurf.geometry.regions import Box, BoxLimits
from cardiosurf.geometry.surface import Surface
from cardiosurf.tissue.distance import distance_to_segments
from cardiosurf.tissue.stimuli import (
    S1S2,
    EdgeStimulus,
    PointStimulus,
    RegionStimulus,
    Train,
    beat_times,
    build_pulses,
)

ANYWHERE = Box(BoxLimits())


def strip_of_triangles() -> Surface:
    """A strip 0 <= x <= 20, 0 <= y <= 1 in the plane z = 0, cut every 0.5 su."""
    x = np.arange(0.0, 20.5, 0.5)
    count = len(x)
    low = np.column_stack([x, np.zeros(count), np.zeros(count)])
    lower = np.arange(count - 1)
    first = np.column_stack([lower, lower + 1, lower + count])
    second = np.column_stack([lower + 1, lower + 1 + count, lower + count])
    triangles = np.concatenate([first, second])
    faces = len(triangles)
    inside = low[triangles % count, 0].mean(axis=1) < 3.0
    return Surface(
        points=np.concatenate([low, low + np.array([0, 1, 0])]),
        triangles=triangles,
        parts=("plane",),
        part_of=np.zeros(faces, dtype=np.int64),
        axes=(("x", "y"),),
        frame=np.broadcast_to(np.eye(3)[:2], (faces, 2, 3)),
        net=np.zeros((faces, 2)),
        edges={"left": np.array([[0, count]]), "right": np.array([[count - 1, 2 * count - 1]])},
        regions={"stimulus.0": inside, "stimulus.1": np.zeros(faces, dtype=bool)},
    )


SURFACE = strip_of_triangles()


def test_edge_stimulus_is_the_authors_plane_wave():
    (pulse,) = build_pulses(SURFACE, [EdgeStimulus(edge="left")])
    for x in (0.0, 3.5, 4.0, 4.5, 20.0):
        vertex = np.flatnonzero(SURFACE.points[:, 0] == x)[0]
        # exp(160) at the far end is still a double
        assert pulse.profile[vertex] == pytest.approx(
            1.0 / (1.0 + math.exp((x - 4.0) / 0.1)), rel=1e-12
        )
    assert (pulse.time, pulse.duration) == (0.0, 0.0)


def test_edge_stimulus_has_its_own_position_width_and_amplitude():
    stimulus = EdgeStimulus(edge="right", position=2.0, width=0.5, amplitude=0.8)
    (pulse,) = build_pulses(SURFACE, [stimulus])
    vertex = np.flatnonzero(SURFACE.points[:, 0] == 17.0)[0]
    assert pulse.profile[vertex] == pytest.approx(0.8 / (1.0 + math.exp(2.0)), rel=1e-12)


def test_point_stimulus_is_the_authors_disc():
    (pulse,) = build_pulses(SURFACE, [PointStimulus(centre=(5.0, 0.0, 3.0))])
    r = np.hypot(SURFACE.points[:, 0] - 5.0, SURFACE.points[:, 1])
    # the nearest surface point of the centre is (5, 0, 0)
    np.testing.assert_allclose(
        pulse.profile, np.where(r < 10, np.exp(-(r**2) / 200), 0.0), atol=1e-12
    )


def test_point_stimulus_keeps_its_form_at_another_radius():
    (pulse,) = build_pulses(SURFACE, [PointStimulus(centre=(0.0, 0.0, 0.0), radius=4.0)])
    at = {x: np.flatnonzero((SURFACE.points == [x, 0, 0]).all(axis=1))[0] for x in (2.0, 4.0)}
    assert pulse.profile[at[2.0]] == pytest.approx(math.exp(-0.125), rel=1e-12)
    assert pulse.profile[at[4.0]] == 0.0


def test_region_stimulus_is_one_on_the_vertices_of_its_triangles():
    (pulse,) = build_pulses(SURFACE, [RegionStimulus(region=ANYWHERE, amplitude=0.9)])
    assert set(np.unique(pulse.profile)) == {0.0, 0.9}
    np.testing.assert_array_equal(pulse.profile > 0, SURFACE.points[:, 0] <= 3.0)


def test_a_stimulus_with_a_duration_is_a_current():
    stimulus = RegionStimulus(region=ANYWHERE, at=5.0, duration=2.0, strength=0.3)
    (pulse,) = build_pulses(SURFACE, [stimulus])
    assert (pulse.time, pulse.duration, pulse.profile.max()) == (5.0, 2.0, 0.3)


def test_trains_and_s1s2_beat_when_they_should():
    train = EdgeStimulus(edge="left", at=10.0, train=Train(count=3, interval=250.0))
    assert beat_times(train) == (10.0, 260.0, 510.0)
    pacing = EdgeStimulus(edge="left", s1s2=S1S2(s1_count=2, s1_interval=400.0, s2_interval=170.0))
    assert beat_times(pacing) == (0.0, 400.0, 570.0)


def test_pulses_come_in_the_order_of_time_and_say_what_they_are():
    pulses = build_pulses(
        SURFACE,
        [
            EdgeStimulus(edge="left", at=100.0, train=Train(count=2, interval=300.0)),
            EdgeStimulus(edge="right", at=200.0),
        ],
    )
    assert [(pulse.time, pulse.label) for pulse in pulses] == [
        (100.0, "stimulus.0 beat 1"),
        (200.0, "stimulus.1"),
        (400.0, "stimulus.0 beat 2"),
    ]


@pytest.mark.parametrize(
    ("stimulus", "says"),
    [
        (
            EdgeStimulus(edge="rigth"),
            ["stimulus.0.edge", "'rigth'", "left, right", "did you mean 'right'?"],
        ),
        (
            PointStimulus(centre=(5.0, 0.0, 30.0)),
            ["stimulus.0.centre", "[5.0, 0.0, 30.0]", "30 su", "10 su", "[5, 0, 0]"],
        ),
        (
            PointStimulus(centre=(5.25, 0.0, 0.0), radius=0.1),
            ["stimulus.0.radius", "no vertex", "0.1 su", "above 0.25", "edge_length"],
        ),
        (
            EdgeStimulus(edge="left", strength=0.3),
            ["stimulus.0.strength", "0.3", "without a duration", "duration"],
        ),
        (
            EdgeStimulus(edge="left", duration=3.0),
            ["stimulus.0.duration", "strength", "3"],
        ),
        (
            EdgeStimulus(edge="left", duration=3.0, strength=0.3, amplitude=0.5),
            ["stimulus.0.duration", "without amplitude"],
        ),
        (
            EdgeStimulus(edge="left", train=Train(2, 10.0), s1s2=S1S2(1, 10.0, 5.0)),
            ["stimulus.0", "train and s1s2", "one of them"],
        ),
        (
            EdgeStimulus(
                edge="left",
                duration=7.0,
                strength=0.3,
                s1s2=S1S2(2, s1_interval=9.0, s2_interval=5.0),
            ),
            ["stimulus.0.duration", "5 tu apart overlap", "7 tu", "at most 5"],
        ),
    ],
)
def test_errors_name_the_key_the_value_and_what_is_allowed(stimulus, says):
    with pytest.raises(InputError) as caught:
        build_pulses(SURFACE, [stimulus])
    for words in says:
        assert words in str(caught.value)


def test_an_empty_region_is_refused():
    stimuli = [RegionStimulus(region=ANYWHERE), RegionStimulus(region=ANYWHERE)]
    with pytest.raises(InputError, match=r"stimulus\.1\.region: the region is empty"):
        build_pulses(SURFACE, stimuli)


def test_a_closed_surface_says_that_it_has_no_edges():
    with pytest.raises(InputError, match="this surface is closed"):
        build_pulses(replace(SURFACE, edges={}), [EdgeStimulus(edge="right")])


def test_distance_to_segments_by_hand():
    points = np.array([[0.5, 2, 0], [-3, 4, 0], [2, 0, 0], [1, 0, 5.0]])
    starts = np.array([[0, 0, 0], [10, 10, 10.0]])
    ends = np.array([[1, 0, 0], [10, 10, 10.0]])
    np.testing.assert_allclose(
        distance_to_segments(points, starts, ends), [2.0, 5.0, 1.0, 5.0], rtol=1e-15
    )


def test_distance_to_segments_is_the_same_in_chunks():
    rng = np.random.default_rng(1)
    points, starts = rng.normal(size=(3000, 3)), rng.normal(size=(300, 3))
    ends = starts + 0.3 * rng.normal(size=(300, 3))
    whole = distance_to_segments(points, starts, ends)
    # an independent way: the least distance to many points along each segment bounds it from above
    along = np.linspace(0.0, 1.0, 65)[:, None, None]
    sampled = (starts + along * (ends - starts)).reshape(-1, 3)
    for number in range(0, 3000, 300):
        nearest = np.linalg.norm(sampled - points[number], axis=1).min()
        # samples lie 1/64 of a segment apart, and no segment is longer than 1.5
        assert whole[number] <= nearest + 1e-12
        assert whole[number] >= nearest - 1.5 / 128
