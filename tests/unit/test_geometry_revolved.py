"""Torus, atrium and turned spheres against their formulas."""

import numpy as np
import pytest
from geometry_integrals import meshed
from region_words import ball, box, half_space, polar
from scipy.integrate import quad

from cardiosurf.geometry import Surface, build_surface
from cardiosurf.geometry.atrium import Atrium
from cardiosurf.geometry.pinches import saddles
from cardiosurf.geometry.quality import quality
from cardiosurf.geometry.regions import (
    AnyOf,
    Part,
)
from cardiosurf.geometry.sphere import Sphere
from cardiosurf.geometry.torus import Torus
from cardiosurf.geometry.trace import background

PI = np.pi
EDGE = 2.5
RING, TUBE = 100.0, 50.0
# of the atrium's join: an eighth of a turn of this radius, then 20 su straight on
FILLET = 80.0 - 20.0 / np.tan(PI / 8)


@pytest.fixture(scope="module")
def torus() -> Surface:
    return build_surface(
        Torus(),
        EDGE,
        {
            "block": box(x=(-50, 50), y=(0, 150)),
            "inner": AnyOf((polar(theta=(PI / 2, PI)), polar(theta=(-PI, -PI / 2)))),
            "across_theta": polar(theta=(PI - 0.5, PI + 0.3), phi=(-0.4, 0.4)),
            "from_below": polar(theta=(-PI - 0.5, -PI + 0.3), phi=(1.0, 2.0)),
            "across_phi": polar(theta=(-0.4, 0.9), phi=(2.9, 4.0)),
            "cap": half_space((-1.0, 0.0, 0.0), 140.0),
            "above": box(z=(30.0, 50.0)),
            "spot": ball((0.0, -150.0, 0.0), 12.0),
        },
    )


def torus_regions() -> dict[str, float]:
    def across(wide) -> float:
        return quad(lambda t: TUBE * (RING + TUBE * np.cos(t)) * wide(t), -PI, PI, limit=500)[0]

    def patch(theta: tuple[float, float], phi: float) -> float:
        low, high = theta
        return TUBE * phi * (RING * (high - low) + TUBE * (np.sin(high) - np.sin(low)))

    def in_block(t: float) -> float:
        return 2.0 * np.arcsin(min(1.0, 50.0 / (RING + TUBE * np.cos(t))))

    def in_cap(t: float) -> float:
        return 2.0 * np.arccos(min(1.0, 140.0 / (RING + TUBE * np.cos(t))))

    def in_spot(t: float) -> float:
        rho, z = RING + TUBE * np.cos(t), TUBE * np.sin(t)
        return 2.0 * np.arccos(min(1.0, (rho**2 + z**2 + 150.0**2 - 144.0) / (300.0 * rho)))

    top = np.arcsin(0.6)
    return {
        "block": across(in_block),
        "inner": patch((PI / 2, 3 * PI / 2), 2 * PI),
        "across_theta": patch((PI - 0.5, PI + 0.3), 0.8),
        "from_below": patch((-PI - 0.5, -PI + 0.3), 1.0),
        "across_phi": patch((-0.4, 0.9), 1.1),
        "cap": across(in_cap),
        "above": patch((top, PI - top), 2 * PI),
        "spot": across(in_spot),
    }


def test_vertices_of_a_torus_lie_on_it(torus: Surface) -> None:
    x, y, z = torus.points.T
    np.testing.assert_allclose(np.hypot(np.hypot(x, y) - RING, z), TUBE, rtol=1e-12)


def test_torus_regions_have_their_exact_areas(torus: Surface) -> None:
    for name, area in torus_regions().items():
        assert meshed(torus, name) == pytest.approx(area, rel=1e-3), name


def test_the_block_has_corners_where_its_planes_touch_the_inner_equator(torus: Surface) -> None:
    for x in (-50.0, 50.0):
        away = np.linalg.norm(torus.points - [x, 0.0, 0.0], axis=1)
        corner = int(away.argmin())
        assert away[corner] < 1e-9
        # between the planes' branches, z^2 = y^2 to leading order, lies a quarter of a turn
        around = torus.triangles[(torus.triangles == corner).any(axis=1) & torus.regions["block"]]
        at = np.array([torus.points[np.roll(t, -t.tolist().index(corner))] for t in around])
        first, second = at[:, 1] - at[:, 0], at[:, 2] - at[:, 0]
        turn = np.arctan2(
            np.linalg.norm(np.cross(first, second), axis=1), np.einsum("kd,kd->k", first, second)
        )
        # a chord of length 2 leaves the branch's tangent by a few hundredths of a radian
        assert turn.sum() == pytest.approx(PI / 2, abs=0.1)


def test_saddles_of_planes_on_a_torus() -> None:
    sheet = Torus().sheet(EDGE)
    # the last plane touches the tube twice, from inside: it cuts two Villarceau circles
    tilt = float(np.arcsin(TUBE / RING))
    for normal, offset, expected in (
        ((1.0, 0.0, 0.0), 50.0, [[50.0, 0.0, 0.0]]),
        ((-1.0, 0.0, 0.0), 50.0, [[-50.0, 0.0, 0.0]]),
        ((1.0, 0.0, 0.0), 140.0, []),
        ((0.0, 0.0, 1.0), 50.0 - 1e-9, []),
        (
            (0.0, -float(np.sin(tilt)), float(np.cos(tilt))),
            0.0,
            [[0.0, 75.0, 75.0 * np.tan(tilt)], [0.0, -75.0, -75.0 * np.tan(tilt)]],
        ),
    ):
        level = sheet.flat_level(normal, offset)
        assert level is not None
        ground = background(sheet, [])
        found = saddles(level, ground.points, ground.edges, sheet, ground.spacing)
        unique = np.unique(np.round(found, 6) + 0.0, axis=0)
        assert len(unique) == len(expected)
        for place in expected:
            assert np.linalg.norm(unique - place, axis=1).min() < 1e-5


@pytest.mark.parametrize("tube", [20.0, 50.0, 80.0])
def test_area_of_a_torus_converges_with_slope_2(tube: float) -> None:
    exact = 4.0 * PI**2 * RING * tube
    off = [
        1.0 - build_surface(Torus(tube_radius=tube), h, {}).areas().sum() / exact
        for h in (10.0, 5.0)
    ]
    # the number of rings is whole, so edges are not exactly halved
    assert np.log2(off[0] / off[1]) == pytest.approx(2.0, abs=0.5)
    assert 0.0 < off[1] < 5.0 / 24.0 * 5.0**2 / tube**2


def test_frame_of_a_torus_is_that_of_its_parametrisation(torus: Surface) -> None:
    assert (torus.parts, torus.axes, dict(torus.edges)) == (("torus",), (("theta", "phi"),), {})
    assert frames_agree(torus, on_torus) < 0.04
    inward = np.einsum("mk,mk->m", normals(torus), outward_of_torus(torus))
    assert inward.max() < -0.99


def on_torus(theta, phi):
    rho = RING + TUBE * np.cos(theta)
    return np.stack([rho * np.cos(phi), rho * np.sin(phi), TUBE * np.sin(theta)], axis=1)


def outward_of_torus(surface: Surface):
    centre = surface.points[surface.triangles].mean(axis=1)
    ring = centre * [1.0, 1.0, 0.0]
    ring *= RING / np.linalg.norm(ring, axis=1)[:, None]
    return (centre - ring) / np.linalg.norm(centre - ring, axis=1)[:, None]


def normals(surface: Surface):
    return np.cross(surface.frame[:, 0], surface.frame[:, 1])


def frames_agree(surface: Surface, place) -> float:
    """How far frames are from central differences of a parametrisation; chords lean by h / 2 r."""
    theta, phi = surface.net.T
    step = 1e-6
    along = place(theta + step, phi) - place(theta - step, phi)
    around = place(theta, phi + step) - place(theta, phi - step)
    exact = np.stack([along, around], axis=1)
    exact /= np.linalg.norm(exact, axis=2, keepdims=True)
    return float(np.abs(surface.frame - exact).max())


SCAR = box(x=(55, 75), y=(-200, 0))


@pytest.fixture(scope="module")
def atrium() -> Surface:
    return build_surface(
        Atrium(),
        EDGE,
        {
            "vein": Part("vein"),
            "body": Part("body"),
            "strip_left": box(x=(-30, -10), y=(-200, 0), z=(0, 60)),
            "strip_right": box(x=(-30, -10), y=(0, 200), z=(0, 60)),
            "scar": SCAR,
            "lowest": box(z=(-170, -150)),
            "upper_vein": polar(theta=(0.0, PI / 4)),
            "across_phi": polar(theta=(1.0, 1.4), phi=(3.0, 3.5)),
            "on_the_circle": ball((126.52, 0.0, -35.55), 15.0),
        },
    )


def atrium_pieces():
    """The profile's four pieces: rho and z of a parameter, its range, and su per unit of it."""
    return (
        (lambda t: (100.0 - 56.0 * np.cos(t), 56.0 * (1.0 - np.sin(t))), (0.0, PI / 2), 56.0),
        (
            lambda t: (100.0 + FILLET * np.sin(t), -FILLET * (1.0 - np.cos(t))),
            (0.0, PI / 4),
            FILLET,
        ),
        (
            lambda t: (
                80.0 + 80.0 * np.sqrt(0.5) - (20.0 - t) * np.sqrt(0.5),
                -80.0 + 80.0 * np.sqrt(0.5) + (20.0 - t) * np.sqrt(0.5),
            ),
            (0.0, 20.0),
            1.0,
        ),
        (
            lambda t: (80.0 + 80.0 * np.sin(t), -80.0 + 80.0 * np.cos(t)),
            (PI / 4, 5 * PI / 4),
            80.0,
        ),
    )


def atrium_area(wide, *, pieces=(0, 1, 2, 3)) -> float:
    """Area that takes wide(rho, z) radians of each ring of some pieces."""
    total = 0.0
    for number in pieces:
        place, limits, scale = atrium_pieces()[number]

        def ring(t: float, place=place, scale=scale) -> float:
            rho, z = place(t)
            return float(scale * rho * wide(rho, z))

        total += quad(ring, *limits, limit=800, epsabs=1e-4)[0]
    return total


def atrium_regions() -> dict[str, float]:
    def turn(_rho: float, _z: float) -> float:
        return 2.0 * PI

    def strip(rho: float, _z: float) -> float:
        return 2.0 * np.arcsin(10.0 / rho)

    def scar(rho: float, _z: float) -> float:
        return np.arccos(min(1.0, 75.0 / rho)) - np.arccos(min(1.0, 95.0 / rho))

    def low(_rho: float, z: float) -> float:
        return 2.0 * PI if z <= -150.0 else 0.0

    def in_ball(rho: float, z: float) -> float:
        cosine = (rho**2 + (z + 35.55) ** 2 + 146.52**2 - 225.0) / (2.0 * rho * 146.52)
        return 2.0 * np.arccos(np.clip(cosine, -1.0, 1.0))

    def part_of_vein(theta: tuple[float, float], phi: float) -> float:
        a, b = theta
        return 56.0 * phi * (100.0 * (b - a) - 56.0 * (np.sin(b) - np.sin(a)))

    return {
        "vein": atrium_area(turn, pieces=(0,)),
        "body": atrium_area(turn, pieces=(1, 2, 3)),
        "strip_left": atrium_area(strip, pieces=(0,)),
        "strip_right": atrium_area(strip, pieces=(0,)),
        "scar": atrium_area(scar),
        "lowest": atrium_area(low, pieces=(3,)),
        "upper_vein": part_of_vein((0.0, PI / 4), 2.0 * PI),
        "across_phi": part_of_vein((1.0, 1.4), 0.5),
        "on_the_circle": atrium_area(in_ball),
    }


def test_atrium_regions_have_their_exact_areas(atrium: Surface) -> None:
    for name, area in atrium_regions().items():
        assert meshed(atrium, name) == pytest.approx(area, rel=1e-3), name


def test_vertices_of_the_atrium_lie_on_its_profile(atrium: Surface) -> None:
    rho, z = np.hypot(atrium.points[:, 0] + 20.0, atrium.points[:, 1]), atrium.points[:, 2]
    line = np.abs((rho - 80.0) + (z + 80.0) - 80.0 * np.sqrt(2.0)) / np.sqrt(2.0)
    body = np.abs(np.hypot(rho - 80.0, z + 80.0) - 80.0)
    fillet = np.abs(np.hypot(rho - 100.0, z + FILLET) - FILLET)
    vein = np.abs(np.hypot(rho - 100.0, z - 56.0) - 56.0)
    assert np.minimum.reduce([line, body, fillet, vein]).max() < 1e-9
    # each where it belongs
    assert vein[z > 1e-9].max() < 1e-9
    assert body[(z < -23.5) | (rho > 137.0)].max() < 1e-9


def test_the_sinoatrial_node_lies_on_the_body() -> None:
    sheet = Atrium().sheet(EDGE)
    angle = np.radians(56.25)
    exact = np.array([[60.0 + 80.0 * np.sin(angle), 0.0, -80.0 + 80.0 * np.cos(angle)]])
    np.testing.assert_allclose(sheet.project(exact), exact, atol=1e-12)
    # what is printed is that, rounded to two decimals
    np.testing.assert_allclose(exact, [[126.52, 0.0, -35.55]], atol=0.005)
    assert sheet.part_of(exact).tolist() == [1]


def test_the_join_is_as_long_and_as_large_as_documented() -> None:
    # docs/physics.md: what is there instead of the straight piece between the paper's grid points
    first = np.array([100.0 - 56.0 * np.sin(PI / 10), 56.0 * (1.0 - np.cos(PI / 10))])
    last = np.array([80.0 + 80.0 * np.sqrt(0.5), -80.0 + 80.0 * np.sqrt(0.5)])
    straight = float(np.linalg.norm(last - first))
    length = 56.0 * PI / 10 + FILLET * PI / 4 + 20.0
    assert length - straight == pytest.approx(2.61, abs=0.005)
    place, _, scale = atrium_pieces()[0]
    piece = quad(lambda t: 2.0 * PI * scale * place(t)[0], 0.4 * PI, 0.5 * PI)[0]
    area = piece + atrium_area(lambda *_: 2.0 * PI, pieces=(1, 2))
    assert area - PI * (first[0] + last[0]) * straight == pytest.approx(2607.0, abs=1.0)
    assert Atrium().sheet(EDGE).stations[1] == pytest.approx(28.0 * PI, rel=1e-14)


def test_open_edges_and_net_of_the_atrium(atrium: Surface) -> None:
    assert (atrium.parts, set(atrium.edges)) == (("vein", "body"), {"tip", "bottom"})
    for name, radius, height in (("tip", 44.0, 56.0), ("bottom", 80.0 - 80.0 * np.sqrt(0.5), None)):
        rim = atrium.points[atrium.edges[name]].reshape(-1, 3)
        np.testing.assert_allclose(np.hypot(rim[:, 0] + 20.0, rim[:, 1]), radius, atol=1e-9)
        below = -80.0 - 80.0 * np.sqrt(0.5) if height is None else height
        np.testing.assert_allclose(rim[:, 2], below, atol=1e-9)
    on_vein = atrium.part_of == 0
    theta, phi = atrium.net.T
    centre = atrium.points[atrium.triangles].mean(axis=1)
    np.testing.assert_allclose(np.arctan2(centre[:, 1], centre[:, 0] + 20.0), phi, atol=1e-9)
    assert theta[on_vein].max() < PI / 2 < theta[~on_vein].min()
    assert theta.max() < PI / 2 + (FILLET * PI / 4 + 20.0 + 80.0 * PI) / 80.0
    # outward: up on the underside of nothing, away from the axis at the equator, down below
    normal = normals(atrium)
    assert normal[centre[:, 2] < -155.0, 2].max() < -0.9
    wide = np.hypot(centre[:, 0] + 20.0, centre[:, 1]) > 158.0
    outward = (centre[wide, :2] + [20.0, 0.0]) / 159.0
    assert np.einsum("mk,mk->m", normal[wide, :2], outward).min() > 0.9


def test_frame_of_the_vein_is_that_of_its_parametrisation(atrium: Surface) -> None:
    on_vein = np.flatnonzero(atrium.part_of == 0)

    def place(theta, phi):
        rho = 100.0 - 56.0 * np.cos(theta)
        return np.stack(
            [-20.0 + rho * np.cos(phi), rho * np.sin(phi), 56.0 * (1.0 - np.sin(theta))], axis=1
        )

    theta, phi = atrium.net[on_vein].T
    step = 1e-6
    along = (place(theta + step, phi) - place(theta - step, phi)) / (2.0 * step)
    around = place(theta, phi + step) - place(theta, phi - step)
    for number, exact in enumerate((along, around)):
        unit = exact / np.linalg.norm(exact, axis=1)[:, None]
        # chords of 4 su on radii of 44 and more
        assert np.abs(atrium.frame[on_vein, number] - unit).max() < 0.05


def test_area_of_the_atrium_converges_with_slope_2() -> None:
    exact = atrium_area(lambda *_: 2.0 * PI)
    off = [1.0 - build_surface(Atrium(), edge, {}).areas().sum() / exact for edge in (10.0, 5.0)]
    assert np.log2(off[0] / off[1]) == pytest.approx(2.0, abs=0.5)
    assert 0.0 < off[1] < 5e-4


def test_the_scar_leaves_only_the_angle_its_edge_makes_with_the_root(atrium: Surface) -> None:
    # the plane x = 75 meets the root circle, 95 of 100 su away from the axis, at 18.2 degrees
    assert np.degrees(np.arccos(0.95)) == pytest.approx(18.2, abs=0.05)
    assert quality(atrium).smallest_angle > 14.0


def test_other_proportions_of_the_atrium() -> None:
    # a root inside the top of the body's circle: a level ring; a root right on it: nothing between
    for root, flat in ((70.0, 10.0), (80.0, 0.0)):
        shape = Atrium(root_radius=root, tip_radius=40.0, axis_x=5.0)
        found = quality(build_surface(shape, 8.0, {}))
        vein = 2.0 * PI * (root - 40.0) * (root * PI / 2 - (root - 40.0))
        ring = PI * (80.0**2 - (80.0 - flat) ** 2)
        body = 2.0 * PI * 6400.0 * (5 * PI / 4 + 1.0 - np.cos(5 * PI / 4))
        assert found.area == pytest.approx(vein + ring + body, rel=3e-3)
        assert (found.euler, found.loops) == (0, 2)
        assert found.smallest_angle > 20.0


POLES = [(0.0, 0.0, 1.0), (1.0, 2.0, -1.0), (3.0, 0.0, 0.0), (0.0, 0.0, -2.0), (0.0, 1.0, 0.0)]


@pytest.mark.parametrize("pole", POLES)
def test_angles_about_any_pole(pole: tuple[float, float, float]) -> None:
    sheet = Sphere(radius=50.0, pole=pole).sheet(EDGE)
    unit = np.array(pole) / np.linalg.norm(pole)
    points = sheet.project(np.random.default_rng(2).normal(size=(200, 3)))
    theta, phi = sheet.net(points, sheet.part_of(points)).T
    np.testing.assert_allclose(np.cos(theta), points @ unit / 50.0, atol=1e-12)
    # a turn about the pole by a right-handed angle adds to phi (Rodrigues)
    turned = (
        points * np.cos(0.3)
        + np.cross(unit, points) * np.sin(0.3)
        + np.outer(points @ unit, unit) * (1.0 - np.cos(0.3))
    )
    grown = sheet.net(turned, sheet.part_of(points))[:, 1] - phi
    np.testing.assert_allclose(np.mod(grown, 2.0 * PI), 0.3, atol=1e-9)
    # phi = 0 on the side of +x, or of +y where the pole is on the x axis
    zero = np.array([[0.0, 50.0, 0.0] if pole[1] == pole[2] == 0.0 else [50.0, 0.0, 0.0]])
    assert sheet.net(zero, np.zeros(1, dtype=int))[0, 1] == pytest.approx(0.0, abs=1e-15)
    e1, e2 = np.moveaxis(sheet.frame(points, sheet.part_of(points)), 1, 0)
    np.testing.assert_allclose(np.cross(e1, e2), points / 50.0, atol=1e-12)
    np.testing.assert_allclose(e2 @ unit, 0.0, atol=1e-15)


def test_the_usual_pole_changes_nothing() -> None:
    given = build_surface(Sphere(pole=(0.0, 0.0, 3.0)), 8.0, {"s": polar(phi=(0.1, 1.0))})
    usual = build_surface(Sphere(), 8.0, {"s": polar(phi=(0.1, 1.0))})
    np.testing.assert_array_equal(given.points, usual.points)
    np.testing.assert_array_equal(given.frame, usual.frame)
    x, y, z = given.points[given.triangles].mean(axis=1).T
    np.testing.assert_allclose(given.net[:, 0], np.arctan2(np.hypot(x, y), z), atol=1e-12)
    np.testing.assert_allclose(given.net[:, 1], np.arctan2(y, x), atol=1e-12)


def test_polar_regions_follow_the_pole() -> None:
    block = polar(theta=(PI / 4, 3 * PI / 4), phi=(-PI / 4, PI / 4))
    regions = {"block": block, "cap": polar(theta=(0.0, 0.5)), "across": polar(phi=(2.8, 3.6))}
    sphere = build_surface(Sphere(pole=(1.0, 2.0, -1.0)), EDGE, regions)
    exact = {
        "block": 2500.0 * PI / 2 * np.sqrt(2.0),
        "cap": 2.0 * PI * 2500.0 * (1.0 - np.cos(0.5)),
        "across": 2.0 * 2500.0 * 0.8,
    }
    for name, area in exact.items():
        assert meshed(sphere, name) == pytest.approx(area, rel=1e-3), name
    middle = sphere.points[sphere.triangles[sphere.regions["cap"]]].mean(axis=(0, 1))
    np.testing.assert_allclose(
        middle / np.linalg.norm(middle), np.array([1.0, 2.0, -1.0]) / np.sqrt(6.0), atol=0.01
    )
