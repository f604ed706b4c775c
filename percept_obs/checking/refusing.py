"""Refusals of a reader: where it cannot read on, what stands there, what is expected."""

import difflib
import unicodedata
from collections.abc import Iterable

from lark import Token

from percept_obs.validation import travels

CLOSING = {
    "RPAR": "(",
    "RBRACE": "{",
    "RSQB": "[",
    "_BAR_CLOSE": "|",
    "_NORM_CLOSE": "||",
    "_END_MATRIX": r"\begin",
    "_END_CASES": r"\begin",
}


@travels
class CannotRead(ValueError):
    """A formula that cannot be read.

    Parameters
    ----------
    text : str
        The formula, or several lines.
    position : int
        Where, counted in characters from 0; kept as an attribute.
    message : str
        Reason, and what can stand there.

    See Also
    --------
    percept_obs.check : Raises it.

    Examples
    --------
    >>> from percept_obs import check
    >>> check("y1' = b1 )", "y1' = b1")
    Traceback (most recent call last):
        ...
    percept_obs.checking.refusing.CannotRead: this bracket was never opened
        y1' = b1 )
                 ^
    """

    def __init__(self, text: str, position: int, message: str) -> None:
        self.position = position
        start = text.rfind("\n", 0, position) + 1
        end = text.find("\n", position) if "\n" in text[position:] else len(text)
        start, end = max(start, position - 50), min(end, position + 30)
        shown = "".join(c if c.isprintable() else " " for c in text[start:end])
        super().__init__(f"{message}\n    {shown}\n    {' ' * (position - start)}^")


def two_meanings(readings: Iterable[str], instead: str) -> str:
    """Return a message that lists the ways to read a text, and what to write instead."""
    return f"this can be read as {' or as '.join(readings)}; {instead}"


def about_character(c: str) -> str:
    """Say why a character cannot be read."""
    name = unicodedata.name(c, "a control character")
    if c == "_":
        return "an index is letters and digits, as in y_1 or v_{c1}"
    if c.isalpha():
        return f"{c!r} is {name}; letters are Latin or Greek, so type the letter that it looks like"
    return f"{c!r} ({name.lower()}) has no meaning in a formula; there are letters, numbers and + - * / ^ ( ) ="


def about_command(name: str) -> str:
    """Say why a command of LaTeX cannot be read."""
    if name in ("hat", "bar", "dot", "tilde", "widehat", "widetilde", "overline"):
        return rf"\{name} stands over a letter, as in \{name}{{y}}_{{1}}"
    if name in ("begin", "end"):
        return "of LaTeX's environments matrices, arrays, cases and those of equations and lines are read"
    known = (
        "frac",
        "sqrt",
        "sum",
        "int",
        "left",
        "right",
        "dot",
        "hat",
        "begin",
        "end",
        "cdot",
        "text",
        "quad",
        "omega",
    )
    near = difflib.get_close_matches(name, known, 1, 0.6)
    guess = rf", did you mean \{near[0]}?" if near else ";"
    return rf"\{name} is not read{guess} there are \frac, \sqrt, \sum with numbers, functions, Greek letters, matrices"


def about_token(token: Token, accepted: set[str]) -> str:
    """Say why a token cannot stand where it does, from the kinds that can."""
    open_brackets = [CLOSING[kind] for kind in accepted if kind in CLOSING]
    if accepted <= {"LPAR", "LBRACE", "_POWER", "RAISED"}:
        return "a function takes its argument in brackets, as in sin(...), and a command in braces"
    if "NAME" in accepted and "_TIMES" not in accepted:
        end = token.type == "$END"
        return f"{'the formula ends too early: ' if end else ''}a number, a letter or a bracket is expected here"
    if token.type in ("_POWER", "RAISED"):
        return "a power of a power needs brackets: (x^2)^3"
    if token.type == "NUMBER":
        return "a number after a factor can mean two things; write * or ^ before it"
    if open_brackets:
        return f"the bracket {open_brackets[0]} is not closed"
    if token.type in CLOSING:
        return "this bracket was never opened"
    return "an operator or the end of the line is expected here"
