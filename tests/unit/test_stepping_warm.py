"""Compiling ahead of the first run."""

from cardiosurf.stepping.compiled.__main__ import main
from cardiosurf.stepping.compiled.stride import stride


def test_the_march_compiled_ahead_is_the_one_that_runs_take():
    assert main() == 0
    compiled = [str(signature) for signature in stride.signatures]
    # a run hands over the same types: contiguous arrays, the constants' own tuple, whole numbers
    assert any("RogersMcCullochConstants" in text for text in compiled)
    before = len(compiled)
    assert main() == 0
    assert len(stride.signatures) == before
