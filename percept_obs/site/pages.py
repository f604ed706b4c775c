"""Pages made from the package: the ledgers, an equation each, and the reference of the public names."""

from __future__ import annotations

import inspect
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from importlib import import_module

from percept_obs.papers import NAMED, Entry, Ledger, Verdict, judge
from percept_obs.papers.mathml import shown

Pages = Iterator[tuple[str, str]]
"""Paths below the site's source, and their texts."""

FOLDERS = {
    "labs": "",
    "film": "",
    "figures": "",
    "observers": "family gains parts integral_sliding_mode",
    "points": "gramian ray scenarios utias",
    "structure": "competitors pixels scenarios",
    "observability": "",
    "tracking": "",
    "studies": "all_observers chatter comparison consistency diagnosis fields least_squares sensitivity "
    "servoing tuning",
    "system": "bearings derivation inertial state_view",
    "recording": "camera_files colmap imu poses pose_files scenarios state_scenario stereo_mat track_files utias "
    "worked",
    "checking": "",
    "exercises": "",
    "papers": "",
}
"""Folders with public names, and modules in them whose names the folder does not gather."""
MODULES = (
    "percept_obs",
    *(
        f"percept_obs.{folder}{module}"
        for folder, names in FOLDERS.items()
        for module in ("", *[f".{m}" for m in names.split()])
    ),
)
"""Modules whose public names have pages: those of `__all__`, or else all that are defined in the module or below."""

NOT_IN_CONTENTS = "---\norphan: true\n---"
"""Header of a page that is left out of the table of contents."""

MARK = {
    Verdict.HOLDS: "✓",
    Verdict.MISPRINT: "✎",
    Verdict.FALSE: "✗",
    Verdict.DEPENDS: "?",
    Verdict.NOT_CHECKABLE: "·",
}


def contents(title: str, intro: str, entries: Iterable[str]) -> str:
    """Return a page that leads to others."""
    return "\n".join([f"# {title}", "", intro, "", "```{toctree}", ":maxdepth: 1", "", *entries, "```", ""])


def ledger_pages(judged: Collection[str]) -> Pages:
    """Yield a page for each ledger and for each of its equations; of those not judged, what is recorded."""
    if judged:
        judge(tuple(NAMED[name] for name in judged))
    intro = f"What the papers print, equation by equation, and what a computation says of it.\n\n{verdicts()}"
    yield "ledger/index.md", contents("The papers, equation by equation", intro, [f"{slug(n)}/index" for n in NAMED])
    for name, ledger in NAMED.items():
        yield from _ledger(name, ledger, name in judged)


def verdicts() -> str:
    """Return a table of how many equations of each paper hold, and of all."""
    counted = {
        ledger.paper.partition(" (")[0]: Counter(entry.expected for entry in ledger.entries)
        for ledger in NAMED.values()
    }
    counted["**all**"] = sum(counted.values(), Counter[Verdict]())
    head = ["paper", *(f"{mark} {verdict}" for verdict, mark in MARK.items()), "equations"]
    rows = [(paper, *(found[verdict] or "" for verdict in MARK), found.total()) for paper, found in counted.items()]
    table = (head, ["---", *["--:"] * (len(head) - 1)], *rows)
    return "\n".join(f"| {' | '.join(map(str, row))} |" for row in table)


def slug(text: str) -> str:
    """Return a text as a part of an address.

    >>> slug("Theorem 3.4 (ii)")
    'theorem-3-4-ii'
    """
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")


def ledger_addresses(ledger: Ledger) -> dict[str, str]:
    """Return the name of each entry's page by its place; places that differ in signs only are numbered."""
    counted: Counter[str] = Counter()
    names = {}
    for entry in ledger.entries:
        plain = slug(entry.place)
        counted[plain] += 1
        names[entry.place] = plain if counted[plain] == 1 else f"{plain}-{counted[plain]}"
    return names


def _ledger(name: str, ledger: Ledger, judged: bool) -> Pages:
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
        yield f"ledger/{slug(name)}/{names[entry.place]}.md", _entry(name, ledger, entry, judged, before, after)


def _entry(name: str, ledger: Ledger, entry: Entry, judged: bool, before: str, after: str) -> str:
    recorded = ("print", entry.printed), ("recorded, not computed here", str(entry.expected))
    parts = entry.parts.items() if judged else recorded
    rows = "".join(f'<tr><th scope="row">{title}<td>{shown(part)}' for title, part in parts if part)
    table = f'```{{raw}} html\n<table class="entry">{rows}</table>\n```'
    code = f"```python\nfrom percept_obs.papers import {name}\n\n{name}[{entry.place!r}]\n```"
    ways = f"[before]({before}.md) · [all of {ledger.paper}](index.md) · [next]({after}.md)"
    return "\n\n".join([NOT_IN_CONTENTS, f"# {entry.place}: {entry.says}", table, code, ways, ""])


def reference() -> Pages:
    """Yield a page of the public names of each module."""
    intro = "All public names, by module. Every example is run by the package's tests."
    yield "reference/index.md", contents("Reference", intro, [slug(name) for name in public()])
    for name, values in public().items():
        text = inspect.getdoc(import_module(name)) or ""
        lines = [name, "=" * len(name), "", text, "", f".. currentmodule:: {name}", ""]
        for (longest, *short), value in values:
            title = f"{longest} ({', '.join(short)})" if short else longest
            kind = "autoclass" if inspect.isclass(value) else "autofunction" if callable(value) else "autodata"
            members = ["   :members:"] if inspect.isclass(value) else []
            lines += [title, "-" * len(title), "", f".. {kind}:: {longest}", *members, ""]
        yield f"reference/{slug(name)}.rst", "\n".join(lines)


def public() -> dict[str, list[tuple[list[str], object]]]:
    """Return public values by the first module that has them, each with its names, the longest first."""
    found: dict[str, list[tuple[list[str], object]]] = {}
    seen: set[int] = set()
    for module in MODULES:
        names: dict[int, list[str]] = {}
        imported = import_module(module)
        own = [
            name
            for name, value in vars(imported).items()
            if name[0] != "_" and getattr(value, "__module__", "").startswith(module)
        ]
        values = {name: getattr(imported, name) for name in getattr(imported, "__all__", own)}
        for name, value in values.items():
            if getattr(value, "__module__", "").startswith("percept_obs") and id(value) not in seen:
                names.setdefault(id(value), []).append(name)
        seen |= names.keys()
        ordered = [sorted(same, key=len, reverse=True) for same in names.values()]
        if ordered:
            found[module] = [(same, values[same[0]]) for same in ordered]
    return found
