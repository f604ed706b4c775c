"""A paper's ledger: its entries, found by place or by words, and shown as a table."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import sympy as sp

from percept_obs.papers.entries import Entry, Known, Verdict
from percept_obs.papers.mathml import shown
from percept_obs.validation import checked, load_pandas

if TYPE_CHECKING:
    import pandas as pd

HEAD = ("equation", "page", "says", "verdict", "note")
WIDTHS = (16, 5, 30, 16, 49)
COLUMNS = ("equation", "page", "says", "print", "verdict", "known", "note")


@checked
@dataclass(frozen=True, eq=False)
class Ledger:
    """All entries of one paper: the numbered equations by number, then what is stated beside them by page.

    Parameters
    ----------
    paper : str
        Authors and year.
    entries : tuple of Entry

    Raises
    ------
    ValueError
        If two entries have the same place.

    See Also
    --------
    find : Ledgers by paper and place.
    Entry : One of its entries.

    Examples
    --------
    >>> from percept_obs.papers import MA2005
    >>> MA2005[4].says
    'perspective dynamics, pinhole'
    >>> [entry.place for entry in MA2005.search("misprint", "P").entries][:2]
    ['(11)', '(13)']
    """

    paper: str
    entries: tuple[Entry, ...]

    def __post_init__(self) -> None:
        if len({entry.place for entry in self.entries}) != len(self.entries):
            raise ValueError(f"two entries of {self.paper} have the same place")
        ordered = sorted(self.entries, key=lambda e: (e.number is None, e.number or 0, int(e.page or 0)))
        object.__setattr__(self, "entries", tuple(ordered))

    def __getitem__(self, place: str | int) -> Entry:
        """The entry at a place: ``"(38)"``, ``"38"``, ``38`` or ``"figure 3"``."""
        for entry in self.entries:
            if entry.named(place):
                return entry
        raise KeyError(f"{self.paper} has no entry {place!r}; it has {', '.join(e.place for e in self.entries)}")

    def search(self, *words: str) -> Ledger:
        """The entries in which all of the words stand, in any column, whatever their case.

        Parameters
        ----------
        *words : str
            Such as ``"misprint"``, ``"seen in runs"`` or ``"chattering"``.
        """

        def told(entry: Entry) -> str:
            texts = (entry.place, entry.section, entry.says, entry.expected, entry.known, entry.note)
            return "; ".join((*texts, *map(str, entry.printed))).casefold()

        found = (entry for entry in self.entries if all(word.casefold() in told(entry) for word in words))
        return replace(self, entries=tuple(found))

    @property
    def table(self) -> pd.DataFrame:
        """A row for each entry, with the verdict that is recorded; `percept-obs check` computes all of them again."""
        pd = load_pandas()  # takes as long to load as an equation to judge
        rows = [(e.place, e.page, e.says, e.printed, str(e.expected), str(e.known), e.note) for e in self.entries]
        return pd.DataFrame(rows, columns=COLUMNS)

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{name}" for name in COLUMNS)
        body = "".join(map(_html_row, self.table.itertuples(index=False, name=None)))
        title = f"{self.paper}: {summary(entry.expected for entry in self.entries)}"
        return f"<table><caption>{shown(title)}</caption><tr>{head}{body}</table>"

    def __str__(self) -> str:
        lines = [self.paper, "", *_row(HEAD), "-" * 120]
        for entry in self.entries:
            lines += _row((entry.place, entry.page, entry.says, entry.verdict, entry.reason))
        return "\n".join((*lines, "-" * 120, self.counts))

    @property
    def counts(self) -> str:
        """Counts of the verdicts, and of the ways in which they are known."""
        found = summary(entry.finding.verdict for entry in self.entries)
        return f"{found}\n{known_how(self.entries)}"


def summary(verdicts: Iterable[Verdict]) -> str:
    """Counts of the verdicts, in one line."""
    counts = Counter(verdicts)
    return ", ".join(f"{counts[verdict]} {verdict}" for verdict in Verdict)


@checked
def page(ledgers: Sequence[Ledger]) -> str:
    """All entries as a page of HTML that needs no network, with a box that leaves those in which a word stands.

    Parameters
    ----------
    ledgers : sequence of Ledger

    Returns
    -------
    str
        The whole page.

    See Also
    --------
    report : As text.

    Examples
    --------
    >>> from percept_obs.papers import find, page
    >>> "<table" in page(find(["(10)"], paper="Ma"))
    True
    """
    entries = "".join(entry._repr_html_() for ledger in ledgers for entry in ledger.entries)
    box = (
        "<label>search <input oninput=\"for (const t of document.querySelectorAll('table')) "
        't.hidden = !t.textContent.toLowerCase().includes(this.value.toLowerCase())"></label>'
    )
    style = "<style>table { margin: 1em 0 } th, caption { text-align: left; vertical-align: top }</style>"
    titles = "".join(f"<p>{shown(f'{each.paper}: {each.counts}')}" for each in ledgers)
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>Equations</title>{style}{titles}<p>{box}{entries}'
    )


def _html_row(cells: Iterable[str | tuple[sp.Basic, ...]]) -> str:
    return "<tr>" + "".join(f"<td>{shown(cell)}" for cell in cells)


def known_how(entries: Iterable[Entry]) -> str:
    """Counts of the ways in which verdicts are known, in one line."""
    counts = Counter(entry.known for entry in entries)
    return ", ".join(f"{counts[known]} {known}" for known in Known)


def _row(cells: Iterable[str]) -> list[str]:
    columns = [textwrap.wrap(cell, width) or [""] for cell, width in zip(cells, WIDTHS, strict=True)]
    height = max(map(len, columns))
    filled = [column + [""] * (height - len(column)) for column in columns]
    return [
        " ".join(part.ljust(width) for part, width in zip(line, WIDTHS, strict=True)).rstrip()
        for line in zip(*filled, strict=True)
    ]
