"""Parts of observers that use the motion X' = A X + b itself, and not only the rates that follow from it."""

import sympy as sp

from percept_obs.compile.equations import Expressions
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.surfaces import ImagingSurface


class NeedsMotion(ValueError):
    """The form does not know its motion or its surface, or its outputs give no equation of the point by themselves."""


def on_surface(form: PartitionedSystem) -> NeedsMotion | None:
    """Return an error if the form knows no motion seen on an imaging surface, or a size is seen on it."""
    if form.motion is None or not isinstance(form.view, ImagingSurface):
        return NeedsMotion("this form does not know its motion and surface; make it by PerspectiveSystem.measure")
    if form.view.radii:
        return NeedsMotion("a size of an unknown radius gives no equation of the point; use a surface without it")
    return None


def motion_on_surface(form: PartitionedSystem) -> tuple[sp.ImmutableMatrix, sp.ImmutableMatrix, ImagingSurface]:
    """Return A, b and the surface of a form to which `on_surface` has no objection."""
    assert form.motion is not None
    assert isinstance(form.view, ImagingSurface)
    return form.motion.A, form.motion.b, form.view


def symmetric(letter: str) -> sp.ImmutableMatrix:
    """Return a symmetric matrix of symbols, shape (3, 3), such as Q11, Q12, ..."""
    return sp.ImmutableMatrix(3, 3, lambda i, j: sp.Symbol(f"{letter}{min(i, j) + 1}{max(i, j) + 1}", real=True))


def upper(matrix: sp.ImmutableMatrix) -> Expressions:
    """Return the entries of a symmetric matrix on its diagonal and above, row by row."""
    return tuple(matrix[i, j] for i in range(matrix.rows) for j in range(i, matrix.cols))
