"""What every fibre rule of the registry must do, on every shape."""

from functools import cache

import numpy as np
import pytest

from cardiosurf.config import dump_config, load_text
from cardiosurf.geometry import SHAPES, build_surface
from cardiosurf.geometry.regions import Box, BoxLimits
from cardiosurf.geometry.topology import area_vectors
from cardiosurf.tissue.fibres import FIBRES, AngleField, Circles, Winding
from cardiosurf.tissue.patches import Patch, TissueSection, patch_key
from cardiosurf.tissue.tensor import build_tissue, main_directions

EXAMPLES = {
    "circles": Circles(Winding((30.0, 20.0, 10.0), 0.3)),
    "angle": AngleField("0.7 + 0.3*sin(x/20) + y*z/5000"),
}
# the half of each shape that lies beyond a plane
HALF = Box(BoxLimits(y=(0.0, 1000.0)))

on_every_shape = pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
every_rule = pytest.mark.parametrize("rule", FIBRES)


@cache
def coarse(shape):
    return build_surface(shape(), 12.0, {patch_key("p"): HALF})


def patched(shape, **given):
    """A coarse surface, the tensors of a tissue with one patch, and the patch's triangles."""
    surface = coarse(shape)
    section = TissueSection(2.0, (Patch("p", HALF, **given),))
    return surface, build_tissue(surface, section).tensor, surface.regions[patch_key("p")]


def test_every_rule_is_tested():
    assert set(EXAMPLES) == set(FIBRES)


@on_every_shape
@every_rule
def test_tensors_are_tangential_with_the_factors_as_eigenvalues(shape, rule):
    surface, tensor, inside = patched(
        shape, fibres=EXAMPLES[rule], anisotropy={"along": 8.0, "across": 0.5}
    )
    normal = area_vectors(surface.points, surface.triangles)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    np.testing.assert_allclose(tensor, np.swapaxes(tensor, 1, 2), atol=1e-13)
    np.testing.assert_allclose(np.einsum("mij,mj->mi", tensor, normal), 0.0, atol=1e-12)
    found = np.linalg.eigvalsh(tensor)
    np.testing.assert_allclose(found[~inside, 1:], 2.0, atol=1e-12)
    # 2 su^2/tu times the factors; where circles have no direction twice their mean
    directed = np.isclose(found[inside, 1:], (1.0, 16.0), rtol=1e-12).all(axis=1)
    alike = np.isclose(found[inside, 1:], 8.5, rtol=1e-12).all(axis=1)
    assert (directed ^ alike).all()
    assert directed.mean() > 0.9
    main = main_directions(surface, tensor)
    np.testing.assert_allclose(
        np.einsum("mij,mj->mi", tensor, main)[inside][directed],
        16.0 * main[inside][directed],
        atol=1e-11,
    )
    np.testing.assert_allclose(np.linalg.norm(main[inside][directed], axis=1), 1.0, atol=1e-12)
    assert (main[~inside] == 0.0).all()


@on_every_shape
@every_rule
def test_equal_factors_leave_nothing_of_the_fibres(shape, rule):
    _, fibres, _ = patched(shape, fibres=EXAMPLES[rule], anisotropy=3.0)
    _, plain, _ = patched(shape, anisotropy=3.0)
    np.testing.assert_allclose(fibres, plain, atol=1e-13)


@on_every_shape
@every_rule
def test_scaling_the_frame_squares_the_factor(shape, rule):
    _, scaled, _ = patched(shape, fibres=EXAMPLES[rule], frame_scaling={"along": 3.0})
    _, factor, _ = patched(shape, fibres=EXAMPLES[rule], anisotropy={"along": 9.0})
    np.testing.assert_allclose(scaled, factor, atol=1e-13)


@every_rule
def test_a_rule_survives_being_written_and_read(rule):
    text = """\
geometry: {kind: plane}
tissue:
  patches:
    - {name: p, region: {box: {x: [0, 10]}}, fibres: {angle: 0}, anisotropy: {along: 2}}
stimulus: [{shape: edge, edge: left}]
time: {end: 10}
"""
    plain = dump_config(load_text(text).config)
    given = EXAMPLES[rule]
    spelled = {
        "circles": "circles: {centre: [30, 20, 10], pitch: 0.3}",
        "angle": "angle: 0.7 + 0.3*sin(x/20) + y*z/5000",
    }
    loaded = load_text(text.replace("angle: 0", spelled[rule]))
    assert loaded.config.tissue.patches[0].fibres == given
    again = load_text(dump_config(loaded.config))
    assert again.config == loaded.config
    assert again.text == loaded.text != plain
