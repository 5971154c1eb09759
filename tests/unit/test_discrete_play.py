"""Appendix B's game: what follows from its rule by hand."""

import numpy as np
import pytest

from cardiosurf.discrete.network import linked, packed
from cardiosurf.discrete.play import Rule, play
from cardiosurf.discrete.stops import expansion, fibre, in_rows
from cardiosurf.errors import InputError

# sums of a few shares
ROUNDING = 1e-12


def when(layers, rule=None):
    first = layers.played(rule or Rule()).first
    return {name: first[layers.unit(name)] for name in layers.names}


def test_figure_b_conducts_at_the_average_load():
    # 3 units for 2 sources, then 4 for 3
    first = when(expansion((2, 3, 4)))
    assert [first[name] for name in ("B1", "B2", "B3")] == pytest.approx([1.5] * 3, abs=ROUNDING)
    assert first["C4"] == pytest.approx(1.5 + 4 / 3, abs=ROUNDING)


@pytest.mark.parametrize(("sources", "targets"), [(1, 3), (2, 6), (3, 9), (2, 5)])
def test_sg_i_up_to_n_max_all_are_excited(sources, targets):
    played = expansion((sources, targets)).played(Rule(n_max=3))
    np.testing.assert_allclose(played.first[sources:], targets / sources, rtol=ROUNDING)


@pytest.mark.parametrize(("sources", "targets"), [(1, 4), (2, 7), (3, 10)])
def test_sg_i_beyond_n_max_none_is_excited(sources, targets):
    played = expansion((sources, targets)).played(Rule(n_max=3))
    assert np.isnan(played.first[sources:]).all()
    assert (played.failures[sources:] == 1).all()
    # the sources are spent when each has given 3
    assert played.end == pytest.approx(3, abs=ROUNDING)
    conducting = expansion((sources, targets)).played(Rule(n_max=targets / sources))
    assert np.isfinite(conducting.first).all()


def test_sc_ii_a_fibre_that_outruns_its_neighbours_stops_the_wave():
    # T1 = 2/4 + 3 = 3.5; B-units beside the fibre at 3, their C-units at T2 = 3 + 4/3
    layers = fibre(4.0, (3, 4))
    first = when(layers)
    assert first["B1"] == pytest.approx(0.25, abs=ROUNDING)
    assert first["C1"] == pytest.approx(0.5, abs=ROUNDING)
    assert first["C2"] == pytest.approx(3 + 4 / 3, abs=ROUNDING)
    assert all(np.isnan(first[f"D{k}"]) for k in range(1, 6))
    # not because there are too many D-units: 5 C-units excite 5 of them without the fibre's lead
    slow = when(fibre(1.0, (3, 4)))
    # C1 at 2 gives 1/5 each until 13/3, then 5 units give 1 in all to each
    assert slow["D1"] == pytest.approx(13 / 3 + (1 - (13 / 3 - 2) / 5), abs=ROUNDING)


def test_sc_ii_takes_refractory_failures_for_granted():
    # if the D-units come to rest again, the other four C-units excite all five
    first = when(fibre(4.0, (3, 4)), Rule(failed="rest"))
    assert first["D5"] == pytest.approx(3 + 4 / 3 + 5 / 4, abs=ROUNDING)


def test_the_papers_own_figure_f_stops_only_beyond_speed_four():
    # T1 = 2/speed + 3 against T2 = 2 + 3/2: equal at 4, "at maximum four times"
    at_four = when(fibre(4.0))
    # spent at 3.5, when each D-unit has 3/5; the other three go on at once
    assert at_four["D1"] == pytest.approx(3.5 + (2 / 5) / (3 / 5), abs=ROUNDING)
    assert np.isnan(when(fibre(4.1))["D1"])
    assert np.isfinite(when(fibre(3.9))["D1"])


def test_sc_ii_does_not_come_about_in_the_packing_itself():
    # there C1 faces two D-units, not five
    first = when(in_rows((2, 3, 4, 5), 4.0))
    assert all(np.isfinite(value) for value in first.values())
    # A1 has B1 at rate 4/2 and B2 at 1/2, where A2 gives 1/2 more from the start
    assert first["B1"] == pytest.approx(0.5, abs=ROUNDING)


def test_refractory_units_are_excited_again_only_when_they_have_recovered():
    ring = linked(10, [(k, (k + 1) % 10) for k in range(10)])
    around = play(ring, Rule(refractory=9.0), np.array([0]), most=25.0)
    # one way round and round: unit 0 again at 10 and 20
    assert around.times[around.units == 0] == pytest.approx([0, 10, 20], abs=ROUNDING)
    late = play(ring, Rule(refractory=9.5), np.array([0]))
    # unit 9 tries at 9 and finds unit 0 refractory: it is done
    assert len(late.units) == 10
    assert late.end == pytest.approx(9, abs=ROUNDING)


def test_a_plane_front_moves_on_by_a_row_in_each_excitation_time():
    # rows of the packing closed to rings: each unit faces two of the next row, each of them two
    rows, around = 7, 6
    unit = np.arange(rows * around).reshape(rows, around)
    pairs = [
        (unit, np.roll(unit, -1, axis=1)),
        (unit[:-1], unit[1:]),
        (unit[:-1], np.roll(unit, -1, axis=1)[1:]),
    ]
    links = np.concatenate([np.stack([a.ravel(), b.ravel()], axis=1) for a, b in pairs])
    ring = linked(unit.size, np.concatenate([links, links[:, ::-1]]))
    played = play(ring, Rule(), unit[0])
    expected = np.repeat(np.arange(rows), around)
    np.testing.assert_allclose(played.first, expected, atol=ROUNDING)


def test_one_unit_cannot_excite_its_six_neighbours_but_seven_can_go_on():
    whole = packed(lambda places: np.abs(places[:, 0]) <= 1e3, 6.0)
    middle = np.flatnonzero(np.hypot(*whole.places.T) < 0.1)
    alone = play(whole.network, Rule(), middle)
    assert np.isfinite(alone.first).sum() == 1
    seven = np.flatnonzero(np.hypot(*whole.places.T) < 1.1)
    together = play(whole.network, Rule(), seven)
    assert np.isfinite(together.first).all()
    # 12 units for 6. Each gives 1/3 to three, two of which it shares with another one: these are
    # excited at 3/2. The third has 1/2 by then, and gets 1 from its source, 1/4 from each of both
    distance = np.hypot(*whole.places.T)
    assert together.first[np.isclose(distance, np.sqrt(3))] == pytest.approx([1.5] * 6)
    assert together.first[np.isclose(distance, 2.0)] == pytest.approx([1.5 + 0.5 / 1.5] * 6)


def test_the_packing_has_six_neighbours_each_within_and_both_ways():
    whole = packed(lambda places: np.abs(places[:, 0]) <= 1e3, 5.0)
    degree = np.bincount(whole.network.sources, minlength=whole.network.count)
    assert (degree[np.hypot(*whole.places.T) < 3.9] == 6).all()
    there = {*zip(whole.network.sources.tolist(), whole.network.targets.tolist(), strict=True)}
    assert there == {(target, source) for source, target in there}
    step = whole.places[whole.network.targets] - whole.places[whole.network.sources]
    np.testing.assert_allclose(np.hypot(*step.T), 1.0, atol=ROUNDING)


def test_wrong_units_and_links_are_refused():
    with pytest.raises(InputError, match="not there"):
        linked(2, [(0, 2)])
    with pytest.raises(InputError, match="costs: a value is not above 0"):
        linked(2, [(0, 1)], costs=np.zeros(1))
    with pytest.raises(InputError, match="initial"):
        play(linked(2, [(0, 1)]), Rule(), np.array([], dtype=int))
