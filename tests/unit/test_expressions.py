"""What an expression means, and how a wrong one is refused."""

import math

import numpy as np
import pytest

from cardiosurf.expressions import ExpressionError, constant, evaluate, parse, pointed


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2 + 3*4", 14.0),
        ("(2 + 3)*4", 20.0),
        ("8/4/2", 1.0),
        ("2 - 3 - 4", -5.0),
        ("2**3**2", 512.0),
        ("-2**2", -4.0),
        ("2**-1", 0.5),
        ("2*-3", -6.0),
        ("+3", 3.0),
        (".5e1", 5.0),
        ("1e-3", 1e-3),
        ("pi", math.pi),
        ("45 deg", math.pi / 4),
        ("-22.5°", -math.pi / 8),
        ("90 degrees - 30deg", math.pi / 3),
        ("sin(pi/6)", 0.5),
        ("cos(pi)", -1.0),
        ("tan(pi/4)", 1.0),
        ("atan2(1, -1)", 3 * math.pi / 4),
        ("sqrt(2)", math.sqrt(2)),
        ("exp(1)", math.e),
        ("log(exp(3))", 3.0),
        ("abs(-4)", 4.0),
        ("min(3, 1, 2)", 1.0),
        ("max(3, 1, 2)", 3.0),
        ("\n 1 +\t2\r\n", 3.0),
    ],
)
def test_it_means_what_it_means_in_mathematics(text, value):
    # a few roundings of numbers of the order of the value
    assert constant(text) == pytest.approx(value, rel=1e-14, abs=1e-15)


@pytest.mark.parametrize(
    ("text", "at", "says"),
    [
        ("", 0, "empty"),
        ("   ", 0, "empty"),
        ("sin(x", 5, "the ) of the ( at character 4 is missing at the end"),
        ("(1 + 2", 6, "missing at the end"),
        ("max(1, 2]", 8, "']' means nothing here"),
        ("x)", 1, "no ( for this )"),
        ("2 x", 2, "an operator such as * is missing before 'x'"),
        ("3(4)", 1, "an operator such as * is missing before '('"),
        ("1 +", 3, "missing before the end"),
        ("* 2", 0, "missing before '*'"),
        ("--x", 1, "missing before '-'"),
        ("2^x", 1, "power is written **"),
        ("1,5", 1, "missing before ','"),
        ("1.2.3", 3, "missing before '.3'"),
        ("sn(x)", 0, "did you mean 'sin'?"),
        ("foo(x)", 0, "there are sin, cos"),
        ("sin", 0, "needs ( after it"),
        ("sin()", 4, "missing before ')'"),
        ("atan2(1)", 0, "has 1 argument, it takes 2"),
        ("sin(1, 2)", 0, "has 2 arguments, it takes 1"),
        ("max(1)", 0, "it takes 2 or more"),
        ("pi/4 deg", 5, "two ways"),
        ("2**3 deg", 5, "two ways"),
        ("x deg", 2, "missing before 'deg'"),
        ("deg", 0, "after a number only"),
        ("1e999", 0, "too large"),
        ("x = 1", 2, "'=' means nothing"),
        ("x < 1", 2, "'<' means nothing"),
        ("x.real", 1, "'.' means nothing"),
        ("'x'", 0, "means nothing"),
        ("x if y else z", 2, "missing before 'if'"),
        ("__import__('os')", 11, "means nothing"),
        ("__import__(1)", 0, "no function '__import__'"),
        ("lambda: 0", 6, "':' means nothing"),
        ("x\x00", 1, "means nothing"),
        ("π", 0, "means nothing"),
        ("٣", 0, "means nothing"),
        ("x;y", 1, "means nothing"),
        ("(" * 41 + "1" + ")" * 41, 40, "more than 40 deep"),
        ("2" + "**2" * 41, 121, "more than 40 deep"),
        ("sin(" * 41 + "1" + ")" * 41, 163, "more than 40 deep"),
        ("x" * 501, 500, "at most 500"),
        ("(" * 100_000, 500, "at most 500"),
    ],
)
def test_what_is_wrong_and_where(text, at, says):
    with pytest.raises(ExpressionError) as caught:
        parse(text)
    assert (caught.value.at, says in caught.value.problem) == (at, True), caught.value
    # the mark stands under the character
    *_, shown, mark = str(caught.value).split("\n")
    if at < len(text) and text[at].isprintable() and not text[at].isspace():
        assert shown[len(mark) - 1] == text[at]


def test_the_longest_chain_and_the_deepest_nest_are_evaluated():
    x = np.array([1.0, 2.0])
    chain, nest = "x" + "+x" * 249, "(" * 40 + "x" + ")" * 40
    np.testing.assert_array_equal(evaluate(parse(chain), {"x": x}, 2), 250.0 * x)
    np.testing.assert_array_equal(evaluate(parse(nest), {"x": x}, 2), x)


@pytest.mark.parametrize(
    ("text", "at", "says", "place"),
    [
        ("1/x", 1, "1 / 0 is not a finite number", 1),
        ("x/(y - 3)", 1, "2 / 0", 0),
        ("log(x)", 0, "log(0)", 1),
        ("sqrt(x - 1)", 0, "sqrt(-1)", 1),
        ("(x - 1)**0.5", 7, "-1 ** 0.5", 1),
        ("exp(1000*y)", 0, "exp(3000)", 0),
        ("1/(1/x)", 4, "1 / 0", 1),
        ("1 + 1/0", 5, "1 / 0", 0),
    ],
)
def test_a_value_that_is_not_finite_is_refused_with_its_place(text, at, says, place):
    values = {"x": np.array([2.0, 0.0]), "y": np.array([3.0, 4.0])}
    with pytest.raises(ExpressionError) as caught:
        evaluate(parse(text), values, 2)
    assert (caught.value.at, caught.value.place) == (at, place)
    assert says in caught.value.problem


def test_a_constant_has_no_names():
    with pytest.raises(ExpressionError, match="'x' means nothing here"):
        constant("2*x")


def test_of_a_long_text_the_part_around_the_mark_is_shown():
    text = "x+" * 60 + "?" + "+x" * 60
    shown, mark = pointed(text, 120).split("\n")
    assert shown[len(mark) - 1] == "?"
    assert shown.startswith("    ...")
    assert shown.endswith("...")
    assert len(shown) < 72
