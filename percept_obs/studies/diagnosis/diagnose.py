"""Diagnosis of recordings: usual mistakes with a camera, fitted together, and those that explain the samples."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from percept_obs.compile import Array, Flags
from percept_obs.recording import Recording
from percept_obs.recording.plausibility import LARGEST_USUAL
from percept_obs.studies.diagnosis.causes import CAUSES, LARGEST_OFFSET, MIX_UPS
from percept_obs.studies.diagnosis.fitting import FINEST, OUTLYING, Estimate, Fit, fit, rms
from percept_obs.studies.diagnosis.tracks import Track, guess, numbers_of, path_of, seen, track_of
from percept_obs.validation import checked

MOST = 12
"""Recordings that are looked at; of more of them, so many are taken, evenly spread."""

FEWEST = 20
"""Fewest values of a track from which a point is estimated."""

SURELY = 5.0
"""Standard deviations from which on a number is named."""

UNEXPLAINED = 1.5
"""Ratio of what is left to the noise from which on something is unexplained."""

WHITE = 0.3
"""Correlation of neighbouring residuals up to which they count as noise, where the noise is not known."""

CLEARLY = 10.0
"""Logarithm of the likelihood ratio from which on one explanation is better than another."""

WORSE = 2.0
"""Ratio of what two explanations leave from which on a mix-up is named where neither explains everything."""

TRIED = 2
"""Mix-ups with which numbers are fitted, those that explain most without."""

APART = 3.0
"""Ratio of what is left of one track to what is left of the others from which on its point may be another one."""

PLACES = 12
"""Places in a track at which another point may begin or end, before the best ones are refined."""

ROUNDS = 3
"""Times that samples are given to one of two points."""

OFFSETS = tuple(np.linspace(-LARGEST_OFFSET, LARGEST_OFFSET, 11).tolist())
"""Offsets in seconds from which fits begin."""


@dataclass(frozen=True)
class Finding:
    """Mistake that explains the samples better than the recordings as they are.

    Parameters
    ----------
    key : str
        One of `KEYS`.
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
        Root mean square of what is left of the samples as they are, and without the mistakes, in focal lengths.
    explained : bool
        True if what is left looks like noise.
    noise : float or None
        The standard deviation that the noise is said to have.
    estimates : mapping of keys to Estimate
        Each wrong number by itself, beside the mistakes found.
    not_told : tuple of str
        Keys of mistakes that this motion cannot tell.
    looked_at, given : int
        Number of recordings.

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
        if self.looked_at < self.given:
            said.append(f"{self.looked_at} of {self.given} recordings were looked at, evenly spread.")
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

    Raises
    ------
    ValueError
        If there is none, one shows several points, or one is too short.

    See Also
    --------
    percept_obs.figures.causes : draws the estimates

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
    several = [given[k] for k in np.unique(np.linspace(0, len(given) - 1, min(MOST, len(given))).round().astype(int))]
    counts = {"looked_at": len(several), "given": len(given)}
    variances = [recording.noise_variance for recording in several if recording.noise_variance is not None]
    noise = math.sqrt(float(np.mean(variances))) if len(variances) == len(several) else None
    size = np.abs(np.concatenate([[0.0], *(recording.outputs.ravel() for recording in several)]))
    if np.nanmedian(size) > LARGEST_USUAL:
        evidence = (
            f"half of them are larger than {np.nanmedian(size):.4g}, up to {np.nanmax(size):.4g}, where no camera sees "
            "farther to the side than a few focal lengths"
        )
        pixels = Finding("pixels", "the samples are pixels and not divided by the focal length", evidence)
        return Diagnosis((pixels,), math.nan, math.nan, True, noise, **counts)
    tracks = tuple(map(track_of, several))
    for recording, track in zip(several, tracks, strict=True):
        if track.count < FEWEST:
            raise ValueError(
                f"{recording!r} has {track.count} values where its motion is known up to the largest offset that is "
                f"tried, {LARGEST_OFFSET} s; {FEWEST} are needed"
            )
    return replace(_Search(tracks, noise).found([recording.source for recording in several]), **counts)


@dataclass(frozen=True, eq=False)
class _Switch:
    """Track that shows another point in some samples, shape (K,), and all tracks with that one parted at the end."""

    number: int
    inside: Flags
    tracks: tuple[Track, ...]


@dataclass(frozen=True, eq=False)
class _Search:
    """Search for the mistakes that explain some tracks, with noise of a known deviation or not."""

    tracks: tuple[Track, ...]
    noise: float | None

    def explained(self, found: Fit) -> bool:
        """True if what a fit leaves looks like noise."""
        if found.rms <= (FINEST if self.noise is None else UNEXPLAINED * max(self.noise, FINEST)):
            return True
        return self.noise is None and found.correlation <= WHITE

    def possible(self) -> list[str]:
        """Keys of the numbers that can be fitted."""
        rigid = all(_is_rigid(track) for track in self.tracks)
        both = all(len(track.whole) for track in self.tracks)
        constant = all(track.motion.signal and track.motion.signal.constant for track in self.tracks)
        ruled_out = {"gyro bias": not rigid, "scale drift": not rigid, "distortion ignored": not both, "rolling shutter": not both or constant}
        ruled_out["time offset"] = constant
        return [key for key in CAUSES if not ruled_out.get(key)]

    def found(self, sources: Sequence[str]) -> Diagnosis:
        keys = self.possible()
        bare = fit(self.tracks, "nothing", ())
        changed, tracks, best, screened = None, self.tracks, bare, []
        for _ in range(2):  # a track that shows two points is looked for before the numbers are fitted, and after
            if changed is None and (switch := self._switched(best)):
                parted = fit(switch.tracks, "nothing", ())
                if len(screened):
                    parted, screened = self._best(switch.tracks, parted, keys)
                if parted.gain(best) > CLEARLY and parted.each[-2:].max() < best.each[switch.number] / APART:
                    changed, tracks, best = switch, switch.tracks, parted
            if not len(screened):
                best, screened = self._best(tracks, fit(tracks, "nothing", ()), keys)
        if changed is not None:  # numbers alone may explain that track as well
            whole = self._best(self.tracks, bare, keys)[0]
            if self.explained(whole) or best.gain(whole) < CLEARLY:
                changed, best = None, whole
        best = self._fewest(best)
        estimates = self._estimates(best, keys)
        findings = self._findings(best, estimates, keys)
        if changed is not None:
            findings.append(self._mismatch(best, bare, changed, sources[changed.number]))
        findings += self._outliers(best)
        same = [each for each in screened if each.mix_up != best.mix_up and each.rms < 1.01 * screened[0].rms + FINEST / 10]
        not_told = [key for key in CAUSES if key not in keys or not SURELY * estimates[key].deviation < CAUSES[key].usual]
        if self.explained(best):
            not_told += [MIX_UPS[each.mix_up][0] for each in same if best.mix_up == "nothing"]
        named = [each.key for each in findings]
        not_told = [key for key in dict.fromkeys(not_told) if key not in named]
        return Diagnosis(
            tuple(findings), bare.rms, best.rms, self.explained(best), self.noise, estimates, tuple(not_told)
        )

    def _best(self, tracks: Sequence[Track], bare: Fit, keys: Sequence[str]) -> tuple[Fit, list[Fit]]:
        """Best joint fit among the mix-ups, and the fits of all mix-ups without wrong numbers."""
        screened = [bare, *(fit(tracks, mix_up, ()) for mix_up in MIX_UPS if mix_up != "nothing")]
        best = _joint(tracks, bare, keys)
        if not self.explained(best):
            better = [each for each in screened[1:] if each.typical < bare.typical]
            for each in sorted(better, key=lambda each: each.typical)[:TRIED]:
                other = _joint(tracks, each, keys)
                if self.explained(other) or WORSE * other.typical < best.typical:
                    best = min(best, other, key=lambda each: (not self.explained(each), each.typical))
        return best, screened

    def _fewest(self, best: Fit) -> Fit:
        """Fit with the fewest numbers that explains the samples as well: the least sure one is left out in turn."""
        while best.wrong:
            estimates = best.estimates([*best.wrong])
            key = min(estimates, key=lambda key: self._weight(key, estimates[key]))
            without = fit(best.tracks, best.mix_up, [k for k in best.wrong if k != key], best.wrong)
            needed = best.gain(without) > CLEARLY and self._weight(key, estimates[key]) >= 1
            if needed:
                break
            best = without
        return best

    @staticmethod
    def _weight(key: str, estimate: Estimate) -> float:
        """Number below 1 if an estimate is not worth naming."""
        cause, size = CAUSES[key], float(np.linalg.norm(estimate.value))
        inside = float(np.abs(estimate.value).max()) < 0.98 * cause.largest
        return min(estimate.sure / SURELY, size / cause.smallest) * inside

    def _estimates(self, best: Fit, keys: Sequence[str]) -> dict[str, Estimate]:
        """Every number by itself, beside the ones that were found."""
        own = [*best.wrong]
        found = best.estimates(own) if own else {}
        for key in keys:
            if key not in own:
                found[key] = best.estimates([*own, key])[key]
        return found | {
            key: Estimate(np.zeros(CAUSES[key].size), math.inf, 0.0) for key in CAUSES if key not in found
        }

    def _findings(self, best: Fit, estimates: Mapping[str, Estimate], keys: Sequence[str]) -> list[Finding]:
        found = []
        if best.mix_up != "nothing":
            key, sentence, _ = MIX_UPS[best.mix_up]
            without = fit(best.tracks, "nothing", [*best.wrong], best.wrong)
            instead = [
                other[0] + (f" ({other[1]})" if other[0] == key else "")
                for name, other in MIX_UPS.items()
                if name not in ("nothing", best.mix_up)
                and self._as_good(fit(best.tracks, name, [*best.wrong], best.wrong), best)
            ]
            found.append(Finding(key, sentence, _evidence(without, best), instead=tuple(dict.fromkeys(instead))))
        sizes = []
        for key in best.wrong:
            rest = [k for k in best.wrong if k != key]
            without = fit(best.tracks, best.mix_up, rest, best.wrong)
            swaps = [other for other in keys if other not in best.wrong]
            instead = [
                other
                for other in swaps
                if self._as_good(fit(best.tracks, best.mix_up, [*rest, other], best.wrong), best)
            ]
            estimate, value = estimates[key], best.wrong[key]
            size = float(value[0]) if len(value) == 1 else float(np.linalg.norm(value))
            size += key == "focal length"
            finding = Finding(
                key,
                CAUSES[key].sentence(value),
                _evidence(without, best),
                size,
                estimate.deviation,
                tuple(instead),
            )
            sizes.append((without.squares, finding))
        return found + [finding for _, finding in sorted(sizes, key=lambda each: -each[0])]

    def _as_good(self, other: Fit, best: Fit) -> bool:
        """True if another fit explains the samples about as well."""
        return best.gain(other) < CLEARLY

    def _switched(self, found: Fit) -> _Switch | None:
        """Track that may show two points, if what is left of one is far more than of the others."""
        if len(found.tracks) < 2:
            return None
        number = int(np.argmax(found.each))
        others = np.delete(found.each, number)
        floor = max(self.noise or 0.0, FINEST)
        if found.each[number] < APART * max(float(np.median(others)), floor):
            return None
        rest = tuple(track for k, track in enumerate(found.tracks) if k != number)
        wrong = fit(rest, found.mix_up, [*found.wrong]).wrong
        inside = _second_point(found.tracks[number], found.mix_up, wrong)
        if inside is None:
            return None
        return _Switch(number, inside, (*rest, *found.tracks[number].parted(inside)))

    def _mismatch(self, best: Fit, bare: Fit, switch: _Switch, source: str) -> Finding:
        whole = best.tracks[-1].time
        time = whole[switch.inside]
        back = f" to {time[-1]:.4g} s" if time[-1] < whole[-1] else " on"
        return Finding(
            "mismatch",
            f"recording {switch.number} ({source or 'without a source'}) shows another landmark from {time[0]:.4g} s{back}",
            f"{_evidence(bare, best)}, while one point each explains the others",
            float(time[0]),
        )

    def _outliers(self, best: Fit) -> list[Finding]:
        """Finding of single samples that are far off, if there are some."""
        if not self.explained(best):
            return []
        spread = max(best.rms, self.noise or 0.0, FINEST)
        wild = total = 0
        for track, point in zip(best.tracks, best.points, strict=True):
            there = np.isfinite(track.sampled).any(axis=1)
            left = track.sampled - seen(track, point, best.mix_up, best.wrong).outputs
            with np.errstate(invalid="ignore"):
                far = (np.abs(left) > max(OUTLYING * spread, 10 * FINEST)).any(axis=1)
            wild, total = wild + int((far & there).sum()), total + int(there.sum())
        share = wild / max(total, 1)
        if wild < 3 or share < 0.003:
            return []
        sentence = f"{100 * share:.2g} % of the samples are far off the others"
        evidence = f"{wild} of {total} differ by more than {OUTLYING:g} standard deviations from what the rest tells"
        return [Finding("outliers", sentence, evidence, share)]


def _joint(tracks: Sequence[Track], bare: Fit, keys: Sequence[str]) -> Fit:
    """Fit of all numbers, from the offset that explains the samples best by itself."""
    offsets = OFFSETS if "time offset" in keys else (0.0,)
    starts = [{"time offset": np.array([late])} for late in offsets]
    start = min(starts, key=lambda start: sum(_squares(track, bare.mix_up, start) for track in tracks))
    return min(fit(tracks, bare.mix_up, keys, start), bare, key=lambda each: each.squares)


def _squares(track: Track, mix_up: str, wrong: Mapping[str, Array]) -> float:
    """Sum of squares that the point of a linear guess leaves."""
    left = seen(track, guess(track, mix_up, wrong)[0], mix_up, wrong).outputs - track.outputs
    return float((left[track.used] ** 2).sum())


def _second_point(track: Track, mix_up: str, wrong: Mapping[str, Array]) -> Array | None:
    """Samples, shape (K,), in which a track shows another point, so that both together leave least."""
    count = len(track.time)

    def left(begin: int, end: int) -> float:
        inside = (np.arange(count) >= begin) & (np.arange(count) < end)
        total = 0.0
        for part in track.parted(inside):
            if part.count < FEWEST:
                return math.inf
            total += _squares(part, mix_up, wrong)
        return total

    places = np.unique(np.linspace(0, count, PLACES + 1).astype(int)).tolist()
    spans = [(a, b) for k, a in enumerate(places) for b in places[k + 1 :] if a > 0]
    best = min(spans, key=lambda span: left(*span))
    inside = (np.arange(count) >= best[0]) & (np.arange(count) < best[1])
    for _ in range(ROUNDS):  # each sample goes to the point that explains it better
        parts = track.parted(inside)
        if min(part.count for part in parts) < FEWEST:
            return None
        found = [fit([part], mix_up, [*wrong], wrong).points[0] for part in parts]
        left = [np.nansum((seen(track, point, mix_up, wrong).outputs - track.outputs) ** 2, axis=1) for point in found]
        inside = _largest_run(left[0] - left[1])
    return np.asarray(inside)


def _largest_run(gain: Array) -> Flags:
    """Run of samples with the largest sum, shape (K,)."""
    total = np.concatenate([[0.0], np.cumsum(gain)])
    lowest = np.minimum.accumulate(total)
    end = int(np.argmax(total - lowest))
    begin = int(np.argmin(total[: end + 1]))
    return np.asarray((np.arange(len(gain)) >= begin) & (np.arange(len(gain)) < end))


def _is_rigid(track: Track) -> bool:
    """True if the motion is that of a rigid body."""
    A = path_of(track, "nothing", numbers_of({})).A
    return bool(np.abs(A + np.swapaxes(A, 1, 2)).max() <= 1e-6 * max(float(np.abs(A).max()), 1e-9))


def _evidence(before: Fit, after: Fit) -> str:
    """By how much the residuals fall."""
    fell = f"{1000 * before.rms:.3g} to {1000 * after.rms:.3g} thousandths of the focal length"
    return f"undone, what is left of the samples falls from {fell}"
