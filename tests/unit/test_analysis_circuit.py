"""Circuits of waves whose activation maps are given by a formula."""

from dataclasses import replace

import numpy as np
import pytest
from rotor_samples import annulus, plane, recording_of, torus

from cardiosurf.analysis.circuit import find_circuit
from cardiosurf.analysis.cycles import find_returns
from cardiosurf.analysis.enclosure import closed_walk, enclosed
from cardiosurf.analysis.rims import Rim, find_rims
from cardiosurf.analysis.waves import trace_waves
from cardiosurf.tissue.tensor import Tissue

INNER, SPEED = 20.0, 0.25
PERIOD = 2 * np.pi * INNER / SPEED


def circuit_of(recording):
    surface, tissue = recording.surface, recording.tissue
    waves = trace_waves(
        recording.activations,
        recording.repolarisations,
        surface.triangles,
        recording.pulses,
        recording.node_count,
    )
    return find_circuit(surface, tissue, waves, find_returns(waves), find_rims(surface, tissue))


def round_a_disc(points, sense=1):
    """LAT of a wave of speed 0.25 su/tu round a disc of radius 20: its fronts are involutes.

    Their normals touch the disc, so T = (sqrt(r^2 - R^2) + R (phi - arccos(R/r))) / c.
    """
    r = np.maximum(np.hypot(points[:, 0], points[:, 1]), INNER)
    phi = sense * np.arctan2(points[:, 1], points[:, 0])
    length = np.sqrt(r * r - INNER**2) + INNER * (phi - np.arccos(np.minimum(INNER / r, 1.0)))
    return (length / SPEED) % PERIOD


@pytest.mark.parametrize("sense", [1, -1])
def test_a_wave_round_a_hole_runs_along_its_rim(sense):
    ring = annulus(inner=INNER)
    recording = recording_of(ring, round_a_disc(ring.points, sense), PERIOD, 5, end=5 * PERIOD)
    circuit = circuit_of(recording)
    assert circuit.period == pytest.approx(PERIOD, rel=1e-9)
    # the rim is a polygon of 96 sides, shorter than the circle by 0.02 %; the path runs along it,
    # or in the first row of triangles
    assert circuit.length == pytest.approx(2 * np.pi * INNER, rel=0.02)
    assert circuit.speed == pytest.approx(SPEED, rel=0.02)
    assert circuit.enclosure.rims == ("inner",)
    assert circuit.enclosure.turns == sense
    assert np.diff(circuit.times).min() >= 0.0
    turned = np.unwrap(np.arctan2(circuit.points[:, 1], circuit.points[:, 0]))
    assert turned[-1] - turned[0] == pytest.approx(sense * 2 * np.pi, abs=0.1)


def test_a_rigid_wave_in_a_ring_closes_on_the_circle_that_it_begins_on():
    # T = phi / omega: every circle about the middle is a circuit
    ring = annulus(inner=INNER)
    lat = (np.arctan2(ring.points[:, 1], ring.points[:, 0]) % (2 * np.pi)) * 500.0 / (2 * np.pi)
    circuit = circuit_of(recording_of(ring, lat, 500.0, 5, end=2500.0))
    radius = np.hypot(*circuit.points[:, :2].T)
    assert circuit.period == pytest.approx(500.0, rel=1e-9)
    assert np.ptp(radius) < 2.0
    assert circuit.length == pytest.approx(2 * np.pi * radius.mean(), rel=0.01)
    expected = np.pi * (radius.mean() ** 2 - INNER**2)
    # the walk along vertices is off by up to half a triangle's side, 2 su or less, to either side
    assert circuit.enclosure.area == pytest.approx(expected, abs=2 * np.pi * radius.mean() * 2.0)


def test_functional_reentry_runs_round_tissue_alone():
    # a core of radius 20 that is never activated, in a square without a hole
    square = plane(half=60.0, edge=3.0)
    lat = round_a_disc(square.points)
    lat[np.hypot(*square.points[:, :2].T) < INNER - 1e-9] = np.nan
    circuit = circuit_of(recording_of(square, lat, PERIOD, 5, end=5 * PERIOD))
    assert circuit.period == pytest.approx(PERIOD, rel=1e-6)
    # round the vertices next to the disc, whose ragged rim is up to an edge of 3 su outside it
    assert 2 * np.pi * INNER < circuit.length < 1.15 * 2 * np.pi * (INNER + 3.0)
    assert circuit.enclosure.rims == ()
    assert circuit.enclosure.turns == 1
    assert np.pi * (INNER - 3) ** 2 < circuit.enclosure.area < np.pi * (INNER + 4.5) ** 2


def test_a_wave_round_a_scar_runs_round_the_scar():
    square = plane(half=60.0, edge=4.0)
    passive = np.hypot(*square.points[square.triangles].mean(axis=1)[:, :2].T) < INNER
    of = Tissue(np.tile(np.eye(3), (len(passive), 1, 1)), ~passive, ("scar",), passive - 1)
    recording = recording_of(square, round_a_disc(square.points, -1), PERIOD, 5, end=5 * PERIOD)
    circuit = circuit_of(replace(recording, tissue=of))
    assert circuit.period == pytest.approx(PERIOD, rel=1e-6)
    assert (circuit.enclosure.rims, circuit.enclosure.turns) == (("scar",), -1)
    # in the tissue alone: triangles of the scar are no way
    assert not passive[circuit.triangles].any()


def test_a_wave_that_does_not_come_back_has_no_circuit():
    ring = annulus()
    assert circuit_of(recording_of(ring, ring.points[:, 0] + 50.0, 500.0, 1, end=300.0)) is None


def test_a_walk_round_the_tube_of_a_torus_does_not_divide_it():
    surface, short = torus(), 16
    tube = np.r_[np.arange(short), 0]
    assert enclosed(tube, surface.points, surface.triangles, ()) is None


def test_a_walk_round_a_vertex_encloses_the_triangles_about_it():
    surface = torus()
    middle = 20 * 16 + 5
    own = surface.triangles[(surface.triangles == middle).any(axis=1)]
    following = {}
    for triangle in own.tolist():
        at = triangle.index(middle)
        following[triangle[at - 2]] = triangle[at - 1]
    walk = [next(iter(following))]
    while len(walk) <= len(following):
        walk.append(following[walk[-1]])
    area = surface.areas()[(surface.triangles == middle).any(axis=1)].sum()
    for way, turns in ((walk, 1), (walk[::-1], -1)):
        found = enclosed(np.array(way), surface.points, surface.triangles, ())
        assert (found.rims, found.turns) == ((), turns)
        assert found.area == pytest.approx(area)


def test_a_walk_along_the_rim_itself_runs_round_the_hole():
    ring = annulus(around=96)
    rims = find_rims(ring, recording_of(ring, ring.points[:, 0], 500.0, 1, end=300.0).tissue)
    for start, turns in ((0, 1), (15 * 96, -1)):
        walk = start + np.r_[np.arange(96), 0][::turns]
        found = enclosed(walk, ring.points, ring.triangles, rims)
        assert found.rims == ("inner",)
        assert found.turns == turns
    # along the outer rim all of the tissue is inside, along the inner one none
    assert found.area == pytest.approx(ring.areas().sum())
    assert [type(rim) for rim in rims] == [Rim, Rim]


def test_a_walk_is_closed_by_the_shortest_way():
    ring = annulus(around=96)
    walk = closed_walk(np.array([0, 1, 1, 97, 98, 99]), ring.triangles)
    assert walk[0] == walk[-1] == 0
    assert np.abs(np.diff(walk)).all()
    # 99 -> 2 or 98 -> ... -> 0 takes 3 steps
    assert len(walk) == 5 + 3
