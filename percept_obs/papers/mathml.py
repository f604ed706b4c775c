"""Formulas as MathML, which a browser shows without help: in a notebook, and in a file."""

import re
from html import escape

import sympy as sp
from sympy.core.relational import Relational

ACCENTS = {"hat": "^", "dot": "˙", "bar": "¯", "tilde": "~", "plus": "+", "cross": "×"}
GREEK = dict(
    zip(
        ["alpha", "beta", "gamma", "delta", "epsilon", "theta", "lambda", "rho", "tau", "phi", "varphi", "xi"],
        "αβγδεθλρτφφξ",
        strict=True,
    )
)
BETTER = (
    ("<mo> </mo>", "<mo>,</mo>"),
    ("<mo><</mo>", "<mo>&lt;</mo>"),
    ("&#x1D540;", "<mi>I</mi>"),
    ("<mn>&#x1D7D8</mn>", "<mn>0</mn>"),
    ("<mo>&dd;</mo>", "<mo>d</mo>"),
    ("<mi>&#960;</mi>", "<mi>pi</mi>"),
)
"""Replacements in what sympy prints; the pi of the papers is an index."""


def shown(part: str | tuple[sp.Basic, ...]) -> str:
    """HTML of a text, or of formulas one below the other."""
    if isinstance(part, str):
        return escape(part)
    return "".join(f'<div><math displaystyle="true">{markup(formula)}</math></div>' for formula in part)


def markup(formula: sp.Basic) -> str:
    """MathML of a formula, with its accents."""
    text = re.sub(r"<mi>(\w+)</mi>", lambda found: _letter(found[1]), _plain(formula))
    for found, better in BETTER:
        text = text.replace(found, better)
    return text


def _plain(formula: sp.Basic) -> str:
    """MathML as sympy prints it, with branches side by side."""
    if isinstance(formula, Relational) and isinstance(formula.rhs, sp.Piecewise):
        branches = (
            f"{_plain(value)}<mtext>&nbsp;{'otherwise' if when == sp.true else 'if'}&nbsp;</mtext>"
            + ("" if when == sp.true else _plain(when))
            for value, when in formula.rhs.args
        )
        return f"{_plain(formula.lhs)}<mo>=</mo>{'<mtext>,&nbsp;</mtext>'.join(branches)}"
    return str(sp.mathml(formula, printer="presentation"))


def _letter(name: str) -> str:
    for accent, mark in ACCENTS.items():
        if name.endswith(accent) and name != accent:
            return f'<mover accent="true">{_letter(name.removesuffix(accent))}<mo>{mark}</mo></mover>'
    if name[:1] == "d" and name[1:] in GREEK:  # of a rate in s
        return f"<mrow><mi>d</mi><mi>{GREEK[name[1:]]}</mi></mrow>"
    return f"<mi>{GREEK.get(name, name)}</mi>"
