"""The accuracy of a config, and the mesh edges that follow from it."""

from dataclasses import replace
from itertools import pairwise

import pytest
from pydantic import TypeAdapter, ValidationError

from cardiosurf.config.accuracy import (
    ACROSS,
    EDGE_ERRORS,
    SHARE,
    TIDY_EDGES,
    Accuracy,
    edge_choice,
    parse_accuracy,
    smallest_diffusivity,
    tidy_edges,
)
from cardiosurf.config.loader import load_text
from cardiosurf.errors import InputError
from cardiosurf.tissue.patches import TissueSection

PLANE = """
geometry: {kind: plane, x: [-50, 50], y: [-50, 50]}
stimulus: [{shape: edge, edge: right}]
time: {end: 100}
"""


def config(more=""):
    return load_text(PLANE + more, "a.yaml").config


@pytest.mark.parametrize(("text", "value"), [("0.5 %", 0.005), ("1%", 0.01), (" .25 % ", 0.0025)])
def test_percentages(text, value):
    assert parse_accuracy(text) == pytest.approx(value, rel=1e-15)
    assert TypeAdapter(Accuracy).validate_python(text) == pytest.approx(value, rel=1e-15)
    assert config(f"accuracy: {text}\n").accuracy == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("wrong", ["0.5", "half", "-1 %", "50 %", "0.001 %", "1 % of LAT"])
def test_what_is_no_accuracy(wrong):
    with pytest.raises(ValidationError):
        TypeAdapter(Accuracy).validate_python(wrong)


def test_an_error_says_what_is_allowed():
    with pytest.raises(InputError, match=r"accuracy.*") as caught:
        config("accuracy: fine\n")
    assert "0.05 % to 5 %" in str(caught.value)


def test_auto_edges_are_the_longest_tidy_ones_within_their_share():
    coefficient, order = EDGE_ERRORS["blended"]
    for accuracy in (0.001, 0.005, 0.02):
        given = config(f"accuracy: {accuracy}\n")
        choice = edge_choice(given)
        longer = next(edge for edge in TIDY_EDGES if edge > choice.edge_length)
        # c1 (1 - a) = 0.2262 is the rate of the shipped constants, d = 1
        errors = [
            coefficient * (edge * 0.2262**0.5) ** order for edge in (choice.edge_length, longer)
        ]
        assert errors[0] == pytest.approx(choice.lat_error, rel=1e-3)
        assert errors[0] <= SHARE * accuracy < errors[1]


def test_edges_go_with_the_width_of_a_front():
    usual = edge_choice(config()).edge_length
    slower = edge_choice(config("tissue: {diffusivity: 0.25}\n")).edge_length
    faster = edge_choice(config("kinetics: {c1: 1.04}\n")).edge_length
    # half the width; tidy edges are at most a third apart
    assert slower == faster == pytest.approx(usual / 2, rel=0.34)
    lumped = edge_choice(config("mesh: {mass: lumped}\n"))
    assert lumped.edge_length < usual
    assert edge_choice(config("mesh: {edge_length: 4}\n")).edge_length == 4.0


def test_small_shapes_are_spanned_by_four_edges():
    small = PLANE.replace("y: [-50, 50]", "y: [0, 4]")
    assert edge_choice(load_text(small, "a.yaml").config).edge_length == 1.0


def test_the_smallest_diffusivity_counts():
    patches = """
tissue:
  diffusivity: 2
  patches:
    - {name: a, region: {box: {x: [0, 10]}}, anisotropy: {x: 0.5}}
    - {name: b, region: {box: {x: [10, 20]}}, diffusivity: 6, anisotropy: {y: 0.1}}
    - {name: c, region: {box: {x: [20, 30]}}, frame_scaling: 0.5}
"""
    tissue = config(patches).tissue
    assert smallest_diffusivity(TissueSection(diffusivity=3.0)) == 3.0
    # 2 * 0.5^2 in c; 6 * 0.1 in b; 2 * 0.5 in a
    assert smallest_diffusivity(tissue) == pytest.approx(0.5)
    without = replace(tissue, patches=tissue.patches[:2])
    assert smallest_diffusivity(without) == pytest.approx(0.6)


def test_tidy_edges_are_never_far_apart():
    edges = tidy_edges()
    assert (edges[0], edges[-1]) == (0.1, 50.0)
    # so auto is at most a third shorter than it might be
    assert max(b / a for a, b in pairwise(edges)) <= 4 / 3 + 1e-12


def test_anisotropy_asks_for_shorter_edges():
    given = config()
    rate, accuracy = 0.2262, 0.005
    choice = edge_choice(given, anisotropy=7.0)
    # 0.0022 rate h^2 (8 - 1) alone, at d = 1, may take half the accuracy
    bound = (SHARE * accuracy / (ACROSS * rate * 7.0)) ** 0.5
    assert bound / 1.5 < choice.edge_length < bound
    assert edge_choice(given, anisotropy=0.7).edge_length > choice.edge_length
