"""Faults of a film of a board: those that its corners show, found by name, and those of light, times and path."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, combinations

import numpy as np

from percept_obs.compile import Array
from percept_obs.film.adjustment import (
    FOCUS,
    LENS,
    SHAPE,
    SHIFT,
    SHUTTER,
    SINGLY,
    Corners,
    Fit,
    State,
    adjusted,
    start,
)
from percept_obs.film.board import Board
from percept_obs.film.lens import FEWEST_CORNERS
from percept_obs.film.sharpness import LIMITS as EDGES
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.poses import Poses
from percept_obs.studies.diagnosis import Finding
from percept_obs.studies.diagnosis.causes import Cause


@dataclass(frozen=True)
class Limits:
    """From where on a fault of a film is named."""

    clearly: float = 5.0  # logarithm by which corners are likelier with a fault: 150 times, for many sets are compared
    surely: float = 4.0  # standard deviations of what else is named: chance reaches them once in 16,000 films
    fewest: int = 30  # pictures with a pose: a second, in which a hand moves once
    searches: int = 4  # for faults that hide each other, each search with those corrected that the last one found
    passes: int = 8  # linearisations of a fit at most
    unexplained: float = 0.15  # pixels that noise does not explain: as many as noise usually has
    scatter: float = 1.0  # pixels of noise, five times the usual
    unknown: float = 0.02  # relative deviation of the focal length, which every distance then has as well
    wrong: float = 0.1  # relative difference from the camera's focal length: autofocus makes a few per cent
    small: float = 0.15  # share of the picture's longer side under which a board shows poses badly
    around: float = 3.0  # degrees that the camera must go around the board to show distances,
    towards: float = 0.05  # or the share of the distance that it must go towards it
    uneven: float = 0.2  # range of nine in ten times from picture to picture, over their median
    blurred: float = 2.5  # pixels, in one picture of ten, that the edges of a sharp picture do not reach
    long: float = 1280  # pixels of the longer side beyond which edges may be wider in proportion


LIMITS = Limits()


@dataclass(frozen=True, eq=False)
class Faults:
    """Findings, and what is corrected by them.

    A pixel (u, v) of a picture of w x h is exposed at t + (u/w - 1/2) readout[0] + (v/h - 1/2) readout[1], in seconds,
    with standard deviations, infinite where pictures that are shifted do not tell it.  `corners` are those at the time
    t itself, `noise` is their deviation in pixels, and `camera` the lens that explains them all but a few wild ones.
    """

    findings: tuple[Finding, ...]
    readout: Array
    deviation: Array
    corners: Array
    noise: float
    camera: PixelCamera


@dataclass(frozen=True)
class Fault(Cause):
    """Fault that is fitted by some columns."""

    columns: tuple[int, ...]

    @property
    def own(self) -> list[int]:
        """Columns that have numbers of the whole film."""
        return [column for column in self.columns if column != SINGLY]


READ = "of a picture are read one after another, from the {end} on, within {millis:.3g} ms"
SHIFTED = "the pictures are shifted against the lens, by about {size:.2g} pixels, as by a stabilisation"

PARTS = (
    Fault("rolling shutter", f"the columns {READ}", 2e-3, SHUTTER[:1], ends=("left", "right")),
    Fault("rolling shutter", f"the rows {READ}", 2e-3, SHUTTER[1:], ends=("top", "bottom")),
    Fault("board", "the board is bent or stretched, by about {millis:.2g} mm", 1e-3, SHAPE),
    Fault("focus", "the focal length changes, by about {percents:.2g} %", 5e-3, FOCUS),
    Fault("stabilisation", SHIFTED, 3.0, SHIFT),
    Fault("stabilisation", SHIFTED, 3.0, (*SHIFT, SINGLY)),
)

CHOICES = (*chain.from_iterable(combinations(PARTS[:4], count) for count in range(5)), *((part,) for part in PARTS[4:]))
"""Sets of faults that are compared; pictures that are shifted, slowly or each by itself too, do not tell the others."""


def find_faults(
    time: Array,
    corners: Array,
    board: Board,
    size: tuple[int, int],
    camera: PixelCamera,
    poses: Poses,
    width: Array | None = None,
) -> Faults:
    """Return what spoils a film, by name, from the corners of a board and the width of its edges in the pictures.

    Corners have the shape (K, n, 2), NaN where unseen; poses, at some of the times, are X_board = R X_camera + p.
    They, the lens and the faults are fitted to the corners together.  A fault is named if it is worth it, and if the
    corners are clearly likelier with it; noise that is correlated in time is allowed for.
    """
    rows = np.searchsorted(time, poses.time)
    good = np.isfinite(corners[rows]).all(axis=-1).sum(axis=1) >= FEWEST_CORNERS
    if good.sum() < LIMITS.fewest:
        raise ValueError(
            f"{good.sum()} pictures with a pose show {FEWEST_CORNERS} corners of the board, and {LIMITS.fewest} are "
            "needed to find faults: film for longer, with the board in the picture"
        )
    rows, poses = rows[good], Poses(poses.time[good], poses.position[good], poses.orientation[good])
    given, state = start(corners[rows], board.points, np.array(size, dtype=float), camera, poses)
    parts: tuple[Fault, ...] = ()
    left = []
    for search in range(LIMITS.searches):  # at first at the given lens, for a wrong one may stand for a fault
        state, fit = adjusted(given, state, _columns(parts), passes=LIMITS.passes if search else 1)
        left.append(fit.left)
        before, parts = parts, max(CHOICES, key=lambda each: _worth(fit, each))
        if search and parts == before:
            break
    sizes = {part: _size(given, state, fit, part, before) for part in PARTS}
    evidence = f"with all of these, {left[-1]:.2g} pixels are left of the corners and not {left[0]:.2g}"
    findings = [
        Finding(part.key, part.sentence(np.array([size])), evidence, size, deviation)
        for part, (size, deviation) in sizes.items()
        if part in before and abs(size) >= part.smallest
    ]
    findings += [*_of_fit(state, fit, before), *_of_times(time), *_of_path(given, state)]
    findings += [] if width is None else _of_blur(board, given, fit, width[rows])
    straight, readout = corners.copy(), np.array([sizes[part] for part in PARTS[:2]])
    readout[:, 1] += math.inf if SHIFT[0] in _columns(before) else 0.0
    straight[rows] -= fit.moved
    lens = given.lens_of(state).tolist()
    fitted = PixelCamera(lens[:2], lens[2:4], size, lens[4:])
    return Faults(tuple(findings), readout[:, 0], readout[:, 1], straight, fit.noise, fitted)


def _columns(parts: tuple[Fault, ...]) -> list[int]:
    """Columns of the lens and of faults."""
    return [*LENS, *chain.from_iterable(part.columns for part in parts)]


def _worth(fit: Fit, parts: tuple[Fault, ...]) -> float:
    """Logarithm of the corners' likelihood, less what each fault must add to it."""
    columns = _columns(parts)
    return fit.normal(columns).likelihood(columns) - LIMITS.clearly * len(parts)


def _size(given: Corners, state: State, fit: Fit, part: Fault, parts: tuple[Fault, ...]) -> tuple[float, float]:
    """Root mean square of a fault over time, with the sign that it has at first, and its standard deviation."""
    columns = _columns((*parts, part))
    normal, values = fit.normal(columns), state.own[:, part.own]
    chosen, _, covariance = normal.solved(columns)
    variance = 0.0
    for column in part.own:
        own, base = normal.owner[chosen] == column, given.bases[column]
        variance += float(((base @ covariance[np.ix_(own, own)]) * base).sum(axis=1).mean())
    size = math.sqrt((values**2).sum(axis=1).mean())
    return math.copysign(size, values[0, 0]), math.sqrt(variance * (1 + max(fit.ratio, 0.0)))


def _of_fit(state: State, fit: Fit, parts: tuple[Fault, ...]) -> Iterator[Finding]:
    """Findings of what the fit leaves, and of the focal length."""
    if fit.excess > LIMITS.unexplained and fit.sure > LIMITS.surely:
        said = f"something is not known: {fit.excess:.2g} pixels of the corners are neither explained nor noise"
        yield Finding("unknown", said, f"the noise is {fit.noise:.2g} pixels", fit.excess, fit.excess / fit.sure)
    if fit.noise > LIMITS.scatter:
        yield Finding("noise", f"the corners scatter by {fit.noise:.2g} pixels", "in single pictures", fit.noise)
    columns = _columns(parts)
    more, deviation = float(state.own[0, 0]), math.sqrt(fit.normal(columns).solved(columns)[2][0, 0])
    if abs(more) > max(LIMITS.wrong, LIMITS.surely * deviation):
        said = f"the focal length is {1 + more:.3f} times the camera's"
        yield Finding("lens", said, "all pictures together say so", 1 + more, deviation)
    if deviation > LIMITS.unknown:
        said = f"the focal length, and so every distance, is known to {100 * deviation:.2g} % only"
        yield Finding("focal length", said, "the board was not seen from the side enough", 1 + more, deviation)


def _of_times(time: Array) -> Iterator[Finding]:
    """Finding of pictures that are not evenly spaced, whose times are used as they are."""
    steps = np.diff(time)
    low, middle, high = 1e3 * np.quantile(steps, [0.05, 0.5, 0.95])
    again = int((steps <= 0).sum())
    if again or high - low > LIMITS.uneven * middle:
        evidence = f"they are {low:.3g} to {high:.3g} ms apart, and {again} are no later than the one before"
        yield Finding("frame rate", "the frame rate varies", evidence, float((high - low) / middle))


def _of_path(given: Corners, state: State) -> Iterator[Finding]:
    """Findings of a small board and of a path that shows no distances."""
    seen = np.where(given.seen[..., None], given.pixels, np.nan)
    share = float(np.median((np.nanmax(seen, axis=1) - np.nanmin(seen, axis=1)).max(axis=1)) / given.size.max())
    if share < LIMITS.small:
        evidence = f"its corners fill {100 * share:.2g} % of the longer side; come nearer, or print a larger one"
        yield Finding("small board", "the board is small in the picture", evidence, share)
    away = -np.einsum("kji,kj->ki", state.R, state.p) - given.places.mean(axis=0)
    far = np.linalg.norm(away, axis=1)
    rays = away / far[:, None]
    middle = rays.mean(axis=0) / np.linalg.norm(rays.mean(axis=0))
    around = 2 * math.degrees(np.quantile(np.arccos(np.minimum(rays @ middle, 1)), 0.95))
    towards = float(np.ptp(np.quantile(far, [0.05, 0.95])) / np.median(far))
    if around < LIMITS.around:
        key = "no parallax" if towards < LIMITS.towards else "along the axis"
        said = "the camera hardly moves" if towards < LIMITS.towards else "the camera moves along its optical axis only"
        evidence = f"it goes {around:.2g} degrees around the board and {100 * towards:.2g} % of the distance towards it"
        yield Finding(key, f"{said}, which shows distances badly", evidence, around)


def _of_blur(board: Board, given: Corners, fit: Fit, width: Array) -> Iterator[Finding]:
    """Finding of wide edges, with the time of exposure that their speed tells."""
    from scipy.optimize import curve_fit
    from scipy.special import erf

    wide = float(np.nanquantile(width, 0.9)) if np.isfinite(width).any() else math.nan
    if not wide > LIMITS.blurred * max(1.0, given.size.max() / LIMITS.long):
        return
    begin, end = board.neighbours.T
    along = given.pixels[:, end] - given.pixels[:, begin]
    across = np.stack([-along[..., 1], along[..., 0]], axis=-1) / (np.linalg.norm(along, axis=-1, keepdims=True) + 1e-9)
    speed = np.abs(((fit.speed[:, begin] + fit.speed[:, end]) / 2 * across).sum(axis=-1))
    speed = np.quantile(speed, EDGES.share, axis=1)
    good = np.isfinite(width)

    def widened(speed: Array, soft: float, exposure: float) -> Array:
        path = exposure * speed + 1e-9  # a step that is smooth, and then evenly moved along this path
        return np.asarray(path / erf(path / (math.sqrt(8) * soft)))

    (_, exposure), spread = curve_fit(widened, speed[good], width[good], (0.7, 0.005), bounds=(1e-4, [50, 0.1]))
    evidence = f"in one picture of ten they are over {wide:.2g} pixels wide"
    if exposure > LIMITS.surely * math.sqrt(spread[1, 1]):
        evidence += f", as by an exposure of {1e3 * exposure:.2g} ms; more light helps"
    yield Finding("blur", "the edges are blurred", evidence, wide)
