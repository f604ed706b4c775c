"""What is printed for the page when the package is built: one compressed file a lab, beside the bundle.

A line a part: its place in the page's model, a tab, JSON.  The page takes the file as it is and parses a part when it
is first needed, and so does Python.  Written by ``python -m percept_obs.labs.printing``.
"""

import gzip
import json
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import Any

FRONT = Path(__file__).parents[1] / "front"
"""The page's side of all labs: sources, the bundle that is built from them, and what is printed for it."""

Texts = dict[str, Any]
Parts = Iterable[tuple[str, Texts]]
"""Texts by their place: "" for what stands in the model itself, "forms/pinhole y1" for an entry of its forms."""


def file_of(kind: str) -> Path:
    """The file of a lab."""
    return FRONT / f"{kind}.gz"


def packed(parts: Parts) -> bytes:
    """Texts as a file holds them; the same texts are the same bytes."""
    return compressed({place: json.dumps(texts, allow_nan=False) for place, texts in parts})


def with_texts(kind: str, added: dict[str, Texts]) -> bytes:
    """What was printed for a lab, with some places printed anew; quick rather than small."""
    if not added:
        return file_of(kind).read_bytes()
    now = {place: json.dumps(texts, allow_nan=False) for place, texts in added.items()}
    return compressed(_lines(kind) | now, level=1)


def compressed(texts: dict[str, str], level: int = 9) -> bytes:
    """JSON by its place as a file holds it."""
    lines = [f"{place}\t{text}" for place, text in texts.items()]
    return gzip.compress("\n".join(lines).encode(), level, mtime=0)


def unpacked(data: bytes) -> dict[str, str]:
    """JSON by its place."""
    lines = gzip.decompress(data).decode().split("\n")
    return {place: text for place, _, text in (line.partition("\t") for line in lines)}


@lru_cache
def part(kind: str, place: str = "") -> Texts:
    """The texts of a lab at a place, as they were printed."""
    return dict(json.loads(_lines(kind)[place]))


@lru_cache
def _lines(kind: str) -> dict[str, str]:
    return unpacked(file_of(kind).read_bytes())
