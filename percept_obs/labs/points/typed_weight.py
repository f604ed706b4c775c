"""A given P of the lab of many points: a number or a diagonal, read like a derivation and never evaluated."""

from __future__ import annotations

import re
from functools import lru_cache, partial
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.checking.reading import read
from percept_obs.compile import Array, function_source, python_text, vectorised
from percept_obs.labs.shared.printed import Texts
from percept_obs.labs.shared.schema import Settings
from percept_obs.labs.shared.typed_motion import INSTANTS, refuse_values
from percept_obs.points import LyapunovMatrix, constant, lyapunov, riccati, scheduled
from percept_obs.system.motion import TIME
from percept_obs.system.signal import OverTime
from percept_obs.validation import expression

MOST_OF_P = 2000
"""Largest number of characters of a given P."""

SIZE = sp.Symbol("P", real=True)
"""The number that the lab sets, which may stand in a given P."""

FORMS = "a number or a diagonal [a, b, c]"
LEAST, LARGEST = 1e-9, 1e9
"""Bounds of the entries of P."""

TYPED_IN = {"typed": "P", "lyapunov": "P0", "riccati": "P0"}
"""Setting in which P is given, by the kind of P."""

Diagonal = tuple[sp.Expr, ...]
"""Entries of P in `TIME` and `SIZE`: one for all states, or three for each vector of three states."""

_GIVES_P = re.compile(r"(^|[;\n])\s*P\s*=")


def gives_P(text: str) -> bool:
    """Return True if a text gives P, and not a motion."""
    return _GIVES_P.search(text) is not None


@lru_cache(maxsize=64)
def read_weight(text: str) -> Diagonal:
    """Read a P such as ``P = 1 + exp(-t)`` or ``P = [1, 1, 4]``; P on the right is the number that the lab sets.

    >>> read_weight("q = exp(-t); P = [1, 1, 1 + q]")
    (1, 1, 1 + exp(-t))
    """
    readings = read(text, {"t": TIME, "P": SIZE}).lines
    if [reading.name for reading in readings] != ["P"]:
        names = ", ".join(reading.name or "an expression" for reading in readings) or "no value"
        raise ValueError(f"P gives {names}; it must be one expression, such as P = 1 + exp(-t)")
    value = readings[0].formula
    entries = tuple(value) if isinstance(value, sp.MatrixBase) else (value,)
    if len(entries) not in (1, 3) or (isinstance(value, sp.MatrixBase) and value.cols > 1):
        raise ValueError(f"P is {value}; it must be {FORMS}, which stands for each vector of three states")
    diagonal = tuple(expression(entry, "P") for entry in entries)
    weight_for_the_page(diagonal)
    return diagonal


def as_text(value: Any) -> Any:
    """A P in numbers as text; anything else stays as it is, for the schema to refuse."""
    if isinstance(value, bool) or not isinstance(value, float | int | list | tuple | np.ndarray):
        return value
    return f"P = {np.asarray(value, dtype=object).tolist()}"


def weight_for_the_page(diagonal: Diagonal) -> Texts:
    """A function of (t, P) for the entries, how many there are, whether they vary, and P in Python."""
    texts = [python_text(entry) for entry in diagonal]
    return {
        "source": function_source((TIME, SIZE), diagonal),
        "entries": len(diagonal),
        "varies": _varies(diagonal),
        "python": texts[0] if len(texts) == 1 else f"[{', '.join(texts)}]",
    }


def weight_of(settings: Settings, states: int) -> LyapunovMatrix:
    """P of settings for a state with `states` entries."""
    kind, size, duration = settings["weight"], settings["size"], settings["duration"]
    text = settings.get(TYPED_IN.get(kind, ""), "")
    diagonal = read_weight(text) if text.strip() else (SIZE,)
    rows = partial(_rows, diagonal, size, states)
    if kind == "scheduled":
        return scheduled(partial(_growing, size, settings["final"], duration))
    if kind == "typed" and _varies(diagonal):
        return scheduled(OverTime(rows))
    start = rows(np.zeros(1)).reshape(states, states) if text.strip() else size
    if kind == "lyapunov":
        return lyapunov(start, settings["decrease"])
    return riccati(start, settings["forgetting"]) if kind == "riccati" else constant(start)


def _rows(diagonal: Diagonal, size: float, states: int, times: Array) -> Array:
    entries = np.tile(_entries(diagonal, times, size), states // len(diagonal))
    return np.asarray(entries[:, :, None] * np.eye(states)).reshape(len(times), -1)


def _growing(size: float, final: float, duration: float, time: float) -> float:
    return size * (final / size) ** (time / duration)


def refuse_P(settings: Settings) -> None:
    """Raise a ValueError for a given P that cannot be read, or is not positive; put ``P =`` before one without it."""
    name = TYPED_IN.get(settings["weight"])
    if name is None or not (settings[name].strip() or name == "P"):
        return
    if "=" not in settings[name]:
        settings[name] = f"P = {settings[name]}"
    try:
        diagonal = read_weight(settings[name])
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    if name == "P0" and _varies(diagonal):
        raise ValueError("P0 has t in it, but it is P at the beginning only; give numbers")
    times = np.linspace(0, settings["duration"], INSTANTS)
    with np.errstate(all="ignore"):
        found = _entries(diagonal, times, settings["size"])
    good = (found > LEAST) & (found < LARGEST)
    refuse_values([name] * found.shape[1], times, found, good, "from 1e-9 to 1e9 at all times")


def _varies(diagonal: Diagonal) -> bool:
    return any(TIME in entry.free_symbols for entry in diagonal)


def _entries(diagonal: Diagonal, times: Array, size: float) -> Array:
    """Entries at T times, shape (T, 1) or (T, 3)."""
    return np.stack(vectorised((TIME, SIZE), diagonal)(times, size), axis=-1)
