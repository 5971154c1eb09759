"""Triangles as units: who faces whom, what a link costs, and the face of a half plane."""

import numpy as np
import pytest

from cardiosurf.config import load
from cardiosurf.discrete.network import link_factors, linked
from cardiosurf.discrete.packings import block_of_fibres
from cardiosurf.discrete.play import Rule, play
from cardiosurf.discrete.triangles import units_of
from cardiosurf.errors import InputError
from cardiosurf.geometry.sphere import Sphere
from cardiosurf.study.discrete_game import play_config
from cardiosurf.study.surface_cache import surface_of
from cardiosurf.tissue.patches import TissueSection
from cardiosurf.tissue.tensor import build_tissue

FACE = """\
name: face
geometry: {kind: plane, x: [-40, 40], y: [0, 6]}
mesh: {edge_length: 2}
tissue:
  patches: [{name: half, region: {box: {x: [-40, 0]}}, anisotropy: {x: 8}}]
stimulus: [{shape: edge, edge: right}]
time: {end: 100}
targets: [{name: far, region: {box: {x: [-40, -20]}}}]
"""


@pytest.fixture(scope="module")
def face(tmp_path_factory):
    path = tmp_path_factory.mktemp("face") / "face.yaml"
    path.write_text(FACE)
    return path


def far(face, factor, rule=None, *, loads=True):
    config = load(str(face), (f"tissue.patches.half.anisotropy.x={factor}",)).config
    return play_config(config, rule or Rule(), loads=loads).targets[0]


def test_on_a_closed_surface_each_triangle_faces_three():
    surface = surface_of(Sphere(radius=10.0), 4.0, {})
    units = units_of(surface, build_tissue(surface, TissueSection()))
    assert (np.bincount(units.network.sources) == 3).all()
    # isotropic: speed times distance is the same on every link, and nothing costs more
    middles = surface.points[surface.triangles].mean(axis=1)
    step = middles[units.network.targets] - middles[units.network.sources]
    along = units.network.speeds * np.linalg.norm(step, axis=1)
    np.testing.assert_allclose(along, units.spacing, rtol=1e-12)
    np.testing.assert_allclose(units.network.costs, 1.0, rtol=1e-12)


def test_a_wave_from_one_triangle_covers_the_sphere():
    surface = surface_of(Sphere(radius=10.0), 4.0, {})
    units = units_of(surface, build_tissue(surface, TissueSection()))
    # each faces three, N_max is three
    played = play(units.network, Rule(), np.array([0]))
    assert np.isfinite(played.first).all()
    # the nearest of three gets its 1 when the three have had nearly 3
    assert len(play(units.network, Rule(n_max=2.0), np.array([0])).units) == 1


@pytest.mark.parametrize("n_max", [2.0, 3.0])
def test_a_square_face_stops_the_wave_where_the_load_is_n_max(n_max):
    # a row of units, diffusivity s from the third on: sqrt(s) > N_max
    for factor, passes in ((0.999 * n_max**2, True), (1.001 * n_max**2, False)):
        d = np.array([1.0, 1.0, factor, factor])
        speeds, costs = link_factors(d[:-1], d[1:], loads=True)
        row = linked(4, [(0, 1), (1, 2), (2, 3)], speeds, costs)
        first = play(row, Rule(n_max=n_max), np.array([0])).first
        assert np.isfinite(first[2]) == passes
        if passes:
            # across the face at the pace of the source, then sqrt(s) times as fast
            assert first.tolist() == pytest.approx([0, 1, 2, 2 + factor**-0.5], rel=1e-12)


def test_on_triangles_the_face_stops_a_wave_near_nine(face):
    # steps from centroid to centroid are not all along x, and one unit that lies askew lets the
    # wave through: from N_max² = 9 to 11, by the mesh
    assert far(face, 8.9).verdict == "conduction"
    assert far(face, 12).verdict == "block"
    assert far(face, 12, Rule(failed="rest")).verdict == "block"
    # and with N_max² = 16
    assert far(face, 15.9, Rule(n_max=4)).verdict == "conduction"


def test_anisotropy_that_is_only_faster_never_stops_it(face):
    # a row still faces a row: the load stays what it is
    assert far(face, 100, loads=False).verdict == "conduction"


def test_in_a_packing_the_links_are_thirty_degrees_off_the_face():
    # d = 3/4 s + 1/4 along them: N_max² = 9 is reached at s = 35/3
    _, below = block_of_fibres(35 / 3 - 0.01, Rule())
    packing, above = block_of_fibres(35 / 3 + 0.01, Rule())
    assert not below.failures.any()
    vain = packing.places[above.failures > 0]
    # along the face, 10 from the middle, and nowhere else
    assert (vain[:, 1] > 9).all()
    assert np.ptp(vain[:, 0]) > 15
    # but it comes in through the sides, where nothing loads it
    assert np.isfinite(above.first[np.hypot(*packing.places.T) < 1]).all()


def test_a_stimulus_that_comes_later_is_refused(face):
    config = load(str(face), ("stimulus.0.at=5",)).config
    with pytest.raises(InputError, match="no unit is excited at time 0"):
        play_config(config, Rule())
