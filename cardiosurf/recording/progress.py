"""The progress bar of a march."""

import time
from collections import deque
from types import TracebackType
from typing import Self

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from cardiosurf.arrays import Floats
from cardiosurf.stepping.moment import Moment

ACTIVE = 0.1
"""Tissue with u above this counts as active; rest is 0, and a run may end below 0.05."""
SECONDS_BETWEEN = 0.1
LARGEST_SHARE = 0.02
"""Drawing the bar takes at most this share of the wall time."""
LOOK_BACK = 100.0
"""The decline of the active tissue is judged over this time, in tu (about one APD)."""


class ProgressBar:
    """Shows simulated time, active tissue and when it may be at rest; silent if not a terminal.

    Use it as a context manager around the march, so that the terminal is left in order whatever
    happens.

    Parameters
    ----------
    label : str
        The run's name.
    end : float
        When the march ends at the latest, in tu.
    vertex_areas : (n,) float
        Area that belongs to each vertex, in su^2.
    console : Console or None
        Where to show it; None is stderr.
    """

    def __init__(
        self, label: str, end: float, vertex_areas: Floats, *, console: Console | None = None
    ) -> None:
        console = Console(stderr=True) if console is None else console
        self._shown = console.is_terminal
        self._shares = vertex_areas / vertex_areas.sum()
        self._end = end
        self._next = 0.0
        self._history: deque[tuple[float, float]] = deque()
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(bar_width=20),
            TextColumn("{task.fields[note]}"),
            TimeElapsedColumn(),
            console=console,
            auto_refresh=False,
            disable=not self._shown,
        )
        self._task = self._bar.add_task(label, total=end, note="")

    def __enter__(self) -> Self:
        """Show the bar."""
        self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave the bar as it is and give the terminal back."""
        self._bar.stop()

    def initialize(self, moment: Moment) -> None:
        """Show the start."""
        self.handle(moment)

    def handle(self, moment: Moment) -> None:
        """Bring the bar up to date, at most ten times a second."""
        if not self._shown:
            return
        now = time.monotonic()
        if now >= self._next:
            self._show(moment)
            spent = time.monotonic() - now
            self._next = now + max(SECONDS_BETWEEN, spent / LARGEST_SHARE)

    def due(self) -> float:
        """Any moment will do: none is long in coming."""
        return np.inf

    def finalize(self, moment: Moment) -> None:
        """Show the end."""
        if self._shown:
            self._show(moment)

    def _show(self, moment: Moment) -> None:
        active = float(self._shares @ (moment.state[0] > ACTIVE))
        self._history.append((moment.time, active))
        while moment.time - self._history[0][0] > LOOK_BACK:
            self._history.popleft()
        rest = expected_rest(np.array(self._history))
        note = f"{moment.time:.0f}/{self._end:.0f} tu, {100 * active:.1f} % active"
        if rest is not None and rest < self._end and not moment.pulse_pending:
            note += f", rest at ~{rest:.0f} tu"
        self._bar.update(self._task, completed=moment.time, note=note)
        self._bar.refresh()


def expected_rest(history: Floats) -> float | None:
    """Return when the active tissue will be gone if it declines as it did, in tu.

    Parameters
    ----------
    history : (k, 2) float
        Time in tu and active share of the tissue, the latest last.

    Returns
    -------
    float or None
        None while the active tissue does not decline.
    """
    (start, before), (now, active) = history[0], history[-1]
    if active == 0.0:
        return float(now)
    if now <= start or active >= before:
        return None
    return float(now + active * (now - start) / (before - active))
