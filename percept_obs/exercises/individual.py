"""A student's own notebook: numbers, factors of letters and the order of options follow from a name."""

from __future__ import annotations

import ast
import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from hashlib import sha256
from typing import Any

from percept_obs.exercises.models import cells_of, statements
from percept_obs.validation import checked

OURS = "percept_obs"
"""Key of what a cell or a notebook says to this package in its metadata."""

_NUMBER = re.compile(r"-?\d+(\.\d+)?")
_OPTION = re.compile(r"^- ([a-z]): (.*)$", re.MULTILINE)


def same_name(student: str) -> str:
    """Return a name in small letters, without spaces around it, however its accents are typed."""
    return unicodedata.normalize("NFKC", student).strip().casefold()


def drawn(student: str, what: str, count: int) -> int:
    """Return a number below a count that follows from a name, the same on every machine and in every version."""
    return int.from_bytes(sha256(f"{same_name(student)}\n{what}".encode()).digest(), "big") % count


def with_numbers(text: str, rules: Mapping[str, Sequence[str]], student: str, what: str) -> str:
    """Return a text with numbers that follow from a name.

    Rules say for a number from where to where it goes, in which steps, and the places where it stands:
    ``{"8": ["6", "10", "0.1", "gain={}", "gain of {} "]}``.
    """
    for number, (low, high, step, *places) in rules.items():
        count = int((Decimal(high) - Decimal(low)) / Decimal(step)) + 1
        own = (Decimal(low) + drawn(student, f"{what} {number}", count) * Decimal(step)).normalize()
        for place in places:
            text = text.replace(place.replace("{}", number), place.replace("{}", f"{own:f}"))
    return text


@checked
def individual(notebook: Mapping[str, Any], student: str) -> dict[str, Any]:
    """Return a notebook whose exercises are a student's own: tasks, solutions and checks.

    Parameters
    ----------
    notebook : mapping
        As its file has it; it is not changed.
    student : str
        A name or a number; capitals and spaces around it do not matter.

    Raises
    ------
    ValueError
        If it is no notebook or a student's, the name is empty, or a rule cannot be followed.

    See Also
    --------
    students_copy : Takes the solutions out.

    Notes
    -----
    The cell of a task says in its metadata what is a student's own: "numbers", with their ranges and places, and
    "letters", with the range of a whole factor.  Options to choose from stand in an order of the student's own.

    Examples
    --------
    >>> rules = {"numbers": {"10": ["5", "15", "0.1", "within {} s"]}}
    >>> task = {"cell_type": "markdown", "id": "wait-task", "source": ["Arrive within 10 s."]}
    >>> task["metadata"] = {"tags": ["exercise"], "percept_obs": rules}
    >>> individual({"metadata": {}, "cells": [task]}, "Ada")["cells"][0]["source"]
    ['Arrive within 14.8 s.']
    """
    if not same_name(student):
        raise ValueError("an empty name has no tasks; give a student's name or number")
    cells, task = [], None
    whole = "".join("".join(cell["source"]) for cell in cells_of(notebook))
    metadata = notebook.get("metadata", {})
    if own := metadata.get(OURS, {}).get("student"):
        raise ValueError(f"this notebook is {own}'s own already; give the one that is common to all")
    for cell in cells_of(notebook):
        tags, text = set(cell["metadata"].get("tags", ())), "".join(cell["source"])
        if cell["cell_type"] == "markdown" and "exercise" in tags:
            _refuse_rules(cell, whole)
            task = _Task.of(cell, student)
        if task and tags & {"exercise", "hint", "solution"}:
            text = with_numbers(text, task.numbers, student, task.name)
            change = task.changes.get((cell["cell_type"], *tags), str)
            cell = {**cell, "source": change(text).splitlines(keepends=True)}
        cells.append(cell)
    return {**notebook, "metadata": {**metadata, OURS: {"student": student.strip()}}, "cells": cells}


def _refuse_rules(cell: Mapping[str, Any], whole: str) -> None:
    """Raise a ValueError for rules of a task that cannot be followed, or do nothing in the whole notebook."""
    rules, task = cell["metadata"].get(OURS, {}), cell.get("id", "")
    if strange := sorted(set(rules) - {"letters", "numbers", "rubric"}):
        raise ValueError(f"the task {task!r} has {', '.join(strange)}; there are letters, numbers, rubric")
    for number, rule in rules.get("numbers", {}).items():
        fits = len(rule) > 3 and all(isinstance(part, str) for part in rule) and all(map(_NUMBER.fullmatch, rule[:3]))
        if not (fits and Decimal(rule[0]) <= Decimal(rule[1]) and Decimal(rule[2]) > 0):
            told = f"the task {task!r} has for {number} the rule {rule!r}"
            raise ValueError(f"{told}; give texts: from, to, a positive step, and places such as 'gain of {{}}'")
        if lost := [place for place in rule[3:] if place.replace("{}", number) not in whole]:
            raise ValueError(f"the task {task!r} has for {number} the place {lost[0]!r}, which is nowhere; mend it")


@dataclass(frozen=True)
class _Task:
    """A student's own version of an exercise."""

    name: str
    numbers: Mapping[str, Sequence[str]]
    factors: Mapping[str, int]
    order: str  # of the shipped options

    @classmethod
    def of(cls, cell: Mapping[str, Any], student: str) -> _Task:
        """Return a student's version of the exercise that a cell begins."""
        rules, name = cell["metadata"].get(OURS, {}), cell.get("id", "")
        factors, order, left = {}, "", [letter for letter, _ in _OPTION.findall("".join(cell["source"]))]
        for letter, (low, high) in rules.get("letters", {}).items():
            choices = [factor for factor in range(low, high + 1) if factor]
            factors[letter] = choices[drawn(student, f"{name} {letter}", len(choices))]
        while left:
            order += left.pop(drawn(student, f"{name} option {len(left)}", len(left)))
        return cls(name, rules.get("numbers", {}), factors, order)

    @property
    def changes(self) -> Mapping[tuple[str, ...], Any]:
        """Changes of the text of a cell, by its kind and tag."""
        return {
            ("markdown", "exercise"): self.words,
            ("code", "solution"): self.solution,
            ("code", "exercise"): self.check,
        }

    def words(self, text: str) -> str:
        """Return the task with its options in order, and with what stands for each letter."""
        options, own = dict(_OPTION.findall(text)), iter(zip(sorted(self.order), self.order, strict=True))
        text = _OPTION.sub(lambda _: "- {}: {}".format(*((pair := next(own))[0], options[pair[1]])), text)
        put = ", ".join(f"`{factor} {letter}` for `{letter}`" for letter, factor in self.factors.items())
        return f"{text}\n\n**Yours:** put {put} in the task and its hint. Your answer has it so, too." if put else text

    def solution(self, text: str) -> str:
        """Return the solution with the student's letter of an option, or with factors before letters of a formula."""
        place = dict(zip(self.order, sorted(self.order), strict=True))
        text = re.sub(r'"([a-z])"$', lambda found: f'"{place.get(found[1], found[1])}"', text)
        pattern = rf"\b({'|'.join(self.factors) or '(?!)'})\b"
        return re.sub(pattern, lambda found: f"({self.factors[found[1]]} {found[1]})", text)

    def check(self, text: str) -> str:
        """Return the check whose last call has the options in order, or knows the factors of letters."""
        last = statements(text)[-1]
        if not (self.order or self.factors) or not isinstance(last, ast.Expr) or not isinstance(last.value, ast.Call):
            return text
        if self.order:
            kept = {str(word.arg): word.value for word in last.value.keywords}
            if sorted(kept) != sorted(self.order):
                raise ValueError(f"the check of {self.name!r} lacks its options; give the notebook with solutions")
            last.value.keywords = [
                ast.keyword(new, kept[old]) for new, old in zip(sorted(kept), self.order, strict=True)
            ]
        if self.factors:
            last.value.keywords.append(ast.keyword("letters", ast.parse(repr(self.factors), mode="eval").body))
        return "".join((*text.splitlines(keepends=True)[: last.lineno - 1], ast.unparse(last)))
