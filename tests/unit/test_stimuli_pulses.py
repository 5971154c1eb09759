"""Profiles against the author's formulas, and the times of trains."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cardiosurf.errors import InputError
from cardiosurf.geometry import build_surface
from cardiosurf.geometry.plane import Plane
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


def hat_areas():
    corners = SURFACE.points[SURFACE.triangles]
    areas = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    return np.bincount(SURFACE.triangles.ravel(), np.repeat(areas / 3.0, 3))


def integral(pulse):
    """The integral of a profile over the strip, which is 1 su wide."""
    return float(pulse.profile @ hat_areas())


def hat_mean_1d(function, x, half=0.5):
    """The mean of a function of x over hats of half-width 0.5 about x, by fine quadrature."""
    offset = np.linspace(-half, half, 20_001)
    weight = 1.0 - np.abs(offset) / half
    return np.array([(function(at + offset) * weight).sum() / weight.sum() for at in x])


def column_means(pulse, places):
    """The mean of the two vertices above one another: a hat of x alone on this mesh."""
    areas, x = hat_areas(), SURFACE.points[:, 0]
    return np.array(
        [(pulse.profile * areas)[x == at].sum() / areas[x == at].sum() for at in places]
    )


def test_edge_stimulus_is_the_authors_plane_wave_in_the_mean():
    (pulse,) = build_pulses(SURFACE, [EdgeStimulus(edge="left")])
    places = np.array([0.5, 3.5, 4.0, 4.5, 10.0])
    # exp(160) at the far end is still a double
    expected = hat_mean_1d(lambda x: 1.0 / (1.0 + np.exp(np.minimum((x - 4.0) / 0.1, 99))), places)
    # pieces of 0.13 su against a width of 0.1
    assert column_means(pulse, places) == pytest.approx(expected, abs=2e-3)
    # the integral over x of the profile is its position, but for exp(-40)
    assert integral(pulse) == pytest.approx(4.0, abs=1e-3)
    assert (pulse.time, pulse.duration) == (0.0, 0.0)


def test_edge_stimulus_has_its_own_position_width_and_amplitude():
    stimulus = EdgeStimulus(edge="right", position=2.0, width=0.5, amplitude=0.8)
    (pulse,) = build_pulses(SURFACE, [stimulus])
    # 0.8 times the integral of 1/(1 + exp((s - 2)/0.5)) from s = 0: 0.5 ln(1 + e^4)
    assert integral(pulse) == pytest.approx(0.8 * 0.5 * math.log1p(math.exp(4.0)), abs=1e-3)


def test_point_stimulus_is_the_authors_disc_in_the_mean():
    (pulse,) = build_pulses(SURFACE, [PointStimulus(centre=(5.0, 0.0, 3.0))])
    # the nearest surface point of the centre is (5, 0, 0)
    near = SURFACE.points[:, 0] < 14.0
    r = np.hypot(SURFACE.points[:, 0] - 5.0, SURFACE.points[:, 1])
    # a mean over hats 0.5 to 1 su wide: curvature 0.01 times a second moment of at most 0.2
    assert pulse.profile[near] == pytest.approx(np.exp(-(r[near] ** 2) / 200), abs=0.03)
    assert (pulse.profile[SURFACE.points[:, 0] > 15.5] == 0.0).all()


@pytest.mark.parametrize("edge", [0.7, 2.0, 4.0])
def test_a_discs_integral_is_the_same_on_every_mesh(edge):
    surface = build_surface(Plane(x=(-20.0, 20.0), y=(-20.0, 20.0)), edge, {})
    (pulse,) = build_pulses(surface, [PointStimulus(centre=(0.3, -0.7, 0.0))])
    # 2 pi times the integral of r exp(-r^2/200) from 0 to 10
    exact = 200.0 * math.pi * (1.0 - math.exp(-0.5))
    # pieces of at most 0.17 su along a circle of 63 su where 0.6 jumps, of random sign
    assert pulse.profile @ surface.vertex_areas() == pytest.approx(exact, rel=1e-3)


def test_point_stimulus_keeps_its_form_at_another_radius():
    (pulse,) = build_pulses(SURFACE, [PointStimulus(centre=(0.0, 0.0, 0.0), radius=4.0)])
    (wider,) = build_pulses(SURFACE, [PointStimulus(centre=(0.0, 0.0, 0.0), radius=8.0)])
    assert 0.0 < pulse.profile.max() <= 1.0
    assert SURFACE.points[pulse.profile > 0, 0].max() == 4.0
    assert SURFACE.points[wider.profile > 0, 0].max() == 8.0


def test_region_stimulus_is_one_inside_and_a_share_on_its_edge():
    (pulse,) = build_pulses(SURFACE, [RegionStimulus(region=ANYWHERE, amplitude=0.9)])
    x = SURFACE.points[:, 0]
    assert pulse.profile[x < 3.0] == pytest.approx(0.9, rel=1e-12)
    assert (pulse.profile[x > 3.0] == 0.0).all()
    # of the triangles at a vertex of the edge a third or two thirds lie inside
    assert sorted(pulse.profile[x == 3.0]) == pytest.approx([0.3, 0.6], rel=1e-12)


def test_a_stimulus_with_a_duration_is_a_current():
    stimulus = RegionStimulus(region=ANYWHERE, at=5.0, duration=2.0, strength=0.3)
    (pulse,) = build_pulses(SURFACE, [stimulus])
    assert (pulse.time, pulse.duration) == (5.0, 2.0)
    assert pulse.profile.max() == pytest.approx(0.3, rel=1e-12)


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
