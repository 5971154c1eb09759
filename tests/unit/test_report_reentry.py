from dataclasses import replace

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from rotor_samples import annulus, frames, recording_of, rotor_phases, sphere

from cardiosurf.analysis.rotation import analyse_reentry
from cardiosurf.report.reentry_map import one_cycle, reentry_map, shown_until

PERIOD = 500.0


def circling(surface, *, end=2400.0):
    """A wave that runs counterclockwise round the z axis."""
    lat = (
        (np.arctan2(surface.points[:, 1], surface.points[:, 0]) % (2 * np.pi)) * PERIOD / 2 / np.pi
    )
    times = np.arange(0.0, end + 1.0, 20.0)
    phases, _ = rotor_phases(surface.points, times, (0.0, 0.0), PERIOD, 1)
    strengths = np.hypot(*surface.points[:, :2].T) / np.abs(surface.points).max()
    return recording_of(surface, lat, PERIOD, 5, end=end, series=frames(times, phases, strengths))


def test_one_cycle_ends_when_it_is_told_to():
    recording = circling(annulus())
    since = one_cycle(recording, PERIOD, 1700.0)
    # three whole cycles and 200 tu: what lies before 200 tu in a cycle was activated in the fourth
    lat = recording.first_activation
    assert since == pytest.approx(np.where(lat <= 200.0, lat + 300.0, lat - 200.0))


def test_tissue_that_a_cycle_left_out_is_none_of_it():
    recording = circling(annulus())
    # as if a wave came once every 100 tu: what was activated 115 tu before has missed it
    since = one_cycle(recording, 100.0, 1700.0)
    lat = recording.first_activation
    assert (np.isfinite(since) == ((lat > 200.0 - 115.0) & (lat <= 200.0))).all()


def test_the_cycle_shown_ends_where_the_circuit_closes():
    recording = circling(annulus())
    analysis = analyse_reentry(recording)
    assert shown_until(recording, analysis) == analysis.circuit.times[-1]
    without = replace(analysis, circuit=None)
    # activations are 500 / 96 tu apart; the last before 2400 is at 4 * 500 + 76 * 500 / 96
    assert shown_until(recording, without) == pytest.approx(2000.0 + 76 * PERIOD / 96)


def test_the_circuit_is_drawn_where_it_runs():
    recording = circling(annulus())
    analysis = analyse_reentry(recording)
    figure = reentry_map(recording, analysis, caption="verdict: reentry")
    lines = [c for c in figure.axes[0].collections if isinstance(c, LineCollection)]
    pieces = np.array([path.vertices for path in lines[-1].get_paths()])
    assert pieces == pytest.approx(
        np.stack((analysis.circuit.points[:-1], analysis.circuit.points[1:]), axis=1)[:, :, :2]
    )
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert f"circuit: {analysis.circuit.length:.0f} su in 500 tu" in labels
    assert "the front at the end of it" in labels


def test_tips_on_a_sphere_are_drawn_at_the_poles():
    recording = circling(sphere(edge=8.0))
    analysis = analyse_reentry(recording)
    assert sorted(rotor.chirality for rotor in analysis.rotors) == [-1, 1]
    figure = reentry_map(recording, analysis)
    tips = [line.get_ydata() for line in figure.axes[0].lines if len(line.get_ydata()) > 20]
    # theta of the two poles, within half an edge of 8 su on a radius of 50
    assert sorted(np.mean(theta) for theta in tips) == pytest.approx([0.0, 180.0], abs=5.0)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"tip of a rotor, clockwise", "tip of a rotor, counterclockwise"} <= set(labels)


def test_without_reentry_there_is_no_map():
    ring = annulus()
    once = recording_of(ring, ring.points[:, 0] + 50.0, PERIOD, 1, end=300.0)
    with pytest.raises(ValueError, match="needs reentry"):
        reentry_map(once, analyse_reentry(once))
