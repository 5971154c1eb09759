"""Phase singularities of waves whose phase is given by a formula."""

import numpy as np
import pytest
from rotor_samples import CENTRE, annulus, frames, plane, rotor_phases, sphere

from cardiosurf.analysis.phase import phase, phase_centre, turns
from cardiosurf.analysis.rims import find_rims, lasting, rim_chiralities
from cardiosurf.analysis.singularities import find_singularities
from cardiosurf.recording.recording import FrameSeries
from cardiosurf.tissue.tensor import Tissue

EDGE, PERIOD = 4.0, 200.0
TIMES = np.arange(0.0, 400.0, 10.0)


@pytest.fixture(scope="module")
def square():
    return plane(edge=EDGE)


def tissue(surface, passive=None):
    count = len(surface.triangles)
    patch_of = np.full(count, -1) if passive is None else np.where(passive, 0, -1)
    excitable = np.ones(count, bool) if passive is None else ~passive
    return Tissue(np.tile(np.eye(3), (count, 1, 1)), excitable, ("scar",), patch_of)


def found(surface, series):
    return find_singularities(series, surface.points, surface.triangles, CENTRE)


def test_the_phase_grows_through_front_plateau_and_tail():
    u, v = np.array([0.0, 0.5, 1.0, 0.5]), np.array([0.25, 0.0, 0.25, 0.5])
    assert phase(u, v, CENTRE) / np.pi == pytest.approx([1.0, -0.5, 0.0, 0.5])


def test_the_centre_is_half_the_largest_v_and_there_is_none_at_rest():
    v = np.zeros((7, 3), np.float32)
    at_rest = FrameSeries(np.arange(7.0), v, v)
    assert phase_centre(at_rest) is None
    v = v.copy()
    v[4, 1] = 0.5
    assert phase_centre(FrameSeries(np.arange(7.0), v, v)) == CENTRE


def test_turns_along_a_circle_of_states():
    angle = np.linspace(0.1, 0.1 + 6 * np.pi, 40)
    a, b = np.cos(angle), np.sin(angle)
    assert turns(a[:-1], b[:-1], a[1:], b[1:]).sum() == 3
    assert turns(a[1:], b[1:], a[:-1], b[:-1]).sum() == -3


@pytest.mark.parametrize("sense", [1, -1])
def test_a_rigid_spiral_has_one_singularity_where_it_turns(square, sense):
    place = (7.3, -4.1)
    phases, strengths = rotor_phases(square.points, TIMES, place, PERIOD, sense)
    seen = found(square, frames(TIMES, phases, strengths))
    assert (seen.counts == 1).all()
    assert (seen.chiralities == sense).all()
    off = np.linalg.norm(seen.points - [*place, 0.0], axis=1)
    assert off.max() < EDGE / 2
    corners = square.points[square.triangles[seen.triangles]]
    assert np.linalg.norm(corners.mean(axis=1) - seen.points, axis=1).max() < EDGE


def test_two_counter_rotating_spirals(square):
    places = ((-25.0, 3.0), (25.0, -3.0))
    left, strong = rotor_phases(square.points, 0 * TIMES, places[0], PERIOD, 1)
    right, also = rotor_phases(square.points, 0 * TIMES, places[1], PERIOD, -1)
    phases = 2 * np.pi * TIMES[:, None] / PERIOD + left + right
    seen = found(square, frames(TIMES, phases, strong * also))
    assert (seen.counts == 2).all()
    for chirality, place in ((1, places[0]), (-1, places[1])):
        off = seen.points[seen.chiralities == chirality] - [*place, 0.0]
        assert np.linalg.norm(off, axis=1).max() < EDGE / 2


@pytest.mark.parametrize("wave", ["plane", "target", "collision", "rest"])
def test_waves_without_an_end_have_no_singularity(square, wave):
    x, y = square.points[:, 0], square.points[:, 1]
    way = {"plane": x, "target": np.hypot(x, y), "collision": -np.abs(x), "rest": 0 * x}[wave]
    phases = 2 * np.pi * TIMES[:, None] / PERIOD - way / 12.0
    if wave == "rest":
        phases = np.full_like(phases, -2.7)
    assert found(square, frames(TIMES, phases)).counts.sum() == 0


def test_a_pair_on_a_sphere_sums_to_zero():
    ball = sphere()
    x, y, z = ball.points.T
    phases = 2 * np.pi * TIMES[:, None] / PERIOD - np.arctan2(y, x) - z / 40.0
    seen = found(ball, frames(TIMES, phases, np.hypot(x, y) / 50.0))
    assert (seen.counts == 2).all()
    # from outside: counterclockwise about the north pole is clockwise about the south pole
    assert (np.sign(seen.points[:, 2]) == seen.chiralities).all()
    # within half an edge of 6 su of the axis
    assert np.hypot(*seen.points[:, :2].T).max() < 3.0


def test_a_singularity_in_a_vertex_or_on_an_edge_is_found_once():
    # the centre of the states lies in vertex 0; then on the edge from it to vertex 1
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]])
    for place in ((0.0, 0.0), (0.5, 0.0), (0.0, 0.5), (-0.5, 0.0), (0.0, -0.5)):
        a, b = (points[None, :, k].astype(np.float32) - np.float32(place[k]) for k in range(2))
        series = FrameSeries(np.zeros(1), a + np.float32(0.5), b + np.float32(0.25))
        seen = find_singularities(series, points, triangles, CENTRE)
        assert seen.chiralities.tolist() == [-1]
        assert seen.points[0] == pytest.approx([*place, 0.0])


def noise(count, steps=40):
    random = np.random.default_rng(4)
    values = random.normal(0.0, 1.0, (2, steps, count)).astype(np.float32)
    return FrameSeries(np.arange(float(steps)), 0.5 + values[0], 0.25 + values[1])


def test_noise_on_a_closed_surface_sums_to_zero():
    ball = sphere()
    seen = found(ball, noise(len(ball.points)))
    total = np.bincount(seen.frames, weights=seen.chiralities)
    assert seen.counts.min() > 100
    assert (total == 0).all()


def test_frames_looked_at_in_pieces_give_the_same(square, monkeypatch):
    series = noise(len(square.points), steps=7)
    whole = found(square, series)
    rims = find_rims(square, tissue(square))
    round_rims = rim_chiralities(series, rims, CENTRE)
    monkeypatch.setattr("cardiosurf.analysis.phase.CHUNK", 2 * len(square.points))
    pieces = found(square, series)
    assert np.array_equal(pieces.frames, whole.frames)
    assert np.array_equal(pieces.triangles, whole.triangles)
    assert np.array_equal(rim_chiralities(series, rims, CENTRE), round_rims)


def test_with_the_rims_noise_sums_to_zero_on_open_surfaces(square):
    middle = square.points[square.triangles].mean(axis=1)
    scar = np.hypot(*(middle[:, :2] - [20.0, 10.0]).T) < 15.0
    for surface, of in ((square, tissue(square, scar)), (annulus(), tissue(annulus()))):
        series, inside = noise(len(surface.points)), surface.triangles[of.excitable]
        seen = find_singularities(series, surface.points, inside, CENTRE)
        rims = rim_chiralities(series, find_rims(surface, of), CENTRE)
        total = np.bincount(seen.frames, weights=seen.chiralities, minlength=len(rims))
        assert np.abs(rims).max(axis=0).min() > 0
        assert (total + rims.sum(axis=1) == 0).all()


def test_rims_are_named_and_measured(square):
    middle = square.points[square.triangles].mean(axis=1)
    scar = np.hypot(*middle[:, :2].T) < 15.0
    outer, inner = find_rims(square, tissue(square, scar))
    assert set(outer.name.split(" + ")) == {"left", "right", "bottom", "top"}
    assert inner.name == "scar"
    assert outer.length == pytest.approx(480.0)
    ring = find_rims(annulus(), tissue(annulus()))
    # a polygon of 96 sides
    expected = [2 * 96 * radius * np.sin(np.pi / 96) for radius in (50.0, 20.0)]
    assert [rim.name for rim in ring] == ["outer", "inner"]
    assert [rim.length for rim in ring] == pytest.approx(expected)
    assert find_rims(sphere(), tissue(sphere())) == ()


@pytest.mark.parametrize("sense", [1, -1])
def test_a_wave_round_a_hole_has_no_singularity_but_circulates(sense):
    ring = annulus()
    phases, _ = rotor_phases(ring.points, TIMES, (0.0, 0.0), PERIOD, sense)
    series = frames(TIMES, phases)
    assert found(ring, series).counts.sum() == 0
    chiralities = rim_chiralities(series, find_rims(ring, tissue(ring)), CENTRE)
    assert (chiralities == [-sense, sense]).all()
    assert lasting(chiralities[:, 1]) == sense


def test_what_holds_in_half_of_the_frames_does_not_last():
    assert lasting(np.array([1, 1, 0, 0])) == 0
    assert lasting(np.array([1, 1, 0, 1])) == 1
    assert lasting(np.empty(0, dtype=int)) == 0
