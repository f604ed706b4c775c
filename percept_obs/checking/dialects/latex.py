r"""LaTeX as people write it: \newcommand, \underbrace{a}_{b}, v_{c_{3}}, \mathrm{a}_{31}, \frac12, % remarks."""

import re

from percept_obs.checking.dialects.source import Source, partners

NAME = "LaTeX"
MARK = re.compile(r"\\[A-Za-z,;!:(\[]|[_^]\s*\{")
LONGEST = 9000
"""Characters up to which commands of one's own are written out."""
_LABEL = "\ue000"  # stands where the label of a brace may follow
_CALLS = {
    **dict.fromkeys(("underbrace", "overbrace"), rf"(\1){_LABEL}"),
    **dict.fromkeys(("nicefrac", "sfrac", "cfrac", "flatfrac"), r"\frac{\1}{\2}"),
    **dict.fromkeys(("textbf", "textit", "emph", "textnormal", "intertext", "shortintertext"), r"\text{\1}"),
}
_RULES = (
    (rf"{_LABEL}(\s*[_^]\s*(\{{(?:[^{{}}]|\{{[^{{}}]*\}})*\}}|\w))?", ""),
    (r"\\(?:mathrm|mathit|mathsf|text|rm)\s*\{\s*([A-Za-z])\s*\}(?=\s*_)", r"\1"),
    (r"_\s*\{\s*([A-Za-z]+)\s*_\s*(?:\{\s*(\w+)\s*\}|(\w))\s*\}", r"_{\1\2\3}"),
    (r"(\\[dt]?frac)\s*(\d)\s*(\d)", r"\1{\2}{\3}"),
    (r"(\\[dt]?frac)\s*(\d)\s*(?=\{)", r"\1{\2}"),
    (r"\\sqrt\s*(?=\()", "sqrt"),
    (r"=\s*\\[lc]?dots[bc]?\s*(?==)", ""),
    (r"(\{[^{}]*\})\s*_\s*\\times(?![A-Za-z])", r"\1_{cross}"),
)
_OWN = re.compile(
    r"\\(?:(?:(?:re|provide)?newcommand|renewcommand)\*?\s*\{?|def)\s*\\([A-Za-z]+)\s*\}?\s*(?:\[\d\]|(?:#\d)*)\s*(?=\{)"
)


def rewritten(source: Source) -> Source:
    """Return a text of LaTeX in the plain form."""
    source = _own_commands(source.sub(r"(?<!\\)%.*", "")).calls(_CALLS, r"\\", "{")
    for pattern, new in _RULES:
        source = source.sub(pattern, new)
    return source


def _own_commands(source: Source) -> Source:
    r"""Return a text with its \newcommand and \def written out, unless that makes it too long."""
    own: dict[str, str] = {}
    ends = partners(source.text) or {}
    for found in _OWN.finditer(source.text):
        end = ends.get(found.end())
        if end is not None and (found[1], end) not in own:
            own[found[1]] = re.sub(r"#(\d)", r"\\\1", source.text[found.end() + 1 : end])
    if not own:
        return source
    source = source.sub(rf"{_OWN.pattern}\{{(?:[^{{}}]|\{{(?:[^{{}}]|\{{[^{{}}]*\}})*\}})*\}}\s*", "")
    for name, body in (*own.items(), *own.items()):  # twice, for one may stand in another
        uses = rf"\\{name}(?![A-Za-z])\s*"
        if len(re.findall(uses, source.text)) * len(body) > LONGEST - len(source.text):
            break
        many = re.search(r"\\\d", body)
        source = source.calls({name: body}, r"\\", "{") if many else source.sub(uses, body.replace("\\", "\\") + " ")
    return source
