"""Face, disc and strand in the packing, against answers by hand."""

import pytest

from cardiosurf.discrete.packings import CLOSE, face_limit, narrowest_strand, smallest_disc
from cardiosurf.discrete.play import Rule


@pytest.mark.parametrize("n_max", [2.0, 3.0])
def test_a_face_stops_the_wave_where_a_link_across_it_costs_n_max(n_max):
    # 30 degrees off the normal d = 3/4 s + 1/4, and sqrt(d) = N_max
    exact = (4.0 * n_max**2 - 1.0) / 3.0
    assert face_limit(Rule(n_max=n_max)) == pytest.approx(exact, abs=2.0 * CLOSE)


@pytest.mark.parametrize(("n_max", "units"), [(3.0, 7), (5.9, 7), (6.1, 1)])
def test_one_unit_faces_six(n_max, units):
    assert smallest_disc(Rule(n_max=n_max)) == units


@pytest.mark.parametrize(("n_max", "rows"), [(3.1, 1), (2.75, 2)])
def test_the_end_of_one_row_faces_three(n_max, rows):
    # the last unit of the strand lies before x = 0 by up to one distance: it faces two or three
    assert narrowest_strand(Rule(n_max=n_max)) == rows


def test_no_strand_is_wide_enough_where_a_straight_front_is_not():
    # each unit of a straight front faces two of the next row, two to two: one each
    assert narrowest_strand(Rule(n_max=0.9)) == 0
