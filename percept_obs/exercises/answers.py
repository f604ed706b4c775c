"""Answers to exercises: a formula is derived, a result is predicted, gains reach a goal."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import inf
from types import EllipsisType, MappingProxyType
from typing import Any

from percept_obs.checking import Review, Target, check, target_of
from percept_obs.validation import checked, of_kind
from percept_obs.validation.arguments import described
from percept_obs.validation.plain import is_real


@checked
@dataclass(frozen=True)
class Attempt:
    """Reply to an answer; it shows itself in a notebook.

    Parameters
    ----------
    right : bool or None
        None if there is no answer yet.
    reply : str
        One sentence or more.

    See Also
    --------
    derive, choose, reach : Make one.

    Examples
    --------
    >>> print(Attempt(False, "This is asked for as well: y2'."))
    This is asked for as well: y2'.
    """

    right: bool | None
    reply: str

    def __str__(self) -> str:
        return self.reply

    def hint(self, number: int) -> Attempt:
        """Return the reply with a note that it has no hints, for only a review of a formula has some."""
        why = NO_HINT if self.right is None else "This reply says all that there is: it has no hints."
        return replace(self, reply=f"{self.reply} {why}")

    def _repr_markdown_(self) -> str:
        return {True: "✓ ", False: "✗ ", None: ""}[self.right] + self.reply


UNANSWERED = "Not answered yet. Put your answer in the place of the dots, and run both cells."
NO_HINT = "A hint needs an answer first."
REFUSALS = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)
"""Errors that an answer of another kind than is asked for raises where it is used."""


@checked
def derive(
    mine: Any, target: Any, *asked: str, letters: Mapping[str, float] = MappingProxyType({})
) -> Attempt | Review:
    """Check a formula by `percept_obs.check`; dots are no answer yet, and no line may be missing.

    Parameters
    ----------
    mine : as for `check`, or ...
    target : as for `check`
    *asked : str
        The names of the lines that are asked for, such as "y1'"; all lines without them.
    letters : mapping of names to numbers
        Letters that stand with a factor in this task, as a student's own has them.

    Returns
    -------
    Attempt or Review
        A review gives hints: ``derive(mine, target).hint(1)`` says which line, 2 which term, 3 which slip.  An attempt
        says why there is nothing to review: no answer, a line that is missing, or no formula of the target's letters.

    Raises
    ------
    ValueError
        If a line that is asked for, or a letter with a factor, is none of the target's.

    See Also
    --------
    percept_obs.check : Checks a formula.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> system = PerspectiveSystem(affine(), pinhole())
    >>> print(derive(..., system, "y3'"))
    Not answered yet. Put your answer in the place of the dots, and run both cells.
    >>> derive("y3' = -y3 (a31 y1 + a32 y2 + a33 + b3 y3)", system, "y3'").right
    True
    >>> derive("y3' = -y3 (a31 y1 + a32 y2 + a33 - 2 b3 y3)", system, "y3'", letters={"b3": -2}).right
    True
    """
    if isinstance(mine, EllipsisType):
        return Attempt(None, UNANSWERED)
    if len(asked) == 1 and isinstance(mine, str) and "=" not in mine:  # the right-hand side alone
        mine = f"{asked[0]} = {mine}"
    goal = _with_factors(target_of(target), letters) if letters else target_of(target)
    names = [line.name for line in goal.lines]
    if unknown := [name or "''" for name in asked if name not in names]:
        raise ValueError(f"there is no line {', '.join(unknown)}; the target has {', '.join(filter(None, names))}")
    try:
        review = check(mine, goal)
    except REFUSALS as error:  # CannotRead is one of them; the place in the text stands below a blank line
        return Attempt(None, f"This cannot be checked: {error}".replace("\n", "\n\n", 1))
    answered = {line.row for line in review.lines}
    missing = [
        line.name or f"line {row + 1}"
        for row, line in enumerate(review.target.lines)
        if row not in answered and (not asked or line.name in asked)
    ]
    return Attempt(False, f"This is asked for as well: {', '.join(missing)}.") if missing else review


def _with_factors(target: Target, factors: Mapping[str, float]) -> Target:
    """Return a target with a number before some letters, and before all entries of those that are matrices."""
    used = set().union(*(line.formula.free_symbols for line in target.lines))
    known = {s: factors[name] * s for s in used for name in (s.name, re.sub(r"_\d+$", "", s.name)) if name in factors}
    names = {re.sub(r"_\d+$", "", symbol.name) for symbol in used} | {symbol.name for symbol in used}
    if strange := sorted(name for name, factor in factors.items() if name not in names or not 0 < abs(factor) < inf):
        raise ValueError(f"no letter can have the factor of {', '.join(strange)}; there are {', '.join(sorted(names))}")
    lines = tuple(replace(line, formula=line.formula.xreplace(known)) for line in target.lines)
    return replace(target, lines=lines, derivation=None, elsewhere=None, others={})


@checked
def choose(mine: Any, found: str, **options: bool) -> Attempt:
    """Compare a prediction with the result of an experiment.

    Parameters
    ----------
    mine : str or ...
        The letter of an option.
    found : str
        Result of the experiment in words; shown only after a choice.
    **options : bool
        True for the option that the experiment confirms; exactly one is.

    Returns
    -------
    Attempt

    Raises
    ------
    ValueError
        If not exactly one option is found.

    See Also
    --------
    derive, reach : Answers of other kinds.

    Examples
    --------
    >>> seconds = 2.5
    >>> print(choose("a", f"It takes {seconds} s.", a=seconds < 2, b=seconds >= 2))
    You said a, the experiment says b. It takes 2.5 s.
    """
    right = [letter for letter, holds in options.items() if holds]
    if len(right) != 1:
        raise ValueError(f"exactly one option can be right, here {right or 'none'}; change the options")
    if isinstance(mine, EllipsisType):
        return Attempt(None, f"Choose first: {', '.join(options)}. Then see.")
    choice = str(mine).strip().lower()
    if choice not in options:
        return Attempt(None, f"{mine!r} is no option. Choose one of {', '.join(map(repr, options))}.")
    if choice == right[0]:
        return Attempt(True, f"Yes, {choice}. {found}")
    return Attempt(False, f"You said {choice}, the experiment says {right[0]}. {found}")


@checked
def reach(mine: Any, judge: Callable[[Any], Mapping[str, float]], **most: float) -> Attempt:
    """Judge an answer, such as a set of gains, by the numbers of an experiment.

    Parameters
    ----------
    mine : anything that `judge` takes, or ...
    judge : function
        Runs the experiment and returns its numbers by name.
    **most : float
        Largest allowed value for each of these names.

    Returns
    -------
    Attempt

        It says why, if `judge` cannot take an answer of this kind.

    Raises
    ------
    ValueError
        If no number is asked for, or `judge` does not give one that is.

    See Also
    --------
    choose, derive : Answers of other kinds.

    Examples
    --------
    >>> print(reach(2.0, lambda gain: {"seconds": 6 / gain}, seconds=2))
    Not reached yet: seconds 3 (2 is allowed).
    """
    if not most:
        raise ValueError("nothing is to be reached; give the largest allowed value of a number by name, as seconds=2")
    if isinstance(mine, EllipsisType):
        return Attempt(None, UNANSWERED)
    try:
        numbers = judge(mine)
    except REFUSALS as error:
        quoted = "; a number stands without quotes" if isinstance(mine, str) else ""
        return Attempt(None, f"The experiment cannot run with {mine!r}{quoted}. It says: {error}")
    of_kind("reach", f"what {getattr(judge, '__name__', 'judge')} returns", numbers, Mapping[str, Any])
    if missing := [name for name in sorted(most) if not is_real(numbers.get(name))]:
        given = (f"{name}, {described(value)}" if name in missing else name for name, value in numbers.items())
        raise ValueError(f"the experiment gives no number {', '.join(missing)}; it gives {', '.join(given)}")
    right = all(numbers[name] <= limit for name, limit in most.items())
    results = [f"{name.replace('_', ' ')} {numbers[name]:.3g} ({limit:g} is allowed)" for name, limit in most.items()]
    return Attempt(right, f"{'Reached' if right else 'Not reached yet'}: {', '.join(results)}.")
