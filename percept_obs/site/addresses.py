"""Descriptions, a card and addresses of the pages, for search engines and other sites."""

from __future__ import annotations

import io
import re
from html import escape
from pathlib import Path
from typing import Any

from percept_obs.validation import write_whole

TITLE = "One picture never tells how far. Move, and it does."
ABOUT = (
    "A camera sees a moving point as a direction. Observers find its distance: live labs, notebooks, papers checked."
)
CARD = "card.png"
LONGEST = 160
"""Characters of a description."""


def describe(app: Any, page: str, template: str, context: dict[str, Any], doctree: Any) -> None:
    """Give a page a description, its first paragraph, and what a card of it shows."""
    paragraphs = [] if doctree is None else [node.astext() for node in doctree.findall() if node.tagname == "paragraph"]
    title = re.sub("<[^>]*>", "", context.get("title", "")) or TITLE
    first = (text for text in paragraphs if len(text.split()) > 4 and " · " not in text)  # which are links alone
    text = ABOUT if page == "index" else next(first, f"{title}. {ABOUT}")
    tags = {"og:title": title, "og:description": short(text), "og:type": "website", "og:site_name": "percept_obs"}
    address = app.config.html_baseurl
    if address:
        tags |= {
            "og:url": f"{address}{page}.html",
            "og:image": f"{address}_static/{CARD}",
            "twitter:card": "summary_large_image",
        }
    lines = [f'<meta name="description" content="{escape(short(text))}" />']
    lines += [f'<meta property="{name}" content="{escape(value)}" />' for name, value in tags.items()]
    context["metatags"] = context.get("metatags", "") + "\n".join(lines)


def short(text: str) -> str:
    """Return the beginning of a text, cut between words.

    >>> short("word " * 100)[-9:]
    'word word'
    """
    whole = " ".join(text.split())
    return whole if len(whole) <= LONGEST else whole[:LONGEST].rpartition(" ")[0]


def above_versions(address: str) -> str:
    """Address of the folder above that of a version; empty where an address does not end with a version.

    >>> above_versions("https://example.org/course/1.2/"), above_versions("https://example.org/course/")
    ('https://example.org/course/', '')
    """
    above, _, last = address.rstrip("/").rpartition("/")
    return f"{above}/" if re.fullmatch(r"v?\d+(\.\w+)*|latest|stable", last) else ""


def write_sitemap(target: Path, address: str) -> None:
    """List all pages of a site for search engines."""
    found = (path.relative_to(target) for path in target.rglob("*.html"))
    pages = sorted(path.as_posix() for path in found if {"_static", "lite", "slides"}.isdisjoint(path.parts))
    entries = "".join(f"<url><loc>{escape(address + page)}</loc></url>\n" for page in pages)
    head = '<?xml version="1.0" encoding="utf-8"?>\n<urlset xmlns="http://www.sitemaps.org/schemas/sitemap/0.9">\n'
    write_whole(target / "sitemap.xml", f"{head}{entries}</urlset>\n".encode())


def card() -> bytes:
    """Return the picture of the card, a PNG file: rays from a camera that moves, which meet in one point."""
    from matplotlib.figure import Figure

    figure = Figure((12, 6.3), dpi=100, facecolor="white")
    axes = figure.add_axes((0.05, 0.06, 0.9, 0.66))
    axes.set(xlim=(0, 12), ylim=(-0.6, 3.8), aspect="equal")
    axes.axis("off")
    point = (10.5, 3.0)
    for k, x in enumerate((1.0, 2.8, 4.6, 6.4)):
        axes.plot([x, point[0]], [0, point[1]], color="#0a5fbf", alpha=0.25 + 0.25 * k, linewidth=2)
        axes.plot(x, 0, marker="^", markersize=18, color="black")
    axes.annotate("", (7.8, 0), (0.4, 0), arrowprops={"arrowstyle": "->", "color": "black", "linewidth": 1.5})
    axes.plot(*point, marker="o", markersize=16, color="black")
    axes.plot(*point, marker="o", markersize=30, markerfacecolor="none", markeredgecolor="#0a5fbf", markeredgewidth=3)
    figure.text(0.05, 0.86, TITLE, fontsize=27, fontweight="bold")
    figure.text(0.05, 0.77, "percept_obs", fontsize=22, color="#59626c")
    written = io.BytesIO()
    figure.savefig(written, format="png", metadata={"Software": None})
    return written.getvalue()
