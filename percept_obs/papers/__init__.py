"""The papers' equations as they are printed, each with a verdict that is computed.

A paper is a module with its name, ``PAPER``, and its entries in ``PARTS`` that share what they run.  Its ledger has
the module's name in capitals.

Examples
--------
>>> from percept_obs.papers import MA2005
>>> print(MA2005[38].expected, "/", MA2005[38].known)
misprint / derived
"""

from __future__ import annotations

import copyreg
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from difflib import get_close_matches
from importlib import import_module
from itertools import chain
from multiprocessing import active_children
from pkgutil import iter_modules
from signal import SIG_IGN, SIGINT, signal

from percept_obs.papers.entries import Entry, Finding, Known, Verdict
from percept_obs.papers.ledger import Ledger, page
from percept_obs.validation import bar, checked, positive, workers

__all__ = ["LEDGERS", "Entry", "Finding", "Known", "Ledger", "Verdict", "find", "judge", "page", "report"]

_MODULES = [import_module(f"{__name__}.{module.name}") for module in iter_modules(__path__)]
_PAPERS = {module.__name__.split(".")[-1]: module for module in _MODULES if hasattr(module, "PAPER")}
NAMED = {name.upper(): Ledger(paper.PAPER, tuple(chain(*paper.PARTS))) for name, paper in _PAPERS.items()}
"""Each ledger by the name under which it is imported."""

LEDGERS = tuple(ledger for _, ledger in sorted(NAMED.items(), key=lambda named: named[0][-4:]))
"""One ledger a paper, the oldest first."""

_PLACES = {entry: (ledger.paper, entry.place) for ledger in LEDGERS for entry in ledger.entries}
copyreg.pickle(Entry, lambda entry: (_entry, _PLACES[entry]) if entry in _PLACES else entry.__reduce_ex__(2))

FEW = 20


def _entry(paper: str, place: str) -> Entry:
    """Return an entry of ours, which travels as its place: what checks it is no value."""
    return next(entry for entry, known in _PLACES.items() if known == (paper, place))


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
    places : sequence of str or int, optional
        Such as ``"(38)"``, ``38`` or ``"figure 3"``; all, when left out.
    paper : str
        A part of the authors' names or of the year; all papers, when left out.

    Returns
    -------
    tuple of Ledger
        The oldest paper first; those without such an entry are left out.

    Raises
    ------
    ValueError
        If there is no such paper or no such entry; it says which there are.

    See Also
    --------
    judge : Computes their verdicts.
    report, page : Show them.

    Examples
    --------
    >>> from percept_obs.papers import find
    >>> (ledger,) = find(["(38)"], paper="Ma")
    >>> ledger.paper, [entry.place for entry in ledger.entries]
    ('Ma, Chen and Moore 2005', ['(38)'])
    """
    called = {ledger: f"{name} {ledger.paper}".casefold() for name, ledger in NAMED.items()}
    ledgers = [ledger for ledger in LEDGERS if paper.casefold() in called[ledger]]
    if not ledgers:
        raise ValueError(f"no paper is called {paper!r}; there are {'; '.join(each.paper for each in LEDGERS)}")
    entries = [entry for ledger in ledgers for entry in ledger.entries]
    for place in places:
        if not any(entry.named(place) for entry in entries):
            near = get_close_matches(str(place), {entry.place: None for entry in entries}, 5, 0.3)
            raise ValueError(f"there is no {place!r}; near to it are {', '.join(near) or 'none'}; name one as printed")
    if not places:
        return tuple(ledgers)
    parts = (
        replace(ledger, entries=tuple(entry for entry in ledger.entries if any(map(entry.named, places))))
        for ledger in ledgers
    )
    return tuple(part for part in parts if part.entries)


@checked
def judge(ledgers: Sequence[Ledger] = LEDGERS, processes: int | None = None) -> bool:
    """Compute verdicts, and tell whether all are the recorded ones.

    It takes a while, which is shown.  What is found stays in the entries.

    Parameters
    ----------
    ledgers : sequence of Ledger
        All of them, when left out.
    processes : int, optional
        As many as there are cores, when left out; `FEW` entries are judged in this one.

    Returns
    -------
    bool
        True if every verdict is the recorded one.

    Raises
    ------
    ValueError
        If there is no entry to judge, or `processes` is not positive.

    See Also
    --------
    find : Chooses ledgers.
    report : Tells what was found.

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
        asked = set(wanted)
        parts = [[entry for entry in part if entry in asked] for paper in _PAPERS.values() for part in paper.PARTS]
        others = {*active_children()}
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
    ledgers : sequence of Ledger
        All of them, when left out.

    Returns
    -------
    str
        The ledgers one below the other.

    See Also
    --------
    page : As HTML.

    Examples
    --------
    >>> from percept_obs.papers import find, report
    >>> print(report(find(["(10)"], paper="Ma")).splitlines()[0])
    Ma, Chen and Moore 2005
    """
    return "\n\n\n".join(map(str, ledgers))
