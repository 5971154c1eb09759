"""Surfaces and rotating waves whose singularities, circuits and periods are known."""

from dataclasses import replace

import numpy as np
from recording_samples import sample_recording

from cardiosurf.analysis.phase import Centre
from cardiosurf.geometry import build_surface
from cardiosurf.geometry.plane import Plane
from cardiosurf.geometry.sphere import Sphere
from cardiosurf.geometry.surface import Surface
from cardiosurf.recording.recording import Events, FrameSeries, ProbeTraces
from cardiosurf.tissue.stimuli import Pulse
from cardiosurf.tissue.tensor import Tissue

CENTRE = Centre(0.5, 0.25)
APD = 60.0


def plane(half=60.0, edge=4.0):
    return build_surface(Plane(x=(-half, half), y=(-half, half)), edge, {})


def sphere(radius=50.0, edge=6.0):
    return build_surface(Sphere(radius=radius), edge, {})


def annulus(inner=20.0, outer=50.0, rings=16, around=96):
    """A flat ring, its vertices on circles and rays; open edges "inner" and "outer"."""
    angle = 2 * np.pi * np.arange(around) / around
    radius = np.linspace(inner, outer, rings)
    r, a = (values.ravel() for values in np.meshgrid(radius, angle, indexing="ij"))
    points = np.column_stack((r * np.cos(a), r * np.sin(a), 0 * r))
    ring, step = (values.ravel() for values in np.mgrid[0 : rings - 1, 0:around])
    following = (step + 1) % around
    corners = [ring * around + step, (ring + 1) * around + step]
    corners += [(ring + 1) * around + following, ring * around + following]
    triangles = np.concatenate(
        (np.stack(corners[:3], 1), np.stack([corners[k] for k in (0, 2, 3)], 1))
    )
    rim = np.column_stack((np.arange(around), (np.arange(around) + 1) % around))
    edges = {"inner": rim, "outer": rim + (rings - 1) * around}
    return _surface(points, triangles, edges)


def torus(big=60.0, small=20.0, long=48, short=16):
    """A torus of right-angled triangles; vertex i * short + j lies at i-th angle round the axis."""
    i, j = (values.ravel() for values in np.mgrid[0:long, 0:short])
    phi, theta = 2 * np.pi * i / long, 2 * np.pi * j / short
    rho = big + small * np.cos(theta)
    points = np.column_stack((rho * np.cos(phi), rho * np.sin(phi), small * np.sin(theta)))
    here, right = i * short + j, ((i + 1) % long) * short + j
    up, both = i * short + (j + 1) % short, ((i + 1) % long) * short + (j + 1) % short
    triangles = np.concatenate((np.stack((here, right, both), 1), np.stack((here, both, up), 1)))
    return _surface(points, triangles, {})


def _surface(points, triangles, edges):
    m = len(triangles)
    frame = np.broadcast_to(np.eye(3)[:2], (m, 2, 3)).copy()
    net = points[triangles].mean(axis=1)[:, :2].copy()
    zeros = np.zeros(m, dtype=np.int64)
    return Surface(
        points, triangles.astype(np.int64), ("ring",), zeros, (("x", "y"),), frame, net, edges, {}
    )


def frames(times, phases, strengths=1.0):
    """Frames of a wave of some phases (k, n): its state runs round the centre once a period."""
    u = CENTRE.u + 0.45 * strengths * np.cos(phases)
    v = CENTRE.v + 0.25 * strengths * np.sin(phases)
    return FrameSeries(np.asarray(times, float), u.astype(np.float32), v.astype(np.float32))


def rotor_phases(points, times, place, period, sense):
    """Phase of a rigid spiral about a place, and how strongly its states are drawn out, (k, n)."""
    x, y = points[:, 0] - place[0], points[:, 1] - place[1]
    r = np.hypot(x, y)
    turn = 2 * np.pi * np.asarray(times)[:, None] / period
    # a wave of phase w t + m phi moves to where the phase is less: m = -1 counterclockwise
    return turn - sense * np.arctan2(y, x) - r / 30.0, np.broadcast_to(
        np.tanh(r / 8), turn.shape[:1] + r.shape
    )


def recording_of(surface, lat, period, cycles, *, end, series=None, probes=()):
    """A recording of a wave that activates vertex i at lat[i], and then once a period."""
    count = len(surface.triangles)
    known = np.flatnonzero(np.isfinite(lat))
    nodes = np.tile(known, cycles)
    times = np.concatenate([lat[known] + turn * period for turn in range(cycles)])
    order = np.argsort(times, kind="stable")
    order = order[times[order] <= end]
    nodes, times = nodes[order], times[order]
    over = times + APD <= end
    steps = np.arange(0.0, end + 0.5)
    traces = [_trace(lat[probe], period, steps) for probe in probes]
    return replace(
        sample_recording("rotor"),
        surface=surface,
        tissue=Tissue(
            np.tile(np.eye(3), (count, 1, 1)), np.ones(count, bool), (), np.full(count, -1)
        ),
        targets={},
        pulses=(Pulse(0.0, 0.0, (lat <= np.nanmin(lat) + 1e-9).astype(float), "stimulus.0"),),
        activations=Events(nodes, times),
        repolarisations=Events(nodes[over], times[over] + APD),
        frames=series or FrameSeries.none(len(lat)),
        probes=ProbeTraces(
            names=tuple(f"p{probe}" for probe in probes),
            positions=surface.points[list(probes)].reshape(-1, 3),
            times=steps,
            u=np.array(traces).reshape(len(probes), len(steps)).T,
            v=np.zeros((len(steps), len(probes))),
        ),
        end_time=end,
    )


def _trace(start, period, steps):
    """A potential that rises in 4 tu through 0.5 at start, and once a period after it."""
    passed = (steps - start + 2.0) % period
    wave = np.where(passed < APD, np.minimum(passed / 4.0, 1.0), 0.0)
    return np.where(steps < start - 2.0, 0.0, wave)
