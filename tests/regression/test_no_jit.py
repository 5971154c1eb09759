"""The shipped configs in machine code and in NumPy: the same LAT and the same verdict."""

from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest

from cardiosurf.config import load
from cardiosurf.recording.hdf5 import read_recording
from cardiosurf.stepping.controls import Execution
from cardiosurf.study.simulation import simulate

CONFIGS = sorted((Path(__file__).parents[2] / "configs").glob("*.yaml"))

# at edge 3 their strips are within 2 % of a critical value, where the wave all but stops and what
# the solver leaves (1e-7) grows up to a hundredfold in both marches: it is told to leave less
OPTIONS = dict.fromkeys(("atrium_reentry", "atrium_scar"), ("time.tolerance=1e-10",))


def outcome(config, folder, *, jit):
    options = OPTIONS.get(config.stem, ())
    loaded = load(config, ("mesh.edge_length=3", "record.frames_every=null", *options))
    verdict = simulate(loaded, folder, execution=Execution(jit=jit, threads=1)).verdict
    return verdict, read_recording(folder / "recording.h5", with_frames=False)


@pytest.mark.slow
@pytest.mark.parametrize("config", CONFIGS, ids=[config.stem for config in CONFIGS])
def test_machine_code_and_numpy_say_the_same(config, tmp_path):
    ours, recording = outcome(config, tmp_path / "compiled", jit=True)
    theirs, reference = outcome(config, tmp_path / "numpy", jit=False)
    assert (recording.meta["engine"], reference.meta["engine"]) == ("compiled", "numpy")
    assert ours.verdict == theirs.verdict
    for one, other in zip(ours.targets, theirs.targets, strict=True):
        assert (one.verdict, one.route) == (other.verdict, other.route)
    assert asdict(ours.reentry)["verdict"] == asdict(theirs.reentry)["verdict"]
    lat, expected = recording.first_activation, reference.first_activation
    assert np.array_equal(np.isnan(lat), np.isnan(expected))
    # rounding, and now and then an iteration of the solver, whose tolerance is 1e-7
    # 1e-7 in u is 1e-5 in the time where u passes 0.5 as slowly as 0.01/tu, beside a stimulus
    assert lat == pytest.approx(expected, rel=1e-6, abs=1e-5, nan_ok=True)
