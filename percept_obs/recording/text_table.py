"""Tables of numbers in text files, and the clocks by which their times are read."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from numbers import Integral
from pathlib import Path
from typing import Any

import numpy as np

from percept_obs.compile import Array
from percept_obs.validation import checked

PathLike = str | os.PathLike[str]

LARGEST_POWER = 300
"""Largest power of ten of a clock's reading, near that of a float."""


@checked
@dataclass(frozen=True)
class Clock:
    """Clock of a file: seconds = (reading - zero) tick.

    Two devices have two clocks.  Give each file its own, so that both give the same seconds.

    Parameters
    ----------
    zero : int or float
        The reading at 0 s.  Whole numbers are exact, however large: the nanoseconds since 1970 of some files leave
        no digits for a millionth of a second otherwise.
    tick : float
        Seconds in one unit of the reading, such as 1e-9 for nanoseconds; positive.

    Raises
    ------
    ValueError
        If zero is not finite, or tick not positive and finite.

    See Also
    --------
    read_tum, read_euroc, Recording.from_csv : Take a clock.

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
        zero = int(self.zero) if isinstance(self.zero, Integral) else float(self.zero)  # numpy's have another repr
        vars(self).update(zero=zero, tick=float(self.tick))

    def seconds(self, readings: list[str]) -> Array:
        """Return the seconds of readings in text, shape (K,); the zero is subtracted before rounding."""
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

    def readings(self, seconds: Array) -> list[str]:
        """Return the readings at some seconds as text with all digits."""
        zero, tick = Decimal(repr(self.zero)), Decimal(repr(self.tick))
        return [f"{Decimal(repr(second)) / tick + zero:f}" for second in seconds.tolist()]


SECONDS, NANOSECONDS = Clock(), Clock(tick=1e-9)


@dataclass(frozen=True, eq=False)
class TextTable:
    """Table of text; an empty cell is ""."""

    file: str
    columns: dict[str, list[str]]

    def column(self, name: str, meaning: str = "") -> list[str]:
        """Return the cells of a column; the meaning, such as "time", is for the message if there is none."""
        if name not in self.columns:
            raise ValueError(
                f"{self.file} has the columns {', '.join(self.columns)}; it needs {name!r}"
                f"{meaning and f' for the {meaning}'}: rename the column, or give its name"
            )
        return self.columns[name]

    def numbers(self, name: str, meaning: str = "", gaps: bool = True) -> Array:
        """Return the numbers of a column, shape (K,); NaN for a cell that is empty or nan, if gaps are allowed."""
        found = []
        for row, text in enumerate(self.column(name, meaning), 1):
            try:
                value = float(text or math.nan)
            except ValueError:
                value = math.inf
            if not (math.isfinite(value) or (gaps and math.isnan(value))):
                raise ValueError(
                    f"{self.file} has {text!r} in row {row} of the column {name!r}; write a finite number there, or "
                    "leave the row out"
                )
            found.append(value)
        return np.array(found)

    def seconds(self, name: str, clock: Clock) -> Array:
        """Return the times of a column in seconds, shape (K,)."""
        try:
            return clock.seconds(self.column(name, "time"))
        except ValueError as error:
            raise ValueError(f"{self.file}, column {name!r}: {error}") from None


def read_table(path: PathLike, names: tuple[str, ...] = (), separator: str = ",", example: str = "") -> TextTable:
    """Read a table of text; what follows a # in a line is a comment.

    Names are those of the columns of a file without a header, which may have further ones; the separator is a regular
    expression, and the example a first line for messages.
    """
    import pandas as pd

    file = os.fspath(path)
    if not Path(path).is_file():
        raise FileNotFoundError(f"the path names '{file}', where there is no file; name a text file with a table")
    layout: dict[str, Any] = {"sep": separator, "comment": "#", "skipinitialspace": True, "encoding": "utf-8-sig"}
    try:
        rows = pd.read_csv(path, header=None if names else 0, dtype=str, keep_default_na=False, **layout)
    except (pd.errors.EmptyDataError, pd.errors.ParserError, UnicodeDecodeError) as error:
        raise ValueError(
            f"{file} is no table of text ({str(error).strip()}); expected rows such as {example}"
        ) from None
    found = [str(name).strip() for name in rows.columns]
    problem = ""
    if not isinstance(rows.index, pd.RangeIndex):
        problem = "rows with more cells than its header has names"
    elif len(found) < len(names):
        problem = f"{len(found)} columns, and {len(names)} are needed: {', '.join(names)}"
    elif len(set(found)) != len(found):
        problem = f"two columns of one name, among {', '.join(found)}"
    elif not len(rows):
        problem = "a header and no rows"
    if problem:
        raise ValueError(f"{file} has {problem}; expected rows such as {example}")
    columns = zip(names or found, (rows[name] for name in rows.columns), strict=False)
    return TextTable(file, {name: column.fillna("").str.strip().tolist() for name, column in columns})
