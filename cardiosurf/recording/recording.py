"""A recording: all that an analysis or a plot needs to know of a finished run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardiosurf.arrays import Floats, Ints, Mask
from cardiosurf.geometry.surface import Surface
from cardiosurf.tissue.patches import patch_key
from cardiosurf.tissue.stimuli import Pulse
from cardiosurf.tissue.tensor import Tissue

THRESHOLD = 0.5
"""A node is activated when u rises through this value, and repolarised when u falls through it."""

Singles: TypeAlias = NDArray[np.float32]


@dataclass(frozen=True)
class Events:
    """Crossings of u = 0.5 in one direction, in the order of time.

    Attributes
    ----------
    nodes : (e,) int
        Vertex of each crossing.
    times : (e,) float
        Its time, in tu, interpolated inside the step.
    """

    nodes: Ints
    times: Floats

    def first(self, node_count: int) -> Floats:
        """Return each node's first time, (n,), in tu; NaN = never."""
        first = np.full(node_count, np.inf)
        np.minimum.at(first, self.nodes, self.times)
        return np.where(np.isfinite(first), first, np.nan)

    def last(self, node_count: int) -> Floats:
        """Return each node's last time, (n,), in tu; NaN = never."""
        last = np.full(node_count, -np.inf)
        np.maximum.at(last, self.nodes, self.times)
        return np.where(np.isfinite(last), last, np.nan)

    def count(self, node_count: int) -> Ints:
        """Return how often each node has one, (n,)."""
        return np.bincount(self.nodes, minlength=node_count).astype(np.int64)


@dataclass(frozen=True)
class FrameSeries:
    """u and v of all nodes at some times.

    Attributes
    ----------
    times : (k,) float
        In tu.
    u, v : (k, n) float32
        Possibly still in a file, and read from there as they are used.
    """

    times: Floats
    u: Singles
    v: Singles

    @classmethod
    def none(cls, node_count: int) -> FrameSeries:
        """Return a series without frames."""
        empty = np.zeros((0, node_count), dtype=np.float32)
        return cls(times=np.zeros(0), u=empty, v=empty)


@dataclass(frozen=True)
class ProbeTraces:
    """u and v at some places at every step.

    Attributes
    ----------
    names : tuple of str
        One name a probe.
    positions : (p, 3) float
        Places on the surface, in su.
    times : (s,) float
        In tu.
    u, v : (s, p) float
        Interpolated linearly in the triangle of the probe.
    """

    names: tuple[str, ...]
    positions: Floats
    times: Floats
    u: Floats
    v: Floats

    @classmethod
    def none(cls) -> ProbeTraces:
        """Return traces of no probe."""
        nothing = np.zeros((0, 0))
        return cls(names=(), positions=np.zeros((0, 3)), times=np.zeros(0), u=nothing, v=nothing)


@dataclass(frozen=True)
class Recording:
    """What a run leaves behind.

    Attributes
    ----------
    name : str
        The run's name.
    surface : Surface
        Points, triangles, parts, net, open edges, and the regions the mesh resolves.
    tissue : Tissue
        Diffusivity tensor, excitable mask and patches of the triangles.
    targets : mapping of str to (m,) bool
        Triangles of each target, in the config's order.
    pulses : tuple of Pulse
        The stimuli as they were given, in the order of time.
    activations, repolarisations : Events
        All crossings of u = 0.5 upward and downward.
    frames : FrameSeries
        u and v of all nodes, every so often.
    probes : ProbeTraces
        u and v at the probes, at every step.
    end_time : float
        Time that the run reached, in tu.
    stop_reason : str
        "rest" (all tissue at rest) or "end" (the config's end).
    config : str
        The resolved config, YAML text.
    config_sha256 : str
        Its hash.
    meta : mapping
        Versions, platform, timings, solver statistics, scheme, step, mass, edge length.
    quiescent_at : float or None
        Since when all tissue has been at rest to the end, in tu; None = not at rest at the end.
    """

    name: str
    surface: Surface
    tissue: Tissue
    targets: Mapping[str, Mask]
    pulses: tuple[Pulse, ...]
    activations: Events
    repolarisations: Events
    frames: FrameSeries
    probes: ProbeTraces
    end_time: float
    stop_reason: str
    config: str
    config_sha256: str
    meta: Mapping[str, Any] = field(default_factory=dict)
    quiescent_at: float | None = None

    @property
    def node_count(self) -> int:
        """Number of vertices n."""
        return len(self.surface.points)

    @property
    def patches(self) -> Mapping[str, Mask]:
        """Triangles of each patch, (m,); ``tissue.patch_of`` tells which rules in overlaps."""
        return {name: self.surface.regions[patch_key(name)] for name in self.tissue.names}

    @cached_property
    def first_activation(self) -> Floats:
        """First LAT of each node, (n,), in tu; NaN = never activated."""
        return self.activations.first(self.node_count)

    @cached_property
    def last_activation(self) -> Floats:
        """Last LAT of each node, (n,), in tu; NaN = never activated."""
        return self.activations.last(self.node_count)

    @cached_property
    def activation_count(self) -> Ints:
        """How often each node was activated, (n,)."""
        return self.activations.count(self.node_count)

    @cached_property
    def first_repolarisation(self) -> Floats:
        """First repolarisation time of each node, (n,), in tu; NaN = never."""
        return self.repolarisations.first(self.node_count)

    @cached_property
    def action_potential_duration(self) -> Floats:
        """APD at u = 0.5 of each node's first activation, (n,), in tu; NaN = none."""
        return self.first_repolarisation - self.first_activation
