"""Dialects in which people and programs write formulas, each rewritten to the plain form that one grammar reads.

A dialect is a file of rules with examples, ``typst.toml``: its name, the mark by which it is known, patterns with what
stands for them, and calls with theirs.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from percept_obs.checking.dialects import prose, symbols
from percept_obs.checking.dialects.code import own_commands, rows
from percept_obs.checking.dialects.delimiters import delimited
from percept_obs.checking.dialects.source import Source

ORDER = ("latex", "markdown", "typst", "julia", "python", "matlab")
BEFORE: Mapping[str, Callable[[Source], Source]] = {"LaTeX": own_commands, "MATLAB": rows}


@dataclass(frozen=True)
class Dialect:
    """A dialect as its file has it; calls in braces are those of TeX."""

    name: str
    mark: re.Pattern[str]
    rules: list[tuple[str, str]]
    examples: list[tuple[str, str]]
    calls: Mapping[str, str] = field(default_factory=dict)
    braces: bool = False

    def rewritten(self, source: Source) -> Source:
        """Return a text in the plain form."""
        source = BEFORE[self.name](source) if self.name in BEFORE else source
        if self.braces:
            source = source.calls(self.calls, r"\\", "{")
        for pattern, new in self.rules:
            source = source.sub(pattern, new)
        if self.name == "Markdown":
            return Source(delimited(source.text), source.origin)
        return source.calls(self.calls) if self.calls and not self.braces else source


@cache
def dialects() -> tuple[Dialect, ...]:
    """All dialects, in the order in which a text is rewritten."""
    files = [(Path(__file__).parent / f"{name}.toml").read_text(encoding="utf-8") for name in ORDER]
    return tuple(Dialect(**each | {"mark": re.compile(each["mark"])}) for each in map(tomllib.loads, files))


def plain(text: str, is_name: Callable[[str], bool]) -> tuple[Source, tuple[str, ...]]:
    """Return a text in the plain form, without prose, and the names of the dialects that were taken.

    Of a word `is_name` says if it can be a letter or a function here; other words that no formula contains are prose.

    >>> source, taken = plain("y1dot = a.*y(2); % the rate", {"a", "y"}.__contains__)
    >>> source.text.strip(), taken
    ('y1dot = a*y2;', ('MATLAB',))
    """
    source, taken = symbols.rewritten(text), []
    for dialect in dialects():
        if dialect.mark.search(source.text):
            source = dialect.rewritten(source)
            taken.append(dialect.name)
    return prose.rewritten(source, is_name), tuple(taken)
