"""A text on its way to the plain form; each of its characters knows where it comes from."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

PAIRS = {"(": ")", "[": "]", "{": "}"}
DEEPEST = 40
"""Brackets in brackets up to which calls are rewritten; what is deeper is refused later."""


@dataclass(frozen=True)
class Source:
    """A text, and for each of its characters the place in what was typed."""

    text: str
    origin: tuple[int, ...]

    def sub(self, pattern: str | re.Pattern[str], new: str | Callable[[re.Match[str]], str]) -> Source:
        r"""Return the text with a pattern replaced; groups \1 of a template keep their places, the rest has the first.

        >>> Source("a b", (0, 1, 2)).sub("(a) (b)", r"\2 + \1")
        Source(text='b + a', origin=(2, 0, 0, 0, 0))
        """
        spans: list[tuple[int, int] | tuple[str, int]] = []
        end = 0
        for found in re.finditer(pattern, self.text):
            spans.append((end, found.start()))
            for k, part in enumerate(re.split(r"\\(\d)", new) if isinstance(new, str) else [new(found)]):
                spans.append(found.span(int(part)) if k % 2 else (part, found.start()))
            end = found.end()
        return self._joined([*spans, (end, len(self.text))]) if end or spans else self

    def calls(self, templates: Mapping[str, str], before: str = r"(?<![\w\\.])", kind: str = "(") -> Source:
        r"""Return the text with calls rewritten: \1 is the first argument, \0 all of them.

        In TeX arguments stand in braces of their own, which may follow a _ or ^: \underbrace{a}_{b}.

        >>> Source("pow(y, 2)", tuple(range(9))).calls({"pow": r"(\1)^(\2)"}).text
        '(y)^( 2)'
        """
        partner = partners(self.text)
        if partner is None:
            return self
        names = "|".join(map(re.escape, sorted(templates, key=len, reverse=True)))
        pattern = re.compile(rf"{before}({names})\s*(?={re.escape(kind)})")

        def emitted(start: int, end: int) -> Iterator[tuple[int, int] | tuple[str, int]]:
            while found := pattern.search(self.text, start, end):
                template = templates[found[1]]
                wanted = max(map(int, re.findall(r"\\(\d)", template)), default=0)
                arguments, close = self._arguments(found.end(), partner, wanted if kind == "{" else 0)
                yield start, found.start()
                if len(arguments) < max(wanted + 1, 2) or close > end:
                    yield found.span()
                    start = found.end()
                    continue
                for k, part in enumerate(re.split(r"\\(\d)", template)):
                    if k % 2:
                        yield from emitted(*arguments[int(part)])
                    else:
                        yield part, found.start()
                start = close
            yield start, end

        return self._joined([*emitted(0, len(self.text))])

    def _arguments(self, start: int, partner: Mapping[int, int], braces: int) -> tuple[list[tuple[int, int]], int]:
        """Return the spans of all arguments and of each, and where the call ends."""
        close = partner.get(start, len(self.text))
        whole, found, at = (start + 1, close), [], start + 1
        for _ in range(braces):
            if self.text[start : start + 1] != "{" or start not in partner:
                break
            found.append((start + 1, partner[start]))
            close = partner[start]
            more = re.compile(r"\s*[_^]?\s*(?=\{)").match(self.text, close + 1)
            start = more.end() if more else close + 1
        k = at
        while not braces and k < close:
            if self.text[k] == ",":
                found.append((at, k))
                at = k + 1
            k = partner.get(k, k) + 1
        return [whole, *found, *([] if braces else [(at, close)])], close + 1

    def _joined(self, spans: list[tuple[int, int] | tuple[str, int]]) -> Source:
        texts, origins = [], []
        for first, second in spans:
            if isinstance(first, str):
                texts.append(first)
                origins += [self.origin[min(second, len(self.origin) - 1)]] * len(first) if self.origin else []
            elif first >= 0:
                texts.append(self.text[first:second])
                origins += self.origin[first:second]
        return Source("".join(texts), tuple(origins))


def partners(text: str) -> dict[int, int] | None:
    """Return where brackets that begin at a place end; None if they are nested too deep."""
    opened: list[int] = []
    found: dict[int, int] = {}
    for k, c in enumerate(text):
        if c in PAIRS:
            opened.append(k)
            if len(opened) > DEEPEST:
                return None
        elif opened and c == PAIRS[text[opened[-1]]]:
            found[opened.pop()] = k
    return found
