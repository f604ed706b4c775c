"""Spelling: characters, what stands around formulas, and names, before anything is parsed."""

import re
import sys
import unicodedata
from collections.abc import Iterator
from contextlib import suppress
from functools import cache, lru_cache
from hashlib import sha256
from io import BytesIO
from itertools import pairwise
from pathlib import Path

import lark
from lark import Lark, Token
from lark.lexer import LexerThread
from platformdirs import user_cache_path

from percept_obs.checking.points import key
from percept_obs.validation import write_whole

GREEK = """alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho sigma tau upsilon
phi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega"""
ACCENTS = {"\u0302": "hat", "\u0304": "bar", "\u0307": "dot", "\u0303": "tilde"}
_ACCENT_COMMANDS = {"hat": "hat", "bar": "bar", "dot": "dot", "tilde": "tilde"} | {
    "widehat": "hat",
    "widetilde": "tilde",
    "overline": "bar",
}
REPLACED = {
    **dict(zip("αβγδεζηθικλμνξοπρστυφχψωΓΔΘΛΞΠΣΦΨΩ", GREEK.split(), strict=True)),
    **dict(zip("ϵϑϕϱϖ", ("epsilon", "theta", "phi", "rho", "pi"), strict=True)),
    **dict(zip("₀₁₂₃₄₅₆₇₈₉", "0123456789", strict=True)),
    **dict(zip("−–·⋅×∗′’⟨⟩≠≤≥", ("-", "-", "*", "*", "*", "*", "'", "'", "(", ")", "!=", "<=", ">="), strict=True)),
    **dict(zip("½¼¾⅓⅔", ("(1/2)", "(1/4)", "(3/4)", "(1/3)", "(2/3)"), strict=True)),
    **dict.fromkeys("→⇒⟹∴", r"\implies "),
    "˙": "'",
    **dict(zip("‖√∑≡≔≜ᵀ″", ("||", r"\sqrt", r"\sum", r"\equiv", ":=", r"\triangleq", r"^{\top}", "''"), strict=True)),
    **dict.fromkeys("\u2009\u202f\u00a0\u2002\u2003\u2061\u2062", " "),
}
_RELATION = re.compile(r"[=<>]|\\(neq?|leq?|geq?|lt|gt|equiv|triangleq|coloneqq)(?![A-Za-z])")
_FORMULA = re.compile(r"[+*/^=<>()\[\]{}&\\]|(^|\s)-|-(\s|$)|[\d_']\w*\s+\w*[\d_']")
_SIGN_ALONE = re.compile(r"[\s$`\\()\[\]]*([-+*/^]|plus|minus|times|over)[\s$`\\()\[\]]*")
_VERB = re.compile(r"\s*([Ii]s|[Aa]re|[Hh]ave|[Dd]enotes?|[Ff]ollows|[Gg]ives?|[Yy]ields?|[Tt]hat|[Ww]hich)\b")
_TEXT_COMMAND = re.compile(r"\\(text|textrm|mbox|mathrm)\s*\{([^{}]*)\}")
_WORDS_OF_CASES = re.compile(r"\s*(for|if|when|otherwise|else)[,.]?\s*|\s*\w+\s*")
_NAMED_BY_COLON = re.compile(r"[\s{]*[A-Za-z]\w*(dot|')\s*:(?!=)[^=<>]*")


def spelled(text: str) -> tuple[str, list[int]]:
    """Return a text in plain letters and signs, and for each of its characters where it comes from."""
    pieces = [_plain(c) for c in text]
    return "".join(pieces), [k for k, piece in enumerate(pieces) for _ in piece]


@lru_cache(maxsize=4096)
def _plain(c: str) -> str:
    if c in REPLACED or c.isascii():
        return REPLACED.get(c, c)
    if unicodedata.name(c, "").startswith("MATHEMATICAL"):
        c = unicodedata.normalize("NFKC", c)
    return REPLACED.get(c) or "".join(REPLACED.get(d, d) for d in unicodedata.normalize("NFD", c))


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
def _terminal(name: str) -> re.Pattern[str]:
    """Return a regular expression of the grammar that looks for what stands around formulas."""
    alternatives = re.search(rf"^{name}:(.*(?:\n +\|.*)*)", _grammar(), re.MULTILINE)
    assert alternatives
    return re.compile("|".join(re.findall(r"/(.*)/ *$", alternatives[1], re.MULTILINE)))


@cache
def _grammar() -> str:
    return (Path(__file__).parent / "formula.lark").read_text(encoding="utf-8")


@lru_cache(maxsize=256)
def lexed(text: str) -> tuple[Token, ...]:
    """Tokens of a text in plain letters, as the grammar has them."""
    return tuple(LexerThread.from_text(parser().parser.lexer, text).lex(None))  # parser().lex() would make a lexer


def laid_out(text: str) -> str:
    """Return a text of the same length in which only formulas are left: blanks stand where words were."""
    text = _delimited(text)
    lines = [_line(line) for line in re.sub(r"(?<!\\)\\\n", "  ", text).split("\n")]
    return "\n".join(lines)


def _blank(text: str) -> str:
    return "".join(c if c == "\n" else " " for c in text)


def _delimited(text: str) -> str:
    """Return a text with blanks for delimiters such as $, and for all outside of them unless a formula stands there."""
    inside: list[tuple[int, int]] = []
    opened: tuple[int, str] | None = None
    marks: list[tuple[int, int]] = []
    for mark in _terminal("DELIMITER").finditer(text):
        kind = _PARTNER.get(mark[0], re.sub(r"[a-z]*$", "", mark[0]) if mark[0].startswith("```") else mark[0])
        if kind == r"\\":
            continue
        if not kind.startswith("\\begin") and not kind.startswith("\\end"):
            marks.append(mark.span())
        else:
            kind = re.sub(r"^\\end", r"\\begin", kind)
        if opened is None:
            opened = (mark.end(), kind)
        elif opened[1] == kind:
            inside.append((opened[0], mark.start()))
            opened = None
    between = _outside(text, inside)
    whole = [text[start:end] for start, end in inside]
    for start, end in marks:
        text = text[:start] + " " * (end - start) + text[end:]
    if not inside or any(_RELATION.search(part) or _SIGN_ALONE.fullmatch(part) for part in between):
        return text
    related = any(_RELATION.search(part) for part in whole)
    kept = [span for span, part in zip(inside, whole, strict=True) if _RELATION.search(part) or not related]
    out = list(_blank(text))
    for start, end in kept:
        out[start:end] = text[start:end]
        if start:
            out[start - 1] = "\n"
        if end < len(out):
            out[end] = "\n"
    return "".join(out)


_PARTNER = {r"\]": r"\[", r"\)": r"\("}


def _outside(text: str, inside: list[tuple[int, int]]) -> list[str]:
    ends = [0, *(end for _, end in inside)]
    starts = [*(start for start, _ in inside), len(text)]
    return [text[end:start] for end, start in zip(ends, starts, strict=True)]


def _line(line: str) -> str:
    """Return a line without words, numbers and marks around its formulas."""
    line = _terminal("COMMENT").sub(lambda found: " " * len(found[0]), line)
    line = re.sub(
        r"^\s*>|^\s*\*\*(?=\S)|^\s*__(?=\S)|(?<=\S)__\s*$|(?<=\S)\*{1,3}\s*$|^\s*\*(?=[A-Za-z\\])",
        lambda f: " " * len(f[0]),
        line,
    )
    start = len(line) - len(line.lstrip())
    if numbered := _terminal("NUMBERED").match(line, start):
        line = " " * numbered.end() + line[numbered.end() :]
    line = re.sub(
        r"(?<=\s\s|.,|ad)\s*\((\d{1,2}[a-z]?)\)\s*[.,]?\s*$", lambda f: " " * len(f[0]), line
    )  # (4) at the end, behind blanks or \quad
    line = re.sub(r"\(((?:with|where)\s.*)\)(\s*)$", r" \1 \2", line)
    if _NAMED_BY_COLON.fullmatch(line):
        line = line.replace(":", "=", 1)
        if line.lstrip().startswith("{"):
            line = line.replace("{", " ", 1).rstrip().removesuffix("}")
    line = _TEXT_COMMAND.sub(_text_command_as_words, line)
    words = re.split(r"(\s+)", line)
    line = "".join(_line_end_for_stop(word) for word in words)
    if not _terminal("PROSE").search(line) and "\n" not in line:
        return line
    return "".join(_formulas_of_sentence(line))


def _formulas_of_sentence(line: str) -> Iterator[str]:
    """Yield the parts of a sentence: formulas, each on a line of its own, and blanks for the words between them."""
    found = [(each.start(), each.end()) for each in _terminal("PROSE").finditer(line)]
    for (_, start), (end, after) in pairwise([(0, 0), *found, (len(line), len(line))]):
        part = line[start:end]
        # "y1 is measured" and "the quotient rule" say something, "by 2" might be meant as a factor
        says = (
            not re.search(r"[\d_]", part)
            or re.search(r"(?<![\w\\])[A-Za-z]{2,}(?!\w)", part)
            or _VERB.match(line[end:])
        )
        yield _blank(part) if says and not _FORMULA.search(part) else part
        yield "\n" * (after > end) + " " * (after - end - 1)


def _text_command_as_words(found: re.Match[str]) -> str:
    """Return text{...} unchanged if it stands in cases or names a function, else its words as those of a sentence."""
    if _WORDS_OF_CASES.fullmatch(found[2]) and not _terminal("PROSE").search(found[2]):
        return found[0]
    head = found[0].index("{") + 1
    return "\n" + " " * (head - 1) + found[2] + " "


def _line_end_for_stop(word: str) -> str:
    """Return a word with an end of line for the stop, colon or other mark that ends it; decimal points stay."""
    bare = word.rstrip(",")
    if bare.endswith((".", "!", "?")) and not bare[:-1].isdigit() and not bare.endswith(("\\right.", "\\left.")):
        return bare[:-1] + "\n" + word[len(bare) :]
    if bare.endswith(":") and not bare.endswith("\\:"):
        return bare[:-1] + "\n" + word[len(bare) :]
    return word


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
    if quotient := re.fullmatch(r"d(\w+)dt", name):
        found.append(key(f"{quotient[1]}dot"))
    return [each for each in dict.fromkeys(found) if each != name]
