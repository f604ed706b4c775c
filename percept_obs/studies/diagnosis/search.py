"""Search for the mistakes that explain some tracks: all numbers at once, then as few of them as explain as much."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from percept_obs.compile import Array, Flags
from percept_obs.studies.diagnosis.causes import (
    BEND,
    BIAS,
    CAUSES,
    DRIFT,
    FOCAL,
    LARGEST_OFFSET,
    MIX_UPS,
    OFFSET,
    SHUTTER,
)
from percept_obs.studies.diagnosis.fitting import FINEST, Estimate, Fit, fit
from percept_obs.studies.diagnosis.tracks import Track, guess, numbers_of, path_of, seen
from percept_obs.tracking.information import looks_like_noise


@dataclass(frozen=True)
class Limits:
    """From where on a mistake is named, and something is left to explain."""

    surely: float = 5.0  # standard deviations of a number from 0: six are tried, and nobody is to be accused wrongly
    clearly: float = 10.0  # logarithm by which samples are likelier with what is named: e^10 times, for the same reason
    worse: float = 2.0  # where nothing explains everything, times that must be left without a mix-up to name it
    most_left: float = 0.1  # share of the samples' spread that it may leave then; a fit that leaves more has failed
    alike: float = 1.01  # ratio of what two explanations leave: chance makes more than 1 % of a few hundred samples
    tried: int = (
        2  # mix-ups with which wrong numbers are fitted, those that explain most without, for most time goes there
    )
    guessed: int = 2  # mix-ups of a kind that are fitted, those with which linear guesses leave least
    apart: float = 3.0  # times what is left of the other tracks, which shows that a track may be of two points
    places: int = 12  # at which the second point may begin or end at first: a part of the track between two shows it
    rounds: int = 3  # times that each sample is then given to the point that explains it better
    fewest: int = 20  # values from which a point is estimated: ten samples of both image coordinates
    outlying: float = 6.0  # standard deviations of a wild sample; normal noise reaches them once in 500 million samples
    around: float = 0.25  # seconds beside a wild sample in which the other tracks have more left than
    restless: float = 1.5  # so many times the usual, if the motion is wrong there and not the sample
    few: int = 3  # wild samples that are worth naming,
    few_of_all: float = 0.003  # and their share of all samples
    most_wild: float = 0.15  # share of wild samples beyond which they are no exceptions, and none is left out


LIMITS = Limits()

DEVIATION = 1.4826
"""Standard deviation of normal noise, in medians of its size."""

OFFSETS = tuple(np.linspace(-LARGEST_OFFSET, LARGEST_OFFSET, 11).tolist())
"""Offsets in seconds of which the best one begins a fit: from 0.05 s away it finds the right one."""


@dataclass(frozen=True, eq=False)
class Switch:
    """Track that shows another point in some samples, shape (K,), and all tracks with that one parted, at the end."""

    number: int
    inside: Flags
    tracks: tuple[Track, ...]


@dataclass(frozen=True, eq=False)
class Found:
    """Fit of the tracks as they are, the best one, and the mistakes in it.

    Each mistake that is `needed` comes with the best fit without it, and with the keys of those that explain as much
    in its place.  Outliers are some of all samples.
    """

    bare: Fit
    best: Fit
    explained: bool
    switch: Switch | None
    needed: Mapping[str, tuple[Fit, tuple[str, ...]]]
    estimates: Mapping[str, Estimate]
    not_told: tuple[str, ...]
    outliers: tuple[int, int]


def search(tracks: tuple[Track, ...], noise: float | None) -> Found:
    """Return the mistakes that explain tracks best, with noise of a known deviation or not."""
    keys, bare = _possible(tracks), _trimmed(fit(tracks, "nothing", ()), noise)
    tracks = tuple(bare.tracks)
    screened = [bare, *_screened(bare, noise)]
    names = [*dict.fromkeys(each.mix_up for each in screened)]
    switch = _switched(bare, noise)
    if switch is not None and _explained(parted := fit(switch.tracks, "nothing", ()), noise):
        best = _best([parted], keys, noise)
    else:
        best = _best(screened, keys, noise)
        switch = _switched(best, noise)
        if switch is not None:
            fits = [fit(switch.tracks, *_own(mix_up)) for mix_up in names]
            parted = _best(fits, keys, noise)
            if _explained(best, noise) or parted.gain(best) < LIMITS.clearly:
                switch = None
            else:
                best = parted
    best = _trimmed(_fewest(best), noise)
    keys = [key for key in _together(best.mix_up, keys) if key not in MIX_UPS[best.mix_up].own]
    explained, needed = _explained(best, noise), _needed(best, keys, names)
    estimates = {key: Estimate(np.zeros(each.size), math.inf, 0.0) for key, each in CAUSES.items()}
    estimates |= best.estimates(keys)
    if switch is not None:
        needed = {"mismatch": (bare, ())} | needed
    plain = [each for each in screened[1:] if MIX_UPS[each.mix_up].plain and not each.wrong]
    alike = [each for each in plain if each.rms < LIMITS.alike * bare.rms + FINEST / 10]
    told = [key for key in keys if LIMITS.surely * estimates[key].deviation < CAUSES[key].usual]
    hidden = [key for key in CAUSES if key not in told]
    if explained and best.mix_up == "nothing":
        hidden += [MIX_UPS[each.mix_up].key for each in alike]
    not_told = tuple(key for key in dict.fromkeys(hidden) if key not in needed)
    outliers = _outliers(best, noise) if explained else (0, 0)
    return Found(bare, best, explained, switch, needed, estimates, not_told, outliers)


def _needed(best: Fit, keys: Sequence[str], names: Sequence[str]) -> dict[str, tuple[Fit, tuple[str, ...]]]:
    """Mistakes of the best fit, as `Found` has them: the mix-up, then the numbers, those that explain most first."""
    found: dict[str, tuple[Fit, tuple[str, ...]]] = {}
    if best.mix_up != "nothing":
        found[MIX_UPS[best.mix_up].key] = (
            _without(best, best.wrong, "nothing"),
            (*_other_mix_ups(best, names), *_other_lens(best)),
        )
    alone = {key: _without(best, _rest(best, key)) for key in _reported(best)}
    others = [key for key in keys if key not in best.wrong]
    for key, without in sorted(alone.items(), key=lambda each: -each[1].squares):
        as_good = [other for other in others if best.gain(_without(best, [*_rest(best, key), other])) < LIMITS.clearly]
        found[key] = without, (*as_good, *(_other_lens(best) if key == BEND else ()))
    return found


def _possible(tracks: Sequence[Track]) -> list[str]:
    """Keys of the numbers that can be fitted: drifts need a rigid motion, lens and shutter both image coordinates."""
    motions = [path_of(track, "nothing", numbers_of({})).A for track in tracks]
    rigid = all(np.abs(A + np.swapaxes(A, 1, 2)).max() <= 1e-6 * max(float(np.abs(A).max()), 1e-9) for A in motions)
    both = all(len(track.whole) for track in tracks)
    varying = not all(track.motion.signal and track.motion.signal.constant for track in tracks)
    possible = {OFFSET: varying, BIAS: rigid, DRIFT: rigid, BEND: both, SHUTTER: both and varying}
    return [key for key in CAUSES if possible.get(key, True)]


def _own(mix_up: str) -> tuple[str, list[str], dict[str, Array]]:
    """A mix-up with its own numbers, and where their fit starts."""
    own = MIX_UPS[mix_up].own
    return mix_up, [*own], {key: np.array(start) for key, start in own.items()}


def _together(mix_up: str, keys: Sequence[str]) -> list[str]:
    """Keys of the numbers that can be fitted with a mix-up; poses drift by no bias, and a fisheye is a lens already."""
    left_out = (BIAS, DRIFT) if MIX_UPS[mix_up].poses else (BEND,) if MIX_UPS[mix_up].fisheye else ()
    kept = [key for key in keys if key not in left_out]
    return [*dict.fromkeys([*MIX_UPS[mix_up].own, *kept])]


def _reported(best: Fit) -> list[str]:
    """Keys of a fit's numbers that are mistakes by themselves."""
    return [key for key in best.wrong if key not in MIX_UPS[best.mix_up].own]


def _screened(bare: Fit, noise: float | None) -> list[Fit]:
    """Fits with mix-ups that can be: all plain ones, and if the tracks are not explained those that a guess prefers.

    Mix-ups with numbers of their own, and half and twice the focal length, are asked after those without.
    """
    tracks = bare.tracks

    def best(names: Sequence[str]) -> list[str]:
        left = {name: sum(_squares(track, name, _own(name)[2]) for track in tracks) for name in names}
        return sorted(left, key=left.__getitem__)[: LIMITS.guessed]

    both = all(track.outputs.shape[1] == 2 and len(track.whole) for track in tracks)
    can_be = {
        name: each
        for name, each in MIX_UPS.items()
        if name != "nothing" and (both or each.plain) and all(each.can_be(track.motion.errors) for track in tracks)
    }
    plain = [name for name, each in can_be.items() if each.plain]
    if _explained(bare, noise):
        return [fit(tracks, name, ()) for name in plain]
    others = best([name for name, each in can_be.items() if not each.plain and not each.own])
    found = [fit(tracks, name, ()) for name in (*plain, *others)]
    if any(_explained(each, noise) for each in found):
        return found
    own = dict.fromkeys(each.key for each in can_be.values() if each.own)
    groups = [best([name for name, each in can_be.items() if each.own and each.key == key]) for key in own]
    found += [fit(tracks, *_own(name)) for names in groups for name in names]
    return found + [fit(tracks, "nothing", [FOCAL], {FOCAL: np.array([size])}) for size in (-math.log(2), math.log(2))]


def _explained(found: Fit, noise: float | None) -> bool:
    """True if what a fit leaves looks like noise."""
    return looks_like_noise(found.rms, found.correlation, noise)


def _trimmed(found: Fit, noise: float | None) -> Fit:
    """Fit without the few samples that are far off, if it explains the rest and the fit of all does not."""
    if _explained(found, noise):
        return found
    far = LIMITS.outlying * max(DEVIATION * float(np.median(np.abs(found.values))), noise or 0.0, FINEST)
    pairs = zip(found.tracks, found.residuals, strict=True)
    near = [(track, (np.nan_to_num(np.abs(left)) <= far).all(axis=1, keepdims=True)) for track, left in pairs]
    tracks = tuple(replace(track, used=track.used & few) for track, few in near)
    if sum(track.count for track in tracks) < (1 - LIMITS.most_wild) * len(found.values):
        return found
    other = fit(tracks, found.mix_up, [*found.wrong], found.wrong)
    return other if _explained(other, noise) else found


def _best(screened: Sequence[Fit], keys: Sequence[str], noise: float | None) -> Fit:
    """Fit of all numbers, with the mix-up that explains the samples; the first fit has none."""
    first, *others = screened
    less = [each for each in others if each.typical < first.typical]
    told = [] if _explained(first, noise) else [each for each in less if _explained(each, noise)]
    other = _fewest(_joint(_likeliest(told), keys)) if told else None
    if other and not (other.wrong or MIX_UPS[other.mix_up].fisheye or any(each.wrong for each in told)):
        return other  # a mix-up without any number explains all; a narrow fisheye bends images as other lenses do
    best = _joint(first, keys)
    explained = _explained(best, noise)
    if other and (other.gain(_fewest(best)) > LIMITS.clearly or not (other.wrong or explained)):
        return other
    if other or explained:
        return best
    better = sorted(less, key=lambda each: each.typical)
    for other in (_joint(each, keys) for each in better[: LIMITS.tried]):
        most = LIMITS.most_left * float(np.median([track.spread for track in other.tracks]))
        plain = MIX_UPS[other.mix_up].plain
        if _explained(other, noise) or (plain and other.typical < min(best.typical / LIMITS.worse, most)):
            best = min(best, other, key=lambda each: (not _explained(each, noise), each.typical))
    return best


def _likeliest(told: Sequence[Fit]) -> Fit:
    """Fit with the fewest numbers, unless another is clearly likelier: poses' noise is fitted by more of them."""
    simplest = min(told, key=lambda each: (each.unknowns, each.typical))
    best = max(told, key=lambda each: each.gain(simplest))
    return best if best.gain(simplest) > LIMITS.clearly else simplest


def _joint(bare: Fit, keys: Sequence[str]) -> Fit:
    """Fit of all numbers, from the offset that explains the samples best by itself."""
    tracks, mix_up = bare.tracks, bare.mix_up
    starts = [{OFFSET: np.array([late])} for late in (OFFSETS if OFFSET in keys else (0.0,))]
    start = min(starts, key=lambda start: sum(_squares(track, mix_up, {**bare.wrong, **start}) for track in tracks))
    joint = fit(tracks, mix_up, _together(mix_up, keys), {**start, **bare.wrong})
    return min(joint, bare, key=lambda each: each.squares)


def _squares(track: Track, mix_up: str, wrong: Mapping[str, Array]) -> float:
    """Sum of squares that the point of a linear guess leaves."""
    left = seen(track, guess(track, mix_up, wrong)[0], mix_up, wrong).outputs - track.outputs
    return float((left[track.used] ** 2).sum())


def _rest(best: Fit, key: str) -> list[str]:
    """Keys of a fit's other numbers."""
    return [other for other in best.wrong if other != key]


def _without(best: Fit, keys: Iterable[str], mix_up: str | None = None) -> Fit:
    """Fit of some numbers only, or with another mix-up and its own ones, from the best one."""
    if mix_up is None:
        return fit(best.tracks, best.mix_up, [*keys], best.wrong)
    _, _, start = _own(mix_up)
    kept = [key for key in keys if key not in MIX_UPS[best.mix_up].own]
    return fit(best.tracks, mix_up, _together(mix_up, kept), {**best.wrong, **start})


def _fewest(best: Fit) -> Fit:
    """Fit with the fewest numbers that explains the samples as well: the least sure one is left out in turn."""
    while kept := _reported(best):
        weights = {key: _weight(key, estimate) for key, estimate in best.estimates(kept).items()}
        key = min(weights, key=weights.__getitem__)
        without = _without(best, _rest(best, key))
        if weights[key] >= 1 and best.gain(without) > LIMITS.clearly:
            break
        best = without
    return best


def _weight(key: str, estimate: Estimate) -> float:
    """Number below 1 if an estimate is not worth naming: not sure, small, or at the edge of its range."""
    cause, size = CAUSES[key], float(np.linalg.norm(estimate.value))
    inside = float(np.abs(estimate.value).max()) < 0.98 * cause.largest
    return min(estimate.sure / LIMITS.surely, size / cause.smallest) * inside


def _other_mix_ups(best: Fit, names: Sequence[str]) -> tuple[str, ...]:
    """Mix-ups that explain the samples as well, by key, and with their sentence if the key is the best one's."""
    own = MIX_UPS[best.mix_up].key
    others = [name for name in names if name not in ("nothing", best.mix_up)]
    as_good = [MIX_UPS[name] for name in others if best.gain(_without(best, best.wrong, name)) < LIMITS.clearly]
    return tuple(dict.fromkeys(each.sentence if each.key == own else each.key for each in as_good))


def _other_lens(best: Fit) -> tuple[str, ...]:
    """Key of the other kind of lens, a fisheye for one that bends images or the reverse, if it explains as well."""
    bends = BEND in best.wrong
    if best.mix_up != ("nothing" if bends else "fisheye"):
        return ()
    mix_up, keys = ("fisheye", _rest(best, BEND)) if bends else ("nothing", [*best.wrong, BEND])
    other = fit(best.tracks, mix_up, keys, best.wrong)
    return (MIX_UPS["fisheye"].key if bends else BEND,) if best.gain(other) < LIMITS.clearly else ()


def _switched(found: Fit, noise: float | None) -> Switch | None:
    """Track that may show two points, if what is left of one is far more than of the others."""
    if len(found.tracks) < 2:
        return None
    number = int(np.argmax(found.each))
    others = float(np.median(np.delete(found.each, number)))
    if found.each[number] < LIMITS.apart * max(others, noise or 0.0, FINEST):
        return None
    rest = tuple(track for k, track in enumerate(found.tracks) if k != number)
    inside = _second_point(found.tracks[number], found.mix_up, fit(rest, found.mix_up, [*found.wrong]).wrong)
    return None if inside is None else Switch(number, inside, (*rest, *found.tracks[number].parted(inside)))


def _second_point(track: Track, mix_up: str, wrong: Mapping[str, Array]) -> Flags | None:
    """Samples, shape (K,), in which a track shows another point, so that both together leave least."""
    number = np.arange(len(track.time))

    def left(inside: Flags) -> float:
        parts = track.parted(inside)
        return sum(_squares(part, mix_up, wrong) if part.count >= LIMITS.fewest else math.inf for part in parts)

    places = np.unique(np.linspace(0, len(number), LIMITS.places + 1).astype(int)).tolist()
    spans = [(number >= a) & (number < b) for k, a in enumerate(places) for b in places[k + 1 :] if a > 0]
    inside = min(spans, key=left, default=number < 0)
    for _ in range(LIMITS.rounds):  # each sample goes to the point that explains it better, in one run
        parts = track.parted(inside)
        if min(part.count for part in parts) < LIMITS.fewest:
            return None
        images = [seen(track, guess(part, mix_up, wrong)[0], mix_up, wrong).outputs for part in parts]
        outside, within = (np.nansum((image - track.outputs) ** 2, axis=1) for image in images)
        inside = _largest_run(outside - within)
    return inside


def _largest_run(gain: Array) -> Flags:
    """Run of samples with the largest sum, shape (K,)."""
    total = np.concatenate([[0.0], np.cumsum(gain)])
    end = int(np.argmax(total - np.minimum.accumulate(total)))
    begin = int(np.argmin(total[: end + 1]))
    number = np.arange(len(gain))
    return np.asarray((number >= begin) & (number < end), dtype=bool)


def _outliers(best: Fit, noise: float | None) -> tuple[int, int]:
    """Number of samples that are far off while the other tracks are not, 0 if they are few, and of all samples."""
    usual, pairs = max(best.rms, noise or 0.0), zip(best.tracks, best.points, strict=True)
    far = max(LIMITS.outlying * usual, 10 * FINEST)
    left = [np.abs(track.sampled - seen(track, point, best.mix_up, best.wrong).outputs) for track, point in pairs]
    wild = 0
    for number, (track, apart) in enumerate(zip(best.tracks, left, strict=True)):
        others = [pair for k, pair in enumerate(zip(best.tracks, left, strict=True)) if k != number]
        for time in track.time[(np.nan_to_num(apart) > far).any(axis=1)]:
            beside = [each[np.abs(other.time - time) <= LIMITS.around] for other, each in others]
            most = (LIMITS.restless * usual) ** 2 * sum(np.isfinite(each).sum() for each in beside)
            wild += int(sum(np.nansum(each**2) for each in beside) <= most)
    total = sum(int(np.isfinite(track.sampled).any(axis=1).sum()) for track in best.tracks)
    return (wild if wild >= max(LIMITS.few, LIMITS.few_of_all * total) else 0), total
