"""Pages that hold labs, without Python and without a network."""

from __future__ import annotations

import gzip
import hashlib
import json
from base64 import b64encode
from collections.abc import Iterable, Mapping
from html import escape
from typing import Any

from percept_obs.labs.shared.printed import FRONT

STARTER = FRONT / "alone.js"
"""Script that turns the places of a page into labs."""

SHOWN = ("kind", "view", "model", "settings", "written", "frames", "sheets")
"""Traits of a lab that its page holds, besides its texts."""

POLICY = "default-src 'none'; script-src 'unsafe-inline' blob:; style-src 'unsafe-inline'"
"""Content policy under which a browser refuses every request of the page."""

PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>:root {{ color-scheme: light dark; }} body {{ margin: 0 auto; max-width: 1280px; padding: 8px; }}</style>
</head>
<body>
<main>
<h1 style="font: 600 1.2em sans-serif">{title}</h1>
{place}
</main>
<script>{library}</script>
<script>{starter}</script>
</body>
</html>
"""


ENDED = "percept-obs-ended"
"""DOM class of the hint in place of a lab whose kernel has ended."""

_LOST = ".jp-OutputArea:not(:has(.percept-lab)):has(.jp-OutputArea-output.jupyter-widgets)"
"""CSS selector of an output whose widget has no kernel any more."""
_IN_ITS_PLACE = f"""<div class="{ENDED}">
<style>
body:has(.percept-lab) .{ENDED}, .jp-OutputArea .{ENDED} {{{{ display: none; }}}}
{_LOST} .{ENDED} {{{{ display: block; }}}}
{_LOST}:has(.{ENDED}) .jp-OutputArea-output.jupyter-widgets:not(:has(*)) {{{{ display: none; }}}}
</style>
<p><strong>{{title}}</strong>: this lab was shown by a kernel that has ended. Run its cell again, and it is back.</p>
<p>To keep labs in a notebook, so that they open without a kernel, choose in JupyterLab
<em>Settings &gt; Save Widget State Automatically</em> before you save it.</p>
</div>"""


def ended(title: str) -> str:
    """Hint in place of a lab whose kernel has ended; hidden as long as the lab is there."""
    return _IN_ITS_PLACE.format(title=escape(title))


def page_of(state: Mapping[str, Any], title: str) -> str:
    """A page with one lab, from the lab's state."""
    return PAGE.format(
        policy=POLICY,
        title=escape(title),
        place=place_of(state),
        library=library_of([state]),
        starter=STARTER.read_text(encoding="utf-8"),
    )


OPENING = (
    "The lab opens here. If it does not, scripts are off, or this page's content security policy forbids scripts in "
    "it, or modules from blob: addresses."
)
"""Words in a lab's place until it is there."""


def place_of(state: Mapping[str, Any]) -> str:
    """HTML of a lab's place in a page, with its data."""
    data = {name: state[name] for name in SHOWN if name in state} | {"texts": _name_of(state["texts"])}
    return f'<div data-percept-obs><script type="application/json">{inside(data)}</script><p>{OPENING}</p></div>'


def inside(data: Mapping[str, Any]) -> str:
    """Data as JSON within a script, which no text in it ends."""
    return json.dumps(data, allow_nan=False, default=_as_base64, separators=(",", ":")).replace("<", "\\u003c")


def library_of(states: Iterable[Mapping[str, Any]]) -> str:
    """Script that a page with these labs needs once: the bundle and their texts."""
    texts = {_name_of(state["texts"]): b64encode(state["texts"]).decode() for state in states}
    bundle = gzip.compress((FRONT / "lab.js").read_bytes(), mtime=0)
    return f"window.perceptObs = {json.dumps({'bundle': b64encode(bundle).decode(), 'texts': texts})};"


def _as_base64(data: bytes) -> dict[str, str]:
    return {"base64": b64encode(data).decode()}


def _name_of(texts: bytes) -> str:
    return hashlib.sha256(texts).hexdigest()[:16]
