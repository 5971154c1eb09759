import pytest

from cardiosurf.config.expansion import expand, expansion_problems, samples, short_names, varied
from cardiosurf.config.scenario import LatinHypercube, Link, Scenario

EDGE, END = "mesh.edge_length", "time.end"


def scenario(**keys):
    return Scenario(name="one", base="base.yaml", **keys)


def test_a_grid_has_every_value_with_every_other():
    points = expand(scenario(grid={EDGE: (1, 2, 3), END: (10, 20)}))
    assert [(p.values[EDGE], p.values[END]) for p in points] == [
        (1, 10),
        (1, 20),
        (2, 10),
        (2, 20),
        (3, 10),
        (3, 20),
    ]
    assert points[3].name == "edge_length-2_end-20"
    assert points[3].settings == {EDGE: 2, END: 20}


def test_lists_go_together_and_with_the_grid():
    points = expand(scenario(lists={EDGE: (1, 2), END: (10, 20)}, grid={"time.step": (0.5, 1.0)}))
    assert [tuple(point.values.values()) for point in points] == [
        (0.5, 1, 10),
        (0.5, 2, 20),
        (1.0, 1, 10),
        (1.0, 2, 20),
    ]


def test_nothing_varied_is_the_base():
    (point,) = expand(scenario())
    assert (point.name, dict(point.values), dict(point.settings)) == ("base", {}, {})


def test_a_parameter_moves_its_keys():
    box = "tissue.patches.block.region.box.x"
    links = {f"{box}.0": -1.0, f"{box}.1": 1.0, "targets.core.region.box.x.1": Link(1.0, -10.0)}
    points = expand(scenario(parameters={"half": links}, grid={"half": (30, 50)}))
    assert [point.name for point in points] == ["half-30", "half-50"]
    assert points[0].settings == {
        f"{box}.0": -30.0,
        f"{box}.1": 30.0,
        "targets.core.region.box.x.1": 20.0,
    }


def test_a_latin_hypercube_is_the_same_for_the_same_seed_and_another_for_another():
    one = LatinHypercube(count=5, seed=3, ranges={EDGE: (1.0, 2.0)})
    assert samples(one) == samples(LatinHypercube(count=5, seed=3, ranges={EDGE: (1.0, 2.0)}))
    assert samples(one) != samples(LatinHypercube(count=5, seed=4, ranges={EDGE: (1.0, 2.0)}))


@pytest.mark.parametrize(
    ("keys", "names"),
    [
        (["tissue.patches.strip.anisotropy"], ["anisotropy"]),
        (["tissue.patches.a.anisotropy", "tissue.patches.b.anisotropy"], ["a.*", "b.*"]),
        (["stimulus.0.centre.1"], ["centre.1"]),
        (["tissue.patches.a.anisotropy.x"], ["anisotropy.x"]),
        (["half"], ["half"]),
    ],
)
def test_short_names_tell_keys_apart(keys, names):
    found = list(short_names(keys).values())
    assert found == [name.replace("*", "anisotropy") for name in names]


def test_names_are_words_for_files_whatever_the_values_are():
    region = {"box": {"x": [1, 2]}}
    points = expand(scenario(grid={"targets.0.region": (region, {"surface": "vein"})}))
    assert all(
        set(point.name) <= set("abcdefghijklmnopqrstuvwxyz0123456789-._") for point in points
    )
    long = expand(scenario(grid={EDGE: ("x" * 200, "y" * 200)}))
    assert [point.name for point in long] == ["point-0000", "point-0001"]


@pytest.mark.parametrize(
    ("keys", "path", "says"),
    [
        ({"grid": {"half": (1,)}}, ("grid", "half"), "neither a key path nor a parameter"),
        ({"lists": {EDGE: (1, 2), END: (1,)}}, ("lists",), "different lengths"),
        ({"grid": {EDGE: (1,)}, "lists": {EDGE: (1,)}}, ("lists", EDGE), "varied by grid already"),
        ({"grid": {EDGE: tuple(range(101)), END: tuple(range(100))}}, ("grid",), "10100 points"),
        (
            {"parameters": {"half": {EDGE: 1.0}}, "grid": {"half": ("wide",)}},
            ("grid", "half"),
            "'wide' is not a number",
        ),
        (
            {"latin_hypercube": LatinHypercube(count=2, ranges={EDGE: (2.0, 2.0)})},
            ("latin_hypercube", "ranges", EDGE),
            "[2, 2] is no range",
        ),
    ],
)
def test_what_cannot_be_expanded(keys, path, says):
    (problem,) = expansion_problems(scenario(**keys))
    assert problem.path == path
    assert says in problem.problem
    assert problem.allowed


def test_what_is_varied_keeps_its_order():
    cube = LatinHypercube(count=2, ranges={"time.step": (1.0, 2.0)})
    one = scenario(grid={END: (1,)}, lists={EDGE: (1,)}, latin_hypercube=cube)
    assert varied(one) == (END, EDGE, "time.step")
