"""Tables of numbers in text files, and the clocks by which their times are read."""

from __future__ import annotations

import math
import os
import re
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from csv import reader
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from io import StringIO
from numbers import Integral
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from percept_obs.compile import Array, Flags
from percept_obs.recording.first_lines import refuse_others
from percept_obs.recording.plausibility import LATEST, LONGEST_STEP, SHORTEST_STEP, USUAL_STEP, Unlikely
from percept_obs.validation import checked, load_pandas, warn

PathLike = str | os.PathLike[str]

LARGEST_POWER = 300
"""Largest power of ten of a clock's reading, near that of a float."""

ROUGH = 1e-3
"""Share of a step by which times may be rounded: a filter's speeds have larger errors."""

TICKS = MappingProxyType({"seconds": 1.0, "milliseconds": 1e-3, "microseconds": 1e-6, "nanoseconds": 1e-9})

Repeated = Literal["refuse", "drop"]


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
        zero, known = Decimal(repr(self.zero)), dict[str, float]()
        for row, text in enumerate(readings, 1):
            if text in known:  # many points are seen at one time
                continue
            try:
                reading = Decimal(text)
            except InvalidOperation:
                reading = Decimal("nan")
            if "_" in text or not reading.is_finite() or reading.adjusted() > LARGEST_POWER:
                raise ValueError(f"row {row} has the time {text!r}; every row needs a finite number there")
            known[text] = float(reading - zero) * self.tick
        return np.array([known[text] for text in readings])


SECONDS, NANOSECONDS = Clock(), Clock(tick=1e-9)


@dataclass(frozen=True, eq=False)
class TextTable:
    """Table in a file: columns of numbers, NaN for an empty cell, or pandas' Categorical of text, "" for one."""

    file: str
    columns: Mapping[str, Any]

    def column(self, name: str, meaning: str = "") -> Any:
        """Return the cells of a column; the meaning, such as "time", is for the message if there is none."""
        if name not in self.columns:
            raise ValueError(
                f"{self.file} has the columns {', '.join(self.columns)}; it needs {name!r}"
                f"{meaning and f' for the {meaning}'}: rename the column, or give its name"
            )
        return self.columns[name]

    def numbers(self, name: str, meaning: str = "", gaps: bool = True) -> Array:
        """Return the numbers of a column, shape (K,); NaN for a cell that is empty or nan, if gaps are allowed."""
        column = self.column(name, meaning)
        if isinstance(column, np.ndarray):
            return column
        values: Array = np.array([_number(text) for text in column.categories], dtype=float)[column.codes]
        wrong = np.isinf(values) if gaps else ~np.isfinite(values)
        if wrong.any():
            raise ValueError(
                f"{self.file} has {column[wrong.argmax()]!r} in row {wrong.argmax() + 1} of the column {name!r}; "
                "write a finite number there, or leave the row out"
            )
        return values

    def seconds(self, name: str, clock: Clock) -> Array:
        """Return the times of a column in seconds, shape (K,)."""
        column = self.column(name, "time")
        try:
            return clock.seconds(column.categories.to_numpy(object)[column.codes].tolist())
        except ValueError as error:
            raise ValueError(f"{self.file}, column {name!r}: {error}") from None

    def steps(self, name: str, clock: Clock, repeated: Repeated) -> tuple[Array, Flags]:
        """Return times in seconds that can be those of a trajectory, and which rows they are of, shape (K,).

        Rows with the time of the one before are refused or dropped, with their number.
        """
        time = self.seconds(name, clock)
        again = np.append(False, np.diff(time) == 0)
        kept = time[~again]
        step = float(np.median(np.abs(np.diff(kept)))) if len(kept) > 1 else USUAL_STEP
        texts = [text for text in self.columns[name].categories[:1000] if "e" in text.lower()]
        rounded = clock.tick * 10.0 ** min((int(Decimal(text).as_tuple().exponent) for text in texts), default=-99)
        if rounded > ROUGH * step:
            said = f"{self.file} has times such as {texts[0]}, rounded to {rounded:.1g} s as a spreadsheet stores them"
            if rounded > step / 2:
                raise ValueError(
                    f"{said}: the steps between its rows are lost; export it again, with the times as text"
                )
            warn(Unlikely(f"{said}: the steps of {step:.3g} s between its rows are wrong by as much"))
        if again.any():
            said = f"{again.sum()} of {len(time)} rows of {self.file} have the time of the row before"
            if repeated == "refuse":
                raise ValueError(f'{said}, the first is row {again.argmax() + 1}; repeated="drop" leaves them out')
            warn(Unlikely(f"{said}, and are left out"))
        if (late := np.diff(kept) < 0).any():
            row = int(np.flatnonzero(~again)[late.argmax() + 1])
            raise ValueError(f"{self.file}: times must increase strictly; look at row {row + 1}, and sort the rows")
        if not SHORTEST_STEP <= step <= LONGEST_STEP or np.abs(kept).max() > LATEST:
            unit = min(TICKS, key=lambda unit: abs(math.log(step / clock.tick * TICKS[unit] / USUAL_STEP)))
            raise ValueError(
                f"{self.file} has times up to {kept[-1]:.4g} s, with {step:.3g} s from row to row, which cannot be; if "
                f"they are {unit}, give clock=Clock(tick={TICKS[unit]:g}), or write seconds where a reader has no clock"
            )
        return kept, ~again


def existing(path: PathLike, what: str) -> str:
    """Return a path as text; FileNotFoundError unless a file is there, which says what to name."""
    file = os.fspath(path)
    if not os.path.isfile(file):  # False for text that can be no path, where pathlib raises
        shown = file[:300].partition("\n")[0]
        raise FileNotFoundError(f"the path names '{shown}', where there is no file; name {what}")
    return file


def read_table(
    path: PathLike,
    names: tuple[str, ...] = (),
    separator: str = ",",
    example: str = "",
    numbers: Sequence[str] = (),
    kind: str = "",
) -> TextTable:
    """Read a table of text; a line that begins with # is a comment.

    Names are those of the columns of a file without a header, which may have further ones; the separator is a regular
    expression, and the example a first line for messages.  The columns that are to be numbers are read fast.  A file
    whose first lines are those of another kind is refused.
    """
    pd = load_pandas()
    file = existing(path, "a text file with a table")
    refuse_others(path, kind)
    layout: dict[str, Any] = {"sep": separator, "skipinitialspace": True, "keep_default_na": False, "header": None}
    header: list[str] = []
    try:
        with open(file, encoding="utf-8-sig") as lines:
            skipped, first = next(((k, line) for k, line in enumerate(lines) if not _is_comment(line)), (0, ""))
        if not names:
            (cells,) = reader([first], skipinitialspace=True)
            header = [cell.strip() or f"Unnamed: {k}" for k, cell in enumerate(cells)]
            layout["names"] = header
            if len(header) == 1 and first.strip():
                raise ValueError(f"a single column, {first.strip()!r}; put commas between cells, points into numbers")
        if repeated := {name for name in header if header.count(name) > 1}:
            raise ValueError(f"two columns of one name, {', '.join(sorted(repeated))}, among {', '.join(header)}")
        if header and separator == ",":
            with open(file, encoding="utf-8-sig") as lines:
                _refuse_short_rows(lines, skipped, len(header))
        if numbers and (clean := _clean(file, skipped + 1, set(header) & set(numbers), layout)):
            return TextTable(file, clean)
        with open(file, encoding="utf-8-sig") as lines:
            text = "".join(line for k, line in enumerate(lines) if k > skipped - bool(names) and not _is_comment(line))
        if header and not text:
            raise ValueError("a header and no rows")
        rows: Any = pd.read_csv(StringIO(text), dtype=str, **layout)
        if not isinstance(rows.index, pd.RangeIndex):
            raise ValueError("rows with more cells than its header has names")
        if len(rows.columns) < len(names):
            raise ValueError(f"{len(rows.columns)} columns, and {len(names)} are needed: {', '.join(names)}")
    except (pd.errors.EmptyDataError, pd.errors.ParserError, UnicodeDecodeError) as error:
        said = re.sub(r".*Expected (\d+) fields .* saw (\d+)", r"rows with \1 and with \2 cells", str(error).strip())
        raise ValueError(f"{file} is no table of text ({said}); expected rows such as {example}") from None
    except ValueError as error:
        raise ValueError(f"{file} has {error}; expected rows such as {example}") from None
    columns = zip(names or header, (rows[name] for name in rows.columns), strict=False)
    return TextTable(file, {name: pd.Categorical(column.fillna("").str.strip()) for name, column in columns})


def _refuse_short_rows(lines: Iterable[str], skipped: int, width: int) -> None:
    """Raise ValueError for a row with fewer cells than the header has names."""
    for number, line in enumerate(lines):
        cells = line.count(",") + 1
        if number > skipped and cells < width and line.strip() and not _is_comment(line):
            raise ValueError(f"{cells} cells in line {number + 1}, and {width} names in its header")


def _clean(file: str, skipped: int, numbers: set[str], layout: dict[str, Any]) -> dict[str, Any] | None:
    """Columns of a table after some lines, if all its cells are as they should be."""
    pd = load_pandas()
    gaps = {name: ["", "nan", "NaN"] for name in numbers}
    kinds: Any = defaultdict(lambda: str, dict.fromkeys(numbers, float))
    try:
        rows = pd.read_csv(file, skiprows=skipped, dtype=kinds, na_values=gaps, encoding="utf-8", **layout)
    except ValueError:
        return None
    if not len(rows) or not isinstance(rows.index, pd.RangeIndex):
        return None
    columns: dict[str, Any] = {}
    for name in rows.columns:
        columns[name] = cells = rows.pop(name).to_numpy() if name in numbers else pd.Categorical(rows.pop(name))
        if name in numbers and np.isinf(cells).any():
            return None
        if name not in numbers and ((cells.codes < 0).any() or any(text != text.strip() for text in cells.categories)):
            return None
    return columns


def _is_comment(line: str) -> bool:
    return line.lstrip()[:1] in ("#", "")


def _number(text: str) -> float:
    """Number in a cell, NaN for none; infinity for what is no number."""
    try:
        return math.inf if "_" in text else float(text or math.nan)
    except ValueError:
        return math.inf
