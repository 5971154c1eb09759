"""Expressions as they are parsed against Python's own parser, which has the same grammar."""

import numpy as np
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from cardiosurf.expressions import FUNCTIONS, Expression, ExpressionError, evaluate, parse
from cardiosurf.expressions.tree import Call, Name, Negation, Number, Operation

PLACES = {
    "x": np.array([-1.5, 0.25, 3.0]),
    "y": np.array([2.0, 0.5, -7.0]),
    "theta": np.array([0.1, 0.7, 1.5]),
}
# tighter binds higher; what is written around an operand must bind less than it
SUM, TERM, SIGNED, POWER, PRIMARY = range(5)
BINDS = {"+": SUM, "-": SUM, "*": TERM, "/": TERM, "**": POWER}


def calls(inner):
    def of(name):
        function = FUNCTIONS[name]
        most = min(function.most, function.fewest + 1)
        arguments = st.lists(inner, min_size=function.fewest, max_size=most).map(tuple)
        return st.builds(Call, st.just(name), arguments)

    return st.sampled_from(sorted(FUNCTIONS)).flatmap(of)


leaves = st.builds(Number, st.floats(0.0, 50.0) | st.just(float(np.pi))) | st.builds(
    Name, st.sampled_from(sorted(PLACES))
)
trees = st.recursive(
    leaves,
    lambda inner: (
        st.builds(Negation, inner)
        | st.builds(Operation, st.sampled_from(sorted(BINDS)), inner, inner)
        | calls(inner)
    ),
    max_leaves=12,
)


class Printer:
    """Writes a tree with no more brackets than it needs, or some more, and spaces by chance."""

    def __init__(self, chance, number):
        self.chance, self.number = chance, number

    def written(self, node, least=SUM):
        text, binds = self._bare(node)
        bracketed = binds < least or self.chance.random() < 0.1
        return f"({text})" if bracketed else text

    def _bare(self, node):
        gap = " " * self.chance.integers(0, 3)
        match node:
            case Number(value=value):
                return self.number(value), PRIMARY
            case Name(name=name):
                return name, PRIMARY
            case Negation(operand=operand):
                return f"-{gap}{self.written(operand, POWER)}", SIGNED
            case Call(function=function, arguments=arguments):
                listed = f"{gap},{gap}".join(self.written(one) for one in arguments)
                return f"{function}{gap}({listed})", PRIMARY
            case Operation(sign="**", left=left, right=right):
                return (
                    f"{self.written(left, PRIMARY)}{gap}**{gap}{self.written(right, SIGNED)}",
                    POWER,
                )
            case Operation(sign=sign, left=left, right=right):
                binds = BINDS[sign]
                first, second = self.written(left, binds), self.written(right, binds + 1)
                return f"{first}{gap}{sign}{gap}{second}", binds
        raise TypeError(node)


@settings(max_examples=100, deadline=None)
@given(trees, st.integers(0, 2**32 - 1))
def test_a_tree_survives_being_written_and_parsed(tree, seed):
    def number(value):
        return "pi" if value == np.pi else repr(value)

    text = Printer(np.random.default_rng(seed), number).written(tree)
    if len(text) > 500:
        reject()
    assert parse(text) == Expression(text, tree)


@settings(max_examples=100, deadline=None)
@given(trees, st.integers(0, 2**32 - 1))
def test_values_are_those_that_python_finds(tree, seed):
    def written(number):
        return Printer(np.random.default_rng(seed), number).written(tree)

    text = written(repr)
    if len(text) > 500:
        reject()
    expression = parse(text)
    try:
        found = evaluate(expression, PLACES, 3)
    except ExpressionError:
        # divisions by zero and the like have tests of their own
        reject()
    known = {name: function.apply for name, function in FUNCTIONS.items()} | PLACES
    # numbers as NumPy's: Python's own raise where NumPy's give an infinity
    known |= {"number": np.float64, "__builtins__": {}}
    with np.errstate(all="ignore"):
        expected = eval(written(lambda value: f"number({value!r})"), known)  # noqa: S307
    # the same operations in the same order: the same bits
    np.testing.assert_array_equal(found, np.broadcast_to(expected, 3))


@settings(max_examples=100, deadline=None)
@given(
    st.text(max_size=40)
    | st.text(alphabet="0123456789.eE+-*/()xpi sn,deg", max_size=60)
    | st.lists(
        st.sampled_from(["(", ")", "*", "**", "/", "-", "sin(", "x", "2", ",", "max(", " deg"])
    ).map("".join)
)
def test_any_text_is_an_expression_or_is_refused_with_a_place_in_it(text):
    try:
        parse(text)
    except ExpressionError as error:
        wrong = error
    else:
        return
    assert wrong.text == text
    assert 0 <= wrong.at <= len(text)
    assert wrong.problem
