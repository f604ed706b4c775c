"""What is said of a run: one rule for when an estimate has converged, and the words for it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

REMEDY = "choose smaller gains or shorter steps"
"""What to do about a run that diverged."""

TOLERANCE = 0.1
"""Relative error within which an estimate counts as right, unless another is asked for.

Samples that are off by a hundredth of the focal length make good observers scatter by 2 to 4 %; a tenth is what they
then hardly ever leave, and what an observer that is off by a fifth never enters.
"""

SETTLED_PART = 0.1
"""Part of a run, at its end, over which an estimate must have stayed within the tolerance to be called converged."""

VERDICTS = MappingProxyType(
    {
        "diverged": "diverged at {time} s: the estimate grew beyond all bounds; {remedy}",
        "followed": "followed {time} s; no truth to compare with",
        "none": "not converged: there is no estimate at the end",
        "behind": "not converged: the estimate ends infinitely far away or behind the camera",
        "outside": "not converged: the {error_of} of {judged} ends at {error}, outside {tolerance}",
        "late": (
            "not converged yet: the {error_of} of {judged} is within {tolerance} only since {time} s, too short before "
            "the end to be sure of"
        ),
        "converged": "converged: the {error_of} of {judged} stays within {tolerance} after {time} s",
        "relative": "relative error",
        "absolute": "error",
        "reset once": "; driven to the bound and reset once, at {time} s",
        "reset often": "; driven to the bound and reset {count} times, first at {time} s",
        "gap": "; no estimate from {begin} to {end} s, for {reason}",
        "more gaps": ", and in {count} more gaps",
    }
)
"""What a verdict says, by what happened; live labs use the same words.  Times count from the first sample."""


@dataclass(frozen=True)
class Outcome:
    """What became of an error.

    Parameters
    ----------
    kind : str
        "converged", "late" (inside at the end, but not for long enough), "outside", "behind" (an infinite error: the
        estimate is infinitely far away or behind the camera), "none" (no estimate) or "diverged".
    settled : float
        Seconds from the first sample until the error stays inside for good; infinite if it ends outside.
    final : float
        The last error.
    """

    kind: str
    settled: float
    final: float

    @property
    def converged(self) -> bool:
        """Whether it stayed inside for at least the last tenth of the run."""
        return self.kind == "converged"


def outcome(elapsed: Array, error: Array, tolerance: float, length: float) -> Outcome:
    """What became of an error over time.

    Parameters
    ----------
    elapsed : array of shape (K,)
        Seconds since the first sample, at the samples whose error is known; at least one.
    error : array of shape (K,)
        Not negative; infinite behind the camera, NaN without an estimate.
    tolerance : float
        Positive.
    length : float
        Seconds that the run lasts.
    """
    if not tolerance > 0:
        raise ValueError(f"the tolerance is {tolerance}; it must be positive")
    final = float(error[-1])
    outside = np.flatnonzero(~(error < tolerance))
    if len(outside) and outside[-1] == len(error) - 1:
        kind = "none" if math.isnan(final) else "behind" if math.isinf(final) else "outside"
        return Outcome(kind, math.inf, final)
    settled = float(elapsed[outside[-1] + 1]) if len(outside) else 0.0
    return Outcome("converged" if length - settled >= SETTLED_PART * length else "late", settled, final)


def in_words(found: Outcome, judged: str, tolerance: float, names: Sequence[str] = ()) -> str:
    """The sentence that says it: of the relative error, or with names of coordinates of their absolute error."""
    kind = "absolute" if names else "relative"
    error, within = (f"{found.final:.2g}", f"{tolerance:g}") if names else (percent(found.final), percent(tolerance, 6))
    return VERDICTS[found.kind].format(
        **{"error_of": VERDICTS[kind], "judged": judged, "error": error},
        **{"tolerance": within, "time": f"{found.settled:.3g}"},
    )


def percent(share: float, digits: int = 2) -> str:
    """A share in per cent."""
    return f"{100 * share:.{digits}g} %"
