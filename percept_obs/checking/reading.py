"""Reading a formula: text or LaTeX becomes sympy, built from listed letters and nothing else."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import sympy as sp
from lark import Token, Tree, UnexpectedToken

from percept_obs.checking.building import Builder
from percept_obs.checking.deciding import MATRICES
from percept_obs.checking.limits import refused
from percept_obs.checking.refusing import CannotRead as CannotRead
from percept_obs.checking.refusing import about_token
from percept_obs.checking.spelling import parser
from percept_obs.checking.tokens import FUNCTIONS as FUNCTIONS
from percept_obs.checking.tokens import Functions as Functions
from percept_obs.checking.words import Words


@dataclass(frozen=True)
class Reading:
    """Line that was read: its left side in letters and digits, such as "y1dot", or empty, and its formula."""

    name: str
    formula: sp.Basic
    at: int = field(default=0, repr=False, compare=False)  # where it begins in the text


@dataclass(frozen=True)
class Definition:
    """A letter that a text defines: its formulas, several for a chain q = a b = c, and if a line uses it."""

    name: str
    formulas: tuple[sp.Basic, ...]
    used: bool
    at: int = field(default=0, repr=False, compare=False)


@dataclass(frozen=True)
class Text:
    """All that was read: lines with the definitions put in, and these by themselves."""

    lines: tuple[Reading, ...]
    definitions: tuple[Definition, ...] = ()
    dialects: tuple[str, ...] = ()


def read(text: str, letters: Mapping[str, Any], labels: Iterable[str] = (), functions: Functions | None = None) -> Text:
    """Read the lines of a text, typed as "y1' = a13 + (a11 - a33) y1 + ..." or LaTeX as papers and sympy print it.

    A line that gives a new letter a meaning, "where q = a31 y1 + a32 y2 + a33", is a definition, wherever it stands.
    Letters are named without underscores, matrices among them (the inverse of one is ``P^-1``); labels may stand on the
    left besides them, and functions besides the usual ones are of numbers or matrices: ``norm(e1)``.  A line in which
    one label stands elsewhere, "y3' + b3 y3^2 = 0", is solved for it.

    Raises
    ------
    CannotRead
        If something is no formula, or has two meanings; it says where, and what to write instead.

    Examples
    --------
    >>> x, y = sp.symbols("x y1")
    >>> read("y1' = 2x(x - 3/4)^2", {"x": x, "y1": y}, ["y1dot"]).lines
    (Reading(name='y1dot', formula=2*x*(x - 3/4)**2),)
    >>> read("x + z", {"x": x})
    Traceback (most recent call last):
        ...
    percept_obs.checking.refusing.CannotRead: "z" is no letter here; there are x
        x + z
            ^
    """
    return _Lines(Words(text, letters, labels, functions or {})).read()


def words_of(text: str) -> list[Token]:
    """Return the tokens of a text as `read` understands them, also where it is no formula; the last is "END"."""
    return Words(text, {}, (), {}).tokens(strict=False)


class _Lines:
    """Reads the lines of one text."""

    def __init__(self, words: Words) -> None:
        self.words, self.refuse = words, words.refuse
        self.tokens = words.tokens()
        self.tree = self.parsed(self.tokens)
        self.named_lines = [line.children for line in self.tree.children if line.data == "named"]
        self.sides: dict[str, tuple[Any, ...]] = {}
        for label, *rest in self.named_lines:
            if str(label) in self.sides and self.new(label):
                self.refuse(f'"{label}" is given twice; give each its own letter', label)
            sides = [side for sign, side in zip(rest[::2], rest[1::2], strict=True) if sign.children[0].type == "EQUAL"]
            self.sides[str(label)] = tuple(sides)
        self.builder = Builder(words, self.sides)

    def parsed(self, tokens: list[Token]) -> Any:
        state = parser().parse_interactive(start="lines")
        *words, end = tokens
        try:
            for token in words:
                state.feed_token(token)
            tree = state.feed_eof(end)
        except UnexpectedToken as error:
            self.refuse(about_token(error.token, state.accepts()), error.token)
        if not tree.children:
            self.refuse('there is no formula; type one, such as "y1 + 2 y2"')
        return tree

    def new(self, label: Token) -> bool:
        """Return True if a left side is a letter that the text gives a meaning."""
        known = (*self.words.labels, *self.words.letters)
        return not all(part in known for part in label.split(","))

    def read(self) -> Text:
        lines = [reading for line in self.tree.children for reading in getattr(self, line.data)(line, *line.children)]
        if why := refused(*(line.formula for line in lines)):
            self.refuse(why)
        names = [
            str(line.children[0]) for line in self.tree.children if line.data == "named" and self.new(line.children[0])
        ]
        found = {name: self.builder.side(name, self.tree.children[0].children[0]) for name in names}
        if len(lines) > 1 and all(not line.name and isinstance(line.formula, sp.Ne) for line in lines):
            join = sp.Or if any("lor" in token for token in self.tokens if token.type == "_LINE") else sp.And
            lines = [Reading("", join(*(line.formula for line in lines), evaluate=False))]
        uses, used = self.builder.uses, set(self.builder.uses.get("", ()))
        waiting = [*used]
        while waiting:
            more = uses.get(waiting.pop(), set()) - used
            used |= more
            waiting += more
        places = {str(label): self.place(label) for label, *_ in self.named_lines}
        definitions = tuple(Definition(n, formulas, n in used, places[n]) for n, formulas in found.items())
        return Text(tuple(lines), definitions, self.words.dialects)

    def place(self, node: Any) -> int:
        """Return where a part of the tree begins in the text that was typed."""
        start = node.start_pos if isinstance(node, Token) else node.meta.start_pos
        return self.words.origin[start] if start is not None and start < len(self.words.origin) else 0

    def line(self, node: Any) -> Any:
        """Return the value of a side of a line, and note the defined letters in it as used."""
        builder = self.builder
        builder.within.append("")
        builder.uses.setdefault("", set())
        value = builder.written(builder.value(node), node)
        builder.within.pop()
        return value

    def named(self, tree: Tree, label: Token, *rest: Any) -> list[Reading]:
        if self.new(label):
            return []
        found: list[Reading] = []
        left = self.builder.value(label) if str(label) in self.words.letters else None
        for sign, side in zip(rest[::2], rest[1::2], strict=True):
            value = self.line(side)
            if sign.children[0].type == "EQUAL":
                self.refuse_unknown_rate(value, side)
                found.append(Reading(str(label), value, self.place(side)))
            else:  # in V' = a <= b it is V' that is at most b
                left = value if left is None else left
                found.append(Reading("", self.builder.related(left, sign.children[0], value, side)))
                left = value
        return found

    def unnamed(self, tree: Tree, side: Any) -> list[Reading]:
        value = self.line(side)
        self.refuse_unknown_rate(value, side)
        return [Reading("", value, self.place(side))]

    def relation(self, tree: Tree, first: Any, *rest: Any) -> list[Reading]:
        found: list[Reading] = []
        left = self.line(first)
        for sign, side in zip(rest[::2], rest[1::2], strict=True):
            right = self.line(side)
            shape, other = (getattr(value, "shape", ()) for value in (left, right))
            if shape and shape == other[::-1] and getattr(first, "data", "") == "raised":  # [a, b]^T = a column
                left = left.T
            kind = "=" if sign.children[0].type == "EQUAL" else sign.children[0]
            solved = self.solved(self.builder.related(left, kind, right, side), side)
            found.append(replace(solved, at=self.place(side)))
            left = right
        return found

    def refuse_unknown_rate(self, value: Any, node: Any) -> None:
        """Refuse a value with a letter's rate, such as y1', for which the text has no line."""
        for name, symbol in self.builder.rates.items():
            if isinstance(value, sp.Basic) and value.has(symbol):
                self.refuse(f'"{name}" stands in this line, and no line gives it; write it in the known letters', node)

    def solved(self, relation: Any, node: Any) -> Reading:
        """Return an equation solved for the only rate in it."""
        rates = [name for name, symbol in self.builder.rates.items() if relation.has(symbol)]
        if not rates or not isinstance(relation, sp.Eq):
            return Reading("", relation)
        left, right = relation.args
        symbol = self.builder.rates[rates[0]]
        if len(rates) > 1 or any(isinstance(side, MATRICES) for side in (left, right)):
            self.refuse(f"{' and '.join(rates)} stand in this line; write one line for each, {rates[0]} = ...", node)
        slope = (left - right).diff(symbol)
        if slope == 0 or slope.has(symbol):
            self.refuse(f"this cannot be solved for {rates[0]}; write {rates[0]} = ...", node)
        rest = (left - right).subs(symbol, 0)
        return Reading(rates[0], rest if slope == -1 else -rest / slope)
