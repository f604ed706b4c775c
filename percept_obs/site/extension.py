"""Extension of Sphinx: formulas as MathML, which a browser shows without any script, and docstrings as they are."""

from __future__ import annotations

import re
from functools import cache, partial
from typing import Any
from xml.etree import ElementTree

from percept_obs.site.addresses import describe


def setup(app: Any) -> dict[str, bool]:
    """Register the extension with Sphinx."""
    from sphinx.search.en import SearchEnglish

    # Each page has the words of the others, and finding their stems takes a tenth of the time.
    app.add_search_language(type("English", (SearchEnglish,), {"stem": cache(SearchEnglish.stem)}))
    app.add_html_math_renderer("mathml", (_inline, None), (_display, None))
    app.connect("autodoc-process-docstring", _keep_bars)
    app.connect("doctree-read", _keep_words)
    app.connect("missing-reference", _find_public)
    app.connect("html-page-context", _let_keys_scroll)
    app.connect("html-page-context", describe)
    app.connect("html-page-context", _mark_contents, priority=400)  # before the theme asks for them
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _mark_contents(app: Any, page: str, template: str, context: dict[str, Any], doctree: Any) -> None:
    context["toctree"] = partial(_contents, app, page)


def _contents(app: Any, page: str, **options: Any) -> str:
    """Contents with a page marked: made once, for to make them anew for each page takes a quarter of the time."""
    from sphinx.environment.adapters.toctree import TocTree

    if "contents" not in vars(app):
        tree = TocTree(app.env).get_toctree_for("search", app.builder, **options)
        app.contents = app.builder.render_partial(tree)["fragment"]
    contents, own = ElementTree.fromstring(app.contents), f"{page}.html"
    for entry in contents.iter("li"):
        if any(link.get("href") == own for link in entry.iter("a")):
            entry.set("class", f"{entry.get('class')} current")
    for link in contents.iter("a"):
        link.set("href", "#" if link.get("href") == own else "../" * page.count("/") + link.get("href", ""))
    return ElementTree.tostring(contents, "unicode", method="html")


def mathml(latex: str, display: str) -> str:
    r"""Return a formula as MathML."""
    from latex2mathml.converter import convert

    plain = latex.replace(r"\displaystyle", "").strip().strip("$")
    rows = plain.replace("{aligned}", "{split}")  # the converter knows only the second name
    return str(convert(rows, display=display))


def displayed(latex: str) -> str:
    """Return a formula as MathML in a block of its own, which keys scroll where it is wider than the page."""
    return f'<div class="math" tabindex="0" role="group" aria-label="formula">{mathml(latex, "block")}</div>'


def _inline(self: Any, node: Any) -> None:
    _write(self, mathml(node.astext(), "inline"))


def _display(self: Any, node: Any) -> None:
    _write(self, displayed(node.astext()))


def _write(self: Any, text: str) -> None:
    from docutils.nodes import SkipNode

    self.body.append(text)
    raise SkipNode


def _keep_bars(app: Any, kind: str, name: str, value: Any, options: Any, lines: list[str]) -> None:
    """Escape |x|, an absolute value in docstrings and a substitution for Sphinx, and initials, which begin no list."""
    for k, line in enumerate(lines):
        if not line.lstrip().startswith((">>>", "...")):
            lines[k] = re.sub(r"^( *[A-Z])\. ", r"\1\\. ", line.replace("|", r"\|"))


def _keep_words(app: Any, doctree: Any) -> None:
    """Take words of a type such as "function of time" for words, not for names of attributes."""
    for node in [each for each in doctree.findall() if each.tagname == "pending_xref"]:
        if node["reftype"] == "class" and node["reftarget"].islower():
            node.replace_self(node.children)


def _find_public(app: Any, env: Any, node: Any, content: Any) -> Any:
    """Return a link to a name of the whole package that a page of one of its folders gives without the package."""
    python, page, name = env.domains["py"], node.get("refdoc"), f"percept_obs.{node['reftarget']}"
    return python.resolve_xref(env, page, app.builder, node["reftype"], name, node, content)


def _let_keys_scroll(app: Any, page: str, template: str, context: dict[str, Any], doctree: Any) -> None:
    """Let keys scroll code and tables that are wider than the page."""
    if "body" in context:
        wide = r'<(pre|table border="1" class="dataframe"|table class="(?:ledger|entry)"|div class="table-wrap[^"]*")>'
        context["body"] = re.sub(wide, r'<\1 tabindex="0">', context["body"])
