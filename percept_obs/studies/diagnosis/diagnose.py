"""Diagnosis of recordings: usual mistakes with a camera, fitted together, and those that explain the samples."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from percept_obs.recording import Recording
from percept_obs.recording.plausibility import LARGEST_USUAL
from percept_obs.studies.diagnosis.causes import CAUSES, FOCAL, LARGEST_OFFSET, MIX_UPS
from percept_obs.studies.diagnosis.fitting import Estimate
from percept_obs.studies.diagnosis.search import LIMITS, Found, search
from percept_obs.studies.diagnosis.tracks import track_of
from percept_obs.validation import checked, once

MOST = 12
"""Recordings that are looked at; of more of them, so many are taken, evenly spread."""


@dataclass(frozen=True)
class Finding:
    """Mistake that explains the samples better than the recordings as they are.

    Parameters
    ----------
    key : str
        "time offset", "focal length", "distortion ignored", "gyro bias", "scale drift", "rolling shutter",
        "sign of w_c", "sign of v", "flipped axis", "frames swapped", "poses inverted", "rotations inverted",
        "quaternion order", "mount inverted", "mount left out", "u and v exchanged", "image size",
        "fisheye ignored", "mismatch", "outliers" or "pixels".
    sentence : str
        The mistake in words.
    evidence : str
        By how much the residuals fall without it.
    value : float
        Such as the offset in seconds; NaN where there is none.
    deviation : float
        Standard deviation of the value; NaN where there is none.
    instead : tuple of str
        Keys of others that explain the samples as well, so that this motion cannot tell them apart.

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
    value: float = math.nan
    deviation: float = math.nan
    instead: tuple[str, ...] = ()


@checked
@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis:
    """Mistakes found in recordings.

    Parameters
    ----------
    findings : tuple of Finding
        Mistakes that together explain the samples, the one that explains most first.
    before, left : float
        Root mean square of what is left of the samples as they are, and without the mistakes, in focal lengths;
        infinite for pixels that are no images.
    explained : bool
        True if what is left looks like noise.
    noise : float or None
        The standard deviation that the noise is said to have.
    estimates : mapping of keys to Estimate
        Each wrong number by itself, beside the mistakes found.
    not_told : tuple of str
        Keys of mistakes that this motion cannot tell.
    looked_at, given, too_short : int
        Numbers of recordings.

    See Also
    --------
    diagnose : Makes it.
    percept_obs.figures.causes : Draws the estimates.

    Examples
    --------
    >>> from percept_obs import Camera, diagnose, record, scenarios
    >>> found = diagnose(record(scenarios.ma2005_eq35(), 3, Camera(0.05)))
    >>> found.named, found.not_told[:1]
    ('nothing', ('time offset',))
    """

    findings: tuple[Finding, ...]
    before: float
    left: float
    explained: bool
    noise: float | None = None
    estimates: Mapping[str, Estimate] = field(default_factory=dict)
    not_told: tuple[str, ...] = ()
    looked_at: int = 1
    given: int = 1
    too_short: int = 0

    @property
    def named(self) -> str:
        """Key of the mistake that explains most, or "nothing"."""
        return self.findings[0].key if self.findings else "nothing"

    @property
    def sentence(self) -> str:
        """The mistakes with the evidence, what is left, and what this motion cannot tell."""
        left = f"{1000 * self.left:.3g} thousandths of the focal length are left of the samples"
        left += "" if self.noise is None else f", with noise of {1000 * self.noise:.3g}"
        said = []
        if self.findings:
            first, *others = self.findings
            said.append(f"It looks as if {first.sentence}: {first.evidence}.")
            said += [f"Besides, {other.sentence}." for other in others]
            said += [
                f"The samples are explained as well by: {', '.join(each.instead)}; this motion cannot tell them from: "
                f"{each.key}."
                for each in self.findings
                if each.instead
            ]
        if not self.explained:
            these = "these do not explain it" if self.findings else "none of the usual mistakes explains it"
            said.append(f"Something is not as it is known: {left}, and {these}.")
        elif not self.findings:
            said.append(f"Nothing looks wrong: {left}.")
        if self.not_told:
            said.append(f"This motion cannot tell: {', '.join(self.not_told)}.")
        if self.looked_at + self.too_short < self.given:
            said.append(f"{self.looked_at} of {self.given} recordings were looked at, evenly spread.")
        if self.too_short:
            said.append(f"{self.too_short} were left out, for they are too short.")
        return " ".join(said)

    def __repr__(self) -> str:
        return f"<Diagnosis: {self.sentence}>"


@checked
def diagnose(recordings: Recording | Sequence[Recording]) -> Diagnosis:
    """Look for the usual mistakes with a camera, in one recording or in several of points that one camera saw.

    One point for each recording and all wrong numbers are fitted together, also with axes and signs mixed up.  A
    mistake is named if this motion can tell it, it is beyond what correlated errors explain, and no other explains the
    samples as well without being said.  A wrong length of the whole translation leaves no trace in images.

    Parameters
    ----------
    recordings : Recording or sequence of Recording
        Of single points at rest, with the motion that is believed; no truth is needed.

    Returns
    -------
    Diagnosis
        Mistakes that together explain the samples, and those that this motion cannot tell.

    Raises
    ------
    ValueError
        If there is none, one shows several points, kinds of motion differ, or all are too short.

    See Also
    --------
    percept_obs.figures.causes : Draws the estimates.

    Notes
    -----
    Deviations for errors that are correlated: Liang and Zeger, Longitudinal data analysis using generalized linear
    models, Biometrika 73(1), 1986, with tenths of the recordings as clusters.

    Examples
    --------
    >>> from dataclasses import replace
    >>> import numpy as np
    >>> from percept_obs import Camera, Gaussian, Scenario, diagnose, pinhole, record, rigid
    >>> def moved(sign):
    ...     turning = lambda t: [sign * 0.3 * np.sin(2 * t), sign * 0.3 * np.cos(t), 0]
    ...     return rigid(camera_angular_velocity=turning, camera_velocity=lambda t: [np.cos(t), 0, 0])
    >>> seen = record(Scenario("mine", moved(1), (0.2, 0.1, 5), 6, pinhole()), camera=Camera(0.05, Gaussian(0.002)))
    >>> diagnose(seen).named
    'nothing'
    >>> diagnose(replace(seen, motion=moved(-1))).named
    'sign of w_c'
    """
    given = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not given:
        raise ValueError("there is no recording; give one, or several of points that one camera saw")
    once(recordings=given)
    if len({each.motion.parameters for each in given}) > 1:
        raise ValueError("the recordings are of several kinds of motion; give points that one camera saw")
    several = [given[k] for k in np.unique(np.linspace(0, len(given) - 1, min(MOST, len(given))).round().astype(int))]
    variances = [each.effective_variance for each in several if each.effective_variance is not None]
    noise = math.sqrt(float(np.mean(variances))) if len(variances) == len(several) else None
    size = np.abs(np.concatenate([[0.0], *(recording.outputs.ravel() for recording in several)]))
    if np.nanmedian(size) > LARGEST_USUAL:
        evidence = (
            f"half of them are larger than {np.nanmedian(size):.4g}, up to {np.nanmax(size):.4g}, where no camera sees "
            "farther to the side than a few focal lengths"
        )
        pixels = Finding("pixels", "the samples are pixels and not divided by the focal length", evidence)
        return Diagnosis((pixels,), math.inf, math.inf, True, noise, looked_at=len(several), given=len(given))
    tracks = {recording: track_of(recording) for recording in several}
    short = [recording for recording, track in tracks.items() if track.count < LIMITS.fewest]
    several = [recording for recording in several if recording not in short]
    if not several:
        raise ValueError(
            f"{short[0]!r} has {tracks[short[0]].count} values where its motion is known up to the largest offset that "
            f"is tried, {LARGEST_OFFSET} s; {LIMITS.fewest} are needed: give longer poses or longer tracks"
        )
    found = search(tuple(tracks[recording] for recording in several), noise)
    return Diagnosis(
        tuple(_findings(found, [recording.source for recording in several])),
        found.bare.rms,
        found.best.rms,
        found.explained,
        noise,
        found.estimates,
        found.not_told,
        len(several),
        len(given),
        len(short),
    )


def _findings(found: Found, sources: Sequence[str]) -> Iterator[Finding]:
    """Mistakes that were found, in words."""
    best = found.best
    for key, (without, instead) in found.needed.items():
        evidence = (
            f"undone, what is left of the samples falls from {1000 * without.rms:.3g} to {1000 * best.rms:.3g} "
            "thousandths of the focal length"
        )
        if key == "mismatch" and found.switch is not None:
            whole = found.best.tracks[-1].time
            time, number = whole[found.switch.inside], found.switch.number
            until = f"to {time[-1]:.4g} s" if time[-1] < whole[-1] else "on"
            said = f"recording {number} ({sources[number] or 'without a source'}) shows another landmark"
            said += f" from {time[0]:.4g} s {until}"
            yield Finding(key, said, f"{evidence}, while one point each explains the others", float(time[0]))
        elif key in CAUSES:
            value, deviation = best.wrong[key], found.estimates[key].deviation
            size = float(value[0] if len(value) == 1 else np.linalg.norm(value))
            size = math.exp(size) if key == FOCAL else size
            yield Finding(key, CAUSES[key].sentence(value), evidence, size, deviation, instead)
        else:
            yield Finding(key, MIX_UPS[best.mix_up].sentence, evidence, instead=instead)
    wild, total = found.outliers
    if wild:
        said = f"{100 * wild / total:.2g} % of the samples are far off the others"
        evidence = (
            f"{wild} of {total} differ by more than {LIMITS.outlying:g} standard deviations from what the rest tells"
        )
        yield Finding("outliers", said, evidence, wild / total)
