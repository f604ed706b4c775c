"""Tables with which the page reads formulas as Python does: terminals, rules and states, as lark made them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from lark.grammar import NonTerminal, Rule, Terminal
from lark.parsers.lalr_analysis import Shift

from percept_obs.checking import building, limits, notation, refusing, spelling, tokens, words
from percept_obs.labs.desk.in_javascript import in_javascript, long_constants
from percept_obs.labs.shared.printed import Texts

REFUSALS = {
    "empty": 'there is no formula; type one, such as "y1 + 2 y2"',
    "twice": '"{name}" is given twice; give each its own letter',
    "itself": '"{name}" is given by itself; begin with what is known',
    "rate": '"{name}" stands in this line, and no line gives it; write it in the known letters',
    "unsolved": "this cannot be solved for {name}; write {name} = ...",
    "exponent": f"exponents are whole or half numbers up to {building.LARGEST_POWER}",
    "divisor": "a matrix or zero cannot stand below a fraction",
    "zero": "zero has no such power",
    "below": "after a / it is not clear what is below it; write brackets or *",
    "transpose": "only a matrix has a transpose, A^T",
    "matrix": "a matrix cannot stand here",
    "large": "this is too large to be compared; there must be a smaller way to write it",
    "python": "only Python reads this: open the desk in a notebook",
}
"""Refusals of the page where it reads a line and no formula comes of it; where Python answers, it says more."""

GREEK = tuple(spelling.GREEK.split())
_LAYOUT = ("DELIMITER", "PROSE", "NUMBERED", "COMMENT")

_START = "lines"
_READER = (refusing, spelling, tokens, notation, words)
_BY_HAND = ("CannotRead", "_terminal", "lexed")  # in the page's own sources, with "key" and the tokens
_LEFT_OUT = (*_BY_HAND, "parser", "_grammar", "Functions", "_NAMED", "_QUOTIENTS", "GREEK")


def reader() -> str:
    """Return what tells the names of a text apart, and what is said where it cannot, as JavaScript for the page."""
    known = (*_BY_HAND, "Token", "UnexpectedCharacters", "key", "sp")
    return in_javascript(_READER, _LEFT_OUT, known)


def tables() -> Texts:
    """Return what the page reads formulas with, as plain data.

    A terminal is its name and its regular expression, in the order in which they are tried.  A rule has its name in
    the tree, the symbol that it makes, how many parts it takes, and the numbers of those that it keeps; "spread" are
    those of them whose own parts take their place, and of an "alone" rule one part alone does.  A state says by the
    next symbol where to go, or as -1 - k that rule k ends.
    """
    parser = spelling.parser()
    lexer, table = parser.parser.lexer, parser.parser.parser._parse_table
    rules: dict[Rule, int] = {}
    number = _in_order(table.states, table.start_states[_START])
    states = [
        {
            str(symbol): number[target] if action is Shift else -1 - rules.setdefault(target, len(rules))
            for symbol, (action, target) in sorted(table.states[state].items())
        }
        for state in number
    ]
    return {
        "terminals": [[str(t.name), t.pattern.to_regexp()] for t in lexer.scanner.terminals],
        "ignored": sorted(map(str, lexer.ignore_types)),
        "rules": [_rule(rule) for rule in rules],
        "states": states,
        "start": number[table.start_states[_START]],
        "end": number[table.end_states[_START]],
        "layout": {name: spelling._terminal(name).pattern for name in _LAYOUT},
        "constants": long_constants(_READER),
        "functions": {
            name: name if name in tokens._QUOTIENTS else function.__name__.lower()
            for name, function in tokens.FUNCTIONS.items()
        },
        "limits": {
            "power": building.LARGEST_POWER,
            "degree": building.LARGEST_DEGREE,
            "integer": building.LONGEST_INTEGER,
            "size": limits.LARGEST,
        },
    }


def _in_order(states: Mapping[Any, Mapping[str, Any]], start: Any) -> dict[Any, int]:
    """Return a number for each state in the order in which they are reached, for lark's own differ from run to run."""
    number = {start: 0}
    queue = [start]
    for state in queue:
        for _, (action, target) in sorted(states[state].items()):
            if action is Shift and target not in number:
                number[target] = len(number)
                queue.append(target)
    return number


def _rule(rule: Rule) -> dict[str, Any]:
    kept = [k for k, part in enumerate(rule.expansion) if not (isinstance(part, Terminal) and part.filter_out)]
    spread = [k for k in kept if isinstance(rule.expansion[k], NonTerminal) and rule.expansion[k].name.startswith("_")]
    return {
        "name": str(rule.alias or rule.origin.name),
        "makes": str(rule.origin.name),
        "size": len(rule.expansion),
        "kept": kept,
        **({"spread": spread} if spread else {}),
        **({"alone": 1} if rule.options.expand1 and not rule.alias else {}),
    }
