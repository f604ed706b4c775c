"""Observers for perspective dynamic systems: a camera sees directions, an observer recovers distance.

A public name is imported when it is asked for, from where `__init__.pyi` says, which type checkers read as well.
"""

import ast
from importlib import import_module
from importlib.util import find_spec
from pkgutil import get_data
from typing import Any

__version__ = "0.1.0"

_STUB = ast.parse(get_data(__name__, "__init__.pyi") or b"")
_HOMES = {name.name: each.module for each in _STUB.body if isinstance(each, ast.ImportFrom) for name in each.names}

__all__ = list(_HOMES)


def __getattr__(name: str) -> Any:
    """Import a public name, or a folder."""
    if home := _HOMES.get(name):
        module = import_module(home)
        value = globals()[name] = getattr(module, name) if hasattr(module, name) else import_module(f"{home}.{name}")
        return value
    if not name.startswith("_") and find_spec(f"{__name__}.{name}"):
        return import_module(f"{__name__}.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})
