"""Tables with which the page reads formulas as Python does: terminals, rules and states, as lark made them."""

from __future__ import annotations

from typing import Any

from lark.grammar import NonTerminal, Rule, Terminal
from lark.parsers.lalr_analysis import Shift

from percept_obs.checking import points, reading
from percept_obs.labs.shared.printed import Texts

REFUSALS = {
    "character": "this sign has no meaning in a formula",
    "word": "this cannot stand here",
    "end": "the formula ends too early",
    "empty": "there is no formula",
    "letter": '"{name}" is no letter here',
    "ways": '"{name}" can be read in several ways; write * between letters',
    "line": 'there is no line "{name}" here',
    "command": r"\{name} is not read",
    "exponent": "exponents are whole or half numbers, and not large",
    "divisor": "zero cannot stand below a fraction",
    "zero": "zero has no such power",
    "below": "after a / it is not clear what is below it; write brackets or *",
    "transpose": "only a matrix has a transpose, A^T",
    "matrix": "a matrix cannot stand here",
    "large": "this is too long or too large to be compared; there must be a smaller way to write it",
    "python": "only Python reads this: open the desk in a notebook",
}
"""Reasons of the page for what it cannot read; where Python answers, it says more."""

GREEK = tuple(reading._GREEK.split())

_START = "lines"


def tables() -> Texts:
    """Return what the page reads formulas with, as plain data.

    A terminal is its name and its regular expression, in the order in which they are tried.  A rule has its name in
    the tree, the symbol that it makes, how many parts it takes, and the numbers of those that it keeps; "spread" are
    those of them whose own parts take their place, and of an "alone" rule one part alone does.  A state says by the
    next symbol where to go, or as -1 - k that rule k ends.
    """
    parser = reading._parser()
    lexer, table = parser.parser.lexer, parser.parser.parser._parse_table
    rules: dict[Rule, int] = {}
    states = [
        {
            str(symbol): target if action is Shift else -1 - rules.setdefault(target, len(rules))
            for symbol, (action, target) in sorted(state.items())
        }
        for _, state in sorted(table.states.items())
    ]
    return {
        "terminals": [[str(t.name), t.pattern.to_regexp()] for t in lexer.scanner.terminals],
        "ignored": sorted(map(str, lexer.ignore_types)),
        "rules": [_rule(rule) for rule in rules],
        "states": states,
        "start": table.start_states[_START],
        "end": table.end_states[_START],
        **_names(),
    }


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


def _names() -> Texts:
    """Return what tells names apart: other spellings, functions, accents, left sides of lines, limits."""
    return {
        "replaced": reading._REPLACED,
        "combining": reading._ACCENTS,
        "accents": points.ACCENTS.partition("(?:")[2].rstrip(")").split("|"),
        "functions": {name: function.__name__.lower() for name, function in reading.FUNCTIONS.items()},
        "label": reading._LABEL.pattern.replace(r"\w", "[A-Za-z0-9]"),
        "opening": list(reading._OPENING),
        "closing": list(reading._CLOSING),
        "limits": {
            "longest": reading.LONGEST,
            "number": reading.LONGEST_NUMBER,
            "word": reading.LONGEST_WORD,
            "deepest": reading.DEEPEST,
            "power": reading.LARGEST_POWER,
            "degree": reading.LARGEST_DEGREE,
            "integer": reading.LONGEST_INTEGER,
        },
    }
