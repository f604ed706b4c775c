"""Motions as expressions of t, given in Python: read like derivations, never evaluated, and printed for the page."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import sympy as sp

from percept_obs.checking.points import key
from percept_obs.checking.reading import read
from percept_obs.compile import Array, Flags, function_source, python_text, vectorised
from percept_obs.labs.shared.printed import Texts
from percept_obs.labs.shared.schema import Text
from percept_obs.system.breaks import breaks_of
from percept_obs.system.motion import TIME
from percept_obs.validation import expression

MOST = 400
"""Largest number of characters of a motion over time."""
LONGEST = 200.0
"""Seconds up to which the page knows where a motion over time jumps."""
INSTANTS = 501
"""Number of times of a run at which a motion over time is checked."""

Blocks = Mapping[str, sp.ImmutableMatrix]
"""Vectors and matrices of symbols, by their letters."""

_IF = re.compile(r"([^,;=\[\]\n]*?)\bif\b([^,;\[\]\n]*?)\belse\b([^,;\[\]\n]*)")


def typed_setting(example: str) -> Text:
    """The setting of a motion over time."""
    about = f"expressions of t for what varies, such as {example!r}; the numbers' letters may stand in them"
    return Text("", MOST, label="Over time", about=about)


@dataclass(frozen=True)
class Typed:
    """A motion over time, as it was read."""

    text: str
    symbols: tuple[sp.Symbol, ...]  # the numbers that a lab sets
    expressions: tuple[sp.Expr, ...]  # one for each symbol, in `TIME` and the symbols

    @property
    def changed(self) -> dict[str, sp.Expr]:
        """Expressions other than the number that the lab sets, by their names."""
        pairs = zip(self.symbols, self.expressions, strict=True)
        return {symbol.name: entry for symbol, entry in pairs if entry != symbol}

    def rows(self, times: Array, numbers: Array) -> Array:
        """Values at T times, shape (T, n), for the numbers that the lab sets, shape (n,) or (T, n)."""
        function = vectorised((TIME, *self.symbols), self.expressions)
        return np.stack(function(times, *numbers.T), axis=-1)

    def breaks(self, until: float) -> tuple[float, ...]:
        """Times between which it is smooth; see `breaks_of`."""
        return breaks_of(TIME, self.expressions, until)

    def refuse_poles(self, duration: float, numbers: Callable[[Array], Array]) -> None:
        """Raise a ValueError if a value is not finite at some time; `numbers` are those of the lab at given times."""
        times = np.union1d(np.linspace(0, duration, INSTANTS), self.breaks(duration))
        with np.errstate(all="ignore"):
            found = self.rows(times, numbers(times))
        names = [f"motion: {symbol}" for symbol in self.symbols]
        refuse_values(names, times, found, np.abs(found) <= 1e6, "a number up to 1e6 at all times of the run")

    def for_the_page(self) -> Texts:
        """A function of (t, numbers) for the changed entries, their columns, the numbers used, those that are 0."""
        names = [symbol.name for symbol in self.symbols]
        source = function_source((TIME, *self.symbols), tuple(self.changed.values()))
        zero = [name for name, entry in self.changed.items() if entry == 0]
        python = {name: python_text(entry) for name, entry in self.changed.items()}
        columns = [names.index(name) for name in python]
        used = set().union(*(entry.free_symbols for entry in self.changed.values()))
        uses = [place for place, symbol in enumerate(self.symbols) if symbol in used]
        found = {"source": source, "columns": columns, "uses": uses, "zero": zero, "python": python}
        return found | {"breaks": self.breaks(LONGEST)}


def refuse_values(names: Sequence[str], times: Array, found: Array, good: Flags, expected: str) -> None:
    """Raise a ValueError for the first of the values at T times, shape (T, n), that is not good."""
    for row, column in np.argwhere(~good)[:1]:
        value = f"{found[row, column]:.4g} at {times[row]:.4g} s"
        raise ValueError(f"{names[column]} is {value}; it must be {expected}")


def read_motion(text: str, blocks: Blocks) -> Typed:
    """Read a motion of lines such as "a12 = 0.4 cos(2t); b3 = b3 + 0.1 t", or of a whole block, "b = [sin(t), 0, 1]".

    A value may be "1 if t < 2 else 0", or hold step(t - 2), which is 0 and then 1.  A line may also name something
    to be used in the next ones, "q = 2t".  The blocks' entries, symbols of the numbers that a lab sets, may be given; a
    ValueError says, with the place, what cannot be read, or is given twice.

    >>> b = sp.ImmutableMatrix(sp.symbols("b1:4", real=True))
    >>> read_motion("b1 = b1 + sin(2t)", {"b": b}).expressions
    (b1 + sin(2*t), b2, b3)
    """
    return _read(text, tuple(blocks.items()))


def _branches(text: str) -> str:
    """A text with Piecewise in place of "1 if t < 2 else 0"."""

    def branches(found: re.Match[str]) -> str:
        value, when, other = found.groups()
        if not re.search("[<>≤≥]", when) or any(part.count("(") != part.count(")") for part in found.groups()):
            raise ValueError('"if" is of a whole entry, such as b1 = 1 if t < 2 else 0')
        return f" Piecewise(({value}, {when}), ({_branches(other)}, True))"

    return _IF.sub(branches, text)


def _step(*values: sp.Expr) -> sp.Expr:
    """Return an expression that is 0 where a number is negative, and 1 elsewhere."""
    if len(values) != 1 or hasattr(values[0], "shape"):
        raise ValueError("step is of one number, such as step(t - 2)")
    return sp.Piecewise((1, values[0] >= 0), (0, True))


@lru_cache(maxsize=64)
def _read(text: str, blocks: tuple[tuple[str, sp.ImmutableMatrix], ...]) -> Typed:
    symbols = tuple(dict.fromkeys(symbol for _, block in blocks for symbol in block))
    named = {key(letter): block for letter, block in blocks} | {key(s.name): sp.ImmutableMatrix([s]) for s in symbols}
    letters = {key(symbol.name): symbol for symbol in (TIME, *symbols)}
    found: dict[sp.Symbol, sp.Expr] = {}
    said = read(_branches(text), letters, list(named), {"step": _step})
    if unused := [each.name for each in said.definitions if not each.used]:
        raise ValueError(f"{unused[0]} is given, and nothing uses it; there are {', '.join([*named])}")
    for reading in said.lines:
        block = named.get(reading.name)
        if block is None:
            raise ValueError(
                f"each line begins with what it gives, such as {symbols[-1]} = ...; there are "
                f"{', '.join([*(letter for letter, _ in blocks), *map(str, symbols)])}"
            )
        value = reading.formula
        given = value if isinstance(value, sp.MatrixBase) else sp.ImmutableMatrix([value])
        if given.shape != block.shape:
            raise ValueError(f"{reading.name} has the shape {given.shape}; expected {block.shape}")
        twice = [str(symbol) for symbol in block if symbol in found]
        if twice:
            raise ValueError(f"{twice[0]} is given twice; give it once")
        found |= {s: expression(e, f"{s}") for s, e in zip(block, given, strict=True)}
    typed = Typed(text, symbols, tuple(found.get(symbol, symbol) for symbol in symbols))
    typed.for_the_page()
    return typed
