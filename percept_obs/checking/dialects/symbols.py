"""Unicode: Greek letters, indices and accents, signs of many kinds, in plain letters and signs."""

import unicodedata
from functools import lru_cache

from percept_obs.checking.dialects.source import Source

GREEK = """alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho sigma tau upsilon
phi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega"""
REPLACED = {
    **dict(zip("αβγδεζηθικλμνξοπρστυφχψωΓΔΘΛΞΠΣΦΨΩ", GREEK.split(), strict=True)),
    **dict(zip("ϵϑϕϱϖ", ("epsilon", "theta", "phi", "rho", "pi"), strict=True)),
    **dict(zip("₀₁₂₃₄₅₆₇₈₉", "0123456789", strict=True)),
    **dict(zip("−–·⋅×∗′’⟨⟩≠≤≥", ("-", "-", "*", "*", "*", "*", "'", "'", "(", ")", "!=", "<=", ">="), strict=True)),
    **dict(zip("½¼¾⅓⅔", ("(1/2)", "(1/4)", "(3/4)", "(1/3)", "(2/3)"), strict=True)),
    **dict.fromkeys("→⇒⟹∴⇔", r"\implies "),
    **{"˙": "'", "∨": r" \lor ", "…": "...", "\t": "    "},
    **dict(zip("‖√∑≡≔≜ᵀ″", ("||", r"\sqrt", r"\sum", r"\equiv", ":=", r"\triangleq", r"^{\top}", "''"), strict=True)),
}


def rewritten(text: str) -> Source:
    """Return a text in plain letters and signs.

    >>> rewritten("ω₁ − 2").text
    'omega1 - 2'
    """
    pieces = [_plain(c) for c in text]
    return Source("".join(pieces), tuple(k for k, piece in enumerate(pieces) for _ in piece))


@lru_cache(maxsize=4096)
def _plain(c: str) -> str:
    if c in REPLACED or c.isascii():
        return REPLACED.get(c, c)
    if unicodedata.category(c) in ("So", "Zs") or c in "\u2061\u2062\u200d\ufe0f":  # blanks, marks such as a tick
        return " "
    if unicodedata.name(c, "").startswith("MATHEMATICAL"):
        c = unicodedata.normalize("NFKC", c)
    return REPLACED.get(c) or "".join(REPLACED.get(d, d) for d in unicodedata.normalize("NFD", c))
