"""Python with numpy or sympy, and C: def and return, y[2] counted from 0, np.power, Eq, # remarks."""

import re

from percept_obs.checking.dialects.source import Source

NAME = "Python"
_MODULE = r"\b(?:np|numpy|jnp|math|sp|sympy|torch|Math|linalg|cmath)\.(?=[A-Za-z])"
MARK = re.compile(
    rf"\b(def|return|import|lambda [\w, ]*:)\b|{_MODULE}|\*\*|(?<![\w\\])(Eq|Derivative|diff|pow|hypot|power)\("
    r"|\w\[\d|\.diff\(|\.T\b|^\s*(double|float|const)\s|,\s*[\])]|^\s*\w+(, \w+)+ = ",
    re.MULTILINE,
)
_BESIDES = (
    r'(?s)"""(.*?)"""',
    r"(?m)^\s*(import|from)\b.*$",
    r"(?m)^\s*\w+(\s*,\s*\w+)+\s*=\s*\w+;?\s*$",  # y1, y2, y3 = y
    r"(?m)^\s*return\s*[\[(]?\s*\w+(\s*,\s*\w+)*\s*,?[\])]?;?\s*$",
    r"\blambda [\w, ]*:|\b(double|float|const)\s",
    _MODULE,
)
_CALLS = {
    **dict.fromkeys(("power", "pow"), r"((\1)^(\2))"),
    **{"square": r"((\1)^2)", "hypot": r"sqrt((\1)^2 + (\2)^2)", "Rational": r"((\1)/(\2))", "Eq": r"\1 = \2"},
    **{"Equality": r"\1 = \2", "maximum": r"max(\0)", "minimum": r"min(\0)", "Symbol": r"\1", "Ne": r"\1 != \2"},
    **dict.fromkeys(("Matrix", "ImmutableMatrix", "array", "expand", "simplify", "factor", "asarray"), r"\0"),
}
_DEF = r"\bdef\s+(\w+)\s*\([^()]*\)[^:\n]*:"
_RATE = r"\w*dot\d*|d_?[A-Za-z]\d|d\w+_?dt"


def rewritten(source: Source) -> Source:
    """Return a text of Python in the plain form."""
    names = re.findall(_DEF, source.text)
    for pattern in _BESIDES:
        source = source.sub(pattern, "")
    name = f"{names[-1]} = " if names and re.fullmatch(_RATE, names[-1]) else ""
    source = source.sub(_DEF, "").sub(r"\breturn\b", name).sub(r"\.T\b", "^T").sub(r" @ ", " * ")
    source = source.sub(r"(?m)^(\s*)(\w+(?:\s*,\s*\w+)+)\s*=\s*([^=\n]+)$", _one_by_one)
    source = source.sub(r",(\s*[\])])", r"\1").sub(r"'(\w+)'(?=\))", r"\1").calls(_CALLS)
    counts = [int(d) for d in re.findall(r"\w\[\s*(\d)(?=\s*[\],])|(?<=,)\s*(\d)\s*\]", source.text) for d in d if d]
    first = 0 if not counts or 0 in counts or max(counts) < 3 else 1
    indexed = r"(?<=[A-Za-z_])\[\s*(\d)\s*(?:(?:,|\]\s*\[)\s*(\d)\s*)?\]"
    return source.sub(indexed, lambda f: "".join(str(int(d) + 1 - first) for d in f.groups() if d))


def _one_by_one(found: re.Match[str]) -> str:
    """Return a line for each of e1, e2 = a, b."""
    names, values = re.split(r"\s*,\s*", found[2]), re.split(r"\s*,\s*(?![^(]*\))", found[3])
    pairs = zip(names, values, strict=False) if len(names) == len(values) else ()
    return "\n".join(f"{name} = {value}" for name, value in pairs) or found[0]
