"""How often tissue was activated, and after how long it was activated again."""

from dataclasses import dataclass

import numpy as np

from cardiosurf.analysis.waves import Waves
from cardiosurf.arrays import Floats, Ints
from cardiosurf.geometry.surface import Surface
from cardiosurf.recording.recording import THRESHOLD, ProbeTraces

TINY = 1e-300
"""All shares are 0 where nothing is excitable."""
MIDDLE = (5.0, 95.0)
"""Percentiles between which the spread of cycle lengths is measured."""


@dataclass(frozen=True)
class Returns:
    """All activations of a vertex that follow another one by the same beat.

    Attributes
    ----------
    nodes : (r,) int
        The vertex.
    times : (r,) float
        When it was activated again, in tu.
    cycles : (r,) float
        Time since its activation before that, in tu.
    """

    nodes: Ints
    times: Floats
    cycles: Floats

    def since(self, time: float) -> "Returns":
        """Return those at or after a time, in tu."""
        late = self.times >= time
        return Returns(self.nodes[late], self.times[late], self.cycles[late])


@dataclass(frozen=True)
class CycleLength:
    """Times between successive activations by the same beat, in tu.

    Attributes
    ----------
    count : int
        How many there are.
    median : float or None
        Their median; None without any.
    spread : float or None
        From the 5th to the 95th percentile.
    """

    count: int
    median: float | None
    spread: float | None

    @classmethod
    def of(cls, cycles: Floats) -> "CycleLength":
        """Return median and spread of some cycles, (r,), in tu."""
        if not len(cycles):
            return cls(0, None, None)
        low, high = np.percentile(cycles, MIDDLE)
        return cls(len(cycles), float(np.median(cycles)), float(high - low))


@dataclass(frozen=True)
class ProbeCycles:
    """Activations at one probe.

    Attributes
    ----------
    name : str
        The probe.
    activations : tuple of float
        When u rose through 0.5 there, in tu.
    cycle_length : CycleLength
        Of those that a beat set off again; times between paced beats are left out.
    """

    name: str
    activations: tuple[float, ...]
    cycle_length: CycleLength


def find_returns(waves: Waves) -> Returns:
    """Return the activations by which a wave came back to where it had been.

    Parameters
    ----------
    waves : Waves
        All activations and the beats that they go back to.
    """
    order = np.lexsort((waves.times, waves.beats, waves.nodes))
    nodes, beats, times = waves.nodes[order], waves.beats[order], waves.times[order]
    again = np.flatnonzero((nodes[1:] == nodes[:-1]) & (beats[1:] == beats[:-1])) + 1
    return Returns(nodes[again], times[again], times[again] - times[again - 1])


def activated_shares(nodes: Ints, vertex_areas: Floats) -> tuple[float, ...]:
    """Return the shares of the area that were activated 0, 1, 2, ... times.

    Parameters
    ----------
    nodes : (k,) int
        The vertex of each activation.
    vertex_areas : (n,) float
        Excitable area that belongs to each vertex, in su^2.
    """
    counts = np.bincount(nodes, minlength=len(vertex_areas))
    counts[vertex_areas == 0.0] = 0
    areas = np.bincount(counts, weights=vertex_areas)
    return tuple(float(share) for share in areas / max(float(vertex_areas.sum()), TINY))


def probe_cycles(
    probes: ProbeTraces, surface: Surface, waves: Waves, gap: float
) -> tuple[ProbeCycles, ...]:
    """Return activations and cycle length at each probe.

    A probe is activated by the beat that activated the nearest vertex at about the same time.

    Parameters
    ----------
    probes : ProbeTraces
        u at the probes, at every step.
    surface : Surface
        The surface they are on.
    waves : Waves
        All activations and the beats that they go back to.
    gap : float
        Rises closer than this are one, as in ``waves``, in tu.
    """
    found = []
    for number, name in enumerate(probes.names):
        times = _rises(probes.times, probes.u[:, number], gap)
        away = np.linalg.norm(surface.points - probes.positions[number], axis=1)
        own = waves.nodes == np.argmin(away)
        beats = _nearest(times, waves.times[own], waves.beats[own])
        same = (beats[1:] == beats[:-1]) & (beats[1:] >= 0)
        cycles = CycleLength.of(np.diff(times)[same])
        found.append(ProbeCycles(name, tuple(float(time) for time in times), cycles))
    return tuple(found)


def _rises(times: Floats, u: Floats, gap: float) -> Floats:
    """Return when u, (s,), rises through 0.5, interpolated between the steps; without flicker."""
    (before,) = np.nonzero((u[:-1] <= THRESHOLD) & (u[1:] > THRESHOLD))
    part = (THRESHOLD - u[before]) / (u[before + 1] - u[before])
    rises = times[before] + part * (times[before + 1] - times[before])
    if len(u) and u[0] > THRESHOLD:
        rises = np.r_[times[0], rises]
    keep = np.diff(rises, prepend=-np.inf) > gap
    return np.asarray(rises[keep])


def _nearest(times: Floats, known: Floats, labels: Ints) -> Ints:
    """Return for each time the label of the nearest known time (sorted); -1 if none is known."""
    if not len(known):
        return np.full(len(times), -1)
    after = np.clip(np.searchsorted(known, times), 0, len(known) - 1)
    before = np.maximum(after - 1, 0)
    nearer = np.abs(known[before] - times) <= np.abs(known[after] - times)
    return labels[np.where(nearer, before, after)]
