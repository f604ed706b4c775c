"""What a notebook needs beyond a plain install: its first cell asks for all of it, so that nothing fails later."""

from __future__ import annotations

import ast
import sys
from typing import Any

from percept_obs.validation import checked, missing


class NotInstalled(ModuleNotFoundError):
    """Raised when a notebook lacks modules; Jupyter shows its sentence and no traceback."""

    def _render_traceback_(self) -> list[str]:
        return [str(self)]


@checked
def needs(*modules: str) -> None:
    """End a notebook with one sentence if it lacks a module: later cells repeat the sentence, and do not run.

    Parameters
    ----------
    *modules : str
        Names of modules that the extra "course" brings, such as ``"xarray"``.

    Raises
    ------
    NotInstalled
        If one of them is missing.

    Examples
    --------
    >>> from percept_obs.exercises import needs
    >>> needs("numpy", "sympy")
    """
    if lacking := missing(*modules):
        error = NotInstalled(
            f"{', '.join(lacking)} is missing, and this notebook needs it: write  "
            '%pip install "percept-obs[course]"  into a cell, run it, and begin again here'
        )
        if "IPython" in sys.modules and (shell := sys.modules["IPython"].get_ipython()):
            shell.ast_transformers.append(_Ended(modules, error))
        raise error


class _Ended:
    """Puts the sentence in place of each cell, but for those of IPython's commands, until all is installed."""

    def __init__(self, modules: tuple[str, ...], error: NotInstalled) -> None:
        self.modules, self.error = modules, error

    def visit(self, cell: ast.Module) -> Any:
        if not missing(*self.modules) or ast.unparse(cell).startswith("get_ipython()"):
            return cell
        return ast.parse(f"print({str(self.error)!r})")
