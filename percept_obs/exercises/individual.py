"""A student's own notebook: numbers, factors of letters and the order of options follow from a name."""

from __future__ import annotations

import ast
import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from hashlib import sha256
from typing import Any

OURS = "percept_obs"
"""Key of what a cell or a notebook says to this package in its metadata."""

_OPTION = re.compile(r"^- ([a-z]): (.*)$", re.MULTILINE)


def same_name(student: str) -> str:
    """Return a name without spaces around it, in small letters, however its accents are typed."""
    return unicodedata.normalize("NFKC", student).strip().casefold()


def drawn(student: str, what: str, count: int) -> int:
    """Return a number below a count that follows from a name, the same on every machine and in every version."""
    return int.from_bytes(sha256(f"{same_name(student)}\n{what}".encode()).digest()) % count


def replaced(rules: Mapping[str, Sequence[Any]], student: str, what: str) -> list[tuple[str, str]]:
    """Return what is replaced by what in the texts of a task: of each number the places where it stands.

    A rule is ``{"8": ["6", "10", "0.1", "gain={}", "gain of {} "]}``: a number, from, to, step, and its places.
    """
    pairs = []
    for number, (low, high, step, *places) in rules.items():
        count = int((Decimal(high) - Decimal(low)) / Decimal(step)) + 1
        own = Decimal(low) + drawn(student, f"{what} {number}", count) * Decimal(step)
        pairs += [(place.replace("{}", number), place.replace("{}", f"{own.normalize():f}")) for place in places]
    return pairs


def put(text: str, pairs: Iterable[tuple[str, str]]) -> str:
    """Return a text with all pairs replaced."""
    for old, new in pairs:
        text = text.replace(old, new)
    return text


def individual(notebook: Mapping[str, Any], student: str) -> dict[str, Any]:
    """Return a notebook whose exercises are a student's own; solutions and checks are those of the student.

    Parameters
    ----------
    notebook : mapping
        As its file has it; it is not changed.
    student : str
        A name or a number; capitals and spaces around it do not matter.

    Raises
    ------
    ValueError
        If the name is empty.

    See Also
    --------
    students_copy : Takes the solutions out.

    Notes
    -----
    The task's cell says in its metadata what can be another: numbers with their ranges and places, and letters with the
    range of a whole factor.  Options to choose from stand in an order of the student's own.

    Examples
    --------
    >>> rules = {"numbers": {"10": ["5", "15", "0.1", "within {} s"]}}
    >>> task = {"cell_type": "markdown", "id": "wait-task", "source": ["Arrive within 10 s."]}
    >>> task["metadata"] = {"tags": ["exercise"], "percept_obs": rules}
    >>> individual({"metadata": {}, "cells": [task]}, "Ada")["cells"][0]["source"]
    ['Arrive within 7.9 s.']
    """
    if not same_name(student):
        raise ValueError("an empty name has no tasks; give a student's name or number")
    cells, task = [], None
    for cell in notebook["cells"]:
        tags = set(cell["metadata"].get("tags", ()))
        if cell["cell_type"] == "markdown" and "exercise" in tags:
            task = _task(cell, student)
        if task and tags & {"exercise", "hint", "solution"}:
            cell = {**cell, "source": task.text(cell, tags).splitlines(keepends=True)}
        cells.append(cell)
    said = {**notebook["metadata"], OURS: {"student": student.strip()}}
    return {**notebook, "metadata": said, "cells": cells}


@dataclass(frozen=True)
class _Task:
    """A student's own version of an exercise."""

    numbers: list[tuple[str, str]]
    factors: Mapping[str, int]
    order: str

    def text(self, cell: Mapping[str, Any], tags: set[str]) -> str:
        """Return the text of one of the exercise's cells in this version."""
        text = put("".join(cell["source"]), self.numbers)
        if cell["cell_type"] == "markdown":
            return self._words(text) if "exercise" in tags else text
        return self._solution(text) if "solution" in tags else self._check(text)

    def _words(self, text: str) -> str:
        options = dict(_OPTION.findall(text))
        shown = iter(zip(sorted(self.order), self.order, strict=True))
        text = _OPTION.sub(lambda _: "- {}: {}".format(*((own := next(shown))[0], options[own[1]])), text)
        if not self.factors:
            return text
        own = ", ".join(f"`{factor} {letter}` for `{letter}`" for letter, factor in self.factors.items())
        return f"{text}\n\n**Yours:** put {own} wherever the task and its hint have that letter. Your answer has it so, too."

    def _solution(self, text: str) -> str:
        place = {old: new for new, old in zip(sorted(self.order), self.order, strict=True)}
        text = re.sub(r'"([a-z])"$', lambda found: f'"{place.get(found[1], found[1])}"', text)
        names = "|".join(self.factors)
        return re.sub(rf"\b({names})\b", lambda found: f"({self.factors[found[1]]} {found[1]})", text) if names else text

    def _check(self, text: str) -> str:
        """Return a check whose last call has the options in the student's order, and the letters with their factors."""
        call = ast.parse(text).body[-1]
        if not (isinstance(call, ast.Expr) and isinstance(call.value, ast.Call)):
            return text
        keywords = call.value.keywords
        if self.order:
            kept = {word.arg: word.value for word in keywords}
            pairs = zip(sorted(self.order), self.order, strict=True)
            call.value.keywords = [ast.keyword(new, kept[old]) for new, old in pairs]
        if self.factors:
            keywords.append(ast.keyword("letters", ast.Constant(dict(self.factors))))
        before = text.splitlines(keepends=True)[: call.lineno - 1]
        return "".join((*before, ast.unparse(call)))


def _task(cell: Mapping[str, Any], student: str) -> _Task:
    """Return a student's version of the exercise that a cell begins."""
    rules, what = cell["metadata"].get(OURS, {}), cell.get("id", "")
    letters = {}
    for letter, (low, high) in rules.get("letters", {}).items():
        factors = [factor for factor in range(low, high + 1) if factor]
        letters[letter] = factors[drawn(student, f"{what} {letter}", len(factors))]
    order, left = "", [letter for letter, _ in _OPTION.findall("".join(cell["source"]))]
    while left:
        order += left.pop(drawn(student, f"{what} option {len(left)}", len(left)))
    return _Task(replaced(rules.get("numbers", {}), student, what), letters, order)
