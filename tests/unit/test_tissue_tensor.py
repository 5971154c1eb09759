"""Diffusivity tensors against tensors written down by hand."""

from dataclasses import replace

import numpy as np
import pytest

from cardiosurf.errors import InputError
from cardiosurf.geometry.regions import Box, BoxLimits
from cardiosurf.geometry.surface import Surface
from cardiosurf.tissue.patches import Patch, TissueSection, factors_of
from cardiosurf.tissue.tensor import along_net, build_tissue

ANYWHERE = Box(BoxLimits())
HALF = np.sqrt(0.5)


def two_parts(**regions: list[bool]) -> Surface:
    """A triangle in the plane z = 0 (part "plane"), and one on a slope of 45 degrees ("vein")."""
    return Surface(
        points=np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1]], dtype=float),
        triangles=np.array([[0, 1, 2], [1, 3, 2]]),
        parts=("plane", "vein"),
        part_of=np.array([0, 1]),
        axes=(("x", "y"), ("theta", "phi")),
        frame=np.array([[[1, 0, 0], [0, 1, 0]], [[HALF, 0, HALF], [0, 1, 0]]]),
        net=np.zeros((2, 2)),
        edges={},
        regions={f"tissue.patches.{name}": np.array(mask) for name, mask in regions.items()},
    )


def tissue_of(*patches: Patch, diffusivity: float = 1.0, **regions: list[bool]):
    return build_tissue(two_parts(**regions), TissueSection(diffusivity, patches))


def test_ambient_tissue_is_the_tangential_identity_times_the_diffusivity():
    tissue = tissue_of(diffusivity=2.5)
    slope = np.array([[0.5, 0, 0.5], [0, 1, 0], [0.5, 0, 0.5]])
    # two products of three rounded numbers: a few units in the last place
    np.testing.assert_allclose(tissue.tensor[0], 2.5 * np.diag([1, 1, 0]), atol=1e-15)
    np.testing.assert_allclose(tissue.tensor[1], 2.5 * slope, atol=1e-15)
    assert tissue.excitable.all()
    assert tissue.patch_of.tolist() == [-1, -1]


def test_anisotropy_is_the_factor_on_the_diffusivity_along_its_axis():
    tissue = tissue_of(Patch("strip", ANYWHERE, anisotropy={"theta": 8.0}), strip=[False, True])
    by_hand = [[4, 0, 4], [0, 1, 0], [4, 0, 4]]
    np.testing.assert_allclose(tissue.tensor[1], by_hand, atol=1e-14)
    np.testing.assert_allclose(tissue.tensor[0], np.diag([1, 1, 0]), atol=1e-15)
    assert tissue.patch_of.tolist() == [-1, 0]


def test_frame_scaling_is_squared():
    # section 6 of the paper: a frame rescaled by 4 means d = 16
    tissue = tissue_of(Patch("strip", ANYWHERE, frame_scaling={"x": 4.0}), strip=[True, False])
    np.testing.assert_allclose(tissue.tensor[0], np.diag([16, 1, 0]), atol=1e-14)


def test_one_number_scales_both_axes_of_every_part():
    tissue = tissue_of(Patch("all", ANYWHERE, anisotropy=3.0), all=[True, True])
    np.testing.assert_allclose(tissue.tensor[0], np.diag([3, 3, 0]), atol=1e-15)
    np.testing.assert_allclose(np.trace(tissue.tensor[1]), 6.0, atol=1e-14)


def test_patch_diffusivity_replaces_the_ambient_one_before_the_factors():
    patch = Patch("p", ANYWHERE, anisotropy={"y": 2.0}, diffusivity=0.5)
    tissue = tissue_of(patch, diffusivity=7.0, p=[True, False])
    np.testing.assert_allclose(tissue.tensor[0], np.diag([0.5, 1.0, 0]), atol=1e-15)
    np.testing.assert_allclose(np.trace(tissue.tensor[1]), 14.0, atol=1e-13)


def test_the_later_patch_wins_as_a_whole():
    first = Patch("fibres", ANYWHERE, anisotropy={"x": 8.0}, excitable=False)
    second = Patch("plain", ANYWHERE, diffusivity=3.0)
    tissue = tissue_of(first, second, fibres=[True, False], plain=[True, False])
    np.testing.assert_allclose(tissue.tensor[0], np.diag([3, 3, 0]), atol=1e-15)
    assert tissue.excitable.tolist() == [True, True]
    assert tissue.patch_of.tolist() == [1, -1]
    assert tissue.names == ("fibres", "plain")


def test_a_scar_diffuses_as_the_ambient_tissue_and_does_not_react():
    tissue = tissue_of(Patch("scar", ANYWHERE, excitable=False), scar=[False, True])
    assert tissue.excitable.tolist() == [True, False]
    np.testing.assert_allclose(np.trace(tissue.tensor[1]), 2.0, atol=1e-15)


def test_tensors_turn_with_the_surface():
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    surface = two_parts(p=[True, True])
    section = TissueSection(1.0, (Patch("p", ANYWHERE, frame_scaling=1.7),))
    turned = replace(surface, frame=surface.frame @ turn.T)
    expected = turn @ build_tissue(surface, section).tensor @ turn.T
    np.testing.assert_allclose(build_tissue(turned, section).tensor, expected, atol=1e-14)


@pytest.mark.parametrize(
    ("patch", "mask", "says"),
    [
        (
            Patch("strip", ANYWHERE, anisotropy={"thta": 8.0}),
            [False, True],
            ["tissue.patches.strip.anisotropy.thta", "no axis 'thta'", "theta, phi", "'theta'?"],
        ),
        (
            Patch("strip", ANYWHERE, anisotropy={"theta": 8.0}),
            [True, True],
            ["'plane'", "no axis 'theta'", "x, y", "surface: vein"],
        ),
        (Patch("strip", ANYWHERE), [False, False], ["tissue.patches.strip.region", "empty"]),
        (
            Patch("strip", ANYWHERE, anisotropy=2.0, frame_scaling=2.0),
            [True, True],
            ["tissue.patches.strip", "both", "frame_scaling 2.0 is the anisotropy 4.0"],
        ),
        (
            Patch("strip", ANYWHERE, anisotropy={"x": -1.0}),
            [True, False],
            ["tissue.patches.strip.anisotropy.x", "-1.0", "not positive", "above 0"],
        ),
        (
            Patch("strip", ANYWHERE, frame_scaling=float("nan")),
            [True, False],
            ["tissue.patches.strip.frame_scaling:", "nan", "above 0"],
        ),
        (
            Patch("strip", ANYWHERE, diffusivity=0.0),
            [True, False],
            ["tissue.patches.strip.diffusivity", "0.0", "above 0"],
        ),
        (Patch("strip", ANYWHERE, anisotropy={}), [True, False], ["names no axis", "theta: 8"]),
    ],
)
def test_errors_name_the_key_the_value_and_what_is_allowed(patch, mask, says):
    with pytest.raises(InputError) as caught:
        tissue_of(patch, strip=mask)
    for words in says:
        assert words in str(caught.value)


def test_factors_without_any_are_one():
    assert factors_of(Patch("p", ANYWHERE)) == 1.0


def test_the_diffusivity_along_the_net_is_that_of_its_directions():
    # e_a . d e_b by matrices, of a tensor with all its entries; sums of nine products of size 1
    surface = two_parts()
    factor = np.random.default_rng(2).normal(size=(2, 3, 3))
    tensor = factor @ factor.transpose(0, 2, 1)
    within = surface.frame @ tensor @ surface.frame.transpose(0, 2, 1)
    expected = within[:, 0, 0], within[:, 0, 1], within[:, 1, 1]
    np.testing.assert_allclose(along_net(surface, tensor), expected, rtol=0, atol=1e-14)
