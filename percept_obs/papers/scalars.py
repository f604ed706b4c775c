"""Numbers made of vectors and matrices in the papers: norms, inner products, smallest eigenvalues."""

from __future__ import annotations

from collections.abc import Callable
from operator import methodcaller
from typing import Any, ClassVar
from xml.dom.minidom import Element

import sympy as sp

from percept_obs.system.surfaces import POINT, pinhole


class Scalar(sp.Function):
    """A number made of matrices; ``doit`` works out its value once the matrices are explicit."""

    is_commutative = is_extended_real = True
    shown: ClassVar[str]
    spoken: ClassVar[str]
    value: ClassVar[Callable[..., sp.Expr]]

    def doit(self, **hints: Any) -> sp.Expr:
        """The value if the matrices are explicit, else itself."""
        parts = [part.doit(**hints) for part in self.args]
        return (self.value if all(isinstance(part, sp.MatrixBase) for part in parts) else self.func)(*parts)

    def _mathml_presentation(self, printer: Any) -> Element:
        row = printer.dom.createElement("mrow")
        for k, words in enumerate(self.spoken.split()):
            if k:
                row.appendChild(printer._print(self.args[k - 1]))
            word = row.appendChild(printer.dom.createElement("mo"))
            word.appendChild(printer.dom.createTextNode(words))
        return row

    def _latex(self, printer: Any, exp: str = "") -> str:
        text = self.shown % tuple(map(printer.doprint, self.args))
        return rf"{text}^{{{exp}}}" if exp else text


class Norm(Scalar):
    """Euclidean norm of a vector."""

    shown, spoken = r"\left\lVert %s \right\rVert", "‖ ‖"
    value = staticmethod(lambda e: sp.sqrt(sum(entry**2 for entry in e)))


class SumNorm(Scalar):
    """Sum of the absolute values of a vector's entries, each written e sgn(e)."""

    shown, spoken = r"\left\lVert %s \right\rVert_1", "‖ ‖₁"
    value = staticmethod(lambda e: sum((entry * sp.sign(entry) for entry in e), sp.S.Zero))


class Inner(Scalar):
    """Inner product a^T b of two vectors."""

    shown, spoken = r"\left\langle %s, %s \right\rangle", "⟨ , ⟩"
    value = staticmethod(lambda a, b: (a.T * b)[0])


class SmallestEigenvalue(Scalar):
    """Smallest eigenvalue of a symmetric matrix of at most two rows."""

    shown, spoken = r"\lambda_{\min}\left\{ %s \right\}", "λₘᵢₙ{ }"

    @staticmethod
    def value(S: sp.MatrixBase) -> sp.Expr:
        """The entry of one row; of two rows, half of trace less root."""
        if S.shape == (1, 1):
            return S[0]
        # The trace stays as a sum of squares, from which sympy sees that it is not negative.
        trace, determinant = S.trace(), sp.expand(S.det())
        return (trace - sp.sqrt(trace**2 - 4 * determinant)) / 2


FUNCTIONS: dict[str, Callable[..., Any]] = {
    "norm": Norm,
    "norm1": SumNorm,
    "inner": Inner,
    "signs": methodcaller("applyfunc", sp.sign),
    "lambdamin": SmallestEigenvalue,
}
"""Functions that may be typed besides the usual ones."""


class H(sp.MatrixExpr):
    """Images of points that stand one below the other; worked out by ``doit`` once the points are explicit."""

    most: Any = sp.oo

    def __new__(cls, points: Any) -> H:
        """Images of these points."""
        return sp.MatrixExpr.__new__(cls, points)

    @property
    def shape(self) -> tuple[sp.Expr, sp.Expr]:
        """Two rows for each three of the points."""
        return (2 * self.args[0].shape[0] / 3, sp.S.One)

    def doit(self, **hints: Any) -> sp.MatrixExpr | sp.MatrixBase:
        """The images, by the package's pinhole."""
        points = self.args[0].doit(**hints)
        if not isinstance(points, sp.MatrixBase):
            return self.func(points)
        if points.rows > self.most:
            raise sp.ShapeError(f"one point has {self.most} coordinates, not {points.rows}")
        one_by_one = (dict(zip(POINT, points[k : k + 3, :], strict=True)) for k in range(0, points.rows, 3))
        return sp.ImmutableMatrix([entry.xreplace(point) for point in one_by_one for entry in pinhole().image])

    def _latex(self, printer: Any) -> str:
        return rf"{type(self).__name__}\left({printer.doprint(self.args[0])}\right)"


class h(H):
    """Image of a single point; without meaning for more."""

    most = 3


IN_PRINT: dict[str, Callable[..., Any]] = {
    "H": H,
    "h": h,
    "length": Norm,
    "det": sp.Determinant,
    "max": sp.Max,
    "limit": sp.Limit,
    "beside": lambda *columns: sp.BlockMatrix([list(columns)]),
    "below": lambda *rows: sp.BlockMatrix([[row] for row in rows]),
    "blocks": lambda *matrices: sp.diag(*matrices).as_immutable(),
}
"""Functions that stand in prints: images, the norm of a column of numbers, determinants, limits, and blocks."""
