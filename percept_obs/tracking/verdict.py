"""Verdict on a run: one rule for when an estimate has converged, and its sentences."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from percept_obs.compile import Array
from percept_obs.recording.camera import TOO_SHORT
from percept_obs.recording.plausibility import Unlikely
from percept_obs.tracking.information import Information
from percept_obs.validation import warn

REMEDY = "choose smaller gains or shorter steps"
"""Advice for a run that diverged."""

TOLERANCE = 0.1
"""Relative error within which an estimate counts as right, unless another is asked for.

Noise of a hundredth of the focal length makes good observers scatter by 2 to 4 %: they hardly ever leave a tenth, and
an observer that is off by a fifth never enters it.
"""

SETTLED_PART = 0.1
"""Share of a run that an estimate must have stayed within the tolerance, up to its end, to have converged.

An estimate that swings through the truth is near it for a moment, and not for a tenth of the run.
"""

FAR_OFF = 10.0
"""Relative error, ten times the distance, beyond which no number is given, for it would tell nothing more."""

VERDICTS = MappingProxyType(
    {
        "diverged": "diverged at {time} s",
        "grew": ": the estimate grew beyond all bounds",
        "followed": "followed {time} s; no truth to compare with",
        "not yet": "not observable yet: {window} s of samples do not tell {judged}",
        "none": "not converged: there is no estimate at the end",
        "behind": "not converged: the estimate ends infinitely far away or behind the camera",
        "outside": "not converged: the {error_of} of {judged} ends at {error}, outside {tolerance}",
        "late": (
            "not converged yet: the {error_of} of {judged} was outside {tolerance} until {time} s, too near the end to "
            "be sure of the rest"
        ),
        "converged": "converged: the {error_of} of {judged} stays within {tolerance} after {time} s",
        "relative": "relative error",
        "absolute": "error",
        "reset once": "; driven to the bound and reset once, at {time} s",
        "reset often": "; driven to the bound and reset {count} times, first at {time} s",
        "gap": "; no estimate from {begin} to {end} s, for {reason}",
        "short gap": "; no estimate at {begin} s, for {reason}",
        "one more gap": ", and in one more gap",
        "more gaps": ", and in {count} more gaps",
    }
)
"""Sentences of verdicts by outcome, also of figures and live labs.  Times count from the first sample."""


BLIND = MappingProxyType(
    {
        "agrees": "; the last {window} s of samples tell {judged} to within {within} (2σ), and the estimate agrees",
        "differs": (
            "; do not trust the estimate: it is {difference} off what the last {window} s of samples tell of {judged}, "
            "to within {within} (2σ)"
        ),
        "vague": "; do not trust the estimate: {window} s of samples tell {judged} only to within {within} (2σ)",
        "hidden": "; do not trust the estimate: {window} s of samples tell nothing of {judged}",
        "not yet": f"; {VERDICTS['not yet']}",
        "no estimate": "; do not trust it: there is no estimate at the end",
        "nowhere": "; do not trust the estimate: it ends infinitely far away or behind the camera",
        "unexcited": ", hardly excited since {begin} s",
        "claimed": "; it claims {claimed} (2σ)",
        "contradicted": (
            "; do not trust the estimate: the last {window} s and longer ones of samples tell {judged} as {apart} "
            "apart, so that the motion is not as it is known"
        ),
        "unexplained": (
            "; do not trust the estimate: no place of the point explains the samples to within their noise; what is "
            "left may move {judged} by {apart}, and `diagnose` looks for the reason"
        ),
        "drifting": (
            "; do not trust the estimate: the samples tell that the length of your translation drifts by {apart} or "
            "more during the recording"
        ),
        "wide": "; do not trust the estimate: the filter itself is not sure enough of {judged}",
        "doubted": "; do not trust the estimate: {doubt}",
        "rests": "; this rests on the length of your translation",
    }
)
"""Sentences of trust, of which live labs, which know the truth, need none."""


def for_the_page() -> dict[str, Any]:
    """Sentences and constants for live labs."""
    numbers = {"settledPart": SETTLED_PART, "tolerance": TOLERANCE, "farOff": FAR_OFF}
    return {"verdicts": {**VERDICTS, "too short": TOO_SHORT}, **numbers}


@dataclass(frozen=True)
class Outcome:
    """Outcome of a run, from its error over time.

    The kind is "converged", "late" (inside at the end, but not for long enough), "outside", "behind" (an infinite
    error: the estimate is infinitely far away or behind the camera), "none" (no estimate) or "diverged".  It settled
    when, in seconds from the first sample, the error stays inside for good; infinite if it ends outside.
    """

    kind: str
    settled: float
    final: float

    @property
    def converged(self) -> bool:
        """True if the error stayed inside for at least the last tenth of the run."""
        return self.kind == "converged"


@dataclass(frozen=True, eq=False)
class Trust:
    """Trust in the last estimate without a truth.

    The kind is "agrees" (with what the samples tell), "differs", "wide" (the observer claims more than the
    tolerance), "contradicted" (longer windows tell something else, so that the motion is not as it is known),
    "drifting" (the scale of the motion drifts), "unexplained" (what is left of the samples is no noise, and may
    move it), "doubted" (the recording has a doubt), "vague" (they tell too little), "hidden" (they tell nothing),
    "nowhere" (the estimate is infinitely far away or behind the camera), "not yet" (nothing was observable) or "no
    estimate". The difference is the estimate's relative distance to the information's, and NaN where that is vague
    or contradicted; `claimed` is the relative standard deviation that the observer claims.
    """

    kind: str
    judged: str
    length: float
    information: Information | None = None
    difference: float = math.nan
    disagreement: float = 0.0
    claimed: float | None = None
    doubt: str = ""

    @property
    def trusted(self) -> bool:
        """True if the estimate agrees with the samples well enough."""
        return self.kind == "agrees"

    @property
    def sentence(self) -> str:
        """The judgement as a sentence of its own."""
        said = self.clause.removeprefix("; ")
        return f"{said[0].upper()}{said[1:]}."

    def __str__(self) -> str:
        return self.sentence

    @property
    def clause(self) -> str:
        """The judgement as the end of another sentence."""
        fields = {"judged": self.judged, "difference": percent(self.difference), "apart": percent(self.disagreement)}
        if self.information is None:
            return BLIND[self.kind].format(**fields, doubt=self.doubt, window=number(self.length))
        window, unexcited = self.information.window, self.information.unexcited
        fields |= {"window": number(window), "within": percent(2 * self.information.deviation)}
        said = BLIND[self.kind].format(**fields)
        if unexcited >= SETTLED_PART * self.length:
            said += BLIND["unexcited"].format(begin=number(self.length - unexcited))
        if self.claimed is not None:
            said += BLIND["claimed"].format(claimed=percent(2 * self.claimed))
        return said + (BLIND["rests"] if self.kind in ("agrees", "differs", "wide") else "")


def judge_tolerance(tolerance: float) -> None:
    """Refuse a relative tolerance that is not positive and finite, and warn of one that looks like per cent."""
    if not 0 < tolerance < math.inf:
        raise ValueError(f"the tolerance is {tolerance}; it must be positive and finite, such as 0.1 for 10 %")
    if tolerance > 1:
        warn(Unlikely(f"the tolerance is {tolerance:g}, more than the distance itself; 10 % are 0.1: were they meant?"))


def outcome(elapsed: Array, error: Array, tolerance: float, length: float) -> Outcome:
    """Outcome of a run of a length in seconds, from its error at some seconds after the first sample, shapes (K,).

    The error is infinite behind the camera and NaN without an estimate.
    """
    final = float(error[-1])
    outside = np.flatnonzero(~(error < tolerance))
    if len(outside) and outside[-1] == len(error) - 1:
        kind = "none" if math.isnan(final) else "behind" if math.isinf(final) else "outside"
        return Outcome(kind, math.inf, final)
    settled = float(elapsed[outside[-1] + 1]) if len(outside) else 0.0
    return Outcome("converged" if stays(settled, length) else "late", settled, final)


def stays(settled: Any, length: float) -> Any:
    """Return True where an error settled early enough in a run of this length, in seconds, to be sure of the rest."""
    return length - settled >= SETTLED_PART * length


def in_words(found: Outcome, judged: str, tolerance: float, names: Sequence[str] = ()) -> str:
    """Sentence of an outcome, of the relative error or, with names of coordinates, of their absolute error."""
    kind, error, within = "relative", percent(found.final), percent(tolerance, 6)
    if names:
        kind, error, within = "absolute", number(found.final, 2), f"{tolerance:g}"
    fields = {"error_of": VERDICTS[kind], "judged": judged, "error": error, "tolerance": within}
    return VERDICTS[found.kind].format(**fields, time=number(found.settled))


def diverged(seconds: float) -> str:
    """When a run diverged, in words, from the seconds since its first sample."""
    return VERDICTS["diverged"].format(time=number(seconds))


def number(value: float, digits: int = 3) -> str:
    """Format a number for people: plain up to a million, and no zero with a sign.

    >>> [number(value) for value in (0.05, 1234.0, -0.0, 2e6)]
    ['0.05', '1230', '0', '2e+06']
    """
    text = f"{value:.{digits}g}"
    if float(text) == 0:
        return "0"
    return f"{float(text):.0f}" if "e+" in text and abs(float(text)) < 1e6 else text


def percent(share: float, digits: int = 3) -> str:
    """Format a share in per cent; beyond `FAR_OFF` no number is given."""
    return f"{number(100 * share, digits)} %" if share <= FAR_OFF else f"more than {100 * FAR_OFF:g} %"
