"""The papers' equations as they are printed, each with a verdict that is computed.

Examples
--------
>>> from percept_obs.papers import MA2005
>>> print(MA2005[38].expected, "/", MA2005[38].known)
misprint / derived
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from difflib import get_close_matches

from percept_obs.papers import (
    chwa2019_cases,
    chwa2019_model,
    chwa2019_observer,
    chwa2019_results,
    chwa2019_statements,
    inaba2005_bounds,
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
from percept_obs.papers.entries import Entry, Finding, Known, Verdict
from percept_obs.papers.ledger import Ledger, page

__all__ = ["LEDGERS", "Entry", "Finding", "Known", "Ledger", "Verdict", "find", "judge", "page", "report"]

PAPERS = {
    "Ma, Chen and Moore 2005": (
        (ma2005_perspective, ma2005_observers, ma2005_appendix),
        (ma2005_observability, ma2005_proofs, ma2005_examples),
    ),
    "Inaba, Abdursul and Ghosh 2005 (pages counted from the first)": (
        (inaba2005_theorem, inaba2005_bounds),
        (inaba2005_observer, inaba2005_conditions, inaba2005_proof),
    ),
    "Chwa 2019 (pages counted from the first)": (
        (chwa2019_results, chwa2019_statements),
        (chwa2019_model, chwa2019_observer, chwa2019_cases),
    ),
}
"""The modules of each paper, in groups that share what they run."""

LEDGERS = tuple(
    Ledger(paper, tuple(entry for group in groups for module in group for entry in module.ENTRIES))
    for paper, groups in PAPERS.items()
)
"""One ledger a paper."""

MA2005, INABA2005, CHWA2019 = LEDGERS
GROUPS = [[entry for module in group for entry in module.ENTRIES] for groups in PAPERS.values() for group in groups]
FEW = 20


def find(places: Sequence[str | int] = (), paper: str = "") -> tuple[Ledger, ...]:
    """The ledgers of papers, or those of their entries that are asked for.

    Parameters
    ----------
    places : sequence of str or int, optional
        Such as ``"(38)"``, ``38`` or ``"figure 3"``; all, when left out.
    paper : str
        A part of the authors' names or of the year; all papers, when left out.

    Raises
    ------
    ValueError
        If there is no such paper or no such entry; it says which there are.
    """
    ledgers = [ledger for ledger in LEDGERS if paper.casefold() in ledger.paper.casefold()]
    if not ledgers:
        raise ValueError(f"no paper is called {paper!r}; there are {'; '.join(each.paper for each in LEDGERS)}")
    entries = [entry for ledger in ledgers for entry in ledger.entries]
    for place in places:
        if not any(entry.named(place) for entry in entries):
            near = get_close_matches(str(place), [entry.place for entry in entries], 5, 0.3)
            raise ValueError(f"there is no {place!r}; near to it are {', '.join(near) or 'none'}; name one as printed")
    if not places:
        return tuple(ledgers)
    parts = (
        replace(ledger, entries=tuple(entry for entry in ledger.entries if any(map(entry.named, places))))
        for ledger in ledgers
    )
    return tuple(part for part in parts if part.entries)


def judge(ledgers: Sequence[Ledger] = LEDGERS, processes: int | None = None) -> bool:
    """Compute verdicts, and tell whether all are the recorded ones.

    It takes a while, which is shown.  What is found stays in the entries.

    Parameters
    ----------
    ledgers : sequence of Ledger
        All of them, when left out.
    processes : int, optional
        As many as there are cores, when left out; `FEW` entries are judged in this one.
    """
    from tqdm.auto import tqdm

    wanted = [entry for ledger in ledgers for entry in ledger.entries]
    if len(wanted) > FEW and (processes or os.cpu_count() or 1) > 1:
        asked = set(wanted)
        tasks = [(g, [k for k, entry in enumerate(group) if entry in asked]) for g, group in enumerate(GROUPS)]
        with ProcessPoolExecutor(processes) as pool:
            results = tqdm(pool.map(_found, tasks), "parts", len(tasks), delay=2, leave=False)
            for (g, numbers), found in zip(tasks, results, strict=True):
                for k, values in zip(numbers, found, strict=True):
                    vars(GROUPS[g][k]).update(values)  # where cached properties keep what they found
    return all([entry.agrees for entry in tqdm(wanted, "equations", delay=2, leave=False)])


def _found(task: tuple[int, list[int]]) -> list[dict[str, object]]:
    """What cached properties of some entries of a group find."""
    g, numbers = task
    return [{"agrees": GROUPS[g][k].agrees, "finding": GROUPS[g][k].finding} for k in numbers]


def report(ledgers: Sequence[Ledger] = LEDGERS) -> str:
    """All entries as tables, with the numbers that verdicts rest on, and how many verdicts are known in which way."""
    return "\n\n\n".join(map(str, ledgers))
