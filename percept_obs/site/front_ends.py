"""Table of the front ends in which labs work, and how that is known: for the site, a terminal, and the tests."""

TRIED = {
    "load": "a lab draws, and Python answers where there is one",
    "drag": "the focus of expansion follows the mouse",
    "keys": "it follows the arrow keys, and the page around the lab takes none of them",
    "switch": "an output is dropped, and another observer is chosen",
    "two labs": "two labs in one page do not move each other",
    "kernel gone": "a lab works on after Python has ended, and says so",
}
"""Actions that are tried in each front end."""

BROWSERS = ("Chromium", "Firefox")

POLICY = "default-src 'none'; script-src 'self' blob:; style-src 'unsafe-inline'"
"""The strictest content security policy under which a lab works."""

RULES = {
    "by rule 1": "The front end shows widgets by anywidget's rules, and the labs keep them: one module that imports "
    "no other, nothing fetched from an address, no text evaluated, state in traits only. The equations become modules "
    "from `blob:`, as the lab itself does in anywidget, so a page that can open a lab can also run it.",
    "by rule 2": "A saved file holds one lab.",
}
"""Rules by which a lab works where nobody has tried it; tests hold what they say of the labs."""

INSTALL = {
    "JupyterLab": 'python -m pip install "percept-obs[course]"',
    "Notebook 7": 'python -m pip install "notebook>=7"',
    "Voila": "python -m pip install voila",
    "marimo": "python -m pip install marimo",
}
"""Commands that install the front ends."""

_IN_BROWSERS = dict.fromkeys(TRIED, ", ".join(BROWSERS))
FRONT_ENDS = {
    **dict.fromkeys(INSTALL, _IN_BROWSERS),
    "saved file": _IN_BROWSERS | {"two labs": "by rule 2"},
    "this site": dict.fromkeys(TRIED, "Chromium"),
    **{name: dict.fromkeys(TRIED, "by rule 1") for name in ("JupyterLite", "VS Code", "Colab")},
}
"""For each front end, how each of `TRIED` is known to work: by a test in browsers, or by a rule."""


def page() -> str:
    """Return the table and its explanation as Markdown.

    >>> print(next(line for line in page().splitlines() if "this site" in line))
    | this site | a program | Chromium | Chromium | Chromium | Chromium | Chromium | Chromium |
    """
    untried = [name for name, cells in FRONT_ENDS.items() if {*cells.values()} <= {*RULES}]
    rows = ((name, "nobody" if name in untried else "a program", *cells.values()) for name, cells in FRONT_ENDS.items())
    table = [("front end", "tried by", *TRIED), ["---"] * (2 + len(TRIED)), *rows]
    lines = [
        *("# Where the labs work", ""),
        f"A program tries the labs in browsers, as a hand would; nobody has tried them in {', '.join(untried)}. There "
        "a rule says why they should work. If you try one, tell us what you saw.\n",
        *(f"| {' | '.join(row)} |" for row in table),
        *("", "What is tried:", ""),
        *(f"- *{name}*: {action}." for name, action in TRIED.items()),
        *("", *(f"{rule[3:].capitalize()}. {why}\n" for rule, why in RULES.items())),
        f"A page with a content security policy must allow this, and no more: `{POLICY}`.\n",
    ]
    return "\n".join(lines)
