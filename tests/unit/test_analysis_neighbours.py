import numpy as np
import pytest

from cardiosurf.analysis.neighbours import counting_order, neighbours, pieces, triangles_around

# two triangles with a common edge, and a vertex (4) that belongs to none
TRIANGLES = np.array([[0, 1, 2], [2, 1, 3]])


@pytest.mark.parametrize("largest", [5, 2**16, 2**31])
def test_equal_numbers_keep_their_order(largest):
    numbers = np.random.default_rng(0).integers(0, largest, 3000)
    numbers[::7] = numbers[0]
    assert np.array_equal(counting_order(numbers), np.argsort(numbers, kind="stable"))


def test_every_neighbour_is_listed_once_and_in_order():
    items, owner = neighbours(TRIANGLES, 5).at(np.array([2, 4, 0, 2]))
    assert items.tolist() == [0, 1, 3, 1, 2, 0, 1, 3]
    assert owner.tolist() == [0, 0, 0, 2, 2, 3, 3, 3]


def test_triangles_are_found_by_their_vertices():
    items, owner = triangles_around(TRIANGLES, 5).at(np.array([3, 1, 4]))
    assert items.tolist() == [1, 0, 1]
    assert owner.tolist() == [0, 1, 1]


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_pieces_are_named_after_their_lowest_vertex(seed):
    # strips of triangles in a random order of their vertices, and three vertices of none
    names = np.random.default_rng(seed).permutation(303)
    strips = [np.arange(100 * k, 100 * (k + 1)) for k in range(3)]
    along = [strip[:-2, None] + np.arange(3) for strip in strips]
    found = pieces(names[np.concatenate(along)], 303)
    for strip in strips:
        assert np.unique(found[names[strip]]).tolist() == [names[strip].min()]
    assert np.array_equal(found[names[300:]], names[300:])
