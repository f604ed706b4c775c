"""Typst: dot(y)_3, a_(31), frac(a, b), mat(a, b; c, d), and a backslash at the end of a line."""

import re

from percept_obs.checking.dialects.source import Source

NAME = "Typst"
MARK = re.compile(
    r"^(?!.*\\[A-Za-z]).*(\w_\(|(?<![\w\\.])(dot|hat|bar|tilde|frac|mat|vec|lr|upright|bold)\()", re.DOTALL
)
CALLS = {
    **{name: rf"\{name}{{\1}}" for name in ("dot", "hat", "bar", "tilde", "overline")},
    **{"frac": r"\frac{\1}{\2}", "root": r"sqrt(\2)", "mat": r"[\0]", "vec": r"[\0]", "norm": r"||\1||"},
    **dict.fromkeys(("lr", "upright", "bold", "italic", "cancel"), r"\0"),
    "dot.double": r"\dot{\dot{\1}}",
}
WORDS = {"arrow.r.double": r"\\implies ", "dot.op": "*", "dot.c": "*", "times": "*", "eq.not": "!=", "or": r"\\lor "}


def rewritten(source: Source) -> Source:
    """Return a text of Typst in the plain form."""
    source = source.sub(r"\\(?=\s*(\n|$))", "\n").sub(r'"([^"\n]*)"', r" \\text{\1} ").sub(r"\^top\b", "^T")
    source = source.sub(r"\(\s*d\s*([^()]+?)\s*\)\s*/\s*\(\s*d\s*t\s*\)", r"(d/dt)(\1)")
    source = source.sub(r"\b(thin|med|thick|quad|space|&)(?!\w)", " ").sub(
        r"\bfrac\(\s*d\s*([^(),]+),\s*d\s*t\s*\)", r"(d/dt)(\1)"
    )
    for word, sign in WORDS.items():
        source = source.sub(rf"(?<![\w\\]){re.escape(word)}(?![\w(.])", sign.replace("\\\\", "\\"))
    source = source.sub(r"_\(\s*([^()]*?)\s*\)", lambda found: f"_{{{re.sub(r'[ ,]', '', found[1])}}}")
    return source.calls(CALLS)
