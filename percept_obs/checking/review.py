"""Check somebody's derivation, and show the result hint by hint."""

from __future__ import annotations

import difflib
import re
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import sympy as sp

from percept_obs.checking.deciding import same
from percept_obs.checking.explaining import Explanation, explained, plain, sentences, wrong_terms
from percept_obs.checking.limits import SECONDS, TooLong, limited
from percept_obs.checking.lines import INEQUALITY, typed
from percept_obs.checking.matching import Judged, Verdict, judged, steps
from percept_obs.checking.places import put
from percept_obs.checking.points import key
from percept_obs.checking.reading import words_of
from percept_obs.checking.target import Target
from percept_obs.checking.targets import target_of
from percept_obs.validation import checked

MARKS = {
    Verdict.RIGHT: "✓",
    Verdict.WRONG: "✗",
    Verdict.CARRIED: "↳",
    Verdict.CONVENTION: "✓",
    Verdict.CANNOT_TELL: "?",
}
VECTOR = "z1, z2, ... are the entries of any vector z: matrices M are compared by z^T M z"
CANNOT_BE_TOLD = "It cannot be told whether this is the same; write it closer to the usual form."
DECIDING = 0.55 * SECONDS
"""Seconds for deciding and explaining; the rest of `SECONDS` is left for printing."""
HINTS = ("which line", "which term", "which slip, and in which step")


@checked
@dataclass(frozen=True, eq=False)
class Review:
    """The result of a check; it shows itself in a notebook, with as many hints as are asked for.

    Parameters
    ----------
    target : Target
        That the lines are compared with.
    lines : tuple of Judged
        Each with its verdict.
    hints : int
        How many hints are open; see `hint`.
    seconds : float
        Processor time that may be taken to find all hints.
    unused : tuple of str
        Letters that were given a meaning which no line uses.
    chain : str
        Of a derivation: which line is the first that does not follow from the one before.
    dialects : tuple of str
        Dialects in which the text was written, such as "MATLAB"; see `percept_obs.checking.dialects`.

    Raises
    ------
    ValueError
        By `hint`, for another number than 1, 2 and 3.

    See Also
    --------
    check : Makes it.

    Examples
    --------
    >>> from percept_obs import check
    >>> review = check("y1' = b1 y1", "y1' = b1 y1 + b2")
    >>> review.right
    False
    >>> print(review.hint(1))
    Not right yet; hint(2) says which term.
    ✗ y1dot = b1 y1
    """

    target: Target
    lines: tuple[Judged, ...]
    hints: int = 0
    seconds: float = SECONDS
    unused: tuple[str, ...] = ()
    chain: str = ""
    dialects: tuple[str, ...] = ()

    @property
    def right(self) -> bool | None:
        """True if all lines are right; None if that cannot be told, or if a definition is asked about."""
        verdicts = {line.verdict for line in self.lines}
        if verdicts & {Verdict.WRONG, Verdict.CARRIED}:
            return False
        return None if Verdict.CANNOT_TELL in verdicts or self.unused else True

    def hint(self, number: int) -> Review:
        """Return the review with a hint: 1 which line, 2 which term, 3 which slip and in which step."""
        if number not in (1, 2, 3):
            raise ValueError(f"there is no hint {number!r}; there are 1 (which line), 2 (which term), 3 (which slip)")
        return replace(self, hints=number)

    @property
    def explanations(self) -> dict[int, Explanation]:
        """Explanations of wrong lines by their number among `lines`."""
        return _explanations(self.target, self.lines, self.seconds)

    @property
    def summary(self) -> str:
        """Verdict on all lines in a sentence."""
        wrong = [line for line in self.lines if line.verdict == Verdict.WRONG]
        if wrong:
            count = len(self.lines)
            what = f"{len(wrong)} of {count} lines {'is' if len(wrong) == 1 else 'are'} wrong"
            after = max(self.hints, int(count == 1))  # of one line it is known which one is wrong
            more = f"; hint({after + 1}) says {HINTS[after]}" if after < 3 else ""
            told = f" {self.chain[:1].upper()}{self.chain[1:]}." if self.hints and self.chain else ""
            first = next((k for k, line in enumerate(self.lines) if line.verdict == Verdict.WRONG), 0)
            if told and self.hints > 2 and (slips := getattr(self.explanations.get(first), "slips", ())):
                lost = f"you lost {plain(slips[0].after)}" if slips[0].kind == "missing" else ""
                told = re.sub(r"(line \d+)(;|\.$)", rf"\1: {lost}\2", told) if lost else told
            return (what if count > 1 else "Not right yet") + more + "." + told
        untold = [line for line in self.lines if line.verdict == Verdict.CANNOT_TELL]
        if untold:
            return next((f"{line.note.capitalize()}." for line in untold if line.note), CANNOT_BE_TOLD)
        if self.unused:
            return self._asked
        rows = sorted({line.row for line in self.lines})
        names = list(dict.fromkeys(self.target.lines[row].whole for row in rows))
        if len(rows) == len(self.target.lines):
            which = ""
        else:  # it says what was looked at: whoever is asked for one line has not left out the others
            which = f": {', '.join(names)}" if all(names) else f", {len(rows)} of {len(self.target.lines)} lines"
        notes = sorted({line.note for line in self.lines if line.note})
        told = "; ".join([f"Right{which}", *notes, *filter(None, [self.target.note])])
        return told.replace("; right for", " for", 1) + "."

    @property
    def _asked(self) -> str:
        """Question about definitions that nothing uses."""
        first, names = self.unused[0], [line.name for line in self.target.lines if line.name]
        near = difflib.get_close_matches(first, [line.key for line in self.target.lines if line.key], 1, 0.5)
        meant = f", or is it meant to be {names[[typed(name) for name in names].index(near[0])]}" if near else ""
        return f"The rest is right, but no line uses {first}: is it left over{meant}?"

    def __str__(self) -> str:
        out = [self.summary]
        for k, line in enumerate(self.lines):
            name = self.target.lines[line.row].name
            out.append(f"{self._mark(line)} {f'{name} = ' if name else ''}{plain(line.mine)}")
            out += [f"    {text}" for text in self._told(k, plain)]
        return "\n".join(out)

    def _repr_markdown_(self) -> str:
        out = [f"**{self.summary}**"]
        for k, line in enumerate(self.lines):
            out.append(f"{self._mark(line)}\n\n$$ {_left(self.target.lines[line.row].name)}{self._boxed(k)} $$")
            out += [f"- {text}" for text in self._told(k, lambda e: f"${_latex(e)}$")]
        return "\n\n".join(out)

    def _mark(self, line: Judged) -> str:
        """Return the mark of a line, a blank before the first hint."""
        return " " if self.right is False and not self.hints else MARKS[line.verdict]

    def _told(self, k: int, show: Callable[[sp.Basic], str]) -> Iterator[str]:
        """Yield the sentences that the hints asked for so far show on a line."""
        line = self.lines[k]
        if line.verdict == Verdict.WRONG and self.hints > 1 and k in self.explanations:
            where, slips, steps = sentences(self.explanations[k], line.mine, show)
            yield from where if self.hints == 2 else [*slips, *steps]
        elif (line.verdict == Verdict.CARRIED and self.hints) or (line.verdict == Verdict.WRONG and self.hints > 2):
            yield line.note
        vector = any(re.fullmatch(r"z\d", s.name) for s in line.mine.free_symbols - self.target.pool)
        if self.hints and vector and self.target.lines[line.row].kind == INEQUALITY:
            yield VECTOR

    def _boxed(self, k: int) -> str:
        """Return the line in LaTeX, from the second hint on with wrong terms in a box."""
        mine = self.lines[k].mine
        boxes: dict[sp.Symbol, str] = {}
        for path, term in wrong_terms(self.explanations[k], mine) if self.hints > 1 and k in self.explanations else ():
            box, minus = sp.Dummy(), term.could_extract_minus_sign()
            boxes[box] = rf"\boxed{{{_latex(-term if minus else term)}}}"
            mine = put(mine, path, -box if minus else box)
        return str(sp.latex(mine, symbol_names=boxes | _strange(mine))) if boxes else _latex(mine)


@lru_cache(maxsize=64)
def _explanations(target: Target, lines: tuple[Judged, ...], seconds: float) -> dict[int, Explanation]:
    """Explain wrong lines, once for all hints."""
    good = {line.row: line.mine for line in lines if line.verdict == Verdict.RIGHT}
    wrong = {k: e for k, e in enumerate(lines) if e.verdict == Verdict.WRONG and not e.note}
    found: dict[int, Explanation] = {}

    def explain() -> None:
        for k, line in wrong.items():
            found[k] = explained(line.mine, line.row, target, good)

    try:
        limited(explain, seconds)
    except TooLong as error:
        found |= {k: Explanation(whole=str(error)) for k in wrong if k not in found}
    return found


@lru_cache(maxsize=64)
def _latex(e: sp.Basic) -> str:
    return str(sp.latex(e, symbol_names=_strange(e)))


def _strange(e: sp.Basic) -> dict[sp.Symbol, str]:
    """Names of symbols that are no names, such as "<b>$", without the letters that would be markup."""
    symbols = [each for each in e.free_symbols if re.search(r"[^\w\s'^{}\\,.+-]", each.name)]
    return {each: rf"\text{{{re.sub(r'[^a-zA-Z0-9 ]', '?', each.name)}}}" for each in symbols}


def _left(name: str) -> str:
    """Return the left side of a line in LaTeX."""
    if name.endswith("'"):
        return rf"\dot{{{sp.latex(sp.Symbol(name[:-1]))}}} = "
    return rf"\text{{{name}}} = " if " " in name else f"{sp.latex(sp.Symbol(name))} = " if name else ""


def check(mine: Any, target: Any) -> Review:
    """Check somebody's formulas against what the package derives, or against a formula of one's own.

    Parameters
    ----------
    mine : str, sympy expression, matrix or relation, or a list or a mapping of them
        Text as one types it, "y1' = a13 + (a11 - a33) y1 + ...", with ``^`` or ``**``, or LaTeX as papers and the
        package print it, also in a sentence.  Letters are matched by name.  One line or several; a line with a new
        letter on its left, "where q = a31 y1", gives that letter a meaning.  In a mapping, 5 stands for the fifth step
        of a derivation.
    target : anything that the package derives
        A system or a form (their rates, and by name "Z' = ...", "w = ...", "phi = ...", "g = ..."), an observer (its
        flow, and by name the rate of its error "e1' = ...", its Jacobian "F = ...", and for a "V = ..." of one's own
        "V' = ..."; its updates are ``observer.equations.update``), a matrix such as ``form.w``, a step of a derivation
        or all of it, a condition of observability (where it fails counts, not its form), a corollary (also "det = ...",
        "Omega = ..."), an entry of a paper's ledger (its correction, if it is a misprint), or a formula of one's own,
        in sympy or as text.

    Returns
    -------
    Review
        Shows itself; ``review.hint(1)`` says which line is wrong, 2 which term, 3 which slip and in which step.

    Raises
    ------
    CannotRead
        If the text is no formula of the target's letters; it says where, and what is allowed.
    ValueError
        If lines and target do not fit, or if reading takes longer than two seconds (TooLong).

    See Also
    --------
    percept_obs.checking.target_of : What formulas a target has.

    Notes
    -----
    What is rational in letters, roots, exponentials, angles and signs is proved, as quotients of polynomials or by
    exact values at a point that nobody knows, which is wrong once in 10^25 times.  The rest is compared at random
    values of all sizes; the review says so, and where it is right.  A "no" is certain.  Where nothing decides, the
    verdict is "cannot tell", with the reason if it takes longer than two seconds of computing.

    Of a photo of a derivation, give what Mathpix, or a chat program that is asked for LaTeX, makes of it: that is read
    as it is, with its delimiters, numbers and words.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, check, pinhole
    >>> system = PerspectiveSystem(affine(), pinhole())
    >>> check("y3' = -y3 (a31 y1 + a32 y2 + a33 + b3 y3)", system).right
    True
    >>> review = check("y3' = -y3 (a31 y1 + a32 y2 + a33 - b3 y3)", system)
    >>> print(review)
    Not right yet; hint(2) says which term.
      y3' = -y3 (a31 y1 + a32 y2 + a33 - b3 y3)
    >>> print(review.hint(2))
    Not right yet; hint(3) says which slip, and in which step.
    ✗ y3' = -y3 (a31 y1 + a32 y2 + a33 - b3 y3)
        look at -b3 y3
    """
    goal = target_of(target)
    words_of("y1")  # loads the grammar, which takes its time once
    began = time.thread_time()

    def lines() -> Review:
        meant = goal.asked(goal.read(mine))
        text = meant.read(mine)
        meant = meant.signed(text)
        found, known = judged(text.lines, meant), {key(s.name): e for s, e in meant.relations.items()}
        left_over = (d for d in text.definitions if not d.used and not same(d.formulas[-1], known.get(d.name, sp.nan)))
        unused = tuple(d.name for d in left_over)
        if not found:
            raise ValueError("there are definitions only; add the line that is asked for")
        chain = steps(text, found, meant, mine)
        return Review(meant, found, unused=unused, chain=chain, dialects=text.dialects)

    found = limited(lines, DECIDING)
    return replace(found, seconds=max(DECIDING - (time.thread_time() - began), 0.1))
