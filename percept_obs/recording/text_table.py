"""Tables of numbers in text files: every cell is a number or empty, or it is told which one is not."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from numbers import Integral
from pathlib import Path

import numpy as np

from percept_obs.compile import Array
from percept_obs.validation import checked, write_whole

PathLike = str | os.PathLike[str]

LARGEST_POWER = 300
"""Power of ten from which on a reading is no number of a clock."""


@checked
@dataclass(frozen=True)
class Clock:
    """How a clock in a file is read: seconds = (reading - zero) tick.

    Two devices have two clocks.  Give each file its own, so that both give the same seconds.

    Parameters
    ----------
    zero : int or float
        The reading at 0 s.  Whole numbers are exact, however large: the nanoseconds since 1970 of some files leave
        no digits for a millionth of a second otherwise.
    tick : float
        Seconds that a reading counts for, such as 1e-9 for nanoseconds; positive.

    Raises
    ------
    ValueError
        If zero is not finite, or tick not positive and finite.

    Examples
    --------
    >>> Clock(zero=1403636579763555584, tick=1e-9).seconds(["1403636579763555592"]).tolist()
    [8e-09]
    """

    zero: int | float = 0
    tick: float = 1.0

    def __post_init__(self) -> None:
        if not math.isfinite(self.zero) or not (math.isfinite(self.tick) and self.tick > 0):
            raise ValueError(
                f"a clock with the zero {self.zero} and the tick {self.tick} s reads no time; give a finite zero and a "
                "positive tick"
            )
        object.__setattr__(self, "zero", int(self.zero) if isinstance(self.zero, Integral) else float(self.zero))
        object.__setattr__(self, "tick", float(self.tick))

    def seconds(self, readings: list[str]) -> Array:
        """Seconds of readings in text, shape (K,); subtracted before they are rounded.

        Raises
        ------
        ValueError
            If a reading is not a finite number.
        """
        zero, found = Decimal(repr(self.zero)), []
        for row, text in enumerate(readings, 1):
            try:
                reading = Decimal(text)
            except InvalidOperation:
                reading = Decimal("nan")
            if not reading.is_finite() or reading.adjusted() > LARGEST_POWER:
                raise ValueError(f"row {row} has the time {text!r}; every row needs a finite number there")
            found.append(float(reading - zero) * self.tick)
        return np.array(found)

    def readings(self, seconds: Array, whole: bool = False) -> list[str]:
        """The readings, as text with all digits, at some seconds; rounded to whole ones if asked for."""
        zero, tick = Decimal(repr(self.zero)), Decimal(repr(self.tick))
        exact = [Decimal(repr(second)) / tick + zero for second in seconds.tolist()]
        return [str(round(each)) if whole else f"{each:f}" for each in exact]


SECONDS, NANOSECONDS = Clock(), Clock(tick=1e-9)


@dataclass(frozen=True, eq=False)
class TextTable:
    """A table as text; an empty cell is "".

    Parameters
    ----------
    file : str
        What it is called in messages.
    columns : mapping of names to lists of text
    """

    file: str
    columns: dict[str, list[str]]

    def column(self, name: str, of: str = "") -> list[str]:
        """The cells of a column, which tells what the second text says.

        Raises
        ------
        ValueError
            If there is none of this name.
        """
        if name not in self.columns:
            raise ValueError(
                f"{self.file} has the columns {', '.join(self.columns)}; it needs {name!r}{of and f' for the {of}'}: "
                "rename the column, or say what it is called"
            )
        return self.columns[name]

    def numbers(self, name: str, of: str = "", gaps: bool = True) -> Array:
        """The numbers of a column, shape (K,), NaN for an empty cell.

        Raises
        ------
        ValueError
            If a cell is no finite number, or is empty though there may be no gaps.
        """
        found = np.full(len(cells := self.column(name, of)), np.nan)
        for row, text in enumerate(cells):
            try:
                found[row] = float(text) if text else np.nan
            except ValueError:
                raise ValueError(self._complaint(name, row, "is not a number")) from None
            if math.isinf(found[row]):
                raise ValueError(self._complaint(name, row, "is infinite"))
            if math.isnan(found[row]) and not gaps:
                raise ValueError(self._complaint(name, row, "is no number" if text else "is empty"))
        return found

    def seconds(self, name: str, clock: Clock) -> Array:
        """The times of a column in seconds, shape (K,)."""
        try:
            return clock.seconds(self.column(name, "time"))
        except ValueError as error:
            raise ValueError(f"{self.file}, column {name!r}: {error}") from None

    def _complaint(self, name: str, row: int, problem: str) -> str:
        text = self.columns[name][row]
        return (
            f"{self.file} has a cell that is not a number: {text!r} in row {row + 1} of the column {name!r} {problem}; "
            "write a finite number, or leave the row out"
        )


def read_table(path: PathLike, names: tuple[str, ...] = (), separator: str = ",", example: str = "") -> TextTable:
    """Read a table of text; lines that begin with # are comments, and what follows a # in a line is one.

    Parameters
    ----------
    path : path
    names : tuple of str
        Of the columns, where the file has no header.  More columns may follow these, and are left out.
    separator : str
        A regular expression.
    example : str
        A first line as it should be, for messages.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no table, has no rows, or too few columns.
    """
    import pandas as pd

    file = os.fspath(path)
    if not Path(path).is_file():
        raise FileNotFoundError(f"the path names '{file}', where there is no file; name a text file with a table")
    try:
        rows = pd.read_csv(
            path,
            sep=separator,
            comment="#",
            header=None if names else 0,
            dtype=str,
            keep_default_na=False,
            skipinitialspace=True,
            encoding="utf-8-sig",
        )
    except (pd.errors.EmptyDataError, pd.errors.ParserError, UnicodeDecodeError) as error:
        raise ValueError(
            f"{file} is no table of text ({str(error).strip()}); the path must name a text file whose first row is "
            f"such as {example}"
        ) from None
    if not isinstance(rows.index, pd.RangeIndex):
        raise ValueError(f"{file} has rows with more cells than its header has names; expected such as {example}")
    found = [str(name).strip() for name in rows.columns]
    if len(found) < len(names):
        raise ValueError(f"{file} has {len(found)} columns; {len(names)} are needed: {', '.join(names)}")
    if len(set(found)) != len(found):
        raise ValueError(f"{file} names a column twice, among {', '.join(found)}; rename one of them")
    if not len(rows):
        raise ValueError(f"{file} has a header and no rows; at least two samples are needed")
    columns = zip(names or found, (rows[name] for name in rows.columns), strict=False)
    return TextTable(file, {name: [str(cell).strip() for cell in column.fillna("")] for name, column in columns})


def write_table(path: PathLike, head: list[str], rows: Iterable[Iterable[str]], separator: str = ",") -> None:
    """Write rows of text below some lines, whole or not at all."""
    lines = [*head, *(separator.join(row) for row in rows)]
    write_whole(Path(path), ("\n".join(lines) + "\n").encode())
