"""Markdown of chat programs, and the delimiters of formulas in TeX: only what stands between them is left."""

import re

from percept_obs.checking.dialects.source import Source

NAME = "Markdown"
_MARKS = (
    r"\\\\|```[a-z]*|\$\$|\$|\\\[|\\\]|\\\(|\\\)|`|\\(?:begin|end)\s*\{(?:equation|align|gather|eqnarray|multline)\*?\}"
)
MARK = re.compile(rf"{_MARKS}|\*\*|^\s*[#>|*-]|__|<\w+>|(?<=\s)\*[^\s*=]+\*(?=\s)", re.MULTILINE)
_PARTNER = {r"\]": r"\[", r"\)": r"\("}
_RELATION = re.compile(r"[=<>]|\\(neq?|leq?|geq?|lt|gt|equiv|triangleq|coloneqq)(?![A-Za-z])")
_SIGN_ALONE = re.compile(r"[\s$`\\()\[\]]*([-+*/^]|plus|minus|times|over)[\s$`\\()\[\]]*")
_ROW = r"(?m)^\s*\|[ \t]*(.*\|.*?)[ \t]*\|[ \t]*$"
_RULES = (
    (r"(?m)^\s*\|[\s:|-]+\|\s*$|^\s*>|^\s*(-{3,}|\*{3,})\s*$|^\s*#{1,6}\s.*$", ""),
    (r"(?<![\w*)}\]])(\*\*|__)(?=\S)([^*\n]*?(?:[^*\n]\*[^*\n]|\*\*\d)*[^*\n]*?)(?<=\S)\1(?![\w(*])", r"\2"),
    (r"(?m)(?:^|(?<=\s))\*(?=[^\s*])([^*\n=]+)(?<=[^\s*])\*(?=[\s.,;:!?]|$)", r"\1"),
    (r"(?m)^\s*\*\*(?=\S)|^\s*__(?=\S)|(?<=\S)__\s*$|(?<=\S)\*{1,3}\s*$|^\s*\*(?=[A-Za-z\\])", ""),
)


def rewritten(source: Source) -> Source:
    """Return a text of Markdown in the plain form."""
    source = source.sub(_ROW, _row)
    for pattern, new in _RULES:
        source = source.sub(pattern, new)
    return Source(_delimited(source.text), source.origin)


def _row(found: re.Match[str]) -> str:
    """Return a row of a table as an equation of its two cells, or its cells line by line."""
    cells = re.split(r"(?<!\\)\|", found[1])
    equation = len(cells) == 2 and re.search(r"\d", cells[0]) and not any(map(_RELATION.search, cells))
    blank = [" " if k % 2 else cell for k, cell in enumerate(cells)]
    return " = ".join(cell.strip().strip("$` ") for cell in cells) if equation else "\n".join(cells) if blank else ""


def _delimited(text: str) -> str:
    """Return a text with blanks for delimiters such as $, and for all outside of them unless a formula stands there."""
    inside: list[tuple[int, int]] = []
    opened: tuple[int, str] | None = None
    marks: list[tuple[int, int]] = []
    for mark in re.finditer(_MARKS, text):
        kind = _PARTNER.get(mark[0], re.sub(r"[a-z]*$", "", mark[0]) if mark[0].startswith("```") else mark[0])
        if kind == r"\\":
            continue
        if not kind.startswith(("\\begin", "\\end")):
            marks.append(mark.span())
        kind = re.sub(r"^\\end", r"\\begin", kind)
        if opened is None:
            opened = (mark.end(), kind)
        elif opened[1] == kind:
            inside.append((opened[0], mark.start()))
            opened = None
    ends, starts = [0, *(end for _, end in inside)], [*(start for start, _ in inside), len(text)]
    between = [text[end:start] for end, start in zip(ends, starts, strict=True)]
    whole = [text[start:end] for start, end in inside]
    for start, end in marks:
        text = text[:start] + " " * (end - start) + text[end:]
    if not inside or any(_RELATION.search(part) or _SIGN_ALONE.fullmatch(part) for part in between):
        return text
    related = any(_RELATION.search(part) for part in whole)
    out = list(re.sub(r"[^\n]", " ", text))
    for (start, end), part in zip(inside, whole, strict=True):
        if _RELATION.search(part) or not related:
            out[start:end] = text[start:end]
            out[max(start - 1, 0)] = "\n" if start else out[0]
            out[min(end, len(out) - 1)] = "\n" if end < len(out) else out[-1]
    return "".join(out)
