"""How anisotropic tissue asks for shorter mesh edges."""

import numpy as np
import pytest

from cardiosurf.config.accuracy import edge_choice
from cardiosurf.config.loader import load_text
from cardiosurf.geometry import build_surface
from cardiosurf.study.edges import anisotropy, edge_of

PLANE = """
geometry: {{kind: plane, x: [-50, 50], y: [-50, 50]}}
tissue:
  diffusivity: 2
  patches:
    - {{name: block, region: {{box: {{x: [-25, 25], y: [-50, 50]}}}}, anisotropy: {factors}}}
stimulus: [{{shape: edge, edge: right}}]
time: {{end: 100}}
"""


def config(factors, more=""):
    return load_text(PLANE.format(factors=factors) + more, "a.yaml").config


def test_anisotropy_is_the_mean_over_the_area():
    surface = build_surface(config("{x: 8}").geometry, 10.0, {})
    tensor = np.zeros((len(surface.triangles), 3, 3))
    right = surface.points[surface.triangles, 0].mean(axis=1) > 0.0
    tensor[:, 0, 0], tensor[:, 1, 1] = np.where(right, 8.0, 0.5), 0.5
    share = surface.areas()[right].sum() / surface.areas().sum()
    # (8 / 0.5 - 1) / 0.5 on one side, nothing on the other
    assert anisotropy(surface, tensor) == pytest.approx(30.0 * share, rel=1e-9)


def test_half_the_area_of_fibres_counts_half():
    given = config("{x: 8}")
    expected = edge_choice(given, anisotropy=0.5 * 7.0 / 2.0)
    found = edge_of(given)
    assert found.edge_length == expected.edge_length
    # the patch's area is exact to 0.1 %
    assert found.lat_error == pytest.approx(expected.lat_error, rel=2e-3)


@pytest.mark.parametrize("factors", ["8", "{x: 8, y: 8}"])
def test_the_same_factor_along_both_axes_is_no_anisotropy(factors):
    given = config(factors)
    assert edge_of(given).lat_error == pytest.approx(edge_choice(given).lat_error, rel=1e-9)


def test_edges_that_are_asked_for_are_taken():
    assert edge_of(config("{x: 8}", "mesh: {edge_length: 7}\n")).edge_length == 7.0
