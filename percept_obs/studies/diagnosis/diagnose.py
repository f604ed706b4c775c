"""Diagnosis of recordings: undo one usual mistake after the other, and name the one that explains the samples."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from percept_obs.recording import Recording
from percept_obs.recording.plausibility import LARGEST_USUAL
from percept_obs.studies.diagnosis.experiments import EXPERIMENTS, impossible, within_reach
from percept_obs.studies.diagnosis.explaining import Explained, explain
from percept_obs.validation import checked

CLEARLY = 10.0
"""Logarithm of the likelihood ratio from which on a mistake is named."""

FEWEST = 10
"""Fewest samples from which a point is estimated."""

PLACES = 12
"""Places in a recording at which another point may begin, before the best one is refined."""

FINEST = 1e-4
"""Root mean square of the residuals of the best camera, in focal lengths: a twentieth of a pixel."""

UNEXPLAINED = 1.5
"""Ratio of the residuals to the noise from which on something is unexplained."""


@dataclass(frozen=True)
class Finding:
    """A mistake that explains the samples better than the recordings as they are.

    Parameters
    ----------
    key : str
        "time offset", "focal length", "sign of w", "frames swapped", "pixels", "distortion ignored" or "mismatch".
    sentence : str
        The mistake in words.
    evidence : str
        By how much the residuals fall without it.
    gain : float
        Logarithm by which the samples become more likely, less the price of the unknowns (Schwarz's criterion);
        infinite if it is certain.
    value : float
        Such as the offset in seconds; NaN where there is none.
    tried, left : tuples of float
        The values that were tried and the root mean square of the residuals for each, in focal lengths.

    See Also
    --------
    Diagnosis : All findings.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from percept_obs import Camera, diagnose, record, scenarios
    >>> seen = record(scenarios.ma2005_eq35(), 5, Camera(0.05))
    >>> diagnose(replace(seen, outputs=0.8 * seen.outputs)).findings[0].sentence
    'the focal length is 0.800 times the one by which the images were divided'
    """

    key: str
    sentence: str
    evidence: str
    gain: float
    value: float = math.nan
    tried: tuple[float, ...] = ()
    left: tuple[float, ...] = ()


@checked
@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis:
    """Mistakes found in recordings.

    Parameters
    ----------
    findings : tuple of Finding
        Mistakes that explain the samples clearly better, the best first; one usually explains part of another.
    left : float
        Root mean square of the residuals of the samples as they are, in focal lengths.
    noise : float or None
        The standard deviation that the noise is said to have.
    not_tried : mapping of keys to reasons

    See Also
    --------
    diagnose : Makes it.
    percept_obs.figures.scan : Draws what was tried.

    Examples
    --------
    >>> from percept_obs import Camera, diagnose, record, scenarios
    >>> found = diagnose(record(scenarios.ma2005_eq35(), 3, Camera(0.05)))
    >>> found.named, list(found.not_tried)[:2]
    ('nothing', ['time offset', 'mismatch'])
    """

    findings: tuple[Finding, ...]
    left: float
    noise: float | None = None
    not_tried: Mapping[str, str] = field(default_factory=dict)

    @property
    def named(self) -> str:
        """Key of the mistake that explains most, or "nothing"."""
        return self.findings[0].key if self.findings else "nothing"

    @property
    def sentence(self) -> str:
        """The mistake that explains most, with the evidence."""
        left = f"{1000 * self.left:.3g} thousandths of the focal length are left of the samples"
        left += "" if self.noise is None else f", with noise of {1000 * self.noise:.3g}"
        if self.findings:
            first, *others = self.findings
            said = f"It looks as if {first.sentence}: {first.evidence}."
            said += f" Less would be explained by: {', '.join(other.key for other in others)}." if others else ""
        elif self.noise and self.left > UNEXPLAINED * self.noise:
            said = f"None of the usual mistakes explains the samples, but something is not as it is known: {left}."
        else:
            said = f"Nothing looks wrong: {left}."
        return said + "".join(f" Not tried: {key}, for {reason}." for key, reason in self.not_tried.items())

    def __repr__(self) -> str:
        return f"<Diagnosis: {self.sentence}>"


@checked
def diagnose(recordings: Recording | Sequence[Recording]) -> Diagnosis:
    """Look for the usual mistakes with a camera, in one recording or in several of points that one camera saw.

    Each mistake is undone, and the residuals of one point for each recording are compared with those of the recordings
    as they are.  Samples whose residuals are correlated in time count less.

    Parameters
    ----------
    recordings : Recording or sequence of Recording
        Of single points at rest, with the motion that is believed; no truth is needed.

    Returns
    -------
    Diagnosis

    Raises
    ------
    ValueError
        If there is none, one shows several points, or one is too short.

    See Also
    --------
    percept_obs.figures.scan : draws the residuals of each value that was tried

    Examples
    --------
    >>> from dataclasses import replace
    >>> import numpy as np
    >>> from percept_obs import Camera, Gaussian, Scenario, diagnose, pinhole, record, rigid
    >>> def moved(sign):
    ...     turning = lambda t: [sign * 0.3 * np.sin(2 * t), sign * 0.3 * np.cos(t), 0]
    ...     return rigid(turning, lambda t: [np.cos(t), 0, 0], [0, 0, 0])
    >>> seen = record(Scenario("mine", moved(1), (0.2, 0.1, 5), 6, pinhole()), camera=Camera(0.05, Gaussian(0.002)))
    >>> diagnose(seen).named
    'nothing'
    >>> diagnose(replace(seen, motion=moved(-1))).named
    'sign of w'
    """
    several = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not several:
        raise ValueError("there is no recording; give one, or several of points that one camera saw")
    variances = [recording.noise_variance for recording in several if recording.noise_variance is not None]
    noise = math.sqrt(float(np.mean(variances))) if len(variances) == len(several) else None
    size = np.abs(np.concatenate([[0.0], *(recording.outputs.ravel() for recording in several)]))
    if np.nanmedian(size) > LARGEST_USUAL:
        evidence = (
            f"half of them are larger than {np.nanmedian(size):.4g}, up to {np.nanmax(size):.4g}, where no camera sees "
            "farther to the side than a few focal lengths"
        )
        pixels = Finding("pixels", "the samples are pixels and not divided by the focal length", evidence, math.inf)
        return Diagnosis((pixels,), math.nan, noise)
    bare = [within_reach(recording) for recording in several]
    for recording in bare:
        if not (recording.seen.sum() >= 2 * FEWEST and recording.imaging_surface):
            raise ValueError(
                f"{recording!r} has {recording.seen.sum()} samples of all its outputs where its motion is known up to "
                f"the largest offset that is tried; {2 * FEWEST} are needed"
            )
    before = _Fits(tuple(map(explain, bare)))
    findings, not_tried = [], {}
    for experiment in EXPERIMENTS:
        if reason := impossible(experiment, bare):
            not_tried[experiment.key] = reason
            continue

        def undone(value: float, undo: Callable[[Recording, float], Recording] = experiment.undo) -> _Fits:
            return _Fits(tuple(explain(undo(recording, value)) for recording in bare))

        best, after, left = _scan(undone, experiment.values, experiment.continuous)
        if abs(best - experiment.none) < experiment.smallest:
            continue
        sentence, value = experiment.sentence(best), best if experiment.continuous else math.nan
        gain, evidence = after.gain(before, 1), after.evidence(before)
        findings.append(Finding(experiment.key, sentence, evidence, gain, value, experiment.values, left))
    if len(bare) > 1:
        findings.append(_mismatch(bare, before))
    else:
        not_tried["mismatch"] = "other points are needed to tell it from what all points share"
    clear = sorted((found for found in findings if found.gain > CLEARLY), key=lambda found: -found.gain)
    return Diagnosis(tuple(clear), before.rms, noise, not_tried)


@dataclass(frozen=True, eq=False)
class _Fits:
    """Residuals of all recordings."""

    each: tuple[Explained, ...]

    @property
    def squares(self) -> float:
        return sum(fit.squares for fit in self.each)

    @property
    def rms(self) -> float:
        return math.sqrt(self.squares / sum(fit.count for fit in self.each))

    def gain(self, before: _Fits, unknowns: int) -> float:
        """Logarithm by which the samples are more likely than before, less Schwarz's price of the unknowns."""
        count = sum(fit.effective_count for fit in self.each)
        finest = FINEST**2 * sum(fit.count for fit in self.each)
        return count / 2 * math.log((before.squares + finest) / (self.squares + finest)) - unknowns / 2 * math.log(
            count
        )

    def evidence(self, before: _Fits) -> str:
        fell = f"{1000 * before.rms:.3g} to {1000 * self.rms:.3g} thousandths of the focal length"
        return f"undone, what is left of the samples falls from {fell}"


def _scan(
    fits: Callable[[float], _Fits], values: Sequence[float], continuous: bool
) -> tuple[float, _Fits, tuple[float, ...]]:
    """Best value, its fits, and the residuals of each value; a continuous one is refined between its neighbours."""
    from scipy.optimize import minimize_scalar

    tried = [fits(value) for value in values]
    k = int(np.argmin([each.squares for each in tried]))
    best, after = values[k], tried[k]
    if continuous:
        ends = values[max(k - 1, 0)], values[min(k + 1, len(values) - 1)]
        options = {"xatol": 1e-3, "maxiter": 12}
        best = float(minimize_scalar(lambda v: fits(v).squares, bounds=ends, method="bounded", options=options).x)
        after = fits(best)
    return best, after, tuple(each.rms for each in tried)


def _mismatch(recordings: Sequence[Recording], before: _Fits) -> Finding:
    """Finding that the recording with the largest residuals shows another point from some sample on."""
    number = int(np.argmax([fit.squares / fit.count for fit in before.each]))
    recording, time = recordings[number], recordings[number].time
    others = (*before.each[:number], *before.each[number + 1 :])

    def split(place: float) -> _Fits:
        k = round(place)
        return _Fits((*others, *(explain(recording.between(*time[ends])) for ends in ([0, k - 1], [k, -1]))))

    places = np.unique(np.linspace(FEWEST, len(time) - FEWEST, PLACES).astype(int)).tolist()
    best, after, left = _scan(split, places, continuous=True)
    when = float(time[round(best)])
    return Finding(
        "mismatch",
        f"recording {number} ({recording.source or 'without a source'}) shows another landmark from {when:.4g} s on",
        f"{after.evidence(before)}, while one point each explains the others",
        after.gain(before, 4),
        when,
        tuple(time[places].tolist()),
        left,
    )
