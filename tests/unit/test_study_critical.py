"""Changes of an answer: found, followed over meshes, and never more runs than needed."""

from bisect import bisect_right
from math import ceil, log2

import pytest

from cardiosurf.study.critical import Search, find_changes

SIZES = (3.5, 2.5, 1.75)


class Known:
    """Answers that change at known values, which may differ from level to level."""

    def __init__(self, *levels, words=("conduction", "block", "partial", "reentry")):
        self.levels, self.words = levels, words
        self.asked = [[] for _ in levels]
        self.batches = 0

    def __call__(self, level, values):
        self.batches += 1
        self.asked[level] += values
        return [self.words[bisect_right(self.levels[level], value)] for value in values]


def search(**given):
    return Search(**{"low": 4.0, "high": 12.0, "tolerance": 0.01, **given})


def middles(change):
    return [None if b is None else b.value for b in change.brackets]


def test_one_change_is_followed_over_all_levels_to_the_tolerance():
    known = Known([7.45], [7.68], [7.78])
    (change,) = find_changes(known, SIZES, search())
    assert (change.below, change.above) == ("conduction", "block")
    for bracket, (true,) in zip(change.brackets, known.levels, strict=True):
        assert bracket.low <= true <= bracket.high
        assert bracket.half_width <= 0.01 * (1 + 1e-9)


def test_two_changes_are_both_found_and_say_from_what_to_what():
    known = Known([5.2, 9.3], [5.3, 9.1], [5.35, 9.05], words=("block", "conduction", "block"))
    first, second = find_changes(known, SIZES, search())
    assert (first.below, first.above) == ("block", "conduction")
    assert (second.below, second.above) == ("conduction", "block")
    assert middles(first) == pytest.approx([5.2, 5.3, 5.35], abs=0.01)
    assert middles(second) == pytest.approx([9.3, 9.1, 9.05], abs=0.01)


def test_a_third_answer_inside_a_scan_interval_is_found_while_bisecting():
    # conduction -> partial -> block within 0.1, where the scan sees conduction -> block
    known = Known([8.40, 8.5], [8.42, 8.52], [8.43, 8.53], words=("conduction", "partial", "block"))
    first, second = find_changes(known, SIZES, search())
    assert (first.below, first.above) == ("conduction", "partial")
    assert (second.below, second.above) == ("partial", "block")
    assert middles(first) == pytest.approx([8.40, 8.42, 8.43], abs=0.01)
    assert middles(second) == pytest.approx([8.5, 8.52, 8.53], abs=0.01)


def test_no_change_takes_the_scan_and_both_ends_of_each_finer_level():
    known = Known([], [], [])
    assert find_changes(known, SIZES, search(scan=9)) == ()
    assert [len(asked) for asked in known.asked] == [9, 2, 2]


def test_the_number_of_runs_is_that_of_bisection():
    known = Known([7.451], [7.681], [7.781])
    find_changes(known, SIZES, search(scan=9))
    # a scan interval of 1 halved to 0.02; finer: both ends, a bracket of 1 at most and its halving
    halvings = ceil(log2(1.0 / 0.02))
    assert len(known.asked[0]) == 9 + halvings
    for asked in known.asked[1:]:
        assert len(asked) <= 4 + halvings


def test_no_value_is_asked_twice_on_a_level():
    known = Known([5.2, 9.3], [5.3, 9.1], [5.35, 9.05], words=("block", "conduction", "block"))
    find_changes(known, SIZES, search())
    assert all(len(set(asked)) == len(asked) for asked in known.asked)


def test_several_values_at_a_time_take_fewer_turns():
    turns = {}
    for parallel in (1, 4):
        known = Known([7.45], [7.68], [7.78])
        (change,) = find_changes(known, SIZES, search(parallel=parallel))
        assert middles(change) == pytest.approx([7.45, 7.68, 7.78], abs=0.01)
        turns[parallel] = known.batches
    # 5-section takes log 50 / log 5 = 2.4 -> 3 turns a level where bisection takes 6
    assert turns[1] >= 3 * 5 + 3
    assert turns[4] <= 3 * 3 + 3 + 1


@pytest.mark.parametrize("moved", [5.1, 11.2])
def test_a_change_that_moves_further_than_expected_is_bracketed_again(moved):
    known = Known([7.5], [moved], [moved])
    (change,) = find_changes(known, SIZES, search())
    assert middles(change) == pytest.approx([7.5, moved, moved], abs=0.01)


def test_a_change_that_vanished_is_reported_and_looked_for_again():
    known = Known([7.45], [], [7.5])
    (change,) = find_changes(known, SIZES, search())
    assert middles(change)[1] is None
    assert middles(change)[::2] == pytest.approx([7.45, 7.5], abs=0.01)


def test_a_change_that_appeared_between_the_ends_is_reported():
    known = Known([7.45], [7.5, 9.9], [7.5, 9.95], words=("block", "conduction", "block"))
    first, second = find_changes(known, SIZES, search())
    assert middles(first) == pytest.approx([7.45, 7.5, 7.5], abs=0.01)
    assert middles(second)[0] is None
    assert middles(second)[1:] == pytest.approx([9.9, 9.95], abs=0.01)


def test_a_change_of_another_kind_in_its_place_is_not_taken_for_it():
    def ask(level, values):
        beyond = "block" if level == 0 else "reentry"
        return ["conduction" if value < 7.5 else beyond for value in values]

    gone, new = sorted(find_changes(ask, SIZES, search()), key=lambda change: change.above)
    assert (gone.above, middles(gone)[1:]) == ("block", [None, None])
    assert (new.above, middles(new)[0]) == ("reentry", None)


def test_an_answer_that_changes_all_the_time_ends_at_the_bound_with_wide_brackets():
    asked = []

    def ask(level, values):
        asked.extend(values)
        return [f"{value:.9f}" for value in values]  # every value another answer

    changes = find_changes(ask, (1.0,), search(most=40))
    assert len(asked) == 40
    assert len(changes) == 39
    assert any(change.brackets[0].half_width > 0.01 for change in changes)


def test_values_have_no_more_digits_than_the_tolerance_deserves():
    known = Known([7.4512345], [7.6], [7.7])
    find_changes(known, SIZES, search(parallel=2))
    every = [value for asked in known.asked for value in asked]
    assert every == [round(value, 4) for value in every]
    assert all(4.0 <= value <= 12.0 for value in every)
