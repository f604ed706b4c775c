"""Lines of a program for many runs side by side: numba loops over the runs, numpy takes arrays of them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from inspect import getsource
from itertools import chain

from percept_obs.compile import vector_functions
from percept_obs.compile.kernels import Language
from percept_obs.compile.text import Text

_NAME = re.compile(r"[A-Za-z_]\w*")


class ManyRuns(Text):
    """Lines as for one run, where a condition is no branch but a choice between two numbers.

    For numba a loop over runs has local variables of one run.  Those that another such loop reads, or the same one the
    next time, stay between them in rows of `work`.
    """

    def __init__(self, language: Language, width: str) -> None:
        super().__init__("many")
        self.numba, self.width = language == "numba", width
        self.loops: list[range] = []  # numbers of the lines inside each loop over runs
        self.choosing = False

    def __str__(self) -> str:
        lines = self._with_rows() if self.numba else self.lines
        # numba compiles the functions of numbers; numpy has its own of arrays
        arrays = "" if self.numba else "\n\nmath, where, some = np, np.where, np.any\n"
        return "\n".join([f"{getsource(vector_functions)}{arrays}\n", *lines, ""])

    @contextmanager
    def runs(self) -> Iterator[None]:
        """Open a loop over the runs."""
        begin = len(self.lines) + 1
        with self._indented(f"for i in range({self.width})" if self.numba else "for i in (slice(None),)", ""):
            yield
        self.loops.append(range(begin, len(self.lines)))

    @contextmanager
    def only(self, condition: str) -> Iterator[None]:
        """Choose in what `replace` adds inside."""
        self.assign("chosen", condition)
        self.choosing = True
        yield
        self.choosing = False

    def replace(self, name: str, expression: str) -> None:
        """Assign a local variable; inside `only` where its condition holds."""
        self.assign(name, f"where(chosen, {expression}, {name})" if self.choosing else expression)

    def _with_rows(self) -> list[str]:
        """Lines with those that load and store the rows of `work`."""
        lines, parts = list(self.lines), [line.strip().partition(" = ") for line in self.lines]
        assigned = [dict.fromkeys(parts[number][0] for number in loop) for loop in self.loops]
        read = [self._read_first([parts[number] for number in loop]) for loop in self.loops]
        inside = {number for loop in self.loops for number in loop}
        shared = {target for number, (target, *_) in enumerate(parts) if number not in inside}
        kept = [name for name in chain(*assigned) if name not in shared and any(name in each for each in read)]
        rows = {name: f"work[{k}, i]" for k, name in enumerate(dict.fromkeys(kept))}
        for loop, first, last in zip(self.loops, read, assigned, strict=True):
            indent = "\n" + lines[loop.start][: -len(lines[loop.start].lstrip())]
            lines[loop.start - 1] += "".join(f"{indent}{name} = {row}" for name, row in rows.items() if name in first)
            lines[loop.stop - 1] += "".join(f"{indent}{rows[name]} = {name}" for name in last if name in rows)
        return [lines[0], f"    work = np.empty(({len(rows)}, {self.width}))", *lines[1:]] if rows else lines

    @staticmethod
    def _read_first(parts: Sequence[tuple[str, str, str]]) -> set[str]:
        """Names that lines, each a target, " = " and an expression, read before they assign them."""
        assigned, found = set[str](), set[str]()
        for target, _, expression in parts:
            found |= set(_NAME.findall(expression)) - assigned
            assigned.add(target)
        return found
