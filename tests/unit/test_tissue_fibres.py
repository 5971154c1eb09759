"""Directions of fibres against directions written down by hand."""

import numpy as np
import pytest

from cardiosurf.config import load_text
from cardiosurf.errors import InputError
from cardiosurf.geometry import Plane, Sphere, Surface, Vein, build_surface
from cardiosurf.geometry.regions import Box, BoxLimits
from cardiosurf.study.edges import anisotropy
from cardiosurf.tissue.fibres import AngleField, Circles, Winding
from cardiosurf.tissue.patches import Patch, TissueSection, patch_key
from cardiosurf.tissue.tensor import build_tissue, main_directions

ANYWHERE = Box(BoxLimits())
FIBRES = {"along": 8.0, "across": 2.0}


def triangles_at(*middles: tuple[float, float], size: float = 0.3) -> Surface:
    """Small equilateral triangles in the plane z = 0, counter-clockwise, around these middles."""
    turn = np.pi / 2 + 2.0 * np.pi * np.arange(3) / 3
    corners = size * np.column_stack((np.cos(turn), np.sin(turn), 0.0 * turn))
    places = np.column_stack((np.array(middles), np.zeros(len(middles))))
    count = len(middles)
    return Surface(
        points=(places[:, None] + corners).reshape(-1, 3),
        triangles=np.arange(3 * count).reshape(-1, 3),
        parts=("plane",),
        part_of=np.zeros(count, dtype=int),
        axes=(("x", "y"),),
        frame=np.tile(np.eye(3)[:2], (count, 1, 1)),
        net=places[:, :2],
        edges={},
        regions={patch_key("p"): np.ones(count, dtype=bool)},
    )


def tensor_of(surface: Surface, fibres, factors=FIBRES, diffusivity=1.0):
    patch = Patch("p", ANYWHERE, fibres, anisotropy=factors)
    return build_tissue(surface, TissueSection(diffusivity, (patch,))).tensor


def test_circles_about_a_point_of_the_plane():
    # right of, above and down-left of the centre (1, 2): along y, along x, along (1, -1)
    surface = triangles_at((4.0, 2.0), (1.0, 7.0), (-2.0, -1.0))
    tensor = tensor_of(surface, Circles(Winding((1.0, 2.0, 5.0))), diffusivity=0.5)
    expected = np.array([[[1, 0], [0, 4]], [[4, 0], [0, 1]], [[2.5, -1.5], [-1.5, 2.5]]])
    np.testing.assert_allclose(tensor[:, :2, :2], expected, atol=1e-14)
    np.testing.assert_allclose(tensor[:, 2], 0.0, atol=1e-15)


@pytest.mark.parametrize("pitch", [0.0, 0.4, -0.4, np.pi / 2])
def test_pitch_winds_inward_going_round_counter_clockwise(pitch):
    surface = triangles_at((10.0, 0.0), (0.0, 10.0))
    tensor = tensor_of(surface, Circles(Winding((0.0, 0.0, 0.0), pitch)))
    # at (10, 0) counter-clockwise is +y and inward -x; at (0, 10) they are -x and -y
    c, s = np.cos(pitch), np.sin(pitch)
    for found, f in zip(tensor, np.array([[-s, c, 0.0], [-c, -s, 0.0]]), strict=True):
        g = np.array([-f[1], f[0], 0.0])
        np.testing.assert_allclose(found, 8 * np.outer(f, f) + 2 * np.outer(g, g), atol=1e-14)


def test_a_triangle_that_reaches_to_the_centre_has_the_mean_both_ways():
    # corners are 0.3 su away from the middles
    surface = triangles_at((0.0, 0.0), (0.29, 0.0), (0.31, 0.0))
    tensor = tensor_of(surface, Circles(Winding((0.0, 0.0, 0.0))))
    np.testing.assert_allclose(tensor[:2, :2, :2], np.tile(5.0 * np.eye(2), (2, 1, 1)), atol=1e-14)
    np.testing.assert_allclose(tensor[2, :2, :2], np.diag([2.0, 8.0]), atol=1e-14)


def test_circles_about_a_pole_of_the_sphere_are_its_parallels():
    surface = build_surface(Sphere(radius=50.0), 5.0, {patch_key("p"): ANYWHERE})
    circles = tensor_of(surface, Circles(Winding((0.0, 0.0, 50.0))))
    parallels = build_tissue(
        surface, TissueSection(1.0, (Patch("p", ANYWHERE, anisotropy={"phi": 8.0, "theta": 2.0}),))
    ).tensor
    away = np.sin(surface.net[:, 0]) > 0.3
    # a triangle leans by up to h/(2 R) = 0.05 against the sphere, which moves the foot of
    # x - centre (at most 2 R long) by at most 5 su; it is 0.3 R or more away from the middle
    turn = np.abs(np.einsum("mij,mij->m", circles, parallels) / 68.0 - 1.0)
    assert turn[away].max() < 0.02
    assert turn[away].mean() < 2e-4
    # the poles themselves: few triangles, the mean of the factors both ways
    alike = np.isclose(np.linalg.eigvalsh(circles)[:, 1], 5.0)
    assert 1 <= alike.sum() <= 20
    assert np.sin(surface.net[alike, 0]).max() < 0.15


def test_an_angle_is_taken_from_the_first_axis_towards_the_second():
    surface = triangles_at((3.0, 0.0), (0.0, 4.0))
    tensor = tensor_of(surface, AngleField("30 deg + y*0"))
    f, g = np.array([3**0.5 / 2, 0.5]), np.array([-0.5, 3**0.5 / 2])
    expected = 8 * np.outer(f, f) + 2 * np.outer(g, g)
    np.testing.assert_allclose(tensor[:, :2, :2], np.tile(expected, (2, 1, 1)), atol=1e-14)


def test_an_angle_of_the_place_makes_the_circles_again():
    surface = build_surface(
        Plane(x=(-40.0, 40.0), y=(-40.0, 40.0)), 5.0, {patch_key("p"): ANYWHERE}
    )
    by_angle = tensor_of(surface, AngleField("atan2(y - 7, x) + pi/2 + 0.2"))
    circles = tensor_of(surface, Circles(Winding((0.0, 7.0, 0.0), 0.2)))
    middle = surface.points[surface.triangles].mean(axis=1)
    away = np.hypot(middle[:, 0], middle[:, 1] - 7.0) > 5.0
    np.testing.assert_allclose(by_angle[away], circles[away], atol=1e-12)


def test_angles_may_name_the_coordinates_of_the_net():
    surface = build_surface(Vein(), 15.0, {patch_key("p"): Box(BoxLimits(x=(20.0, 60.0)))})
    tensor = tensor_of(surface, AngleField("theta + phi/2"))
    inside = surface.regions[patch_key("p")]
    theta, phi = surface.net[inside].T
    along = np.cos(theta + phi / 2)[:, None] * surface.frame[inside, 0]
    along += np.sin(theta + phi / 2)[:, None] * surface.frame[inside, 1]
    found = main_directions(surface, tensor)[inside]
    # the sign of a direction means nothing
    np.testing.assert_allclose(np.abs(np.einsum("md,md->m", found, along)), 1.0, atol=1e-12)


def test_fibres_ask_for_the_same_edges_whatever_their_direction():
    surface = triangles_at((3.0, 0.0), (0.0, 4.0), (5.0, 5.0))
    # (8 / 2 - 1) / 2 everywhere
    for fibres in (AngleField("x + y"), Circles(Winding((0.0, 0.0, 0.0), 1.0))):
        assert anisotropy(surface, tensor_of(surface, fibres)) == pytest.approx(1.5, rel=1e-9)


def test_later_patches_without_fibres_have_the_axes_of_the_net_again():
    surface = triangles_at((3.0, 0.0), (0.0, 4.0))
    surface.regions[patch_key("q")] = np.array([False, True])
    patches = (
        Patch("p", ANYWHERE, AngleField("1"), anisotropy=FIBRES),
        Patch("q", ANYWHERE, anisotropy={"x": 3.0}),
    )
    tensor = build_tissue(surface, TissueSection(1.0, patches)).tensor
    np.testing.assert_allclose(tensor[1], np.diag([3.0, 1.0, 0.0]), atol=1e-14)


def test_circles_need_a_place_to_the_side_of_their_centre():
    surface = build_surface(Sphere(radius=50.0), 10.0, {patch_key("p"): ANYWHERE})
    with pytest.raises(InputError) as caught:
        tensor_of(surface, Circles(Winding((0.0, 0.0, 0.0))))
    assert caught.value.where == "tissue.patches.p.fibres.circles.centre"
    assert "no place of the patch lies to the side of [0.0, 0.0, 0.0]" in caught.value.problem


def test_an_angle_that_is_not_finite_somewhere_is_refused_with_the_place():
    surface = triangles_at((3.0, 1.0), (-2.0, 4.0))
    with pytest.raises(InputError) as caught:
        tensor_of(surface, AngleField("sqrt(x)"))
    assert caught.value.where == "tissue.patches.p.fibres.angle"
    assert "sqrt(-2) is not a finite number, at (x, y, z) = (-2, 4, 0)" in caught.value.problem


CONFIG = """\
geometry: {kind: plane}
tissue:
  patches:
    - name: block
      region: {box: {x: [-50, 50]}}
      fibres: FIBRES
      anisotropy: FACTORS
stimulus: [{shape: edge, edge: right}]
time: {end: 1000}
"""


@pytest.mark.parametrize(
    ("fibres", "factors", "says"),
    [
        (
            "{angle: 'sin(x'}",
            "{along: 8}",
            ["a.yaml:6: tissue.patches.block.fibres.angle", "      ^"],
        ),
        (
            "{angle: 'z + phi'}",
            "{along: 8}",
            ["a.yaml:6", "a plane has no coordinate 'phi'", "x, y, z"],
        ),
        ("{angle: X}", "{along: 8}", ["no coordinate 'X', did you mean 'x'?"]),
        ("{angle: true}", "{along: 8}", ["a.yaml:6", "true is not text", "atan2"]),
        ("{angle: .nan}", "{along: 8}", ["fibres.angle", "nan"]),
        (
            "{angle: 0}",
            "{x: 8}",
            ["a.yaml:7", "block.anisotropy.x", "no axis 'x'", "along, across"],
        ),
        ("{angle: 0}", "{alng: 8}", ["a.yaml:7", "did you mean 'along'?"]),
        ("{angle: 0}", "null", ["a.yaml:6: tissue.patches.block.fibres", "anisotropy: {along: 8}"]),
        ("null", "{along: 8}", ["anisotropy.along", "an axis of fibres", "fibres: {angle: 0}"]),
        ("{circle: {centre: [0, 0, 0]}}", "2", ["fibre rule word 'circle'", "'circles'?"]),
        ("{angle: 0, circles: {centre: [0, 0, 0]}}", "2", ["has one word, this one has 2"]),
        ("{}", "2", ["{} is not a fibre rule", "circles, angle"]),
        ("circles", "2", ["'circles' is not a fibre rule", "circles, angle", "centre: [0, 0, 0]"]),
        ("{circles: {pitch: 1}}", "2", ["a.yaml:6", "fibres.circles.centre", "missing"]),
        ("{circles: {centre: [0, 0]}}", "2", ["fibres.circles.centre"]),
        ("{circles: {centre: [0, 0, 0], pitch: steep}}", "2", ["circles.pitch", "45 deg"]),
    ],
)
def test_wrong_fibres_are_refused_with_line_and_key(fibres, factors, says):
    with pytest.raises(InputError) as caught:
        load_text(CONFIG.replace("FIBRES", fibres).replace("FACTORS", factors), "a.yaml")
    for words in says:
        assert words in str(caught.value)


@pytest.mark.parametrize(("written", "text"), [("0.25", "0.25"), ("2", "2"), ("45 deg", "45 deg")])
def test_a_number_is_an_angle_too(written, text):
    given = CONFIG.replace("FIBRES", f"{{angle: {written}}}").replace("FACTORS", "{along: 8}")
    assert load_text(given).config.tissue.patches[0].fibres == AngleField(text)
