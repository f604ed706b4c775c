"""Gains: constants of an observer that a user may choose, and grids of them."""

import keyword
import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import sympy as sp

from percept_obs.validation import checked, of_kind, refuse_names, set_fields


@dataclass(frozen=True)
class Gain:
    """Constant of an observer that a user may choose.

    Parameters
    ----------
    symbol : sympy symbol
        Its letter in the equations.
    name : str
        Its keyword.
    value : float
    low, high : float
        Range that is worth exploring.
    unit : str
        Such as "1/s", for image coordinates without a unit and hidden ones in 1/m, where m is the recording's `unit`;
        "1" for a number.
    meaning : str
        Its effect, in a few words.
    condition : sympy relation
        Condition on the value.
    reason : str
        Reason for the condition.
    given : bool
        True if a user chose the value, so that no recording replaces it.

    Raises
    ------
    ValueError
        If the value is not finite, or does not fulfil the condition, or the name or the range makes no sense.

    See Also
    --------
    percept_obs.observers.gains.grid : Combinations of values.
    percept_obs.observers.family.Option : A choice that is no number.

    Examples
    --------
    >>> from percept_obs import ibo
    >>> gain = ibo.gains[0]
    >>> gain.name, gain.value, gain.unit, gain.condition
    ('gain', 10.0, '1/s', G > 0)
    """

    symbol: sp.Symbol
    name: str
    value: float
    low: float
    high: float
    unit: str
    meaning: str
    condition: Any = sp.true
    reason: str = ""
    given: bool = False

    def __post_init__(self) -> None:
        if not str(self.name).isidentifier() or keyword.iskeyword(self.name) or self.name.startswith("_"):
            raise ValueError(f"a gain has the name {self.name!r}; give it a name in Python, such as 'gain'")
        of_kind("the gain", "symbol", self.symbol, sp.Symbol)
        refuse_names([self.symbol], self.name)
        for label in ("value", "low", "high"):
            name = self.name if label == "value" else label
            set_fields(self, **{label: of_kind("the gain", name, getattr(self, label), float)})
        if not self.low < self.high:
            raise ValueError(f"{self.name} is to be explored from {self.low} to {self.high}; give the lower end first")
        value = float(self.value)
        set_fields(self, value=value)
        if not math.isfinite(value):
            raise ValueError(f"{self.name} = {value} is not finite; choose a number like {self.low} to {self.high}")
        if not self.condition.subs(self.symbol, sp.Float(value)):
            raise ValueError(f"{self.name} = {value:g} is out of range: {self.condition} is needed; {self.reason}")

    def __str__(self) -> str:
        """Two lines of a docstring."""
        unit = "" if self.unit == "1" else f", in {self.unit}"
        condition = "" if self.condition == sp.true else f"; {self.condition}"
        meaning = self.meaning[:1].upper() + self.meaning[1:]
        return f"{self.name} : float\n    {meaning} ({self.symbol}{unit}{condition}).  Default {self.value:.4g}."


@checked
def grid(**values: Sequence[float]) -> tuple[dict[str, float], ...]:
    """Return every combination of the gains' values by name; the last gain changes fastest.

    Parameters
    ----------
    **values : sequence of float
        Values to try, by the names of gains.

    Raises
    ------
    ValueError
        If a gain has no values.

    See Also
    --------
    percept_obs.studies.all_observers.all_observers : Tries them.

    Examples
    --------
    >>> from percept_obs.observers.gains import grid
    >>> grid(gain=(2, 10), bound=(5,))
    ({'gain': 2, 'bound': 5}, {'gain': 10, 'bound': 5})
    """
    if empty := [name for name, several in values.items() if not len(several)]:
        raise ValueError(f"{', '.join(empty)} has no values to try; give at least one, or leave it out")
    return tuple(dict(zip(values, each, strict=True)) for each in product(*values.values()))
