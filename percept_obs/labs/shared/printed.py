"""What is printed for the page when the package is built: one compressed file a lab, beside the bundle.

The first line lists all lines that longer texts are made of, since loops share most of theirs.  Then a line a part: its
place in the page's model, a tab, JSON.  The page takes the file as it is and parses a part when it is first needed, and
so does Python.  Written by ``python -m percept_obs.labs.printing``.
"""

import gzip
import json
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

FRONT = Path(__file__).parents[1] / "front"
"""The page's side of all labs: sources, the bundle that is built from them, and what is printed for it."""

Texts = dict[str, Any]
Parts = Iterable[tuple[str, Texts]]
"""Texts by their place: "" for what stands in the model itself, "forms/pinhole y1" for an entry of its forms."""

LINES = "\n"
"""The key under which numbers of lines stand for a text."""


def file_of(kind: str) -> Path:
    """The file of a lab."""
    return FRONT / f"{kind}.gz"


def packed(parts: Parts) -> bytes:
    """Texts as a file holds them; the same texts are the same bytes."""
    return _file((), {}, parts, level=9)


def with_texts(kind: str, added: dict[str, Texts]) -> bytes:
    """What was printed for a lab, with some places printed anew; quick rather than small."""
    return _file(*_rows_of(kind), added.items(), level=1) if added else file_of(kind).read_bytes()


def unpacked(data: bytes) -> dict[str, Texts]:
    """Texts by their place."""
    lines, rows = _rows(data)
    return {place: _read(row, lines) for place, row in rows.items()}


@lru_cache
def part(kind: str, place: str = "") -> Texts:
    """The texts of a lab at a place, as they were printed."""
    lines, rows = _rows_of(kind)
    return _read(rows[place], lines)


def _file(lines: Iterable[str], rows: Mapping[str, str], parts: Parts, level: int) -> bytes:
    """A file of rows that are there and of parts beside or in place of them."""
    numbers = {line: number for number, line in enumerate(lines)}
    added = {place: json.dumps(_numbered(texts, numbers), allow_nan=False) for place, texts in parts}
    told = [f"{place}\t{row}" for place, row in {**rows, **added}.items()]
    return gzip.compress("\n".join([json.dumps(list(numbers)), *told]).encode(), level, mtime=0)


def _numbered(texts: Any, numbers: dict[str, int]) -> Any:
    """The same with numbers for the lines of every text that has several."""
    if isinstance(texts, dict):
        return {name: _numbered(each, numbers) for name, each in texts.items()}
    if isinstance(texts, list | tuple):
        return [_numbered(each, numbers) for each in texts]
    if isinstance(texts, str) and LINES in texts:
        return {LINES: [numbers.setdefault(line, len(numbers)) for line in texts.split(LINES)]}
    return texts


def _read(row: str, lines: Sequence[str]) -> Texts:
    def whole(found: Any) -> Any:
        return LINES.join(lines[number] for number in found[LINES]) if LINES in found else found

    return dict(json.loads(row, object_hook=whole))


@lru_cache
def _rows_of(kind: str) -> tuple[list[str], dict[str, str]]:
    return _rows(file_of(kind).read_bytes())


def _rows(data: bytes) -> tuple[list[str], dict[str, str]]:
    """The lines that texts share, and JSON by its place."""
    first, *rows = gzip.decompress(data).decode().split("\n")
    return json.loads(first), {place: row for place, _, row in (each.partition("\t") for each in rows)}
