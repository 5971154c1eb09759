from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from matplotlib import colormaps
from matplotlib.colors import BoundaryNorm, Normalize, to_rgb
from recording_samples import sample_recording

from cardiosurf.analysis.findings import judge_recording
from cardiosurf.analysis.reentry import ReentryFinding
from cardiosurf.errors import InputError
from cardiosurf.geometry import build_surface
from cardiosurf.geometry.vein import Vein
from cardiosurf.recording.recording import Events, ProbeTraces
from cardiosurf.report.canvas import NEVER, save
from cardiosurf.report.caption import verdict_caption
from cardiosurf.report.figures import (
    activation_count,
    activation_map,
    plot_all,
    probe_traces,
    vein_unrolled,
)
from cardiosurf.report.solid import triangle_colours
from cardiosurf.tissue.tensor import Tissue


def vein_recording():
    """A front that runs along y over a square with a vein; y < -100 su is never reached."""
    surface = build_surface(Vein(), 15.0, {})
    y, count = surface.points[:, 1], len(surface.triangles)
    reached = np.flatnonzero(y > -100)
    return replace(
        sample_recording("vein"),
        surface=surface,
        tissue=Tissue(
            np.tile(np.eye(3), (count, 1, 1)), np.ones(count, bool), (), np.full(count, -1)
        ),
        targets={"far": surface.points[surface.triangles][:, :, 1].max(axis=1) < -100},
        pulses=(),
        activations=Events(reached, 0.2 * (150 - y[reached])),
        repolarisations=Events(reached, 0.2 * (150 - y[reached]) + 100),
    )


def texts(path):
    """All texts of an SVG, after checking that it is XML."""
    tree = ET.parse(path)  # noqa: S314  the file was written a moment ago
    return {"".join(item.itertext()).strip() for item in tree.iter() if item.text}


def test_all_figures_of_a_plane_are_written_with_labels_and_units(tmp_path):
    recording = sample_recording()
    written = plot_all(recording, tmp_path / "new", caption="verdict: block")
    assert [path.name for path in written] == [
        "activation_map.png",
        "activation_map.svg",
        "probe_traces.png",
        "probe_traces.svg",
    ]
    assert sorted(path.name for path in (tmp_path / "new").iterdir()) == sorted(
        path.name for path in written
    )
    assert written[0].read_bytes().startswith(b"\x89PNG")
    found = texts(written[1])
    assert {"x [su]", "y [su]", "LAT, first activation [tu]"} <= found
    assert {"sample", "verdict: block", "strip", "far end", "strip (patch)", "target"} <= found
    assert {"stimulus (half strength)", "never activated"} <= found
    assert {"t [tu]", "u, v [1]", "a at (0, 0, 0) su", "b at (10, 10, 0) su"} <= texts(written[3])


def test_figures_of_a_vein_are_small_and_label_every_axis(tmp_path):
    written = plot_all(vein_recording(), tmp_path, ("svg",))
    assert [path.name for path in written] == [
        "activation_map.svg",
        "vein_unrolled.svg",
        "probe_traces.svg",
    ]
    assert {"x [su]", "y [su]", "z [su]", "far"} <= texts(written[0])
    assert {"phi [deg]", "arc length from the root [su]", "LAT, first activation [tu]"} <= texts(
        written[1]
    )
    assert max(path.stat().st_size for path in written) < 5_000_000


def test_colours_range_from_the_first_to_the_last_lat():
    recording = sample_recording()
    figure = activation_map(recording)
    (coloured,) = (
        item for item in figure.axes[0].collections if item.get_array() is not None
        and item.get_cmap().name == "viridis" and len(item.get_array()) == recording.node_count
    )  # fmt: skip
    # x runs from 0 to 50 su at 0.25 su/tu
    assert (coloured.norm.vmin, coloured.norm.vmax) == (0.0, 200.0)
    reached = np.isfinite(recording.first_activation)
    assert np.array_equal(coloured.get_array()[reached], recording.first_activation[reached])
    assert figure.axes[-1].get_ylim() == (0.0, 200.0)


def test_isochrones_lie_where_the_front_was():
    figure = activation_map(sample_recording())
    levels, places = [], []
    for item in figure.axes[0].collections:
        if hasattr(item, "levels") and len(item.levels) > 1:
            levels = list(item.levels)
            places = [path.vertices[:, 0] for path in item.get_paths()]
    assert levels == pytest.approx(np.arange(25.0, 200.0, 25.0))
    for level, x in zip(levels, places, strict=True):
        assert x == pytest.approx(np.full(len(x), 0.25 * level))


def test_triangles_in_space_are_coloured_by_lat_and_grey_where_never_activated():
    recording = vein_recording()
    norm = Normalize(0.0, 50.0)
    colours = triangle_colours(recording.surface, recording.first_activation, norm, (25.0, 40.0))
    middle = recording.first_activation[recording.surface.triangles].mean(axis=1)
    known = np.isfinite(middle)
    assert 0 < known.sum() < len(known)
    plain = np.tile(to_rgb(NEVER), (len(middle), 1))
    plain[known] = colormaps["viridis"](norm(middle[known]))[:, :3]
    # shading darkens a triangle by 0 to 25 % and leaves its hue
    shade = colours / plain
    assert shade.min() >= 0.75 - 1e-12
    assert shade.max() <= 1.0 + 1e-12
    assert np.ptp(shade, axis=1).max() < 1e-12


def test_traces_show_what_was_recorded():
    recording = sample_recording()
    figure = probe_traces(recording)
    _, u, v = figure.axes[1].lines
    assert np.array_equal(u.get_ydata(), recording.probes.u[:, 1])
    assert np.array_equal(v.get_ydata(), recording.probes.v[:, 1])
    assert np.array_equal(u.get_xdata(), recording.probes.times)


def test_counts_are_drawn_as_whole_numbers_where_tissue_was_activated_again(tmp_path):
    recording = sample_recording()
    again = recording.activations
    twice = replace(
        recording,
        activations=Events(
            np.r_[again.nodes, again.nodes], np.r_[again.times, again.times + 300.0]
        ),
    )
    names = [path.name for path in plot_all(twice, tmp_path, ("svg",))]
    assert "activation_count.svg" in names
    figure = activation_count(twice)
    (coloured,) = (c for c in figure.axes[0].collections if isinstance(c.norm, BoundaryNorm))
    assert set(np.asarray(coloured.get_array())) == {2.0}
    assert [tick.get_text() for tick in figure.axes[-1].get_yticklabels()] == ["1", "2"]


def test_a_run_in_which_nothing_was_activated_is_all_grey(tmp_path):
    nothing = Events(np.zeros(0, dtype=np.int64), np.zeros(0))
    recording = replace(sample_recording(), activations=nothing, repolarisations=nothing)
    written = plot_all(recording, tmp_path, ("svg",))
    assert "never activated" in texts(written[0])


def test_figures_that_make_no_sense_are_refused():
    with pytest.raises(InputError, match="no vein"):
        vein_unrolled(sample_recording())
    with pytest.raises(InputError, match="no probes"):
        probe_traces(replace(sample_recording(), probes=ProbeTraces.none()))


def test_an_unusable_folder_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be made"):
        plot_all(sample_recording(), tmp_path / "file" / "figures")


def test_a_figure_that_cannot_be_written_leaves_nothing(tmp_path, monkeypatch):
    figure = probe_traces(sample_recording())

    def full(path, **options):
        path.write_text("half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(figure, "savefig", full)
    with pytest.raises(InputError, match="No space left"):
        save(figure, tmp_path / "traces")
    assert list(tmp_path.iterdir()) == []


def test_equal_figures_give_equal_files(tmp_path):
    for name in ("one", "two"):
        save(probe_traces(sample_recording()), tmp_path / name, ("svg",))
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "two.svg").read_bytes()


def test_caption_tells_the_verdict_and_each_target():
    # of the far end, x > 48 su, the nodes at x = 60 were never activated
    caption = verdict_caption(judge_recording(sample_recording()))
    assert caption == "verdict: block (far end: block, 0 % activated)"


def test_caption_tells_of_reentry_that_died():
    verdict = judge_recording(sample_recording())
    echo = replace(verdict, reentry=ReentryFinding("transient", 2, 1115.0))
    assert verdict_caption(echo).endswith("activated); transient reentry")
