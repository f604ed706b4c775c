"""A paper's ledger: its entries, found by place or by words, and shown as a table."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

from percept_obs.papers.entries import Entry, Known, Verdict
from percept_obs.papers.letters import Letters
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
    paper, entries

    Raises
    ------
    ValueError
        If two entries have the same place.

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

    @classmethod
    def read(cls, text: str, computations: Mapping[str, Callable[..., Any]]) -> Ledger:
        """The ledger that a text says: the paper, its parts with their letters, and the entries of each.

        `CONTRIBUTING.md` says how it is written.  Computations are what prints are compared with, by their names in it.
        """
        paper, found = "", []
        part: dict[str, list[str]] = {}
        entry: dict[str, Any] = {}
        for number, line in enumerate(text.splitlines(), 1):
            try:
                if line.startswith("# "):
                    paper = line[2:]
                elif line.startswith("## "):
                    part, entry = {"declared": [], "terms": []}, {}
                elif line.startswith("### "):
                    place, stands, says = line[4:].split(" | ", 2)
                    page, section = stands.split(", ")
                    letters = Letters(**{kind: tuple(lines) for kind, lines in part.items()})
                    entry = {"place": place, "page": page, "section": section, "says": says, "letters": letters}
                    found.append(entry)
                elif line.strip() and entry:
                    _read(entry, line)
                elif line.strip() and part:
                    part["terms" if line.startswith("    ") else "declared"].append(line.strip())
            except ValueError as error:
                like = '"### (7) | 3, II | what it says" or "= rates | misprint, derived | note"'
                raise ValueError(f"line {number} of the ledger, {line!r}, is not {like}: {error}") from None
        others: dict[str, Entry] = {}
        entries = [Entry(**each, computations=computations, others=others) for each in found]
        others |= {each.place: each for each in entries}
        return cls(paper, tuple(entries))

    def __getitem__(self, place: str | int) -> Entry:
        """The entry at a place: ``"(38)"``, ``"38"``, ``38`` or ``"figure 3"``."""
        for entry in filter(lambda entry: entry.named(place), self.entries):
            return entry
        raise KeyError(f"{self.paper} has no entry {place!r}; it has {', '.join(e.place for e in self.entries)}")

    def search(self, *words: str) -> Ledger:
        """The entries in which all of the words stand, in any column, whatever their case.

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
        cells = ("".join(f"<td>{shown(cell)}" for cell in row) for row in self.table.itertuples(index=False, name=None))
        title = f"{self.paper}: {counted(Verdict, (entry.expected for entry in self.entries))}"
        return f"<table><caption>{shown(title)}</caption><tr>{head}<tr>{'<tr>'.join(cells)}</table>"

    def __str__(self) -> str:
        lines = [self.paper, "", *_row(HEAD), "-" * 120]
        for entry in self.entries:
            lines += _row((entry.place, entry.page, entry.says, entry.verdict, entry.reason))
        return "\n".join((*lines, "-" * 120, self.counts))

    @property
    def counts(self) -> str:
        """Counts of the verdicts, and of the ways in which they are known."""
        verdicts, ways = ((e.finding.verdict for e in self.entries), (e.known for e in self.entries))
        return f"{counted(Verdict, verdicts)}\n{counted(Known, ways)}"


def _read(entry: dict[str, Any], line: str) -> None:
    """Add a line to an entry: a formula or what belongs to it, or what it is compared with, verdict and note."""
    word, _, rest = line.strip().partition(" ")
    last = next(reversed(entry))
    if line.startswith("    "):
        if word == "drops":
            entry["drops"] = {**entry.get("drops", {}), len(entry["typed"]) - 1: rest}
        elif word in ("asks", "given"):
            entry |= {"asked": rest} if word == "asks" else {"given": tuple(rest.split("; "))}
        else:
            kind = "mends" if " -> " in line else "typed"
            entry[kind] = (*entry.get(kind, ()), line.strip())
    elif word == "numbers:":
        entry["numbers"] = rest
    elif last in ("note", "numbers"):  # which may go on over several lines
        entry[last] += f" {line}"
    else:
        compared, verdict, note = (*line.split(" | ", 2), "", "")[:3]
        verdict, _, known = verdict.partition(", ")
        entry |= {"compared": "" if compared == "nothing" else compared, "expected": Verdict(verdict or "holds")}
        entry |= {"known": Known(known or "derived"), "note": note}


def counted(kinds: Iterable[StrEnum], found: Iterable[StrEnum]) -> str:
    """How many there are of each kind, in one line."""
    counts = Counter(found)
    return ", ".join(f"{counts[kind]} {kind}" for kind in kinds)


@checked
def page(ledgers: Sequence[Ledger]) -> str:
    """All entries as a page of HTML that needs no network, with a box that leaves those in which a word stands.

    Parameters
    ----------
    ledgers

    Returns
    -------
    The whole page.

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


def _row(cells: Iterable[str]) -> list[str]:
    columns = (textwrap.wrap(cell, width) or [""] for cell, width in zip(cells, WIDTHS, strict=True))
    return [" ".join(map(str.ljust, line, WIDTHS)).rstrip() for line in zip_longest(*columns, fillvalue="")]
