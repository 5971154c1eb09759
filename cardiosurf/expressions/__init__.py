"""Expressions in a config: a small grammar, parsed into a tree that NumPy evaluates; never eval."""

from cardiosurf.expressions.errors import ExpressionError, pointed
from cardiosurf.expressions.evaluation import constant, evaluate
from cardiosurf.expressions.grammar import parse
from cardiosurf.expressions.tree import FUNCTIONS, Expression, names_in

__all__ = [
    "FUNCTIONS",
    "Expression",
    "ExpressionError",
    "constant",
    "evaluate",
    "names_in",
    "parse",
    "pointed",
]
