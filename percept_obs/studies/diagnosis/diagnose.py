"""What looks wrong with recordings, found by undoing one mistake after the other."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from percept_obs.recording import Recording
from percept_obs.recording.doubts import LARGEST_USUAL
from percept_obs.studies.diagnosis.experiments import EXPERIMENTS, FRAMES, Experiment, possible, within_reach
from percept_obs.studies.diagnosis.explaining import Explained, explain
from percept_obs.validation import checked

CLEARLY = 10.0
"""Logarithm of the ratio of likelihoods from which on a mistake is named."""

FEWEST = 10
"""Samples in a part of a recording that is explained by a point of its own."""

PLACES = 12
"""Places in a recording at which another point may begin, as first tried."""

FINEST = 1e-4
"""What is left of the samples of the best camera, in focal lengths: a twentieth of a pixel."""

UNEXPLAINED = 1.5
"""Times the noise that may be left before it is said that something is unexplained."""


@dataclass(frozen=True)
class Finding:
    """A mistake that explains the samples better than the recordings as they are.

    Parameters
    ----------
    key : str
        "time offset", "focal length", "sign of w", "frames swapped", "pixels", "distortion ignored" or "mismatch".
    sentence : str
        What looks wrong.
    evidence : str
        By which one knows.
    gain : float
        Logarithm by which the samples become more likely, less what its unknowns are worth; infinite without a doubt.
    value : float
        Such as the offset in seconds; NaN where there is none.
    tried, left : arrays
        The values that were tried and what each leaves of the samples: the root mean square, in focal lengths.
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
    """What looks wrong with recordings.

    Parameters
    ----------
    findings : tuple of Finding
        Mistakes that explain the samples clearly better, the best first; one usually explains part of another.
    left : float
        What the best point leaves of the samples as they are: the root mean square, in focal lengths.
    noise : float or None
        The standard deviation that the noise is said to have.
    not_tried : mapping of keys to reasons
    """

    findings: tuple[Finding, ...]
    left: float
    noise: float | None = None
    not_tried: dict[str, str] = field(default_factory=dict)

    @property
    def named(self) -> str:
        """Key of the mistake that explains most, or "nothing"."""
        return self.findings[0].key if self.findings else "nothing"

    @property
    def sentence(self) -> str:
        """What looks wrong, with the evidence."""
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
        said += "".join(f" Not tried: {key}, for {reason}." for key, reason in self.not_tried.items())
        return said

    def __repr__(self) -> str:
        return f"<Diagnosis: {self.sentence}>"


@checked
def diagnose(recordings: Recording | Sequence[Recording]) -> Diagnosis:
    """Look for the usual mistakes with a camera, in one recording or in several of points that one camera saw.

    Each mistake is undone, and what one point leaves of each recording's samples is compared with what it leaves of
    them as they are.  Samples whose rest is correlated in time count less.

    Parameters
    ----------
    recordings : Recording or sequence of Recording
        Of single points at rest, with the motion that is believed; no truth is needed.

    Raises
    ------
    ValueError
        If there is none, one shows several points, or one is too short.

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
    given = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not given:
        raise ValueError("there is no recording; give one, or several of points that one camera saw")
    variances = [recording.noise_variance for recording in given if recording.noise_variance is not None]
    noise = math.sqrt(float(np.mean(variances))) if len(variances) == len(given) else None
    pixels = _pixels(given)
    if pixels:
        return Diagnosis((pixels,), math.nan, noise)
    bare = [within_reach(recording) for recording in given]
    _refuse_short_ones(bare)
    as_they_are = _Left.of(bare)
    findings, not_tried = [], {}
    for experiment in EXPERIMENTS:
        reason = possible(experiment, bare)
        if reason:
            not_tried[experiment.key] = reason
        else:
            findings.append(_tried(experiment, bare, as_they_are))
    if len(bare) > 1:
        findings.append(_mismatched(bare, as_they_are))
    else:
        not_tried["mismatch"] = "other points are needed to tell it from what all points share"
    clear = sorted((f for f in findings if f is not None and f.gain > CLEARLY), key=lambda f: -f.gain)
    return Diagnosis(tuple(clear), as_they_are.rms, noise, not_tried)


@dataclass(frozen=True, eq=False)
class _Left:
    """What is left of all samples."""

    parts: tuple[Explained, ...]

    @classmethod
    def of(cls, recordings: Sequence[Recording]) -> _Left:
        return cls(tuple(map(explain, recordings)))

    @property
    def squares(self) -> float:
        return sum(part.squares for part in self.parts)

    @property
    def rms(self) -> float:
        return math.sqrt(self.squares / sum(part.count for part in self.parts))

    @property
    def independent(self) -> float:
        """How many numbers that are not correlated tell as much as all."""
        correlations = [min(max(part.correlation, 0.0), 0.99) for part in self.parts]
        return sum(part.count * (1 - r) / (1 + r) for part, r in zip(self.parts, correlations, strict=True))

    def gain(self, before: _Left, unknowns: int) -> float:
        """Logarithm by which samples are more likely than before, less Schwarz's price of the unknowns."""
        count, finest = self.independent, FINEST**2 * sum(part.count for part in self.parts)
        ratio = (before.squares + finest) / (self.squares + finest)
        return count / 2 * math.log(ratio) - unknowns / 2 * math.log(count)

    def evidence(self, before: _Left) -> str:
        fell = f"{1000 * before.rms:.3g} to {1000 * self.rms:.3g} thousandths of the focal length"
        return f"undone, what is left of the samples falls from {fell}"


def _tried(experiment: Experiment, recordings: Sequence[Recording], before: _Left) -> Finding | None:
    """What an experiment finds; nothing if its best value is none or is not worth a word."""

    def left(value: float) -> _Left:
        return _Left.of([experiment.undone(recording, value) for recording in recordings])

    found = {value: left(value) for value in experiment.values}
    tried, remaining = tuple(found), tuple(each.rms for each in found.values())
    best = min(found, key=lambda value: found[value].squares)
    if experiment.continuous:
        best = _refined(lambda value: left(value).squares, best, experiment.values)
    after = left(best)
    if not experiment.worth_telling(best):
        return None
    words = {"late": "late" if best > 0 else "early", "frame": [*FRAMES][int(best) % len(FRAMES)]}
    sentence = experiment.sentence.format(value=best, size=abs(best), **words)
    gain = after.gain(before, 1)
    value = best if experiment.continuous else math.nan
    return Finding(experiment.key, sentence, after.evidence(before), gain, value, tried, remaining)


def _refined(squares: Callable[[float], float], best: float, values: Sequence[float]) -> float:
    """The best value between the neighbours of the best of some."""
    from scipy.optimize import minimize_scalar

    place = list(values).index(best)
    low, high = values[max(place - 1, 0)], values[min(place + 1, len(values) - 1)]
    found = minimize_scalar(squares, bounds=(low, high), method="bounded", options={"xatol": 1e-3, "maxiter": 12})
    return float(found.x)


def _mismatched(recordings: Sequence[Recording], before: _Left) -> Finding | None:
    """The recording that shows another point from some sample on, if one does."""
    spread = [part.squares / part.count for part in before.parts]
    number = int(np.argmax(spread))
    recording, length = recordings[number], len(recordings[number].time)
    others = [part for k, part in enumerate(before.parts) if k != number]

    def split(place: int) -> _Left:
        ends = (recording.time[[0, place - 1]], recording.time[[place, -1]])
        return _Left((*others, *(explain(recording.between(*end)) for end in ends)))

    places = np.unique(np.linspace(FEWEST, length - FEWEST, PLACES).astype(int)).tolist()
    found = {place: split(place) for place in places}
    reach = max(1, (length - 2 * FEWEST) // PLACES)
    while True:
        best = min(found, key=lambda place: found[place].squares)
        near = [p for p in (best - reach, best + reach) if FEWEST <= p <= length - FEWEST and p not in found]
        if not near and reach == 1:
            break
        found |= {place: split(place) for place in near}
        reach = max(1, reach // 2)
    after = found[best]
    when = float(recording.time[best])
    return Finding(
        "mismatch",
        f"recording {number} ({recording.source or 'without a source'}) shows another landmark from {when:.4g} s on",
        f"{after.evidence(before)}, while one point each explains the others",
        after.gain(before, 4),
        when,
        tuple(recording.time[sorted(found)].tolist()),
        tuple(found[place].rms for place in sorted(found)),
    )


def _pixels(recordings: Sequence[Recording]) -> Finding | None:
    """That the outputs are pixels, which their size alone tells."""
    sizes = [np.abs(recording.outputs[np.isfinite(recording.outputs)]) for recording in recordings]
    size = np.concatenate([[0.0], *sizes])
    if not np.median(size) > LARGEST_USUAL:
        return None
    return Finding(
        "pixels",
        "the samples are pixels and not divided by the focal length",
        f"half of them are larger than {np.median(size):.4g}, up to {size.max():.4g}, where no camera sees farther to "
        f"the side than a few focal lengths",
        math.inf,
    )


def _refuse_short_ones(recordings: Sequence[Recording]) -> None:
    for recording in recordings:
        if not (recording.seen.sum() >= 2 * FEWEST and recording.imaging_surface):
            raise ValueError(
                f"{recording!r} has {recording.seen.sum()} samples of all its outputs where its motion is known up to "
                f"the largest offset that is tried; {2 * FEWEST} are needed"
            )
