"""P of the lab of many points, typed in expressions of t: read as derivations are, never evaluated."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations
from numbers import Real
from types import MappingProxyType
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.checking.reading import read
from percept_obs.compile import Array, function_source, python_text, vectorised
from percept_obs.labs.points.texts import BLOCKS
from percept_obs.labs.shared.printed import Texts
from percept_obs.labs.shared.schema import Settings
from percept_obs.labs.shared.typed_motion import INSTANTS
from percept_obs.points import LyapunovMatrix, constant, lyapunov, riccati, scheduled
from percept_obs.system.motion import TIME
from percept_obs.system.signal import OverTime
from percept_obs.validation import expression

MOST_OF_P = 2000
"""Letters of a P that is typed."""

SIZE = sp.Symbol("P", real=True)
"""The number that the lab sets, which may stand in what is typed."""

FORMS = "a number, a diagonal [a, b, c], or a matrix [[a, b, c], [b, d, e], [c, e, f]]"

LEAST, LARGEST = 1e-9, 1e9
"""Between which the eigenvalues of P are to be."""

USED_BY = MappingProxyType({"P": ("typed",), "P0": ("lyapunov", "riccati")})
"""Which kinds of P use which of the settings that are typed."""

DIGITS = 12
"""Digits of numbers that are written as text."""

_GIVES_P = re.compile(r"(^|[;\n])\s*P\s*=")


@dataclass(frozen=True)
class TypedWeight:
    """A P that was read.

    Parameters
    ----------
    matrix : sympy matrix of shape (b, b)
        In `TIME` and `SIZE`: a number, 3 x 3 for each vector of three states, or the whole.
    """

    matrix: sp.ImmutableMatrix

    @property
    def block(self) -> int:
        """How many states a block of P has: 1, 3 or all."""
        return int(self.matrix.rows)

    @property
    def varies(self) -> bool:
        """Whether it depends on time."""
        return TIME in self.matrix.free_symbols

    def blocks(self, times: Array, size: float) -> Array:
        """A block at some times, shape (T, b, b)."""
        found = np.stack(vectorised((TIME, SIZE), tuple(self.matrix))(times, size), axis=-1)
        return found.reshape(len(times), self.block, self.block)

    def whole(self, times: Array, size: float, states: int) -> Array:
        """P of all states at some times, shape (T, n, n)."""
        return np.asarray(np.kron(np.eye(states // self.block), self.blocks(times, size)), dtype=float)

    def refuse(self, name: str, settings: Settings, states: int) -> None:
        """Refuse what is of another size than the state, or not positive definite at some time of a run."""
        if self.block not in (1, 3, states):
            raise ValueError(
                f"{name} is of {self.block} x {self.block}; it must be {FORMS}, of 3 x 3 for each vector of three "
                f"states, or of {states} x {states}, for the state has {states} entries"
            )
        times = np.linspace(0, settings["duration"], INSTANTS) if self.varies else np.zeros(1)
        with np.errstate(all="ignore"):
            found = self.blocks(times, settings["size"])
        least, largest = np.full((2, len(times)), np.nan)
        there = np.isfinite(found).all(axis=(1, 2))
        values = np.linalg.eigvalsh(found[there])
        least[there], largest[there] = values[:, 0], values[:, -1]
        bad = np.flatnonzero(~((least > LEAST) & (largest < LARGEST)))
        if len(bad):
            worst = least[bad[0]] if not least[bad[0]] > LEAST else largest[bad[0]]
            what = "is" if self.block == 1 else "is not positive definite: it has the eigenvalue"
            raise ValueError(
                f"{name} {what} {worst:.4g} at {times[bad[0]]:.4g} s; it must be from 1e-9 to 1e9 at all times"
            )

    def for_the_page(self) -> Texts:
        """A function of (t, P) of a block's entries row by row, how many rows it has, and the same in Python."""
        rows = [[python_text(entry) for entry in row] for row in self.matrix.tolist()]
        lines = ", ".join(f"[{', '.join(row)}]" for row in rows)
        text = rows[0][0] if self.block == 1 else f"[{lines}]"
        source = function_source((TIME, SIZE), tuple(self.matrix))
        return {"source": source, "block": self.block, "varies": self.varies, "python": text}


def gives_P(text: str) -> bool:
    """Whether a text gives P, and not a motion."""
    return _GIVES_P.search(text) is not None


@lru_cache(maxsize=64)
def read_weight(text: str) -> TypedWeight:
    """Read a P.

    Parameters
    ----------
    text : str
        Such as ``P = 1 + exp(-t)``; a column is a diagonal, ``P = [1, 1, 4]``.  The letter P on the right is the number
        that the lab sets.  A line may also name something to be used in the next ones.

    Raises
    ------
    ValueError
        If it cannot be read, with the place, is not symmetric, gives something else, or twice.

    Examples
    --------
    >>> read_weight("q = exp(-t); P = [1, 1, 1 + q]").matrix.diagonal()
    Matrix([[1, 1, 1 + exp(-t)]])
    """
    others = [symbol.name for block in BLOCKS.values() for symbol in block]
    readings = read(text, {"t": TIME, "P": SIZE}, [*others, *BLOCKS])
    wrong = sorted({reading.name or "an expression" for reading in readings} - {"P"})
    if wrong:
        raise ValueError(f"P gives {', '.join(wrong)}; it must be one expression, such as P = 1 + exp(-t)")
    if len(readings) > 1:
        raise ValueError("P is given twice; give it once")
    value: Any = readings[0].formula
    given = value if isinstance(value, sp.MatrixBase) else sp.ImmutableMatrix([value])
    matrix = sp.ImmutableMatrix(sp.diag(*given) if given.cols == 1 else given)
    if matrix.rows != matrix.cols:
        raise ValueError(f"P is of {matrix.rows} x {matrix.cols}; it must be {FORMS}")
    for i, j in combinations(range(matrix.rows), 2):
        if sp.expand(matrix[i, j] - matrix[j, i]) != 0:
            raise ValueError(
                f"P is not symmetric: its row {i + 1} has {matrix[i, j]} in column {j + 1}, and its row {j + 1} has "
                f"{matrix[j, i]} in column {i + 1}; write the same in both"
            )
    typed = TypedWeight(matrix.applyfunc(lambda entry: expression(entry, "P")))
    typed.for_the_page()
    return typed


def as_text(name: str, value: Any) -> Any:
    """What is given for a setting of P as a text: of a number, a column, a matrix, in numbers or in `TIME`.

    What else is given stays as it is, for the schema to refuse.
    """
    if not isinstance(value, list | tuple | np.ndarray | sp.MatrixBase | sp.Expr | Real) or isinstance(value, bool):
        return value
    try:
        entries = np.atleast_1d(np.asarray(value, dtype=object))  # a matrix of sympy would run text as code
        if not 0 < entries.size <= MOST_OF_P:
            raise ValueError(f"it has {entries.size} entries")
        rows = (entries[:, None] if entries.ndim == 1 else entries).tolist()
        lines = [", ".join(_written(expression(entry, "an entry")) for entry in row) for row in rows]
    except ValueError as error:
        raise ValueError(f"{name}: {error}; it must be {FORMS}") from None
    return f"P = {lines[0]}" if len(rows) == len(rows[0]) == 1 else f"P = [{', '.join(f'[{line}]' for line in lines)}]"


def _written(entry: sp.Expr) -> str:
    if not entry.is_Float:
        return sp.sstr(entry, full_prec=False)
    return np.format_float_positional(float(entry), DIGITS, unique=False, fractional=False, trim="-")


def weight_of(settings: Settings, states: int) -> LyapunovMatrix:
    """P of settings, for a state of so many entries."""
    size, duration = settings["size"], settings["duration"]
    if settings["weight"] == "constant":
        return constant(size)
    if settings["weight"] == "scheduled":
        return scheduled(lambda t: size * (settings["final"] / size) ** (t / duration))
    if settings["weight"] == "typed":
        typed = read_weight(settings["P"])
        if not typed.varies:
            return constant(typed.whole(np.zeros(1), size, states)[0])
        return scheduled(OverTime(lambda times: typed.whole(times, size, states).reshape(len(times), -1)))
    start = read_weight(settings["P0"]).whole(np.zeros(1), size, states)[0] if settings["P0"].strip() else size
    if settings["weight"] == "lyapunov":
        return lyapunov(start, settings["decrease"])
    return riccati(start, settings["forgetting"])


def refuse_P(settings: Settings, states: int) -> None:
    """Refuse a typed P that cannot be, in settings for a state of so many entries; one without its name is given it."""
    for name, weights in USED_BY.items():
        if settings["weight"] not in weights or not (settings[name].strip() or name == "P"):
            continue
        if "=" not in settings[name]:
            settings[name] = f"P = {settings[name]}"
        try:
            typed = read_weight(settings[name])
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from None
        if name == "P0" and typed.varies:
            raise ValueError("P0 has t in it, but it is P at the beginning only; give numbers")
        typed.refuse(name, settings, states)
