"""Markdown's and TeX's delimiters of formulas: only what stands between them is left."""

import re

_MARKS = (
    r"\\\\|```[a-z]*|\$\$|\$|\\\[|\\\]|\\\(|\\\)|`|\\(?:begin|end)\s*\{(?:equation|align|gather|eqnarray|multline)\*?\}"
)
_PARTNER = {r"\]": r"\[", r"\)": r"\("}
_RELATION = re.compile(r"[=<>]|\\(neq?|leq?|geq?|lt|gt|equiv|triangleq|coloneqq)(?![A-Za-z])")
_SIGN_ALONE = re.compile(r"[\s$`\\()\[\]]*([-+*/^]|plus|minus|times|over)[\s$`\\()\[\]]*")


def delimited(text: str) -> str:
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
    blank = list(text)
    for start, end in marks:
        blank[start:end] = " " * (end - start)
    text = "".join(blank)
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
