"""Formulas as MathML whose letters carry the names of gains and settings."""

import re
from collections.abc import Iterable, Mapping
from html import escape

import sympy as sp

from percept_obs.compile import in_letters
from percept_obs.validation.expressions import UNFIT

BETTER = (
    ("<mi>phi</mi>", "<mi>φ</mi>"),
    ("<mi>xi</mi>", "<mi>ξ</mi>"),
    ("&#x1D540;", "I"),
    ("<mo>&dd;</mo>", "<mi>d</mi>"),
)
"""Replacements of what sympy prints."""


def formula(left: object, right: object, letters: Mapping[str, sp.Symbol] | None = None) -> str:
    """The equation ``left = right`` as MathML, of expressions or MathML.

    The page highlights a letter, and puts its number in, by its name.
    """
    sides = [side if isinstance(side, str) else markup(side, letters) for side in (left, right)]
    return f"<mrow>{sides[0]}<mo>=</mo>{sides[1]}</mrow>"


def markup(expression: object, letters: Mapping[str, sp.Symbol] | None = None) -> str:
    """MathML of an expression, with hats, and with the letters marked by name."""
    text = _mathml(expression)
    text = re.sub(r"<mi>(\w+?)hat</mi>", r'<mover accent="true"><mi>\1</mi><mo>^</mo></mover>', text)
    for found, better in BETTER:
        text = text.replace(found, better)
    # Browsers stretch brackets only with a mathematical font, so the page draws those of a matrix as borders.
    text = text.replace("<mo>[</mo><mtable>", '<mtable class="matrix">').replace("</mtable><mo>]</mo>", "</mtable>")
    names = {_mathml(symbol): name for name, symbol in (letters or {}).items()}
    if not names:
        return text
    # The longest first, for the markup of alpha is a part of that of alpha1.
    pattern = "|".join(re.escape(letter) for letter in sorted(names, key=len, reverse=True))
    return re.sub(pattern, lambda found: f'<mrow data-letter="{names[found[0]]}">{found[0]}</mrow>', text)


def dotted(symbol: sp.Basic) -> str:
    """MathML of a symbol's time derivative."""
    # not as an accent, which without a mathematical font would lie on the letter
    return f"<mover><mrow>{markup(symbol)}</mrow><mo>˙</mo></mover>"


def after(symbol: sp.Basic) -> str:
    """MathML of a symbol's value after an update or a reset."""
    return f"<msup><mrow>{markup(symbol)}</mrow><mo>+</mo></msup>"


def row(*texts: str) -> str:
    """MathML of texts side by side; a text that is not MathML becomes words."""
    return f"<mrow>{''.join(text if text.startswith('<') else words(text) for text in texts)}</mrow>"


def listed(formulas: Iterable[str]) -> list[str]:
    """MathML of formulas with commas between them."""
    return [part for k, text in enumerate(formulas) for part in ([words(","), text] if k else [text])]


def words(text: str) -> str:
    """MathML of words beside a formula."""
    return f"<mtext>&nbsp;{escape(text)}&nbsp;</mtext>"


def _mathml(expression: object) -> str:
    if isinstance(expression, sp.Basic) and not isinstance(expression, sp.MatrixExpr):
        expression = in_letters(expression)
    if isinstance(expression, sp.Basic):  # sympy escapes no name
        named = expression.atoms(sp.Symbol, sp.MatrixSymbol)
        expression = expression.xreplace({s: s.func(escape(s.name), *s.args[1:]) for s in named if UNFIT & set(s.name)})
    if isinstance(expression, sp.Piecewise):
        cases = [(_mathml(value), "" if when == sp.true else _mathml(when)) for value, when in expression.args]
        rows = [
            f"<mtr><mtd>{value}</mtd><mtd>{words('if' if when else 'otherwise')}{when}</mtd></mtr>"
            for value, when in cases
        ]
        return f'<mtable class="cases">{"".join(rows)}</mtable>'
    if isinstance(expression, sp.MatAdd):  # sympy would begin with what is taken away
        taken = [term for term in expression.args if term.as_coeff_mmul()[0].is_negative]
        added = "<mo>+</mo>".join(_mathml(term) for term in expression.args if term not in taken)
        return f"<mrow>{added}{''.join(f'<mo>-</mo>{_mathml(-term)}' for term in taken)}</mrow>"
    text = re.sub(r"\s*\n\s*", "", str(sp.mathml(expression, printer="presentation")))
    return text.replace("<mi>ybar</mi>", "<mover><mi>y</mi><mo>¯</mo></mover>")
