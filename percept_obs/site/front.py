"""The site's first page: a live lab, one question, and three doors."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from html import escape
from typing import Any

from percept_obs.labs import observer_lab
from percept_obs.labs.shared.saved import place_of
from percept_obs.papers import LEDGERS, Verdict
from percept_obs.site.pages import slug

STEPS = {
    "See it, derive it": ("00", "01", "08"),
    "Observe": ("02", "03", "04"),
    "Go further": ("05", "06", "07", "10", "15", "16", "17"),
    "Doubt": ("09", "11", "12", "13", "14"),
}
"""Steps of the course, each with its notebooks."""

QUESTION = "You drive straight at a standing stone. Does its image tell how far it is?"
ANSWERS = ("Yes, at once", "Yes, but slowly", "No")
"""Answers of the lab's question "straight", in its order."""

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

ASKED = """<script>
document.querySelectorAll(".front-question button").forEach((button, k) => {
  button.addEventListener("click", () => {
    const [lab] = window.perceptObsLabs;
    lab.first.ask("straight");
    lab.first.answer(k);
    document.querySelector("[data-percept-obs]").scrollIntoView({ block: "start" });
  });
});
</script>"""

PAGES = """notebooks/index how tour use_labs labs observers ledger/index reference/index guide about"""
"""Pages in the order of the contents."""

HEADER = "---\nhide-toc: true\n---\n\n# One picture never tells how far. Move, and it does."


def first_lab() -> dict[str, Any]:
    """State of the lab on the first page."""
    return dict(observer_lab().get_state())


def front(state: Mapping[str, Any], notebooks: Mapping[str, Mapping[str, Any]]) -> str:
    """Text of the first page.

    Parameters
    ----------
    state : mapping
        State of its lab, see `first_lab`.
    notebooks : mapping of str to notebook
        The site's notebooks, by their file names.
    """
    tree = "\n".join(["```{toctree}", ":hidden:", ":maxdepth: 2", "", *PAGES.split(), "```"])
    scripts = "".join(f'<script defer src="_static/{name}"></script>' for name in ("labs.js", "alone.js"))
    answers = "".join(f'<button type="button">{answer}</button> ' for answer in ANSWERS)
    doors = [
        scripts + place_of(state),
        f'<p class="front-question"><strong>{QUESTION}</strong><br>{answers}</p>{ASKED}',
        f"<h2>Learn</h2>{_course(notebooks)}{_links(LEARN)}",
        f'<div class="front-doors"><section><h2>Teach</h2>{_links(TEACH)}</section>',
        f"<section><h2>Look things up</h2>{_verdicts()}{_links(LOOK_UP)}</section></div>",
        '<h2>Install</h2><pre>python3 -m pip install -e ".[course]"\npercept-obs lab</pre>',
    ]
    return "\n\n".join([HEADER, "```{raw} html\n" + "\n".join(doors) + "\n```", tree, ""])


def _links(links: Mapping[str, str]) -> str:
    return "<ul>" + "".join(f'<li><a href="{to}">{escape(text)}</a></li>' for to, text in links.items()) + "</ul>"


def _course(notebooks: Mapping[str, Mapping[str, Any]]) -> str:
    by_number = {name[:2]: (name, *_title_and_time(notebook)) for name, notebook in notebooks.items()}

    def listed(numbers: tuple[str, ...]) -> Iterator[str]:
        for name, title, time in (by_number[number] for number in numbers if number in by_number):
            to = f"notebooks/{name.removesuffix('.ipynb')}.html"
            yield f'<li><a href="{to}">{escape(title)}</a> <small>{escape(time)}</small></li>'

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
