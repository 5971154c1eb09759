"""u at some times beside the activation map."""

from dataclasses import replace

import numpy as np
import pytest
from recording_samples import sample_recording

from cardiosurf.errors import InputError
from cardiosurf.geometry import SHAPES, build_surface
from cardiosurf.geometry.sphere import Sphere
from cardiosurf.recording.recording import Events, FrameSeries
from cardiosurf.report.panels import Moments, _visible_outline, frame_at, snapshots
from cardiosurf.tissue.patches import patch_key
from cardiosurf.tissue.tensor import Tissue


def test_each_time_has_its_panel_and_the_map_comes_last():
    figure = snapshots(sample_recording(), Moments((100.0, 200.0), ("T = 10", "T = 20")), "run")
    titles = [axes.get_title() for axes in figure.axes if axes.get_title()]
    assert titles == ["T = 10", "T = 20", "LAT, isochrones"]
    assert figure.get_suptitle() == "run"


def test_a_frame_is_that_of_its_time():
    recording = sample_recording()
    u, time = frame_at(recording, 100.0)
    assert time == 100.0
    np.testing.assert_array_equal(u, recording.frames.u[1])


def test_a_time_without_frame_is_refused():
    with pytest.raises(InputError, match="no frame at 150 tu"):
        frame_at(sample_recording(), 150.0)
    # the run ended before all was at rest: what came later is not known
    with pytest.raises(InputError, match="no frame at 300 tu"):
        frame_at(sample_recording(), 300.0)


def test_after_rest_the_last_frame_stands_for_all_times():
    recording = replace(sample_recording(), quiescent_at=180.0)
    u, time = frame_at(recording, 300.0)
    assert time == 200.0
    np.testing.assert_array_equal(u, recording.frames.u[2])
    figure = snapshots(recording, Moments((300.0,), ("T = 300",)), "run")
    assert figure.axes[0].get_title() == "T = 300 (at rest since 200)"


def test_only_the_side_of_a_sphere_that_is_turned_to_the_viewer_has_an_outline():
    surface = build_surface(Sphere(radius=50.0), 12.0, {})
    middle = surface.points[surface.triangles].mean(axis=1)
    recording = replace(sample_recording(), surface=surface)
    # a band about the equator: its rims are two circles, of each of which half is seen from +x
    band = np.abs(middle[:, 2]) < 20.0
    lines = np.array(_visible_outline(recording, band, (0.0, 0.0)))
    assert lines[:, :, 0].mean(axis=1).min() > -12.0
    whole = np.pi * 2.0 * np.sqrt(50.0**2 - 20.0**2)
    length = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).sum()
    # two half circles; the rims follow the triangles and are longer by up to a third
    assert whole <= length <= 1.45 * whole


@pytest.mark.parametrize("kind", ["torus", "atrium", "sphere"])
def test_closed_shapes_are_seen_in_space_and_their_map_unrolled(kind):
    surface = build_surface(SHAPES[kind](), 16.0, {})
    count, vertices = len(surface.triangles), len(surface.points)
    x = surface.points[:, 0]
    reached = np.flatnonzero(x > x.min() + 20.0)
    u = np.linspace(0.0, 1.0, vertices)[None, :].repeat(3, axis=0).astype(np.float32)
    middle = surface.points[surface.triangles].mean(axis=1)
    surface = replace(surface, regions={patch_key("strip"): middle[:, 2] > 0.0})
    recording = replace(
        sample_recording(kind),
        surface=surface,
        tissue=Tissue(
            np.tile(np.eye(3), (count, 1, 1)),
            np.ones(count, bool),
            ("strip",),
            np.zeros(count, int),
        ),
        targets={},
        pulses=(),
        activations=Events(reached, 5.0 * (x.max() - x[reached])),
        frames=FrameSeries(np.array([0.0, 100.0, 200.0]), u, u),
    )
    figure = snapshots(recording, Moments((100.0,), ("T = 10",)), kind)
    names = [axes.name for axes in figure.axes if axes.get_title()]
    assert names == ["3d", "rectilinear"]
