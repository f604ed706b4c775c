"""Prose around formulas: words of any language that no formula contains, numbers and marks of lists, remarks."""

import re
from collections.abc import Callable, Iterator
from itertools import pairwise

from percept_obs.checking.dialects.source import Source

_WORD = re.compile(r"(?<![\\\w{^_.'])[^\W\d_](?:[^\W\d_]|[\u0300-\u036f]|['-](?=[^\W\d_]{2}))*\.?(?![\w'({\[^]|\.\w)")
_ACCENTED = re.compile(r"[A-Za-z][\u0302\u0303\u0304\u0307]+")
_NUMBERED = re.compile(
    r"\s*((Eq|Eqn|Equation|Line|Step)?\.?\s*\(\d{1,2}[a-z]?\):?|\(?[ivx]{1,4}\)|\d{1,2}[a-z]?[.)]|\(?[a-z]\)|•)"
    r"(?=\s+(\$|\\|[^\W\d]|[^\s=]+(\(t\))?\s*:?=))"
)
_REMARK = re.compile(
    r"#.*|(?<!\\)%.*|\(\s*\*+\s*\)|(?<=\s\s|.,|ad|\}\.)\s*\((\d{1,2}[a-z]?)\)\s*[.,]?\s*$", re.MULTILINE
)
_TIMES = re.compile(r"(?<![\w\\])(?<!if )t\s*(>=?|<=?|\\geq?|\\in)\s*((0|t_?0)(?![\w.])|\[.*?[)\]])")
_NAMED_BY_COLON = re.compile(r"[\s{]*[A-Za-z]\w*(\d|dot|')\s*:(?!=)(?=[^=<>:]*$)")
_TEXT_COMMAND = re.compile(r"\\(text|textrm|mbox|mathrm)\s*\{([^{}]*)\}")
_WORDS_OF_CASES = re.compile(r"\s*(for|if|when|otherwise|else)[,.]?\s*|\s*\w+\s*")
_FORMULA = re.compile(r"[+*/^=<>()\[\]{}&\\]|(^|\s)-|-(\s|$)|[\d_']\w*\s+\w*[\d_']")
_EQUATION = re.compile(r"[\s\\\w{}'_^()\u0300-\u036f,/.]*?(:?=|<|>|\\[ngl]e)")
_SIGN = re.compile(r"[-+*/^=_)}<>|\]]|:=|\\([lg]eq?|neq?|cdot|times)(?![A-Za-z])")
_EITHER = r"(?:\\text\s*\{\s*)?(?<![\w\\])(?:or|oder|ou)(?!\w)(?:\s*\})?(?=[^\n]{0,300}(?:\\neq?|!=|>))"


def rewritten(source: Source, known: Callable[[str], bool]) -> Source:
    """Return a text with blanks and ends of lines where words were."""
    source = source.sub(_EITHER, r"\lor ")
    own = set(re.findall(r"(?<![\\\w])([A-Za-z]{2,})\s*:?=", source.text))

    def is_name(word: str) -> bool:
        return word in own or known(word)

    text = re.sub(r"(?<!\\)\\\n", "  ", _REMARK.sub(_blanks, source.text))
    lines = [_bare(line, is_name) for line in text.split("\n")]
    count = sum(len(list(_words(line, is_name))) for line in lines)
    related = bool(re.search(r"[=<>]|\\(neq?|[lg]eq?)(?![A-Za-z])", text))
    kept = ("".join(_formulas(line, is_name, count > 1, related)) for line in lines)
    return Source("\n".join(kept), source.origin)


def _blanks(found: re.Match[str] | str) -> str:
    return re.sub(r"[^\n]", " ", found if isinstance(found, str) else found[0])


def _bare(line: str, is_name: Callable[[str], bool]) -> str:
    """Return a line without its number and remarks; sentences in it are lines of their own."""
    if numbered := _NUMBERED.match(line):
        line = " " * numbered.end() + line[numbered.end() :]
    line = _TEXT_COMMAND.sub(lambda f: _as_words(f, is_name), line)
    line = re.sub(r"\(((?:with|where)\s.*)\)(\s*)$", r" \1 \2", line)
    line = re.sub(r"\(([^()\d=<>+*/^&\\]*)\)", lambda f: _remark(f, is_name), _TIMES.sub(_blanks, line))
    if named := _NAMED_BY_COLON.match(line):
        line = line[: named.end() - 1] + "=" + line[named.end() :]
        if line.lstrip().startswith("{"):
            line = line.replace("{", " ", 1).rstrip().removesuffix("}")
    words = re.split(r"(\s+)", line)
    first = next((k for k, word in enumerate(words) if word.strip()), 0)
    begins = words[first].endswith(":") and is_name(words[first][:-1])  # "y1: 2 + 2" is not two lines
    return "".join(word if k == first and begins else _line_end_for_stop(word) for k, word in enumerate(words))


def _remark(found: re.Match[str], is_name: Callable[[str], bool]) -> str:
    words = re.findall(r"[^\W\d_][\w\u0300-\u036f'-]*", found[1])
    return _blanks(found) if any(len(word) > 2 and not is_name(word) for word in words) else found[0]


def _as_words(found: re.Match[str], is_name: Callable[[str], bool]) -> str:
    """Return text{...} unchanged if it stands in cases or names a function, else its words as those of a sentence."""
    word = found[2].strip()
    if (
        re.fullmatch(r"for|if|when|otherwise|else", word.rstrip(",."))
        or (word.isalnum() and is_name(word))
        or len(word) == 1
    ):
        return found[0]
    head = found[0].index("{") + 1
    return "\n" + " " * (head - 1) + found[2] + " "


def _line_end_for_stop(word: str) -> str:
    """Return a word with an end of line for the stop, colon or other mark that ends it; decimal points stay."""
    bare = word.rstrip(",")
    if bare.endswith((".", "!", "?")) and not bare[:-1].isdigit() and not bare.endswith(("\\right.", "\\left.", "..")):
        return bare[:-1] + "\n" + word[len(bare) :]
    if bare.endswith(":") and not bare.endswith("\\:"):
        return bare[:-1] + "\n" + word[len(bare) :]
    return word


def _words(line: str, is_name: Callable[[str], bool]) -> Iterator[re.Match[str]]:
    """Yield words of a line that no formula contains: no name, and without a sign of arithmetic beside them."""
    end = -1  # of the last such word
    for word in _WORD.finditer(line):
        before, after = line[: word.start()].rstrip(" "), line[word.end() :].lstrip(" ")
        beside = before[-1:] in tuple("+-*/^=<>&_\\([{") or bool(_SIGN.match(after))
        if len(word[0]) == 1:  # "a" in a sentence, but not the letter a
            following = _WORD.match(line, len(line) - len(after))
            named = following is not None and is_name(following[0])
            last = end >= 0 and not after
            beside = beside or named or bool(before[max(end, 0) :].strip(" ,")) or not (following or last)
        beside = beside or word[0] in ("plus", "minus", "times")
        if not beside and not is_name(word[0].rstrip(".")) and not _ACCENTED.fullmatch(word[0]):
            end = word.end()
            yield word


def _formulas(line: str, is_name: Callable[[str], bool], sentence: bool, related: bool) -> Iterator[str]:
    """Yield the parts of a line: formulas, each on a line of its own, and blanks for the words between them."""
    found = [(each.start(), each.end()) for each in _words(line, is_name)]
    found = [span for k, span in enumerate(found) if not _factor(line, found, k, sentence, related)]
    if not found:
        yield line
        return
    for (_, start), (end, after) in pairwise([(0, 0), *found, (len(line), len(line))]):
        part = line[start:end]
        # "y1 is measured" says something beside an equation; a number may be meant as a factor
        says = related and re.search(r"[^\W\d_]", part)
        yield part if _FORMULA.search(part) or (re.search(r"\d", part) and not says) else _blanks(part)
        yield "\n" * (after > end) + " " * (after - end - 1)


def _factor(line: str, found: list[tuple[int, int]], k: int, sentence: bool, related: bool) -> bool:
    """Return True if a word may be meant as a factor, b1 speed y3: alone between operands, no equation behind it."""
    start, end = found[k]
    before, after = line[:start].rstrip(), line[end:].lstrip()
    following = bool(k + 1 < len(found)) and not line[end : found[k + 1][0]].strip(" ,'")
    preceding = k > 0 and not line[found[k - 1][1] : start].strip(" ,'")
    if following or preceding or not re.search(r"[\w)}\]']$", before) or (related and not _FORMULA.search(before)):
        return False
    return not _EQUATION.match(after) if re.match(r"[\w\\({\[|]", after) else not (sentence or line[end:].strip())
