"""The papers' equations as they are printed, each with a verdict that is computed.

A paper is a text, ``ma2005.md``, and a module ``ma2005.py`` with the functions that it names.  Its ledger has the name
of the text in capitals.

Examples
--------
>>> from percept_obs.papers import MA2005
>>> print(MA2005[38].expected, "/", MA2005[38].known)
misprint / derived
"""

from __future__ import annotations

import copyreg
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from difflib import get_close_matches
from importlib import import_module
from itertools import chain
from multiprocessing import active_children
from pathlib import Path
from signal import SIG_IGN, SIGINT, signal
from typing import Any

from percept_obs.papers.entries import Entry, Finding, Known, Verdict
from percept_obs.papers.ledger import Ledger, page
from percept_obs.validation import bar, checked, positive, workers

__all__ = ["LEDGERS", "Entry", "Finding", "Known", "Ledger", "Verdict", "find", "judge", "page", "report"]


class _Computations(dict[str, Callable[..., Any]]):
    """Functions of a paper's module by their names, imported when one is wanted."""

    def __init__(self, paper: str) -> None:
        super().__init__()
        self.module = f"{__name__}.{paper}"

    def __missing__(self, name: str) -> Callable[..., Any]:
        found = vars(import_module(self.module)).get(name)
        if found is None or found.__module__ != self.module:
            raise KeyError(name)
        return self.setdefault(name, found)


_TEXTS = sorted(Path(__file__).parent.glob("*.md"))
NAMED = {path.stem.upper(): Ledger.read(path.read_text("utf-8"), _Computations(path.stem)) for path in _TEXTS}
"""Each ledger by the name under which it is imported."""

LEDGERS = tuple(ledger for _, ledger in sorted(NAMED.items(), key=lambda named: named[0][-4:]))
"""One ledger a paper, the oldest first."""

# What checks an entry is no value, so that those of ours travel as their places.
_PLACES = {entry: (name, entry.place) for name, ledger in NAMED.items() for entry in ledger.entries}
copyreg.pickle(Entry, lambda entry: (_entry, _PLACES[entry]) if entry in _PLACES else entry.__reduce_ex__(2))

FEW = 20


def _entry(name: str, place: str) -> Entry:
    return NAMED[name][place]


def __getattr__(name: str) -> Ledger:
    """The ledger of a paper, such as ``MA2005``."""
    if name in NAMED:
        return NAMED[name]
    raise AttributeError(f"there is no {name!r} among the papers; there are {', '.join(NAMED)}")


@checked
def find(places: Sequence[str | int] = (), paper: str = "") -> tuple[Ledger, ...]:
    """The ledgers of papers, or those of their entries that are asked for.

    Parameters
    ----------
    places
        Such as ``"(38)"``, ``38`` or ``"figure 3"``; all, when left out.
    paper
        A part of the authors' names or of the year; all papers, when left out.

    Returns
    -------
    The oldest paper first; those without such an entry are left out.

    Raises
    ------
    ValueError
        If there is no such paper or no such entry; it says which there are.

    Examples
    --------
    >>> from percept_obs.papers import find
    >>> (ledger,) = find(["(38)"], paper="Ma")
    >>> ledger.paper, [entry.place for entry in ledger.entries]
    ('Ma, Chen and Moore 2005', ['(38)'])
    """
    called = {ledger: f"{name} {ledger.paper}".casefold() for name, ledger in NAMED.items()}
    ledgers = tuple(ledger for ledger in LEDGERS if paper.casefold() in called[ledger])
    if not ledgers:
        raise ValueError(f"no paper is called {paper!r}; there are {'; '.join(each.paper for each in LEDGERS)}")
    entries = [entry for ledger in ledgers for entry in ledger.entries]
    for place in places:
        if not any(entry.named(place) for entry in entries):
            near = get_close_matches(str(place), {entry.place: None for entry in entries}, 5, 0.3)
            raise ValueError(f"there is no {place!r}; near to it are {', '.join(near) or 'none'}; name one as printed")
    if not places:
        return ledgers
    wanted = {ledger: tuple(e for e in ledger.entries if any(map(e.named, places))) for ledger in ledgers}
    return tuple(replace(ledger, entries=entries) for ledger, entries in wanted.items() if entries)


@checked
def judge(ledgers: Sequence[Ledger] = LEDGERS, processes: int | None = None) -> bool:
    """Compute verdicts, and tell whether all are the recorded ones.

    It takes a while, which is shown.  What is found stays in the entries.

    Parameters
    ----------
    ledgers
        All of them, when left out.
    processes
        As many as there are cores, when left out; `FEW` entries are judged in this one.

    Returns
    -------
    True if every verdict is the recorded one.

    Raises
    ------
    ValueError
        If there is no entry to judge, or `processes` is not positive.

    Examples
    --------
    >>> from percept_obs.papers import find, judge
    >>> judge(find(["(10)"], paper="Ma"), processes=1)
    True
    """
    positive(processes=1 if processes is None else processes)
    wanted = [entry for ledger in ledgers for entry in ledger.entries]
    if not wanted:
        raise ValueError("there is no entry to judge; find(places) gives ledgers that have some")
    if len(wanted) > FEW and (processes or workers()) > 1:
        shares: dict[object, list[Entry]] = {}  # of a part of a paper, whose letters and runs are the same
        for entry in filter(_PLACES.__contains__, wanted):
            shares.setdefault(entry.letters, []).append(entry)
        parts, others = list(shares.values()), {*active_children()}
        with ProcessPoolExecutor(processes, initializer=signal, initargs=(SIGINT, SIG_IGN)) as pool:
            try:
                results = bar(pool.map(_found, parts), "parts", len(parts))
                for entry, values in zip(chain(*parts), chain.from_iterable(results), strict=True):
                    vars(entry).update(values)  # where cached properties keep what they found
            except BaseException:  # an interrupt ends the work of the others as well
                for process in {*active_children()} - others:
                    process.terminate()
                raise
    return all([entry.agrees for entry in bar(wanted, "equations")])


def _found(entries: Sequence[Entry]) -> list[dict[str, object]]:
    """Results of cached properties of entries that share what they run."""
    return [{"agrees": entry.agrees, "finding": entry.finding} for entry in entries]


@checked
def report(ledgers: Sequence[Ledger] = LEDGERS) -> str:
    """All entries as tables, with the numbers that verdicts rest on, and how many verdicts are known in which way.

    Parameters
    ----------
    ledgers
        All of them, when left out.

    Returns
    -------
    The ledgers one below the other.

    Examples
    --------
    >>> from percept_obs.papers import find, report
    >>> print(report(find(["(10)"], paper="Ma")).splitlines()[0])
    Ma, Chen and Moore 2005
    """
    return "\n\n\n".join(map(str, ledgers))
