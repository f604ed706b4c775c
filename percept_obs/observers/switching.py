"""Functions that replace the sign of an innovation where an observer switches."""

from collections.abc import Callable
from types import MappingProxyType

import sympy as sp

from percept_obs.observers.family import Option
from percept_obs.validation import of_kind

Switch = Callable[[sp.Expr, sp.Expr], sp.Expr]

SWITCHES: MappingProxyType[str, Switch] = MappingProxyType(
    {
        "sign": lambda e, width: sp.sign(e),
        "hyperbolic tangent": lambda e, width: sp.tanh(e / width),
        "fraction": lambda e, width: e / (sp.Abs(e) + width),
    }
)
"""Ways to switch, by name: the sign itself, and two boundary layers of a given width that smooth it."""


def switch_option(own: str, meaning: str) -> Option:
    """Option of an observer to switch in one of these ways, or in its own, which comes first."""
    return Option("switch", own, meaning, tuple(dict.fromkeys((own, *SWITCHES))))


def switch_named(name: str) -> Switch:
    """Way to switch with this name; refuse an unknown one."""
    of_kind("the observer", "switch", name, str)
    if name not in SWITCHES:
        raise ValueError(f"the switch {name!r} is none of {', '.join(map(repr, SWITCHES))}")
    return SWITCHES[name]
