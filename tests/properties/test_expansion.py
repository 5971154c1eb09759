"""What must hold of every sweep, whatever is varied."""

from hypothesis import given
from hypothesis import strategies as st

from cardiosurf.config.expansion import expand, samples
from cardiosurf.config.scenario import LatinHypercube, Scenario

KEYS = ["mesh.edge_length", "time.end", "time.step", "tissue.patches.0.anisotropy"]
VALUES = st.lists(st.integers(0, 50) | st.floats(0.1, 9.0), min_size=1, max_size=5, unique=True)
grids = st.dictionaries(st.sampled_from(KEYS), VALUES.map(tuple), max_size=4)


@given(grids)
def test_a_grid_holds_every_combination_once_and_names_differ(grid):
    points = expand(Scenario(name="one", base="base.yaml", grid=grid))
    count = 1
    for values in grid.values():
        count *= len(values)
    assert len(points) == count
    assert len({point.name for point in points}) == count
    assert len({tuple(point.settings.items()) for point in points}) == count
    for key, values in grid.items():
        # every value as often as every other
        column = [point.settings[key] for point in points]
        assert {column.count(value) for value in values} == {count // len(values)}


@given(
    st.integers(1, 40),
    st.integers(0, 2**32 - 1),
    st.dictionaries(
        st.sampled_from(KEYS),
        st.tuples(st.floats(-100.0, 99.0), st.floats(1.0, 100.0)).map(lambda r: (r[0], sum(r))),
        min_size=1,
    ),
)
def test_each_part_of_a_range_holds_one_sample(count, seed, ranges):
    found = samples(LatinHypercube(count=count, seed=seed, ranges=ranges))
    assert len(found) == count
    for key, (low, high) in ranges.items():
        # in units of parts; rounding moves a sample on the edge of one by no more than 1e-9
        places = sorted((one[key] - low) / (high - low) * count for one in found)
        assert all(n - 1e-9 <= place <= n + 1 + 1e-9 for n, place in enumerate(places))
