"""The value of an expression, at many places at once."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from cardiosurf.arrays import Floats
from cardiosurf.expressions.errors import ExpressionError
from cardiosurf.expressions.grammar import parse
from cardiosurf.expressions.tree import (
    FUNCTIONS,
    OPERATIONS,
    Call,
    Expression,
    Name,
    Negation,
    Node,
    Number,
    Operation,
    names_in,
)


def evaluate(expression: Expression, values: Mapping[str, Floats], count: int) -> Floats:
    """Return the value of an expression at each of ``count`` places.

    Parameters
    ----------
    expression : Expression
        What ``parse`` returned; every name of it is one of ``values``.
    values : mapping of str to (count,) float
        What the names stand for.
    count : int
        How many places there are.

    Returns
    -------
    (count,) float
        All finite.

    Raises
    ------
    ExpressionError
        If something in it has no finite value somewhere: a division by zero, the root of a
        negative number, ...; ``place`` is the first such place.
    """
    with np.errstate(all="ignore"):
        return np.broadcast_to(_value(expression.root, expression.text, values), (count,)).copy()


def constant(text: str) -> float:
    """Return the value of an expression without names.

    Raises
    ------
    ExpressionError
        If it is not an expression, has a name, or has no finite value.

    Examples
    --------
    >>> constant("3*pi/4"), constant("45 deg")
    (2.356194490192345, 0.7853981633974483)
    """
    expression = parse(text)
    for name in names_in(expression.root):
        raise ExpressionError(text, name.at, f"{name.name!r} means nothing here")
    return float(evaluate(expression, {}, 1)[0])


def _value(node: Node, text: str, values: Mapping[str, Floats]) -> Any:
    match node:
        case Number(value=number):
            return np.float64(number)
        case Name(name=name):
            return values[name]
        case Negation(operand=operand):
            return -_value(operand, text, values)
        case Operation(sign=sign, left=left, right=right):
            given = [_value(left, text, values), _value(right, text, values)]
            return _finite(node, text, OPERATIONS[sign], given)
        case Call(function=function, arguments=arguments):
            given = [_value(argument, text, values) for argument in arguments]
            return _finite(node, text, FUNCTIONS[function].apply, given)


def _finite(
    node: Operation | Call, text: str, function: Callable[..., Any], given: list[Any]
) -> Any:
    result = function(*given)
    good = np.isfinite(result)
    if np.all(good):
        return result
    first = int(np.argmin(good))
    numbers = [f"{float(np.broadcast_to(one, np.shape(result)).flat[first]):.6g}" for one in given]
    if isinstance(node, Call):
        what = f"{node.function}({', '.join(numbers)})"
    else:
        what = f"{numbers[0]} {node.sign} {numbers[1]}"
    raise ExpressionError(text, node.at, f"{what} is not a finite number", first)
