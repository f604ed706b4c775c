"""Where the labs work, and how that is known: one table for the site, for a terminal, and for the tests behind it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

TRIED = {
    "load": "a lab draws, and Python answers where there is one",
    "drag": "the focus of expansion follows the mouse",
    "keys": "it follows the arrow keys, and the page around the lab takes none of them",
    "switch": "an output is dropped, and another observer is chosen",
    "two labs": "two labs in one page do not move each other",
    "kernel gone": "a lab works on after Python has ended, and says so",
}
"""What is tried in each front end."""

BROWSERS = ("Chromium", "Firefox")

POLICY = "default-src 'none'; script-src 'self' blob:; style-src 'unsafe-inline'"
"""The strictest content security policy under which a lab works."""

BY_ANYWIDGET = "by rule 1"
BY_KIND = "by rule 2"
RULES = {
    BY_ANYWIDGET: "The front end shows widgets by anywidget's rules, and the labs keep them: one module that imports "
    "no other, nothing fetched from an address, no text evaluated, state in traits only. The equations become modules "
    "from `blob:`, as the lab itself does in anywidget, so a page that can open a lab can also run it.",
    BY_KIND: "A saved file holds one lab.",
}
"""Why a lab works where nobody has tried it; tests hold what the rules say of the labs."""


@dataclass(frozen=True)
class FrontEnd:
    """A program or a page that shows labs.

    Parameters
    ----------
    name : str
        What it is called.
    get : str
        What installs it; empty for what comes with the package.
    by_rule : mapping of str to str
        Cells of the table that no test fills, and the rule that does.
    browsers : tuple of str
        Those in which a test tries the others.
    """

    name: str
    get: str = ""
    by_rule: Mapping[str, str] = field(default_factory=dict)
    browsers: tuple[str, ...] = BROWSERS

    def cell(self, what: str) -> str:
        """How it is known that the labs can do something here."""
        return self.by_rule.get(what, ", ".join(self.browsers))


FRONT_ENDS = (
    FrontEnd("JupyterLab", "python -m pip install 'percept-obs[lab]'"),
    FrontEnd("Notebook 7", "python -m pip install 'notebook>=7'"),
    FrontEnd("Voila", "python -m pip install voila"),
    FrontEnd("marimo", "python -m pip install marimo"),
    FrontEnd("saved file", by_rule={"two labs": BY_KIND}),
    FrontEnd("this site", browsers=("Chromium",)),
    FrontEnd("VS Code", by_rule=dict.fromkeys(TRIED, BY_ANYWIDGET)),
    FrontEnd("Colab", by_rule=dict.fromkeys(TRIED, BY_ANYWIDGET)),
)


def page() -> str:
    """The table with all that it rests on, as Markdown.

    Examples
    --------
    >>> print(next(line for line in page().splitlines() if "this site" in line))
    | this site | Chromium | Chromium | Chromium | Chromium | Chromium | Chromium |
    """
    return "\n".join(_lines())


def _lines() -> Iterator[str]:
    yield from ("# Where the labs work", "")
    yield "Each cell says how it is known: by a test in a browser, or by a rule."
    yield from ("", _row("", *TRIED), _row(*["---"] * (1 + len(TRIED))))
    yield from (_row(end.name, *map(end.cell, TRIED)) for end in FRONT_ENDS)
    yield from ("", "What is tried:", "")
    yield from (f"- *{name}*: {what}." for name, what in TRIED.items())
    yield from ("", *(f"{rule[3:].capitalize()}. {why}\n" for rule, why in RULES.items()))
    yield f"A page with a content security policy must allow this, and no more: `{POLICY}`."
    yield ""


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"
