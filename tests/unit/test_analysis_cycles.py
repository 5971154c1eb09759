"""Cycle lengths of waves that come back after times that are known."""

import numpy as np
import pytest
from rotor_samples import annulus, frames, recording_of, rotor_phases

from cardiosurf.analysis.cycles import CycleLength, activated_shares
from cardiosurf.analysis.rotation import analyse_reentry
from cardiosurf.analysis.rotation_json import reentry_json
from cardiosurf.report.reentry_summary import reentry_lines

PERIOD, CYCLES = 501.25, 5


@pytest.fixture(scope="module")
def circling():
    ring = annulus()
    lat = (np.arctan2(ring.points[:, 1], ring.points[:, 0]) % (2 * np.pi)) * PERIOD / (2 * np.pi)
    times = np.arange(0.0, 2501.0, 20.0)
    phases, _ = rotor_phases(ring.points, times, (0.0, 0.0), PERIOD, 1)
    series = frames(times, phases)
    return recording_of(ring, lat, PERIOD, CYCLES, end=2500.0, series=series, probes=(8, 400))


def test_shares_of_the_area_by_the_number_of_activations():
    areas = np.array([1.0, 2.0, 3.0, 4.0, 0.0])
    nodes = np.array([1, 2, 2, 3, 3, 3, 4, 4, 4, 4, 4])
    # vertex 4 has no area: what happened there is not counted
    assert activated_shares(nodes, areas) == pytest.approx((0.1, 0.2, 0.3, 0.4))


def test_median_and_spread():
    cycles = np.arange(101.0) + 200.0
    assert CycleLength.of(cycles) == CycleLength(101, 250.0, 90.0)
    assert CycleLength.of(np.empty(0)) == CycleLength(0, None, None)


def test_the_cycle_length_of_a_rotor_is_its_period(circling):
    analysis = analyse_reentry(circling)
    for cycle in (analysis.cycle_length, analysis.recent_cycle_length):
        assert cycle.median == pytest.approx(PERIOD, rel=1e-12)
        assert cycle.spread == pytest.approx(0.0, abs=1e-9)
    assert analysis.reentry.verdict == "sustained"
    # what is reached by 2500 has been activated five times, the last rays (2500 is in the fifth
    # cycle, 495 of 501.25 tu after its beginning) four times: 1 of 96
    assert analysis.reentry.activated_shares == pytest.approx((0, 0, 0, 0, 1 / 96, 95 / 96))
    assert analysis.reentry.last_reactivation == pytest.approx((4 + 94 / 96) * PERIOD)


def test_probes_have_the_period_too(circling):
    first, second = analyse_reentry(circling).probes
    # straight between steps of 1 tu, the rise is read off exactly
    assert first.activations == pytest.approx(PERIOD * (8 / 96 + np.arange(5)))
    assert second.activations == pytest.approx(PERIOD * (16 / 96 + np.arange(5)))
    for probe in (first, second):
        assert probe.cycle_length.count == 4
        assert probe.cycle_length.median == pytest.approx(PERIOD)
        assert probe.cycle_length.spread == pytest.approx(0.0, abs=1e-6)


def test_a_wave_in_a_ring_has_no_rotor_but_runs_round_the_hole(circling):
    analysis = analyse_reentry(circling)
    assert analysis.phases.most == 0
    assert analysis.rotors == ()
    assert {rim.name: rim.chirality for rim in analysis.phases.rims} == {"inner": 1, "outer": -1}
    assert analysis.circuit.enclosure.rims == ("inner",)


def test_what_is_printed(circling):
    text = "\n".join(reentry_lines(analyse_reentry(circling)))
    assert "rotor: sustained reentry, last reactivation at t = 2495.8 tu" in text
    assert "4 times 1.0%, 5 times 99.0% of the area" in text
    assert "cycle length  501.2 tu, spread 0.0 tu" in text
    assert "counterclockwise round inner" in text
    assert "a wave circulates counterclockwise round inner" in text
    data = reentry_json(analyse_reentry(circling))
    assert data["schema"] == "cardiosurf/reentry/1"
    assert data["circuit"]["encloses"]["rims"] == ("inner",)
    assert data["phases"]["tracks"] == ()


def test_one_wave_has_no_cycle():
    ring = annulus()
    analysis = analyse_reentry(recording_of(ring, ring.points[:, 0] + 50.0, 1.0, 1, end=400.0))
    assert analysis.cycle_length == CycleLength(0, None, None)
    assert (analysis.circuit, analysis.phases) == (None, None)
    assert "rotor: no reentry" in reentry_lines(analysis)[0]
