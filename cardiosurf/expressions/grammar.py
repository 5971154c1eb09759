"""From the text of an expression to its tree, by recursive descent.

    sum     = term (("+" | "-") term)*
    term    = signed (("*" | "/") signed)*
    signed  = ["+" | "-"] power
    power   = primary ["**" signed]
    primary = number ["deg"] | name | function "(" sum ("," sum)* ")" | "(" sum ")"

``**`` binds to the right and tighter than a sign before it, as in mathematics: -x**2 is -(x**2).
``45 deg`` is a number in degrees; it cannot stand right after ``/`` or ``**``, where it could be
read in two ways.
"""

import math
import re
from dataclasses import dataclass
from functools import lru_cache

from cardiosurf.expressions.errors import ExpressionError
from cardiosurf.expressions.tree import (
    FUNCTIONS,
    Call,
    Expression,
    Name,
    Negation,
    Node,
    Number,
    Operation,
)
from cardiosurf.spelling import did_you_mean

LONGEST = 500
"""Characters of an expression: bounds the depth of its tree and what it takes to evaluate it."""
DEEPEST = 40
"""How many brackets, calls and exponents may be open at a time."""

CONSTANTS = {"pi": math.pi}
DEGREES = frozenset({"deg", "degrees", "°"})

_TOKEN = re.compile(
    r"(?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)"
    r"|(?P<word>[A-Za-z_][A-Za-z_0-9]*|°)"
    r"|(?P<sign>\*\*|[-+*/(),])"
)
_SPACE = re.compile(r"[ \t\r\n]*")


@dataclass(frozen=True)
class _Token:
    """A piece of the text: of kind number, word or sign, or the end."""

    kind: str
    text: str
    at: int


@lru_cache(maxsize=256)
def parse(text: str) -> Expression:
    """Return the tree that a text spells.

    Parameters
    ----------
    text : str
        Numbers, pi, names, + - * / ** ( ) and the functions of ``FUNCTIONS``.

    Raises
    ------
    ExpressionError
        If it is none, is longer than 500 characters or is nested more than 40 deep. Whether names
        stand for something is not asked here.

    Examples
    --------
    >>> parse("-x").root
    Negation(operand=Name(name='x', at=1), at=0)
    """
    if len(text) > LONGEST:
        problem = f"has {len(text)} characters, an expression at most {LONGEST}"
        raise ExpressionError(text, LONGEST, problem)
    if not text.strip():
        raise ExpressionError(text, 0, "is empty")
    parser = _Parser(text, _tokens(text))
    root = parser.sum()
    parser.finish()
    return Expression(text, root)


def _tokens(text: str) -> list[_Token]:
    found: list[_Token] = []
    at = _after_space(text, 0)
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            hint = "; the power is written **" if text[at] == "^" else ""
            raise ExpressionError(text, at, f"{text[at]!r} means nothing here{hint}")
        found.append(_Token(str(match.lastgroup), match[0], at))
        at = _after_space(text, match.end())
    return [*found, _Token("end", "", len(text))]


def _after_space(text: str, at: int) -> int:
    space = _SPACE.match(text, at)
    return at if space is None else space.end()


class _Parser:
    """Reads tokens from left to right; each method reads what it is called after."""

    def __init__(self, text: str, tokens: list[_Token]) -> None:
        self.text, self.tokens = text, tokens
        self.next, self.depth = 0, 0

    @property
    def here(self) -> _Token:
        return self.tokens[self.next]

    def sum(self) -> Node:
        node = self.term()
        while self.here.text in {"+", "-"}:
            sign = self.take()
            node = Operation(sign.text, node, self.term(), sign.at)
        return node

    def term(self) -> Node:
        node = self.signed()
        while self.here.text in {"*", "/"}:
            sign = self.take()
            right = self.signed()
            if sign.text == "/":
                self.refuse_degrees(sign)
            node = Operation(sign.text, node, right, sign.at)
        return node

    def signed(self) -> Node:
        if self.here.text not in {"+", "-"}:
            return self.power()
        sign = self.take()
        operand = self.power()
        return Negation(operand, sign.at) if sign.text == "-" else operand

    def power(self) -> Node:
        base = self.primary()
        if self.here.text != "**":
            return base
        sign = self.take()
        self.deeper(sign)
        exponent = self.signed()
        self.depth -= 1
        self.refuse_degrees(sign)
        return Operation(sign.text, base, exponent, sign.at)

    def primary(self) -> Node:
        token = self.take()
        if token.kind == "number":
            return self.number(token)
        if token.kind == "word":
            return self.word(token)
        if token.text == "(":
            self.deeper(token)
            inside = self.sum()
            self.close(token)
            return inside
        what = repr(token.text) if token.text else "the end"
        raise self.error(token, f"a number, a name or ( is missing before {what}")

    def number(self, token: _Token) -> Node:
        value = float(token.text)
        if not math.isfinite(value):
            raise self.error(token, f"{token.text} is too large a number")
        if self.here.text in DEGREES:
            self.take()
            value = math.radians(value)
        return Number(value, token.at)

    def word(self, token: _Token) -> Node:
        if token.text in CONSTANTS:
            return Number(CONSTANTS[token.text], token.at)
        if token.text in DEGREES:
            raise self.error(token, f"{token.text!r} stands after a number only, as in 45 deg")
        if self.here.text == "(":
            return self.call(token)
        if token.text in FUNCTIONS:
            raise self.error(token, f"the function {token.text!r} needs ( after it")
        return Name(token.text, token.at)

    def call(self, token: _Token) -> Node:
        function = FUNCTIONS.get(token.text)
        if function is None:
            guess = did_you_mean(token.text, FUNCTIONS)
            known = guess or f"there are {', '.join(FUNCTIONS)}"
            raise self.error(token, f"there is no function {token.text!r}, {known}")
        bracket = self.take()
        self.deeper(bracket)
        arguments = [self.sum()]
        while self.here.text == ",":
            self.take()
            arguments.append(self.sum())
        self.close(bracket)
        if not function.fewest <= len(arguments) <= function.most:
            exact = function.fewest == function.most
            wanted = f"{function.fewest}" if exact else f"{function.fewest} or more"
            given = f"{len(arguments)} argument" + "s" * (len(arguments) != 1)
            raise self.error(token, f"{token.text} has {given}, it takes {wanted}")
        return Call(token.text, tuple(arguments), token.at)

    def close(self, bracket: _Token) -> None:
        if self.here.text != ")":
            found = f"before {self.here.text!r}" if self.here.text else "at the end"
            raise self.error(
                self.here, f"the ) of the ( at character {bracket.at + 1} is missing {found}"
            )
        self.take()
        self.depth -= 1

    def finish(self) -> None:
        if self.here.kind == "end":
            return
        if self.here.text == ")":
            raise self.error(self.here, "there is no ( for this )")
        raise self.error(self.here, f"an operator such as * is missing before {self.here.text!r}")

    def take(self) -> _Token:
        token = self.here
        self.next += token.kind != "end"
        return token

    def deeper(self, token: _Token) -> None:
        self.depth += 1
        if self.depth > DEEPEST:
            raise self.error(token, f"nested more than {DEEPEST} deep")

    def refuse_degrees(self, sign: _Token) -> None:
        last = self.tokens[self.next - 1]
        if last.text in DEGREES:
            raise self.error(
                last, f"degrees right after {sign.text} can be read in two ways; use brackets"
            )

    def error(self, token: _Token, problem: str) -> ExpressionError:
        return ExpressionError(self.text, token.at, problem)
