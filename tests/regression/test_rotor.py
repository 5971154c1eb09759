"""A spiral wave made by S1 and S2 that really rotates, and what the analysis says about it."""

from pathlib import Path

import numpy as np
import pytest

from cardiosurf.analysis.rotation import analyse_reentry
from cardiosurf.config import load
from cardiosurf.recording.hdf5 import read_recording
from cardiosurf.study.simulation import simulate

CONFIG = Path(__file__).parents[2] / "configs" / "spiral.yaml"
PERIOD = 1427.0  # at edges of 2 su; 1434.7 at 4, 1428.8 at 3


def rotation(folder, *overrides):
    simulate(load(CONFIG, overrides), folder, overwrite=True)
    return analyse_reentry(read_recording(folder / "recording.h5"))


def turns_per_time(track, cycle):
    """How fast a tip turns about the middle of its path in its last cycle, in turns/tu."""
    middle, _ = track.core(cycle)
    last = track.times > track.times[-1] - cycle
    x, y, _ = (track.points[last] - middle).T
    return np.polyfit(track.times[last], np.unwrap(np.arctan2(y, x)), 1)[0] / (2 * np.pi)


@pytest.mark.slow
def test_the_spiral_rotates_and_its_period_is_stable_under_refinement(tmp_path):
    cycles = []
    for edge in (4, 3):
        found = rotation(tmp_path / "run", f"mesh.edge_length={edge}")
        assert found.reentry.verdict == "sustained"
        (rotor,) = found.rotors
        # S2 starts in the lower left, goes up, and turns right behind the tail of S1
        assert (rotor.chirality, rotor.died) == (-1, None)
        assert 650.0 <= rotor.born <= 670.0
        assert {rim.chirality for rim in found.phases.rims} == {1}
        # the same period three ways: from activations, the circuit, and the tip's rotation
        cycle = found.recent_cycle_length.median
        assert found.recent_cycle_length.spread < 0.01 * cycle
        assert found.circuit.period == pytest.approx(cycle, rel=0.005)
        assert -1.0 / turns_per_time(rotor, cycle) == pytest.approx(cycle, rel=0.01)
        # the circuit lies outside the tip's circle, and is a circle itself
        _, radius = rotor.core(cycle)
        assert found.circuit.length > 2 * np.pi * radius
        around = found.circuit.enclosure
        assert (around.rims, around.turns) == ((), -1)
        assert found.circuit.length == pytest.approx(2 * np.sqrt(np.pi * around.area), rel=0.02)
        cycles.append(cycle)
    assert cycles == pytest.approx([PERIOD, PERIOD], rel=0.01)
    assert abs(cycles[1] - PERIOD) < abs(cycles[0] - PERIOD)


@pytest.mark.slow
def test_walls_close_by_make_the_rotor_turn_faster(tmp_path):
    # no room for the free core of 23 su radius and a wave about it: 748.2 tu at edges of 1.5 su
    small = (
        "geometry.x=[-30, 30]",
        "geometry.y=[-30, 30]",
        "stimulus.1.region.box.y=[-30, 0]",
        "stimulus.1.at=400",
        "targets=[]",
        "record.probes=[]",
        "mesh.edge_length=3",
    )
    found = rotation(tmp_path / "run", *small)
    assert found.recent_cycle_length.median == pytest.approx(748.2, rel=0.01)
    middle, radius = found.rotors[0].core(748.2)
    # the square's symmetry puts it in the middle
    assert middle == pytest.approx([0.0, 0.0, 0.0], abs=0.5)
    assert radius == pytest.approx(11.1, abs=0.5)


@pytest.mark.slow
@pytest.mark.parametrize("at", [300, 1200])
def test_outside_the_window_s2_starts_no_rotor(tmp_path, at):
    found = rotation(tmp_path / "run", f"stimulus.1.at={at}", "mesh.edge_length=4")
    assert found.reentry.verdict == "none"
    assert (found.circuit, found.rotors) == (None, ())
