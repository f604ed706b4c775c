"""MATLAB, Octave and Julia: y(3), A(3,1), .* and .^, % remarks, functions, rows of matrices without commas."""

import re

from percept_obs.checking.dialects.source import Source
from percept_obs.checking.tokens import FUNCTIONS

NAME = "MATLAB"
_INDEXED = rf"(?<![\w\\])(?!(?:{'|'.join(FUNCTIONS)})\()(\w*[A-Za-z])\(([1-9])(?:,\s*([1-9]))?\)"
MARK = re.compile(
    rf"\.[*/^](?!\w+\()|{_INDEXED}|^\s*function\b|@\(|\.\.\.|\[[^\[\],()]*;[^\[\]()]*\]|\]'", re.MULTILINE
)
_BESIDES = r"(?m)^\s*function\b.*$|^\s*end(function)?;?\s*$|(\b\w+\s*=\s*)?@\([^()]*\)|%.*$"


def rewritten(source: Source) -> Source:
    """Return a text of MATLAB in the plain form."""
    source = source.sub(_BESIDES, "").sub(r"\s*\.\.\.[^\n]*\n", " ").sub(r" ?\.([*/^])", r"\1").sub(r"\]'", "]^T")
    return source.sub(_INDEXED, _indexed).sub(r"\[([^\[\],()]*[;\s][^\[\],()]*)\]", _rows)


def _indexed(found: re.Match[str]) -> str:
    """Return y3 for y(3), ydot3 for the column's ydot(3,1), a31 for A(3,1)."""
    name, first, second = found.groups()
    return f"{name}{first}{second or ''}" if len(name) == 1 or second != "1" else f"{name}{first}"


def _rows(found: re.Match[str]) -> str:
    """Return a matrix of letters and numbers with commas, if its entries are apart by blanks alone."""
    rows = [row.split() for row in re.split(r"[;\n]+", found[1]) if row.strip()]
    several = len({*map(len, rows)}) == 1 and len(rows[0]) > 1
    if not several or not all(re.fullmatch(r"[-+]?[\w.]+", entry) for row in rows for entry in row):
        return found[0]
    signs = any(entry[0] in "+-" or entry.isdigit() for row in rows for entry in row[1:])  # a b; c d may be products
    return f"[{'; '.join(', '.join(row) for row in rows)}]" if signs else found[0]
