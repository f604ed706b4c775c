"""Files of texts that are printed for the page when the package is built: one compressed file a lab.

The first line lists the lines of all longer texts, since loops share most of theirs.  Then a line a part: its place in
the page's model, a tab, JSON.  Page and Python parse a part when it is first needed.  Written by
``python -m percept_obs.labs.printing``.
"""

import gzip
import json
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

FRONT = Path(__file__).parents[1] / "front"
"""Folder of the page: sources, bundle, printed texts."""

Texts = dict[str, Any]
Parts = Iterable[tuple[str, Texts]]
"""Texts by their place: "" for what stands in the model itself, "forms/pinhole y1" for an entry of its forms."""

LINES = "\n"
"""Key under which a text of several lines stands as the numbers of these lines, which texts share."""


def file_of(kind: str) -> Path:
    """The file of a lab."""
    return FRONT / f"{kind}.gz"


def packed(parts: Parts) -> bytes:
    """Contents of a file with these texts; equal texts give equal bytes."""
    return _file((), {}, parts, level=9)


def with_texts(kind: str, added: dict[str, Texts]) -> bytes:
    """Contents of a lab's file with texts added or replaced; quick rather than small."""
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
    """Contents of a file with these rows, and with parts added or replaced."""
    numbers = {line: number for number, line in enumerate(lines)}
    added = {place: json.dumps(_numbered(texts, numbers), allow_nan=False) for place, texts in parts}
    rows_of_file = [f"{place}\t{row}" for place, row in {**rows, **added}.items()]
    return gzip.compress("\n".join([json.dumps(list(numbers)), *rows_of_file]).encode(), level, mtime=0)


def _numbered(texts: Any, numbers: dict[str, int]) -> Any:
    """Texts with line numbers in place of every text of several lines."""
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
