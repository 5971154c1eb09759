"""The paper's theoretical figures: what their curves are made of."""

import numpy as np
import pytest

from cardiosurf.report.theory_figures import (
    FIGURES,
    WIDTH,
    case_two,
    draw_theory,
    edge_component,
    planeani2a,
    relpv1,
    rise,
)


def printed(angle, theta, ratio, factors):
    """Case II as section 5.4 prints it, with R = 1."""
    q = 1 - np.sin(theta) + ratio
    first, second = factors
    weight = np.sin(angle) / (first * q**2 * np.cos(angle) ** 2 + second * np.sin(angle) ** 2)
    velocity = first * np.cos(angle) * (1 - np.sin(theta) - ratio * np.sin(theta))
    return weight * (velocity - 2 * second * np.sin(angle) ** 2 * np.cos(theta) / q)


@pytest.mark.parametrize("ratio", [0.3, 1.0, 2.5])
def test_case_two_is_the_printed_formula_with_unit_arc(ratio):
    theta = np.linspace(0, np.pi / 2, 11)
    for angle in (0.2, 0.9, 1.5):
        np.testing.assert_allclose(
            case_two(angle, theta, ratio, (5.0, 3.0)),
            printed(angle, theta, ratio, (5.0, 3.0)),
            rtol=1e-12,
            atol=1e-14,
        )


def test_relpv1_draws_case_two():
    figure = relpv1()
    assert [axes.get_title() for axes in figure.axes] == ["A = pi/6", "A = pi/3", "A = pi/2"]
    line = next(one for one in figure.axes[1].lines if one.get_label() == "r/R = 1")
    theta, height = line.get_data()
    np.testing.assert_allclose(height, printed(np.pi / 3, theta, 1.0, (4, 4)), atol=1e-14)


def test_what_the_paper_reads_off_relpv2():
    # at r/R = 1: greatest near pi/3, and a sixth of that at pi/2
    angles = np.linspace(0, np.pi / 2, 181)
    heights = np.array([rise(angle, 1.0) for angle in angles])
    assert angles[heights.argmax()] == pytest.approx(np.pi / 3, abs=0.04)
    assert heights[-1] / heights.max() == pytest.approx(0.0938 / 0.6406, rel=1e-3)
    # but at r/R = 1/2, the vein of its own section 5.4, the drop is to a half
    heights = np.array([rise(angle, 0.5) for angle in angles])
    assert heights[-1] / heights.max() == pytest.approx(0.46, abs=0.01)


def test_planeani2a_has_the_jump_in_its_integral():
    figure = planeani2a()
    y, slope = figure.axes[1].lines[0].get_data()
    below = y < 0
    integral = (0.5 * (slope[1:] + slope[:-1]) * np.diff(y))[below[1:]].sum()
    assert integral == pytest.approx(np.log(10.0), rel=1e-6)


def test_sphereani2a_goes_with_the_cotangent_or_the_cosine():
    theta = np.array([0.6, 1.2, 2.0, 2.7])
    even = edge_component(theta, lambda one: WIDTH * float(np.sin(one)))
    # d log s / d phi at the edge, where s = (1 + 10) / 2: -2 ln 9 (R / width) (9 / 4) / 5.5
    slope = -2 * np.log(9) * 50 / WIDTH * 2.25 / 5.5
    # the block's other edge, pi/2 away, is felt by exp(-2 ln 9 (pi/2) / 0.24) = 3e-13
    np.testing.assert_allclose(even, slope / np.tan(theta), rtol=1e-9)
    fixed = edge_component(theta, lambda _: WIDTH)
    np.testing.assert_allclose(fixed, slope * np.cos(theta), rtol=1e-4)


def test_every_figure_becomes_a_file(tmp_path):
    written = draw_theory(tmp_path)
    assert [path.stem for path in written] == list(FIGURES)
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in written)
