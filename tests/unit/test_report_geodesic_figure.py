"""How high the shortest ways over the vein climb."""

import numpy as np
import pytest
import scipy

from cardiosurf.analysis.conductor import Conductor
from cardiosurf.analysis.eikonal import arrival
from cardiosurf.analysis.sources import Sources
from cardiosurf.geometry import build_surface
from cardiosurf.geometry.vein import Vein
from cardiosurf.report.geodesic_figure import RIM, ROOT, SPANS, TIP, geodesics, summit, tangential

ARC = ROOT - TIP


def integral(theta, weight):
    """Clairaut: from a turn at theta down to the root; t = theta - w² takes the root out."""
    c = ROOT - ARC * np.sin(theta)

    def along(w):
        rho = ROOT - ARC * np.sin(theta - w**2)
        return 2 * w * ARC * weight(rho, c) / np.sqrt(rho**2 - c**2)

    return scipy.integrate.quad(along, 1e-9, np.sqrt(theta), epsabs=1e-12, epsrel=1e-12)[0]


@pytest.mark.parametrize("span", [0.5 * np.pi, np.pi])
def test_the_summit_is_where_clairauts_integral_gives_half_the_span(span):
    theta = summit(span)
    # rho² - c² loses digits near the turn
    assert integral(theta, lambda rho, c: c / rho) == pytest.approx(0.5 * span, abs=1e-6)
    length = integral(theta, lambda rho, c: rho)
    assert tangential(theta).arclength[-1] == pytest.approx(length, abs=1e-5)
    assert 2 * length < ROOT * span


def test_longer_ways_climb_higher_but_never_to_the_tip():
    heights = [summit(part * np.pi) for part in SPANS]
    assert (np.diff(heights) > 0).all()
    assert heights[-1] < RIM
    # the values that docs/theory.md gives
    assert heights == pytest.approx([0.1510, 0.5257, 0.8845, 1.1242], abs=5e-5)


def test_the_figure_shows_circles_geodesics_and_curvature():
    left, middle, right = geodesics().axes
    # after seven circles geodesics and starts; the last stretch is straight, on the plane
    y, z = np.array(left.lines[7].get_data())[:, -2:]
    assert np.hypot(y[0], z[0]) == pytest.approx(ROOT, abs=1e-6)
    assert np.hypot(y[1] - y[0], z[1] - z[0]) == pytest.approx(30.0, rel=1e-9)
    assert len(middle.lines) == 2 + len(SPANS) + 1
    theta, bent = right.lines[1].get_data()
    # tip 35: -ROOT cos theta / rho
    expected = -ROOT * np.cos(theta) / (ROOT - 35.0 * np.sin(theta))
    np.testing.assert_allclose(bent, expected, atol=1e-12)


def test_the_shortest_ways_are_as_long_as_the_eikonal_equation_says():
    # an independent way: distance from a point of the root, square and vein meshed, no net used
    surface = build_surface(Vein(root_radius=ROOT, tip_radius=TIP, half_width=80.0), 4.0, {})
    points = surface.points
    turn = np.array([0.0, *SPANS]) * np.pi
    places = ROOT * np.stack([np.zeros_like(turn), np.sin(turn), np.cos(turn)], axis=1)
    near = [int(np.linalg.norm(points - place, axis=1).argmin()) for place in places]
    # the mesh has the root among its lines
    assert points[near, 0] == pytest.approx(0.0, abs=1e-9)
    assert np.hypot(*points[near, 1:].T) == pytest.approx(ROOT, abs=1e-9)
    angles = np.arctan2(points[near, 1], points[near, 2])
    spans = np.arccos(np.cos(angles[1:] - angles[0]))
    everywhere = np.broadcast_to(np.eye(3), (len(surface.triangles), 3, 3))
    conductor = Conductor(points, surface.triangles, everywhere)
    source = Sources(np.array(near[:1]), np.zeros(1), np.full((1, 3), np.nan))
    found = arrival(conductor, source, 1.0).times[near[1:]]
    exact = [2 * tangential(summit(span)).arclength[-1] for span in spans.tolist()]
    # second order: 2e-4 at edge 4; chords alone shorten ways by (edge / radius)² / 24 = 5e-4
    np.testing.assert_allclose(found, exact, rtol=1e-3)
