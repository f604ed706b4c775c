r"""Rewrite what no single pattern can: commands that a TeX source defines, and MATLAB's rows without commas."""

import re

from percept_obs.checking.dialects.source import Source, partners

LONGEST = 9000
"""Characters up to which commands of one's own are written out."""
_OWN = r"\\(?:(?:(?:re|provide)?newcommand|renewcommand)\*?\s*\{?|def)\s*\\([A-Za-z]+)\s*\}?\s*(?:\[\d\]|(?:#\d)*)\s*"
_BODY = r"\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\}\s*"


def own_commands(source: Source) -> Source:
    r"""Return a text without % remarks, and with its \newcommand and \def written out, unless that is too long."""
    source = source.sub(r"(?<!\\)%.*", "")
    ends = partners(source.text) or {}
    found = [
        (f[1], source.text[f.end() + 1 : ends[f.end()]]) for f in re.finditer(_OWN, source.text) if f.end() in ends
    ]
    own = {name: re.sub(r"#(\d)", r"\\\1", body) for name, body in found[:40]}
    source = source.sub(_OWN + _BODY, "") if own else source
    for name, body in (*own.items(), *own.items()):  # twice, for one may stand in another
        uses = rf"\\{name}(?![A-Za-z])\s*"
        if len(re.findall(uses, source.text)) * len(body) > LONGEST - len(source.text):
            break
        many = re.search(r"\\\d", body)
        source = source.calls({name: body}, r"\\", "{") if many else source.sub(uses, f" {body} ")
    return source


def rows(source: Source) -> Source:
    """Return a text with commas between entries of matrices that are apart by blanks alone."""
    source = source.sub(r"\[[^\[\]]*\n[^\[\]]*\]", lambda f: re.sub(r"(?<![;,+*/^=(\[-])[ \t]*\n\s*(?!\])", "; ", f[0]))
    return source.sub(r"\[([^\[\],()]*[;\s][^\[\],()]*)\]", _rows)


def _rows(found: re.Match[str]) -> str:
    lines = [row.split() for row in re.split(r"[;\n]+", found[1]) if row.strip()]
    several = len({*map(len, lines)}) == 1 and len(lines[0]) > 1
    if not several or not all(re.fullmatch(r"[-+]?[\w.]+", entry) for row in lines for entry in row):
        return found[0]
    signs = any(entry[0] in "+-" or entry.isdigit() for row in lines for entry in row[1:])  # a b; c d may be products
    return f"[{'; '.join(', '.join(row) for row in lines)}]" if signs else found[0]
