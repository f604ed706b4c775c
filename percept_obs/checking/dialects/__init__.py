"""Dialects in which people and programs write formulas, each a rewriter to the plain form that one grammar reads."""

from __future__ import annotations

from collections.abc import Callable

from percept_obs.checking.dialects import latex, markdown, matlab, prose, python, symbols, typst
from percept_obs.checking.dialects.source import Source

DIALECTS = (markdown, typst, python, matlab, latex)
"""Modules with a NAME, a MARK by which the dialect is known, and a function `rewritten`; in this order."""


def plain(text: str, is_name: Callable[[str], bool]) -> tuple[Source, tuple[str, ...]]:
    """Return a text in the plain form, without prose, and the names of the dialects that were taken.

    Of a word `is_name` says if it can be a letter or a function here; other words that no formula contains are prose.

    >>> source, taken = plain("y1dot = a.*y(2); % the rate", {"a", "y"}.__contains__)
    >>> source.text.strip(), taken
    ('y1dot = a*y2;', ('MATLAB',))
    """
    source, taken = symbols.rewritten(text), []
    for dialect in DIALECTS:
        if dialect.MARK.search(source.text):
            source = dialect.rewritten(source)
            taken.append(dialect.NAME)
    return prose.rewritten(source, is_name), tuple(taken)
