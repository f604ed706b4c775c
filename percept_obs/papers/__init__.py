"""The papers' equations as they are printed, each with a verdict that is computed."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Iterable

from percept_obs.papers import (
    chwa2019_cases,
    chwa2019_model,
    chwa2019_observer,
    chwa2019_results,
    inaba2005_conditions,
    inaba2005_observer,
    inaba2005_proof,
    inaba2005_theorem,
    ma2005_appendix,
    ma2005_examples,
    ma2005_observability,
    ma2005_observers,
    ma2005_perspective,
    ma2005_proofs,
)
from percept_obs.papers.base import Entry, Finding, Ledger, Verdict

__all__ = ["LEDGERS", "Entry", "Finding", "Ledger", "Verdict", "all_hold", "report"]

MA2005 = Ledger(
    "Ma, Chen and Moore 2005",
    (
        *ma2005_perspective.ENTRIES,
        *ma2005_observers.ENTRIES,
        *ma2005_observability.ENTRIES,
        *ma2005_proofs.ENTRIES,
        *ma2005_appendix.ENTRIES,
        *ma2005_examples.ENTRIES,
    ),
)

INABA2005 = Ledger(
    "Inaba, Abdursul and Ghosh 2005 (pages counted from the first)",
    (
        *inaba2005_observer.ENTRIES,
        *inaba2005_conditions.ENTRIES,
        *inaba2005_proof.ENTRIES,
        *inaba2005_theorem.ENTRIES,
    ),
)

CHWA2019 = Ledger(
    "Chwa 2019 (pages counted from the first)",
    (
        *chwa2019_model.ENTRIES,
        *chwa2019_observer.ENTRIES,
        *chwa2019_cases.ENTRIES,
        *chwa2019_results.ENTRIES,
    ),
)

LEDGERS = (MA2005, INABA2005, CHWA2019)
"""One ledger a paper."""

WIDTHS = (16, 5, 30, 16, 49)


def all_hold() -> bool:
    """Whether every computed verdict is the recorded one; computing them takes a while, which is shown."""
    from tqdm.auto import tqdm

    entries = [entry for ledger in LEDGERS for entry in ledger.entries]
    return all(entry.agrees for entry in tqdm(entries, desc="equations", delay=2, leave=False))


def report() -> str:
    """All entries as a table, with the numbers that verdicts rest on, and a count of verdicts."""
    return "\n\n\n".join(_table(ledger) for ledger in LEDGERS)


def _table(ledger: Ledger) -> str:
    head = ("equation", "page", "says", "verdict", "note")
    lines = [ledger.paper, "", *_row(head), "-" * 120]
    for entry in ledger.entries:
        lines += _row((entry.place, entry.page, entry.says, _verdict(entry), _note(entry)))
    return "\n".join((*lines, "-" * 120, summary(ledger.entries)))


def summary(entries: Iterable[Entry]) -> str:
    """How many entries got which verdict, in one line."""
    counts = Counter(entry.finding.verdict for entry in entries)
    return ", ".join(f"{counts[verdict]} {verdict}" for verdict in Verdict)


def _verdict(entry: Entry) -> str:
    return entry.finding.verdict if entry.agrees else f"{entry.finding.verdict}; recorded: {entry.expected}"


def _note(entry: Entry) -> str:
    numbers = ", ".join(f"{name}: {value:.4g}" for name, value in entry.finding.numbers.items())
    return "; ".join(filter(None, (entry.note, numbers)))


def _row(cells: Iterable[str]) -> list[str]:
    columns = [textwrap.wrap(cell, width) or [""] for cell, width in zip(cells, WIDTHS, strict=True)]
    height = max(map(len, columns))
    filled = [column + [""] * (height - len(column)) for column in columns]
    return [
        " ".join(part.ljust(width) for part, width in zip(line, WIDTHS, strict=True)).rstrip()
        for line in zip(*filled, strict=True)
    ]
