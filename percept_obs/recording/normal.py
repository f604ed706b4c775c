"""Least squares of numbers that samples share, of a film or of recordings: what they alone explain, and how surely."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from percept_obs.compile import Array, Flags

ROUNDING = 1e-6
"""Share of a column's norm below which what is left of it is rounding, for half of the digits are lost in squares."""


def project_out(columns: Array, others: Array) -> Array:
    """Return columns, shape (..., n, q), less what others explain of them; 0 where that is all but rounding."""
    size = np.linalg.norm(others, axis=-2, keepdims=True)
    basis, strength, _ = np.linalg.svd(others / np.where(size > 0, size, 1), full_matrices=False)
    basis = basis * (strength > ROUNDING * strength.max(axis=-1, keepdims=True))[..., None, :]
    left = columns - basis @ (np.swapaxes(basis, -1, -2) @ columns)
    alone = np.linalg.norm(left, axis=-2, keepdims=True) > ROUNDING * np.linalg.norm(columns, axis=-2, keepdims=True)
    return np.asarray(left * alone)


@dataclass(frozen=True, eq=False)
class NormalEquations:
    """Normal equations of q numbers, each with the cause that it belongs to, its `owner`.

    What each picture or track has alone, a pose or a point, is eliminated already, see `project_out`.  The scores,
    shape (q, B), are the derivatives by the numbers in B parts of the samples.  Before anything is seen a number is 0
    with its `usual` standard deviation.  `more` is what the eliminated unknowns add to the likelihood's logarithm.
    """

    owner: NDArray[Any]
    matrix: Array
    scores: Array
    usual: Array
    more: float = 0.0

    def solved(self, causes: Sequence[int] | Sequence[str]) -> tuple[Flags, Array, Array]:
        """Return which numbers belong to some causes, their steps from each part, all others being 0, and covariance.

        The sum of the steps explains the samples best.  A number that is not told has an infinite variance.
        """
        own = np.isin(self.owner, causes)
        matrix = self.matrix[np.ix_(own, own)] + np.diag(self.usual[own] ** -2)
        scale = np.sqrt(np.where(np.diag(matrix) > 0, np.diag(matrix), 1))
        values, vectors = np.linalg.eigh(matrix / np.outer(scale, scale))
        told = values > ROUNDING**2
        covariance = vectors[:, told] / values[told] @ vectors[:, told].T / np.outer(scale, scale)
        steps = covariance @ self.scores[own]
        lost = np.flatnonzero((vectors[:, ~told] ** 2).sum(axis=1) > ROUNDING)
        covariance[lost, lost] = np.inf
        return own, steps, np.asarray(covariance)

    def likelihood(self, causes: Sequence[int] | Sequence[str]) -> float:
        """Logarithm of the likelihood with some causes, the mean over all numbers that are usual."""
        own, steps, covariance = self.solved(causes)
        narrower = np.linalg.slogdet(covariance)[1] / 2 - np.log(self.usual[own]).sum()
        return float((self.scores[own].sum(axis=1) * steps.sum(axis=1)).sum() / 2 + narrower + self.more)
