"""Pages that follow from the package itself: the ledgers, an equation each, and the public names."""

from __future__ import annotations

import inspect
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from importlib import import_module
from types import ModuleType

from percept_obs.papers import Entry, Ledger, Verdict, judge
from percept_obs.papers.mathml import shown

Pages = Iterator[tuple[str, str]]
"""Paths below the site's source, and what stands there."""

MODULES = (
    "percept_obs",
    "percept_obs.labs",
    "percept_obs.figures",
    "percept_obs.observers",
    "percept_obs.points",
    "percept_obs.structure",
    "percept_obs.observability",
    "percept_obs.recording",
    "percept_obs.recording.scenarios",
    "percept_obs.papers",
)
"""Modules whose public names have pages."""

NOT_IN_CONTENTS = "---\norphan: true\n---"
"""Begins a page that the contents beside every page leave out."""

MARK = {
    Verdict.HOLDS: "✓",
    Verdict.MISPRINT: "✎",
    Verdict.FALSE: "✗",
    Verdict.DEPENDS: "?",
    Verdict.NOT_CHECKABLE: "·",
}


def contents(title: str, intro: str, entries: Iterable[str]) -> str:
    """A page that leads to others."""
    return "\n".join([f"# {title}", "", intro, "", "```{toctree}", ":maxdepth: 1", "", *entries, "```", ""])


def ledger_pages(ledgers: Mapping[str, Ledger]) -> Pages:
    """The papers: a page a ledger, a page an equation."""
    judge(tuple(ledgers.values()))
    intro = "What the papers print, equation by equation, and what a computation says of it."
    yield "ledger/index.md", contents("The papers, equation by equation", intro, [f"{slug(n)}/index" for n in ledgers])
    for name, ledger in ledgers.items():
        yield from _ledger(name, ledger)


def slug(text: str) -> str:
    """A text as a part of an address.

    Examples
    --------
    >>> slug("Theorem 3.4 (ii)")
    'theorem-3-4-ii'
    """
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")


def ledger_addresses(ledger: Ledger) -> dict[str, str]:
    """The name of each entry's page by its place; places that differ in signs only are numbered."""
    counted: Counter[str] = Counter()
    names = {}
    for entry in ledger.entries:
        plain = slug(entry.place)
        counted[plain] += 1
        names[entry.place] = plain if counted[plain] == 1 else f"{plain}-{counted[plain]}"
    return names


def _ledger(name: str, ledger: Ledger) -> Pages:
    names = ledger_addresses(ledger)
    rows = "".join(
        f'<tr><td><a href="{names[e.place]}.html">{shown(e.place)}</a><td>{e.page}<td>{shown(e.says)}'
        f"<td>{MARK[e.expected]} {e.expected}<td>{e.known}"
        for e in ledger.entries
    )
    head = "".join(f'<th scope="col">{column}' for column in ("place", "page", "says", "verdict", "known"))
    table = f'```{{raw}} html\n<table class="ledger"><thead><tr>{head}</thead><tbody>{rows}</table>\n```'
    yield f"ledger/{slug(name)}/index.md", f"# {ledger.paper}\n\n{table}\n"
    addresses = ["index", *names.values(), "index"]
    for entry, before, after in zip(ledger.entries, addresses, addresses[2:], strict=False):
        yield f"ledger/{slug(name)}/{names[entry.place]}.md", _entry(name, ledger, entry, before, after)


def _entry(name: str, ledger: Ledger, entry: Entry, before: str, after: str) -> str:
    rows = "".join(f'<tr><th scope="row">{title}<td>{shown(part)}' for title, part in entry.parts.items() if part)
    table = f'```{{raw}} html\n<table class="entry">{rows}</table>\n```'
    code = f"```python\nfrom percept_obs.papers import {name}\n\n{name}[{entry.place!r}]\n```"
    ways = f"[before]({before}.md) · [all of {ledger.paper}](index.md) · [next]({after}.md)"
    return "\n\n".join([NOT_IN_CONTENTS, f"# {entry.place}: {entry.says}", table, code, ways, ""])


def reference() -> Pages:
    """The public names: a page a module."""
    intro = "All public names, by module. Every example is run by the package's tests."
    yield "reference/index.md", contents("Reference", intro, [slug(name) for name in MODULES])
    for name, values in public().items():
        text = inspect.getdoc(import_module(name)) or ""
        lines = [name, "=" * len(name), "", text, "", f".. currentmodule:: {name}", ""]
        for names, value in values:
            lines += _described(names, value)
        yield f"reference/{slug(name)}.rst", "\n".join(lines)


def public() -> dict[str, list[tuple[list[str], object]]]:
    """Public values by the first module that has them, each with its names, the longest first."""
    found: dict[str, list[tuple[list[str], object]]] = {}
    seen: set[int] = set()
    for name in MODULES:
        found[name] = [(names, value) for names, value in _named(import_module(name)) if id(value) not in seen]
        seen |= {id(value) for _, value in found[name]}
    return found


def _named(module: ModuleType) -> list[tuple[list[str], object]]:
    names: dict[int, list[str]] = {}
    for name in getattr(module, "__all__", [name for name in vars(module) if not name.startswith("_")]):
        value = getattr(module, name)
        if getattr(value, "__module__", "").startswith("percept_obs"):
            names.setdefault(id(value), []).append(name)
    ordered = [sorted(same, key=len, reverse=True) for same in names.values()]
    return [(same, getattr(module, same[0])) for same in ordered]


def _described(names: list[str], value: object) -> list[str]:
    name, *short = names
    title = f"{name} ({', '.join(short)})" if short else name
    kind = "autoclass" if inspect.isclass(value) else "autofunction" if callable(value) else "autodata"
    return [title, "-" * len(title), "", f".. {kind}:: {name}", *["   :members:"] * inspect.isclass(value), ""]
