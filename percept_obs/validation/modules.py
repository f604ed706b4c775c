"""Modules that not every installation has."""

from __future__ import annotations

from importlib.util import find_spec


def needed(extra: str, *modules: str) -> None:
    """Refuse what needs a module that is not installed, and say how to get it.

    Parameters
    ----------
    extra : str
        Of this package, which brings the modules.
    *modules : str

    Raises
    ------
    ModuleNotFoundError
        If one of them is missing.
    """
    missing = [module for module in modules if find_spec(module) is None]
    if missing:
        raise ModuleNotFoundError(
            f"{', '.join(missing)} is missing; get it with: python -m pip install 'percept-obs[{extra}]'"
        )
