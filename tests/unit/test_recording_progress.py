import io

import numpy as np
import pytest
from recording_samples import moments, potentials
from rich.console import Console

from cardiosurf.recording import progress
from cardiosurf.recording.progress import ProgressBar, expected_rest


def show(monkeypatch, *, terminal):
    monkeypatch.setattr(progress, "SECONDS_BETWEEN", 0.0)
    monkeypatch.setattr(progress, "LARGEST_SHARE", np.inf)
    text = io.StringIO()
    console = Console(file=text, force_terminal=terminal, width=120)
    states = potentials([0, 1, 1, 1, 1], [0, 1, 1, 0, 0], [0, 1, 0, 0, 0])
    with ProgressBar("t-domain", 600.0, np.array([5.0, 3.0, 2.0]), console=console) as bar:
        seen = list(moments(np.array([0.0, 200.0, 240.0, 260.0, 280.0]), states))
        bar.initialize(seen[0])
        for moment in seen[1:]:
            bar.handle(moment)
        bar.finalize(seen[-1])
    return text.getvalue()


def test_bar_shows_time_active_share_of_the_area_and_when_rest_is_expected(monkeypatch):
    text = show(monkeypatch, terminal=True)
    assert "240/600 tu, 80.0 % active" in text
    # 100 % at 200, 80 % at 240 and 50 % at 260: the line through the first and the last
    # reaches 0 at 400 and 320
    assert "80.0 % active, rest at ~400 tu" in text
    assert "50.0 % active, rest at ~320 tu" in text


def test_bar_is_silent_when_stderr_is_no_terminal(monkeypatch):
    assert show(monkeypatch, terminal=False) == ""


def test_expected_rest():
    assert expected_rest(np.array([[0.0, 0.2], [10.0, 0.4]])) is None
    assert expected_rest(np.array([[5.0, 0.2]])) is None
    assert expected_rest(np.array([[0.0, 0.5], [50.0, 0.0]])) == pytest.approx(50.0)
    assert expected_rest(np.array([[0.0, 0.5], [50.0, 0.25]])) == pytest.approx(100.0)
