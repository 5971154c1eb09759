"""Observers of the march that keep what a recording is made of.

Each has the three verbs of ``stepping.moment.Observer`` and, so that a stopped run goes on bit for
bit, ``snapshot`` (its memory as named arrays) and ``restore`` (take such a memory back).
A march that goes on from a checkpoint calls ``initialize`` too; an observer with a memory has
already seen that moment and does not record it again.
"""

from collections.abc import Mapping
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardiosurf.arrays import Floats, Ints
from cardiosurf.recording.growing import GrowingTable
from cardiosurf.recording.recording import Events, FrameSeries, ProbeTraces
from cardiosurf.recording.spool import Spool
from cardiosurf.stepping.limits import THRESHOLD
from cardiosurf.stepping.moment import Moment, Observer

Snapshot: TypeAlias = Mapping[str, NDArray[Any]]


class Recorder(Observer, Protocol):
    """An observer whose memory a checkpoint can hold."""

    def snapshot(self) -> Snapshot:
        """Return all that was recorded so far, as named arrays."""
        ...

    def restore(self, snapshot: Snapshot) -> None:
        """Take back what ``snapshot`` returned."""
        ...


class Activation:
    """All activations (u rises through 0.5) and repolarisations (u falls through 0.5).

    The time of a crossing is interpolated inside the step,
    ``t = t0 + (t1 - t0) (0.5 - u0) / (u1 - u0)``. Nodes that lie above 0.5 at the start, or that a
    pulse sets above it, are activated at that very time. Reaching 0.5 and turning back is no
    crossing.
    """

    def __init__(self) -> None:
        self._begun = False
        self._up = GrowingTable(2)
        self._down = GrowingTable(2)

    def initialize(self, moment: Moment) -> None:
        """Record the nodes that are above 0.5 at the start."""
        if not self._begun:
            nodes = np.flatnonzero(moment.state[0] > THRESHOLD)
            self._up.append(np.column_stack((nodes, np.full(len(nodes), moment.time))))
            self._begun = True

    def handle(self, moment: Moment) -> None:
        """Record the crossings since the moment before."""
        crossings = moment.crossings()
        if len(crossings.nodes):
            rows = np.column_stack((crossings.nodes.astype(np.float64), crossings.times))
            self._up.append(rows[crossings.upward])
            self._down.append(rows[~crossings.upward])

    def due(self) -> float:
        """Any moment will do: each tells all crossings."""
        return np.inf

    def finalize(self, moment: Moment) -> None:
        """Nothing is left to do."""

    def activations(self) -> Events:
        """Return all upward crossings, sorted by time."""
        return _sorted_events(self._up.rows())

    def repolarisations(self) -> Events:
        """Return all downward crossings, sorted by time."""
        return _sorted_events(self._down.rows())

    def snapshot(self) -> Snapshot:
        """Return the crossings so far."""
        return {"up": self._up.rows(), "down": self._down.rows()}

    def restore(self, snapshot: Snapshot) -> None:
        """Take back what ``snapshot`` returned."""
        self._begun = True
        self._up.replace(snapshot["up"])
        self._down.replace(snapshot["down"])


def _sorted_events(rows: Floats) -> Events:
    """Return (node, time) rows as events in the order of time, then of nodes."""
    order = np.lexsort((rows[:, 0], rows[:, 1]))
    return Events(nodes=rows[order, 0].astype(np.int64), times=rows[order, 1])


class Probes:
    """u and v at given places, at every step, interpolated linearly in the nearest triangle.

    Parameters
    ----------
    names : tuple of str
        One name a probe.
    positions : (p, 3) float
        Places on the surface, in su.
    nodes : (p, 3) int
        The vertices of each probe's triangle.
    weights : (p, 3) float
        Their weights; a row sums to 1.
    """

    def __init__(
        self, names: tuple[str, ...], positions: Floats, nodes: Ints, weights: Floats
    ) -> None:
        self._names = names
        self._positions = positions
        self._nodes = nodes
        self._weights = weights
        self._rows = GrowingTable(1 + 2 * len(names))

    def initialize(self, moment: Moment) -> None:
        """Record the start."""
        if not len(self._rows):
            self.handle(moment)

    def handle(self, moment: Moment) -> None:
        """Record every step since the moment before."""
        times, corners = moment.watched(self._nodes)
        values = np.einsum("skpc,pc->skp", corners, self._weights)
        self._rows.append(np.column_stack((times, values.reshape(len(times), -1))))

    def due(self) -> float:
        """Any moment will do: each tells the watched vertices after every step."""
        return np.inf

    @property
    def watches(self) -> Ints:
        """The vertices of the probes' triangles."""
        return self._nodes

    def finalize(self, moment: Moment) -> None:
        """Nothing is left to do."""

    def traces(self) -> ProbeTraces:
        """Return all that was recorded."""
        rows, count = self._rows.rows(), len(self._names)
        return ProbeTraces(
            names=self._names,
            positions=self._positions,
            times=rows[:, 0],
            u=rows[:, 1 : 1 + count],
            v=rows[:, 1 + count :],
        )

    def snapshot(self) -> Snapshot:
        """Return the rows (time, u of all probes, v of all probes) so far."""
        return {"rows": self._rows.rows()}

    def restore(self, snapshot: Snapshot) -> None:
        """Take back what ``snapshot`` returned."""
        self._rows.replace(snapshot["rows"])


class Frames:
    """u and v of all nodes every ``every`` tu, as float32, written to a file as they come.

    A frame is taken at the first step at or beyond each multiple of ``every``, with the time of
    that step, and at the end of the march. A pulse given at the very time of a frame is in it.

    Parameters
    ----------
    every : float
        Time between two frames, in tu.
    spool : Spool
        The raw file that they go to.
    """

    def __init__(self, every: float, spool: Spool) -> None:
        self._every = every
        self._spool = spool
        self._next = 0
        self._last_time = -np.inf

    def initialize(self, moment: Moment) -> None:
        """Take the start as the first frame."""
        if not len(self._spool):
            self._take(moment)

    def handle(self, moment: Moment) -> None:
        """Take a frame when one is due."""
        if moment.time == self._last_time:
            self._spool.truncate(len(self._spool) - 1)
            self._take(moment)
        elif moment.time >= self.due():
            self._take(moment)

    def due(self) -> float:
        """Return when the next frame is due, in tu."""
        # times carry round-off: 9.999999999999998 is meant to be 10
        return self._every * (self._next - 1e-9)

    def finalize(self, moment: Moment) -> None:
        """Take the end as the last frame."""
        if moment.time > self._last_time:
            self._take(moment)

    def series(self) -> FrameSeries:
        """Return all frames; u and v stay in the spool's file and are read as they are used."""
        return self._spool.series()

    def _take(self, moment: Moment) -> None:
        self._spool.append(moment.time, moment.state)
        self._last_time = moment.time
        self._next = int(np.floor(moment.time / self._every + 1e-9)) + 1

    def snapshot(self) -> Snapshot:
        """Return how many frames the spool holds, safely on disk, and when the last was taken."""
        self._spool.flush()
        return {
            "count": np.asarray(len(self._spool)),
            "next": np.asarray(self._next),
            "last_time": np.asarray(self._last_time),
        }

    def restore(self, snapshot: Snapshot) -> None:
        """Go on after the frames that ``snapshot`` knew of; later ones are cut off."""
        self._spool.truncate(int(snapshot["count"]))
        self._next = int(snapshot["next"])
        self._last_time = float(snapshot["last_time"])
