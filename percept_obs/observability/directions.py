"""Directions of a state: those that no output can show, and their names in words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from percept_obs.compile import Array
from percept_obs.tracking.verdict import number

NEGLIGIBLE = 1e-9
"""A direction that changes the outputs less than this, relatively, is not seen."""

MOST_TERMS = 6
"""Most terms in the name of a direction: of more states the first five are named, and the others counted."""


def unobservable(A: Array, C: Array) -> Array:
    """Unobservable subspace: the largest one that C maps to 0 and every A maps into itself; orthonormal columns.

    A has the shape (K, n, n), C the shape (q, n).
    """
    from scipy.linalg import null_space

    basis = null_space(C, rcond=NEGLIGIBLE)
    tolerance = NEGLIGIBLE * max(1.0, float(np.abs(A).max(initial=0.0)))
    while basis.shape[1]:
        # the part of A basis outside of the subspace: directions that A turns into seen ones are dropped
        leaving = A @ basis - basis @ (basis.T @ (A @ basis))
        _, singular, right = np.linalg.svd(leaving.reshape(-1, basis.shape[1]))
        kept = right[int((singular > tolerance).sum()) :].T
        if kept.shape[1] == basis.shape[1]:
            break
        basis = basis @ kept
    return np.asarray(basis)


def in_words(directions: Array, names: Sequence[str]) -> tuple[str, ...]:
    """Name linearly independent directions, shape (n, q), as sums of states, such as "r_x - d2_x".

    The sums span the same space, each with as few states as elimination leaves; of many states the first are named.
    """
    return tuple(_sum(row, names) for row in _reduced(directions.T))


def _reduced(rows: Array) -> Array:
    """Reduced row echelon form."""
    rows = np.array(rows, dtype=float)
    for k in range(len(rows)):
        # pivot on the earliest state whose entry is about the largest, so that names follow the states' order
        candidates = np.abs(rows[k:]).max(axis=0)
        column = int(np.argmax(candidates > 0.5 * candidates.max()))
        pivot = k + int(np.argmax(np.abs(rows[k:, column])))
        rows[[k, pivot]] = rows[[pivot, k]]
        rows[k] /= rows[k, column]
        others = np.arange(len(rows)) != k
        rows[others] -= rows[others][:, [column]] * rows[k]
    return rows


def mainly(direction: Array, names: Sequence[str]) -> str:
    """Name the states that a direction of shape (n,) changes most, at most three, such as "r_z, d2_z, d2_x"."""
    size = np.round(np.abs(direction) / np.abs(direction).max(), 6)
    return ", ".join(names[k] for k in np.argsort(-size, kind="stable")[:3] if size[k] > 0)


def _sum(row: Array, names: Sequence[str]) -> str:
    """Text of a sum of states."""
    largest = np.abs(row).max()
    terms = [(value, name) for value, name in zip(row, names, strict=True) if abs(value) >= 1e-6 * largest]
    shown = terms if len(terms) <= MOST_TERMS else terms[: MOST_TERMS - 1]
    text = ""
    for value, name in shown:
        size = "" if abs(abs(value) - 1) < 1e-6 else f"{number(abs(value))} "
        sign = "-" if value < 0 else "+"
        text += f" {sign} {size}{name}" if text else f"{sign.strip('+')}{size}{name}"
    return text if shown is terms else f"{text} and {len(terms) - len(shown)} more states"
