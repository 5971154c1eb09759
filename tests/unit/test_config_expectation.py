import pytest

from cardiosurf.config.expectation import Expectation, Reader, parse_tolerance

TARGETS, PROBES = ("left", "core"), ("tip",)


def read(expect, tolerance=None):
    return Reader(TARGETS, PROBES, tolerance).read(expect)


def test_words_and_numbers_by_key():
    expected, problems = read(
        {
            "verdict": "conduction",
            "left": "block",
            "core": {"route": None, "activated_fraction": {"value": 0.5, "tolerance": 0.1}},
            "reentry": "none",
            "cycle_length": {"value": 300, "tolerance": "2 %"},
            "lat": {"tip": {"value": 700, "tolerance": 5}},
            "quiescent_at": None,
            "captured": True,
        }
    )
    assert not problems
    assert expected == [
        Expectation("verdict", "conduction"),
        Expectation("left.verdict", "block"),
        Expectation("core.route", None),
        Expectation("core.activated_fraction", 0.5, 0.1),
        Expectation("reentry.verdict", "none"),
        Expectation("reentry.cycle_length", 300, 6.0),
        Expectation("lat.tip", 700, 5.0),
        Expectation("quiescent_at", None),
        Expectation("captured", wanted=True),
    ]


def test_a_number_takes_the_tolerance_of_its_case():
    assert read({"left": {"first_activation": 200}}, "1 %")[0][0].tolerance == 2.0
    own = {"left": {"first_activation": {"value": 200, "tolerance": 3}}}
    assert read(own, "1 %")[0][0].tolerance == 3.0


@pytest.mark.parametrize(
    ("expect", "path", "says"),
    [
        ({"verdit": "block"}, ("verdit",), "did you mean 'verdict'?"),
        ({"verdict": "blocks"}, ("verdict",), "did you mean 'block'?"),
        ({"verdict": None}, ("verdict",), "null is not allowed"),
        ({"left": {"rout": "direct"}}, ("left", "rout"), "did you mean 'route'?"),
        ({"left": {"route": 3}}, ("left", "route"), "3 is not allowed"),
        ({"reentry": {"cycle_length": 3}}, ("reentry", "cycle_length"), "has no tolerance"),
        ({"captured": "yes"}, ("captured",), "'yes' is not allowed"),
        ({"captured": 1}, ("captured",), "1 is not allowed"),
        ({"end": True}, ("end",), "true is not allowed"),
        ({"end": {"value": 3}}, ("end",), "is not understood"),
        ({"end": {"value": 3, "tolerance": -1}}, ("end",), "-1 is not a tolerance"),
        ({"end": {"value": 3, "tolerance": "1"}}, ("end",), "'1' is not a tolerance"),
        ({"lat": 3}, ("lat",), "is not a mapping"),
        ({"lat": {"top": 3}}, ("lat", "top"), "unknown key 'top'"),
    ],
)
def test_each_mistake_is_named_with_its_path(expect, path, says):
    expected, (problem,) = read(expect)
    assert not expected
    assert problem.path == path
    assert says in problem.problem
    assert problem.allowed


@pytest.mark.parametrize(
    ("wanted", "tolerance", "found", "met"),
    [
        ("block", 0.0, "block", True),
        ("block", 0.0, "partial", False),
        (100.0, 1.0, 101.0, True),
        (100.0, 1.0, 101.01, False),
        (100, 1.0, 99.5, True),
        (0.1, 0.2, 0.3, True),  # 0.3 - 0.1 is above 0.2 in double precision
        (None, 0.0, None, True),
        (None, 0.0, 3.0, False),
        (3.0, 1.0, None, False),
        (True, 0.0, True, True),
        (True, 0.0, 1, False),
    ],
)
def test_what_meets_an_expectation(wanted, tolerance, found, met):
    assert Expectation("key", wanted, tolerance).met_by(found) is met


@pytest.mark.parametrize(
    ("given", "tolerance"), [(2, 2.0), ("2 %", 1.0), (".5%", 0.25), (-1, None), ("two", None)]
)
def test_tolerances(given, tolerance):
    assert parse_tolerance(given, -50.0) == tolerance
