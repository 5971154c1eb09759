"""Strokes on a map lie along the fibres."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from recording_samples import sample_recording

from cardiosurf.geometry import Sphere, Vein, build_surface
from cardiosurf.report.layers import draw_patches
from cardiosurf.report.strokes import draw_strokes
from cardiosurf.report.views import flat_views, unrolled_sphere, unrolled_vein
from cardiosurf.tissue.tensor import Tissue


def with_fibres(surface, directions, inside):
    """A recording whose tissue is 4 times as conductive along directions (m, 3), where inside."""
    tensor = np.tile(np.eye(3), (len(inside), 1, 1))
    tensor += 3.0 * inside[:, None, None] * np.einsum("mi,mj->mij", directions, directions)
    count = len(inside)
    tissue = Tissue(tensor, np.ones(count, bool), ("strip",), np.where(inside, 0, -1))
    return replace(sample_recording(), surface=surface, tissue=tissue)


def strokes(view, recording):
    """The strokes (k, 2, 2) that are drawn, and how many lines of the legend speak of them."""
    axes = Figure().add_subplot()
    legend = draw_strokes(axes, view, recording)
    return np.array([s for lines in axes.collections for s in lines.get_segments()]), len(legend)


def test_on_a_plane_they_have_the_angle_of_the_fibres():
    surface = sample_recording().surface
    inside = surface.points[surface.triangles][:, :, 0].mean(axis=1) > 30.0
    direction = np.array([np.cos(0.5), np.sin(0.5), 0.0])
    recording = with_fibres(surface, np.tile(direction, (len(inside), 1)), inside)
    drawn, legend = strokes(flat_views(surface)[0], recording)
    # every triangle of the right half is larger than the room of a stroke, 60/32 su
    assert (len(drawn), legend) == (inside.sum(), 1)
    assert drawn.mean(axis=1)[:, 0].min() > 30.0
    along = drawn[:, 1] - drawn[:, 0]
    np.testing.assert_allclose(np.tan(0.5) * along[:, 0], along[:, 1], atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(along, axis=1), 0.7 * 60.0 / 32.0, rtol=1e-12)


@pytest.mark.parametrize(
    ("shape", "unrolled"), [(Vein(), unrolled_vein), (Sphere(), unrolled_sphere)]
)
@pytest.mark.parametrize("axis", [0, 1])
def test_on_an_unrolled_map_theta_is_upright_and_phi_lies(shape, unrolled, axis):
    surface = build_surface(shape, 5.0, {})
    inside = np.array(surface.axes)[surface.part_of, 0] == "theta"
    view = unrolled(surface)
    drawn, _ = strokes(view, with_fibres(surface, surface.frame[:, axis], inside))
    assert len(drawn) > 300
    if shape.kind == "sphere":
        # towards a pole the map itself turns within a triangle
        drawn = drawn[np.abs(drawn.mean(axis=1)[:, 1] - 90.0) < 60.0]
    along = np.abs(drawn[:, 1] - drawn[:, 0]) / np.ptp(view.limits, axis=1)
    slope = along[:, axis] / np.linalg.norm(along, axis=1)
    # the other component comes from the triangles being flat: h/(2 R) = 0.07 at the narrow tip
    assert slope.max() < 0.15
    assert slope.mean() < 0.02


def test_where_all_directions_are_alike_there_are_none_but_a_hatching():
    recording = sample_recording()
    alike = with_fibres(
        recording.surface,
        np.zeros((len(recording.surface.triangles), 3)),
        recording.tissue.patch_of == 0,
    )
    view = flat_views(recording.surface)[0]
    drawn, legend = strokes(view, alike)
    assert (len(drawn), legend) == (0, 0)
    axes = Figure().add_subplot()
    assert draw_patches(axes, view, alike, {})[0].get_hatch() == "////"
    # the strip of the sample has fibres along x
    assert not draw_patches(axes, view, recording, {})[0].get_hatch()
