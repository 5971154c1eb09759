"""The tree of an expression: frozen nodes that know where in the text they stand."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import reduce
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np


@dataclass(frozen=True)
class Number:
    """A number, or a constant."""

    value: float
    at: int = field(default=0, compare=False)


@dataclass(frozen=True)
class Name:
    """A coordinate."""

    name: str
    at: int = field(default=0, compare=False)


@dataclass(frozen=True)
class Negation:
    """Minus something."""

    operand: "Node"
    at: int = field(default=0, compare=False)


@dataclass(frozen=True)
class Operation:
    """Two operands and ``+``, ``-``, ``*``, ``/`` or ``**`` between them."""

    sign: str
    left: "Node"
    right: "Node"
    at: int = field(default=0, compare=False)


@dataclass(frozen=True)
class Call:
    """A function of one or more arguments."""

    function: str
    arguments: tuple["Node", ...]
    at: int = field(default=0, compare=False)


Node: TypeAlias = Number | Name | Negation | Operation | Call


@dataclass(frozen=True)
class Expression:
    """A text and the tree that it spells."""

    text: str
    root: Node


@dataclass(frozen=True)
class Function:
    """What a function's name stands for.

    Attributes
    ----------
    apply : callable
        Of arrays, element by element.
    fewest, most : int
        How many arguments it takes.
    """

    apply: Callable[..., Any]
    fewest: int = 1
    most: int = 1


def _least(*values: Any) -> Any:
    return reduce(np.minimum, values)


def _greatest(*values: Any) -> Any:
    return reduce(np.maximum, values)


_ANY_NUMBER = 1_000_000

FUNCTIONS: Mapping[str, Function] = MappingProxyType(
    {
        "sin": Function(np.sin),
        "cos": Function(np.cos),
        "tan": Function(np.tan),
        "atan2": Function(np.arctan2, 2, 2),
        "sqrt": Function(np.sqrt),
        "exp": Function(np.exp),
        "log": Function(np.log),
        "abs": Function(np.abs),
        "min": Function(_least, 2, _ANY_NUMBER),
        "max": Function(_greatest, 2, _ANY_NUMBER),
    }
)
"""Every function that an expression may call; angles in radians, log to the base e."""

OPERATIONS: Mapping[str, Callable[..., Any]] = MappingProxyType(
    {
        "+": np.add,
        "-": np.subtract,
        "*": np.multiply,
        "/": np.divide,
        # of floating-point numbers, so that 2**-1 is 0.5
        "**": np.power,
    }
)


def names_in(node: Node) -> Iterator[Name]:
    """Yield every coordinate of a tree, from left to right, as often as it stands there."""
    match node:
        case Name():
            yield node
        case Negation(operand=operand):
            yield from names_in(operand)
        case Operation(left=left, right=right):
            yield from names_in(left)
            yield from names_in(right)
        case Call(arguments=arguments):
            for argument in arguments:
                yield from names_in(argument)
