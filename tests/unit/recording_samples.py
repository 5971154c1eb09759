"""Small surfaces, made-up marches and recordings whose every number is known."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from cardiosurf.arrays import Floats
from cardiosurf.geometry.surface import Surface
from cardiosurf.recording.observers import Activation, Frames, Probes
from cardiosurf.recording.recording import Events, FrameSeries, ProbeTraces, Recording
from cardiosurf.recording.spool import Spool
from cardiosurf.stepping.moment import Moment
from cardiosurf.tissue.patches import patch_key
from cardiosurf.tissue.stimuli import Pulse
from cardiosurf.tissue.tensor import Tissue


def square_surface(count: int = 6, width: float = 60.0) -> Surface:
    """A flat square [0, width]^2 of 2 count^2 right-angled triangles."""
    ticks = np.linspace(0.0, width, count + 1)
    x, y = (values.ravel() for values in np.meshgrid(ticks, ticks))
    points = np.column_stack((x, y, np.zeros_like(x)))
    corner = (np.arange(count)[:, None] * (count + 1) + np.arange(count)).ravel()
    lower = np.column_stack((corner, corner + 1, corner + count + 2))
    upper = np.column_stack((corner, corner + count + 2, corner + count + 1))
    triangles = np.concatenate((lower, upper)).astype(np.int64)
    middle = points[triangles].mean(axis=1)
    row = np.arange(count + 1)
    return Surface(
        points=points,
        triangles=triangles,
        parts=("plane",),
        part_of=np.zeros(len(triangles), dtype=np.int64),
        axes=(("x", "y"),),
        frame=np.broadcast_to(np.eye(3)[:2], (len(triangles), 2, 3)).copy(),
        net=middle[:, :2].copy(),
        edges={"bottom": np.column_stack((row[:-1], row[1:]))},
        regions={
            patch_key("strip"): middle[:, 0] > width / 2,
            "targets/far end": middle[:, 0] > 0.8 * width,
        },
    )


def moments(times: Floats, states: Floats) -> Iterator[Moment]:
    """The moments of a march through the states (k, 2, n): the first one for ``initialize``."""
    before = 0
    for now in range(len(times)):
        yield Moment(now, float(times[now]), states[now], float(times[before]), states[before])
        before = now


def potentials(*signals: list[float]) -> Floats:
    """States (k, 2, n) whose u are the given signals, one a node, and whose v are 10 times u."""
    u = np.array(signals).T
    return np.stack((u, 10.0 * u), axis=1)


def sample_recording(name: str = "sample") -> Recording:
    """A recording of a front that runs along x at 0.25 su/tu; the last column is never reached."""
    surface = square_surface()
    x = surface.points[:, 0]
    reached = np.flatnonzero(x < 55.0)
    order = reached[np.argsort(x[reached], kind="stable")]
    times = np.array([0.0, 100.0, 200.0])
    u = (x < 0.25 * times[:, None]).astype(np.float32)
    strip = surface.regions[patch_key("strip")]
    scale = np.where(strip, 4.0, 1.0)
    e1, e2 = np.eye(3)[:2]
    return Recording(
        name=name,
        surface=surface,
        tissue=Tissue(
            tensor=scale[:, None, None] * np.outer(e1, e1) + np.outer(e2, e2),
            excitable=~strip | (surface.net[:, 1] > 20.0),
            names=("strip",),
            patch_of=np.where(strip, 0, -1),
        ),
        targets={"far end": surface.regions["targets/far end"]},
        pulses=(Pulse(0.0, 0.0, (x < 5.0).astype(float), "stimulus.0"),),
        activations=Events(nodes=order, times=x[order] / 0.25),
        repolarisations=Events(nodes=order, times=x[order] / 0.25 + 136.6),
        frames=FrameSeries(times=times, u=u, v=u / 3),
        probes=ProbeTraces(
            names=("a", "b"),
            positions=surface.points[[0, 8]],
            times=times,
            u=np.array([[1.0, 0.0], [0.5, 0.25], [0.0, 1.0 / 3.0]]),
            v=np.array([[0.0, 0.0], [0.5, 0.25], [0.7, 1.0 / 7.0]]),
        ),
        end_time=200.0,
        stop_reason="end",
        config="name: sample  # ä\n",
        config_sha256="0" * 64,
        meta={
            "created": "2000-01-01T00:00:00+00:00",
            "versions": {"numpy": "2.0"},
            "solver": {"name": "cg", "iterations": 7, "seconds": 0.25},
            "converged": True,
            "seed": None,
        },
    )


def recorders(folder: Path, surface: Surface) -> dict[str, Any]:
    """One of each observer that records, a probe in the middle of a triangle among them."""
    folder.mkdir(exist_ok=True)
    weights = np.array([[0.2, 0.3, 0.5]])
    return {
        "activation": Activation(),
        "frames": Frames(2.0, Spool(folder / "frames.spool", len(surface.points))),
        "probes": Probes(("p",), np.zeros((1, 3)), surface.triangles[3:4], weights),
    }


def recorded(recorders: dict[str, Any]) -> tuple[Floats, ...]:
    """Everything that ``recorders`` recorded, as arrays."""
    activation, frames, probes = recorders.values()
    up, down = activation.activations(), activation.repolarisations()
    series, traces = frames.series(), probes.traces()
    return (
        up.nodes, up.times, down.nodes, down.times,
        series.times, series.u, series.v, traces.times, traces.u, traces.v,
    )  # fmt: skip
