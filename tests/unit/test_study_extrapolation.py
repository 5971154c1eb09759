"""Richardson's extrapolation: exact on what it assumes, and honest about what it does not know."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cardiosurf.study.critical import Search, find_changes
from cardiosurf.study.extrapolation import Sample, enclosure, extrapolate, fit_order

SIZES = (3.5, 2.5, 1.75)
MANY = settings(max_examples=100, deadline=None, derandomize=True)


def samples(true, c, order, half_width=1e-9, sizes=SIZES):
    return [Sample(h, true + c * h**order, half_width) for h in sizes]


@pytest.mark.parametrize("order", [1.0, 1.3, 1.7, 2.0 - 1e-9])
def test_powers_of_the_edge_are_extrapolated_exactly(order):
    # solved by bisection of the order to 2e-12
    found = extrapolate(samples(7.84, -0.03, order))
    assert found.value == pytest.approx(7.84, abs=1e-7)
    assert found.order == pytest.approx(order, abs=1e-5)
    assert found.order_is == "fitted"
    assert found.converged
    # the error is the whole extrapolation
    assert found.error == pytest.approx(0.03 * 1.75**order, rel=1e-5)


@pytest.mark.parametrize("order", [2.5, 3.0, 4.0])
def test_values_that_seem_to_converge_faster_are_extrapolated_with_the_formal_order(order):
    found = extrapolate(samples(7.84, -0.03, order))
    assert (found.order, found.order_is, found.converged) == (2.0, "assumed", True)
    # what order 2 makes of the last step
    last = 0.03 * (2.5**order - 1.75**order)
    assert found.value == pytest.approx(7.84 - 0.03 * 1.75**order + last / ((2.5 / 1.75) ** 2 - 1))
    assert abs(found.value - 7.84) <= found.error


def test_values_that_do_not_move_are_converged_without_a_trend():
    found = extrapolate([Sample(h, 6.97, 0.01) for h in SIZES])
    assert (found.value, found.order, found.order_is) == (6.97, None, "none")
    assert found.converged
    # at order 1 edges of 3.5 and 1.75 leave 3 half widths open, and no more
    assert 0.01 < found.error <= 0.03 * (1 + 1e-9)


def test_meshes_that_scatter_by_little_more_than_the_brackets_are_converged():
    measured = [Sample(h, x, 0.0075) for h, x in zip(SIZES, (6.974, 6.985, 6.967), strict=True)]
    found = extrapolate(measured)
    assert found.converged
    # nothing to extrapolate: the finest, with the spread and the bracket
    assert found.value == 6.967
    assert found.error == pytest.approx(0.018 + 0.0075)


def test_values_that_turn_round_are_not_converged_and_their_spread_is_the_error():
    found = extrapolate([Sample(h, x, 0.005) for h, x in zip(SIZES, (6.8, 7.0, 6.9), strict=True)])
    assert not found.converged
    assert (found.value, found.order_is) == (6.9, "none")
    assert found.error == pytest.approx(0.2 + 0.005)


def test_steps_that_grow_are_not_converged():
    found = extrapolate([Sample(h, x, 0.005) for h, x in zip(SIZES, (7.0, 7.1, 7.4), strict=True)])
    assert not found.converged
    assert found.error >= 0.4


def test_only_the_three_finest_levels_count():
    rough = Sample(5.0, 3.0, 0.01)
    assert extrapolate([rough, *samples(7.0, 0.1, 2.0)]) == extrapolate(samples(7.0, 0.1, 2.0))


def test_two_levels_tell_no_error():
    with pytest.raises(ValueError, match="2 levels"):
        extrapolate(samples(7.0, 0.1, 2.0)[:2])


def test_an_order_beyond_the_plausible_is_not_fitted():
    assert fit_order(*samples(7.0, 0.01, 5.0)) is None
    assert fit_order(*samples(7.0, 0.01, 0.5)) is None
    assert enclosure(samples(7.0, 0.01, 5.0), 2.0) is None


def test_the_enclosure_of_two_levels_is_that_of_their_lines():
    # order 1, edges 2 and 1, brackets 1 +- 0.1 and 2 +- 0.1: x0 from 2 * 1.9 - 1.1 to 2 * 2.1 - 0.9
    # and higher orders lie nearer to the fine value
    low, high = enclosure([Sample(2.0, 1.0, 0.1), Sample(1.0, 2.0, 0.1)], 1.0)
    assert high == pytest.approx(2 * 2.1 - 0.9)
    assert low == pytest.approx((16 * 1.9 - 1.1) / 15)


@MANY
@given(
    true=st.floats(-10.0, 10.0),
    c=st.floats(-0.2, 0.2),
    order=st.floats(1.0, 4.0),
    half_width=st.floats(1e-4, 0.05),
    noise=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
    ratios=st.tuples(*[st.floats(1.2, 2.0)] * 2),
)
def test_the_true_value_lies_within_the_error(true, c, order, half_width, noise, ratios):
    sizes = (1.0, 1.0 / ratios[0], 1.0 / ratios[0] / ratios[1])
    measured = [
        Sample(h, true + c * h**order + share * half_width, half_width)
        for h, share in zip(sizes, noise, strict=True)
    ]
    found = extrapolate(measured)
    assert abs(found.value - true) <= found.error * (1 + 1e-9)
    assert found.bracket_error == half_width


@MANY
@given(
    true=st.floats(6.0, 10.0),
    c=st.floats(-0.08, 0.08),
    order=st.floats(1.0, 4.0),
    tolerance=st.floats(0.002, 0.05),
    parallel=st.integers(1, 4),
)
def test_a_search_encloses_the_true_critical_value(true, c, order, tolerance, parallel):
    sizes = (2.0, 1.41, 1.0)

    def ask(level, values):
        critical = true + c * sizes[level] ** order
        return ["conduction" if value < critical else "block" for value in values]

    search = Search(4.0, 12.0, tolerance, parallel=parallel)
    (change,) = find_changes(ask, sizes, search)
    measured = [
        Sample(h, bracket.value, bracket.half_width)
        for h, bracket in zip(sizes, change.brackets, strict=True)
    ]
    found = extrapolate(measured)
    assert abs(found.value - true) <= found.error * (1 + 1e-9)
