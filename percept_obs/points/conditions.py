"""The inequalities for P under which the error of the Luenberger-type observer cannot grow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from percept_obs.compile import Array
from percept_obs.points.luenberger import LuenbergerObserver
from percept_obs.validation import checked

TOLERANCE = 1e-6
"""Relative amount by which an inequality may be missed for rounding."""


@dataclass(frozen=True, eq=False)
class Conditions:
    """Inequalities that make V = rho^T P rho decrease, at T times along a run.

    The largest eigenvalues of A^T P + P A + P', as `printed` in (15), and of the `weaker` condition with -(2 - epsilon)
    S added, under which V' <= -epsilon |B C rho|^2, must not be positive; the least one of P must stay above a positive
    number.  They are judged by the scale, the size of the terms.
    """

    time: Array
    printed: Array
    weaker: Array
    least: Array
    epsilon: float
    scale: Array

    @property
    def printed_holds(self) -> bool:
        """True if (15) holds throughout."""
        return bool((self.printed <= TOLERANCE * self.scale).all())

    @property
    def weaker_holds(self) -> bool:
        """True if the weaker inequality holds throughout."""
        return bool((self.weaker <= TOLERANCE * self.scale).all())

    def verdict(self) -> str:
        """Say in words which inequalities hold, and since when others fail."""
        found = []
        for name, values in (("(15)", self.printed), (f"the weaker one with epsilon = {self.epsilon:g}", self.weaker)):
            missed = self.time[values > TOLERANCE * self.scale]
            worst = f"by {values.max():.3g} at {self.time[values.argmax()]:.3g} s"
            found.append(
                f"{name} " + (f"fails first at {missed[0]:.3g} s, {worst}" if len(missed) else "holds throughout")
            )
        lost = self.time[self.least <= 0]
        least = f"the smallest eigenvalue of P is {self.least.min():.3g}"
        return "; ".join([*found, f"P is not positive definite from {lost[0]:.3g} s on" if len(lost) else least])


@checked
def conditions(observer: LuenbergerObserver, time: Array, outputs: Array, P: Array, epsilon: float = 1.0) -> Conditions:
    """Evaluate (15) and the weaker A^T P + P A + P' <= (2 - epsilon) S, 0 < epsilon <= 2, at some times.

    Outputs have the shape (T, p, m), NaN where a point is not seen, and P the shape (T, n, n).
    """
    if not 0 < epsilon <= 2:
        raise ValueError(f"epsilon is {epsilon}; it must be above 0 and at most 2")
    form, matrix = observer.form, observer.P
    S = form.information(outputs)
    if matrix.computed:
        # the equation of P itself gives A^T P + P A + P', without A or a difference
        left = matrix.information * S - matrix.forgetting * (P - matrix.start) - matrix.decrease
    else:
        A, _ = form.coefficients(time)
        left = np.swapaxes(A, 1, 2) @ P + P @ A + matrix.rate(time)
        left = (left + np.swapaxes(left, 1, 2)) / 2
    printed, weaker = (np.linalg.eigvalsh(each)[:, -1] for each in (left, left - (2 - epsilon) * S))
    scale = np.linalg.norm(P, axis=(1, 2)) + np.linalg.norm(S, axis=(1, 2))
    return Conditions(time, printed, weaker, np.asarray(np.linalg.eigvalsh(P)[:, 0]), epsilon, scale)
