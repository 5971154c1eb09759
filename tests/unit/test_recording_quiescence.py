from dataclasses import replace

import numpy as np
import pytest
from recording_samples import moments, potentials, sample_recording

from cardiosurf.recording.hdf5 import read_recording, write_recording
from cardiosurf.recording.quiescence import Quiescence


def watched(*signals, times=None, pending_until=-1.0):
    """Let Quiescence see a march of one step a tu."""
    states = potentials(*signals)
    quiescence = Quiescence()
    seen = list(moments(np.arange(len(states), dtype=float) if times is None else times, states))
    quiescence.initialize(seen[0])
    for moment in seen[1:]:
        quiescence.handle(replace(moment, pulse_pending=moment.time < pending_until))
    return quiescence


@pytest.mark.parametrize(
    ("signal", "since"),
    [
        ([0.0, 1.0, 0.3, 0.04, 0.01, 0.0], 3.0),
        # an undershoot that recovers is rest all along
        ([1.0, 0.04, 0.01, -0.02, -0.01, 0.0], 1.0),
        # excited again, and at rest again
        ([1.0, 0.04, 0.06, 0.7, 0.05, 0.04], 4.0),
        # below the level but rising: a wave may be on its way
        ([0.0, 0.01, 0.02, 0.03], None),
        ([1.0, 0.9, 0.8, 0.06], None),
    ],
)
def test_rest_begins_with_the_rule_and_ends_with_excitation(signal, since):
    assert watched(signal, [-0.1] * len(signal)).since == since


def test_rest_waits_for_the_last_pulse():
    assert watched([1.0, 0.0, 0.0, 0.0, 0.0], pending_until=3.0).since == 3.0


def test_a_pulse_too_weak_to_matter_is_not_itself_rest():
    # the march stops only after a step: at 2, not at the pulse at 1
    assert watched([0.0, 0.0, 0.0], times=np.array([1.0, 1.0, 2.0])).since == 2.0


@pytest.mark.parametrize("since", [None, 0.0, 733.25])
def test_it_survives_checkpoints_and_files(tmp_path, since):
    first, second = Quiescence(), Quiescence()
    first._since = since
    second.restore(first.snapshot())
    assert second.since == since
    write_recording(tmp_path / "r.h5", replace(sample_recording(), quiescent_at=since))
    assert read_recording(tmp_path / "r.h5").quiescent_at == since
