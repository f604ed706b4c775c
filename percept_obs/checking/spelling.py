"""Spelling of names, and the parser that tells them from signs."""

import re
import sys
from contextlib import suppress
from functools import cache, lru_cache
from hashlib import sha256
from io import BytesIO
from pathlib import Path

import lark
from lark import Lark, Token
from lark.lexer import LexerThread
from platformdirs import user_cache_path

from percept_obs.checking.points import key
from percept_obs.validation import write_whole

LABELS = ("w", "wT", "phi", "g", "J", "Jm", "x", "x1", "x2", "xdot", "x1dot", "x2dot", "y", "ydot", "nablal")
"""Names that may stand on the left of any line."""
ACCENTS = {"\u0302": "hat", "\u0304": "bar", "\u0307": "dot", "\u0303": "tilde"}
_ACCENT_COMMANDS = {"hat": "hat", "bar": "bar", "dot": "dot", "tilde": "tilde"} | {
    "widehat": "hat",
    "widetilde": "tilde",
    "overline": "bar",
}


@cache
def parser() -> Lark:
    """The parser of formulas, which takes a second to make and so stays in the user's cache."""
    told = f"{_grammar()} {lark.__version__} {sys.version}"
    file = user_cache_path("percept_obs") / f"formulas_{sha256(told.encode()).hexdigest()[:32]}.parser"
    with suppress(Exception), file.open("rb") as kept:  # what was cut off may raise anything
        return Lark.load(kept)
    made = Lark(_grammar(), parser="lalr", lexer="basic", start=["lines", "words"], propagate_positions=True)
    with suppress(OSError):
        made.save(packed := BytesIO())
        file.parent.mkdir(parents=True, exist_ok=True)
        write_whole(file, packed.getvalue())
    return made


@cache
def _grammar() -> str:
    return (Path(__file__).parent / "formula.lark").read_text(encoding="utf-8")


@lru_cache(maxsize=256)
def lexed(text: str) -> tuple[Token, ...]:
    """Tokens of a text in plain letters, as the grammar has them."""
    return tuple(LexerThread.from_text(parser().parser.lexer, text).lex(None))  # parser().lex() would make a lexer


def name_of(token: str) -> str:
    """Return the key of a name, accents at its end and a prime as "dot"."""
    marks = "".join(ACCENTS)
    text = re.sub(r"\s*\^\s*(\{\s*((\\prime\s*)+)\}|\\prime)", lambda f: "'" * f[0].count("prime"), token)
    text = re.sub(r"\\(mathbf|boldsymbol|bm|mathit|vec|mathcal|mathsf|pmb)(?![A-Za-z])", "", text)
    text = re.sub(r"\\var(?=[a-zA-Z])", r"\\", text)
    over = re.findall(rf"\\({'|'.join(_ACCENT_COMMANDS)})(?![A-Za-z])", text)
    accents = [*(_ACCENT_COMMANDS[each] for each in over), *(ACCENTS[c] for c in text if c in ACCENTS)]
    plain = re.sub(rf"\\({'|'.join(_ACCENT_COMMANDS)})(?![A-Za-z])|[{marks}',]", "", text)
    return key(plain + "".join(accents) + "dot" * text.count("'"))


_DEE = r"(?:d|∂|\\partial|\\mathrm\s*(?:\{\s*d\s*\}|d)|\\rm\s)"
_FRACTION = re.compile(
    rf"\\[dt]?frac\s*\{{\s*{_DEE}(.*)\}}\s*\{{\s*(?:\\mathrm\s*\{{\s*d(.)\s*\}}|{_DEE}(.*))\}}", re.DOTALL
)
_CALLS = re.compile(
    rf"(?:Derivative|diff|dot)\s*\(([^,]*?)(?:,\s*t\s*)?\)|(.*)\.diff\(\s*t\s*\)|{_DEE}([^/]*)/.*", re.DOTALL
)


def rate_of(token: str) -> str:
    """Return the key of a rate that is written as a quotient or a function; dV for a quotient by other letters."""
    if found := _FRACTION.fullmatch(token):
        inner, by = found[1], (found[2] or found[3]).strip()
    elif token.startswith("Symbol"):
        return name_of(token.split("'")[1])
    else:
        found = _CALLS.fullmatch(token)
        assert found
        inner, by = next(part for part in found.groups() if part), "t"
    inner = inner.strip().removeprefix("(").removesuffix(")") if inner.strip().startswith("(") else inner
    name = name_of(re.sub(r"\s*\([^()]*\)\s*$", "", inner).strip())
    return key(f"{name}dot") if by == "t" else f"d{name}"


def other_names(name: str) -> list[str]:
    """Return other spellings: omega or w for w_c, x, y, z for 1, 2, 3, dy3dt for the rate of y3, lambda for its hat."""
    numbered = re.sub(r"^(omega|wc?|vc|vp)([xyz])", lambda f: f[1] + str("xyz".index(f[2]) + 1), name)
    found = [re.sub(r"^(lambda\d?)hat", r"\1", name), numbered, re.sub("omega", "w", numbered)]
    found.append(re.sub(r"omega|^w(?!c)", "wc", numbered))
    found.append(re.sub(r"^(k\d|xf|R|Omegag)bar$|^(xO)q$|^(I)n$", r"\1\2\3", name))  # of the papers
    if rate := re.fullmatch(r"[dD]([A-Za-z]+?\d?[a-z]*?)(?:dt(\d?))?", name):  # dy3, dy3dt, dydt3
        found.append(key(f"{rate[1]}{rate[2] or ''}dot"))
    found.append(re.sub(r"^([a-z])(?:h(\d)|(\d)h)(?=dot|$)", r"\1\2\3hat", re.sub(r"^[a-z](\d)tilde", r"e\1", name)))
    found += [name[:1].lower() + name[1:]] * bool(re.fullmatch(r"[A-Z]\d\d", name))  # A(3,1) of MATLAB is a31
    found += {"omegatimes": ["wcross"], "omegacross": ["wcross"], "df": ["J"], "dfdy": ["J"], "dfdx": ["J"]}.get(
        name, []
    )
    return [each for each in dict.fromkeys(found) if each != name]
