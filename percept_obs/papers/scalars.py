"""Numbers made of vectors and matrices in the papers: norms, inner products, smallest eigenvalues."""

from __future__ import annotations

from collections.abc import Callable
from operator import methodcaller
from typing import Any, ClassVar
from xml.dom.minidom import Element

import sympy as sp


class Scalar(sp.Function):
    """A number made of matrices; ``doit`` works out its value once the matrices are explicit."""

    shown: ClassVar[str]
    spoken: ClassVar[str]
    value: ClassVar[Callable[..., sp.Expr]]

    def _eval_is_commutative(self) -> bool:
        return True

    def _eval_is_extended_real(self) -> bool:
        return True

    def doit(self, **hints: Any) -> sp.Expr:
        """The value if the matrices are explicit, else itself."""
        parts = [part.doit(**hints) for part in self.args]
        if all(isinstance(part, sp.MatrixBase) for part in parts):
            return self.value(*parts)
        return self.func(*parts)

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

    shown = r"\left\lVert %s \right\rVert"
    spoken = "‖ ‖"

    @staticmethod
    def value(*matrices: sp.MatrixBase) -> sp.Expr:
        """Root of the sum of squares."""
        return sp.sqrt(sum(entry**2 for entry in matrices[0]))


class SumNorm(Scalar):
    """Sum of the absolute values of a vector's entries, each written e sgn(e)."""

    shown = r"\left\lVert %s \right\rVert_1"
    spoken = "‖ ‖₁"

    @staticmethod
    def value(*matrices: sp.MatrixBase) -> sp.Expr:
        """Sum of e sgn(e)."""
        return sum((entry * sp.sign(entry) for entry in matrices[0]), sp.S.Zero)


class Inner(Scalar):
    """Inner product a^T b of two vectors."""

    shown = r"\left\langle %s, %s \right\rangle"
    spoken = "⟨ , ⟩"

    @staticmethod
    def value(*matrices: sp.MatrixBase) -> sp.Expr:
        """Sum of products."""
        (product,) = matrices[0].T * matrices[1]
        return product


class SmallestEigenvalue(Scalar):
    """Smallest eigenvalue of a symmetric matrix of at most two rows."""

    shown = r"\lambda_{\min}\left\{ %s \right\}"
    spoken = "λₘᵢₙ{ }"

    @staticmethod
    def value(*matrices: sp.MatrixBase) -> sp.Expr:
        """The entry of one row; of two rows, half of trace less root."""
        matrix = matrices[0]
        if matrix.shape == (1, 1):
            return matrix[0]
        # The trace stays as a sum of squares, from which sympy sees that it is not negative.
        trace, determinant = matrix.trace(), sp.expand(matrix.det())
        return (trace - sp.sqrt(trace**2 - 4 * determinant)) / 2


FUNCTIONS: dict[str, Callable[..., Any]] = {
    "norm": Norm,
    "norm1": SumNorm,
    "inner": Inner,
    "signs": methodcaller("applyfunc", sp.sign),
    "lambdamin": SmallestEigenvalue,
}
"""Functions that `reader` reads besides the usual ones."""
