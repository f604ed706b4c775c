"""The site's first page: the article, three doors, and what nobody else shows."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from html import escape
from importlib import metadata
from typing import Any

from percept_obs.labs.observer.lab import ObserverLab
from percept_obs.labs.shared.printed import FRONT
from percept_obs.labs.shared.saved import place_of
from percept_obs.papers import LEDGERS, Verdict
from percept_obs.site.article import ARTICLE, scenes
from percept_obs.site.pages import slug

STEPS = {
    "See it, derive it": ("00", "01", "08"),
    "Observe": ("02", "03", "04"),
    "Go further": ("05", "06", "07", "10", "15", "16", "17"),
    "Doubt": ("09", "11", "12", "13", "14"),
}
"""Steps of the course, each with its notebooks."""

LEARN = {
    "tour.html": "A tour of the package",
    "gallery.html": "Gallery",
    "own.html": "Your own recording",
}
TEACH = {
    "guide.html#lesson-plans": "Lesson plans: 45 and 90 minutes, eight weeks, and one with films",
    "guide.html#what-students-often-get-wrong": "What students often get wrong",
    "guide.html": "The teacher's guide",
}
LOOK_UP = {
    "ledger/index.html": "The papers, equation by equation",
    "observers.html": "The observers",
    "use_labs.html": "How to use the labs",
    "labs.html": "What the labs compute",
    "reference/index.html": "Reference: all public names",
    "sources.html": "Sources, data, and other packages",
}

NAMES = {
    Verdict.HOLDS: "hold",
    Verdict.MISPRINT: "misprints",
    Verdict.FALSE: "false as stated",
    Verdict.DEPENDS: "depend",
    Verdict.NOT_CHECKABLE: "cannot be checked",
}

INSTALL = 'python3 -m venv .venv && .venv/bin/python -m pip install -e ".[course]" && .venv/bin/percept-obs lab'
CITE = (
    "The percept_obs authors: <cite>percept_obs: observers for perspective dynamic systems</cite>, version "
    f"{metadata.version('percept_obs')}. CITATION.cff has it for programs that keep references, with the papers."
)

PAGES = """notebooks/index how tour use_labs labs observers ledger/index reference/index guide about"""
"""Pages in the order of the contents."""

ALONE = (
    (
        "A figure that cannot be reproduced",
        "notebooks/09_reading_papers.html",
        "We run a published comparison with its own "
        "numbers, and the run does not show what the figure shows: judge it yourself.",
    ),
    (
        "A slip, named with its step",
        "notebooks/08_check_a_derivation.html",
        "Type your derivation line by line. A wrong term is marked, and the step is named where it went wrong.",
    ),
    (
        "The limit under the error",
        "notebooks/12_the_limit.html",
        "Under every error stands the least one that the noise "
        "allows, so that you see whether an observer or the pictures are to blame.",
    ),
)
"""Three things that no other package shows: a title, a page, and words for each."""

PLAYER = FRONT / "article.js"
"""Script that plays the scenes in the lab."""


def tree() -> str:
    """Text of the page that holds the contents; the article takes its place."""
    words = "\n\n".join(re.sub("<[^>]*>", "", scene["text"]) for scene in ARTICLE["scene"])
    return "\n".join(
        [f"# {ARTICLE['title']}", "", words, "", "```{toctree}", ":maxdepth: 2", "", *PAGES.split(), "```", ""]
    )


def front(notebooks: Mapping[str, Mapping[str, Any]]) -> tuple[dict[str, Any], ObserverLab]:
    """Return the values that fill the template of the first page, and the lab that plays the article.

    Parameters
    ----------
    notebooks : mapping of str to notebook
        The site's notebooks, by their file names.
    """
    found, lab = scenes()
    pages = {name[:2]: _page(name) for name in notebooks}
    for scene in found:
        scene["to"] = pages.get(scene["notebook"], "notebooks/index.html")
    played = json.dumps([scene["played"] for scene in found], allow_nan=False, separators=(",", ":"))
    shown = "".join(
        f'<section><h3><a href="{to}">{title}</a></h3><p>{words}</p></section>' for title, to, words in ALONE
    )
    doors = [
        f'<h2 id="learn">Learn</h2>{_course(notebooks)}{_links(LEARN)}',
        f'<div class="front-doors"><section><h2 id="teach">Teach</h2>{_links(TEACH)}</section>',
        f'<section><h2 id="look-up">Look things up</h2>{_verdicts()}{_links(LOOK_UP)}</section></div>',
        f'<h2>What nobody else shows</h2><div class="front-doors">{shown}</div>',
        '<h2 id="install">Install</h2><p>In the folder of the repository, with Python 3.11 or newer:</p>',
        f"<pre>{INSTALL}</pre>",
        f"<h2>Cite</h2><p>{CITE}</p>",
    ]
    words = {name: ARTICLE[name] for name in ("title", "lead")}
    inside = played.replace("<", "\\u003c")
    return {
        **words,
        "scenes": found,
        "played": inside,
        "lab": place_of(lab.get_state()),
        "doors": "\n".join(doors),
    }, lab


def _page(notebook: str) -> str:
    return f"notebooks/{notebook.removesuffix('.ipynb')}.html"


def _links(links: Mapping[str, str]) -> str:
    return "<ul>" + "".join(f'<li><a href="{to}">{escape(text)}</a></li>' for to, text in links.items()) + "</ul>"


def _course(notebooks: Mapping[str, Mapping[str, Any]]) -> str:
    by_number = {name[:2]: (name, *_title_and_time(notebook)) for name, notebook in notebooks.items()}

    def listed(numbers: tuple[str, ...]) -> Iterator[str]:
        for name, title, time in (by_number[number] for number in numbers if number in by_number):
            yield f'<li><a href="{_page(name)}">{escape(title)}</a> <small>{escape(time)}</small></li>'

    steps = (
        f"<section><h3>{step}</h3><ol>{''.join(listed(numbers))}</ol></section>" for step, numbers in STEPS.items()
    )
    return f'<div class="front-course">{"".join(steps)}</div>'


def _title_and_time(notebook: Mapping[str, Any]) -> tuple[str, str]:
    """First heading of a notebook, and how long it takes."""
    text = "\n".join("".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "markdown")
    title, time = (
        re.search(pattern, text, re.MULTILINE) for pattern in (r"^# (.*)", r"\*\*Time:\*\* (?:about )?([^,;.]*)")
    )
    return title[1] if title else "", time[1] if time else ""


def _verdicts() -> str:
    """A bar of all verdicts on the papers' equations."""
    counted = Counter(entry.expected for ledger in LEDGERS for entry in ledger.entries)
    told = [(verdict, counted[verdict]) for verdict in Verdict if counted[verdict]]
    parts = "".join(f'<span class="{slug(NAMES[verdict])}" style="flex: {n}"></span>' for verdict, n in told)
    words = ", ".join(f"{n} {NAMES[verdict]}" for verdict, n in told)
    return f'<div class="front-bar" aria-hidden="true">{parts}</div><p>{sum(counted.values())} equations: {words}.</p>'
