"""Faults of a film of a board: those that its corners show, found by name, and those of light, times and path."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain, combinations
from typing import Any

import numpy as np

from percept_obs.compile import Array, Indices
from percept_obs.film.adjustment import (
    FOCUS,
    LENS,
    PASSES,
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
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.poses import Poses
from percept_obs.studies.diagnosis import Finding
from percept_obs.validation import checked, needed, numbers

SURELY = 4.0
"""Standard deviations from which on a fault is named; a model of it must be as much likelier."""

FEWEST, FEWEST_CORNERS = 30, 8
"""Frames with a pose that are needed, and corners in each of them."""

ROUNDS = 4
"""Searches at most for the faults that explain the corners best, each where the last one's are corrected."""

UNEXPLAINED, SCATTER = 0.15, 1.0
"""Pixels that noise does not explain, and pixels of noise, that are worth naming."""

UNKNOWN, WRONG = 0.02, 0.1
"""Relative deviation, and error, of the focal length that are worth naming."""

SMALL = 0.15
"""Share of the picture's longer side under which a board is small."""

LEVEL, NEARER = 3.0, 0.05
"""Degrees that a camera must go around the board, and share of its distance that it may go towards it instead."""

UNEVEN = 0.2
"""Range of the times from frame to frame, over their median, that is worth naming."""

BLURRED = 2.5
"""Width in pixels of one edge in ten that is worth naming."""

FAINT = 20.0
"""Contrast of an edge in grey values up to which its width is not told."""

REACH = 0.9
"""Share of the white between square and marker in which the grey across an edge is looked at."""


@checked
@dataclass(frozen=True, eq=False)
class Sightings:
    """Corners of a board in the frames of a film.

    Parameters
    ----------
    time : array of shape (K,)
        Seconds.
    pixels : array of shape (K, n, 2)
        NaN where a corner was not seen.
    places : array of shape (n, 3)
        The corners on the board in metres.
    size : pair of ints
        Width and height of the pictures in pixels.

    Raises
    ------
    ValueError
        If shapes do not fit.

    See Also
    --------
    find_faults : Takes them.

    Examples
    --------
    >>> board = Board()
    >>> Sightings(np.arange(2.0), np.zeros((2, 24, 2)), board.points, (640, 480)).pixels.shape
    (2, 24, 2)
    """

    time: Array
    pixels: Array
    places: Array
    size: tuple[int, int]

    def __post_init__(self) -> None:
        time, places = numbers(self.time, "the times", "K"), numbers(self.places, "the places", "n", 3)
        pixels = numbers(self.pixels, "the pixels", "K", "n", 2)
        if pixels.shape != (len(time), len(places), 2):
            raise ValueError(
                f"the pixels have the shape {pixels.shape}; expected {(len(time), len(places), 2)}, for there are "
                f"{len(time)} times and {len(places)} places"
            )


@dataclass(frozen=True, eq=False)
class Faults:
    """Faults of a film, and what is corrected by them.

    Parameters
    ----------
    findings : tuple of Finding
        The keys are "rolling shutter", "board", "focus", "stabilisation", "unknown", "noise", "lens", "focal length",
        "small board", "no parallax", "along the axis", "frame rate" and "blur".
    readout, deviation : arrays of shape (2,)
        Seconds from the first column of a picture to the last one, and from the first row to the last one; a pixel
        (u, v) of a picture of w x h is exposed at t + (u/w - 1/2) readout[0] + (v/h - 1/2) readout[1].  0 where there
        is no such delay; with standard deviations.
    pixels : array of shape (K, n, 2)
        The corners as they would be seen at the times of the frames, without a rolling shutter.
    camera : PixelCamera
        The lens, from all frames and without the faults.
    noise : float
        Standard deviation of the corners in pixels.

    See Also
    --------
    find_faults : Makes it.

    Examples
    --------
    See `find_faults`.
    """

    findings: tuple[Finding, ...]
    readout: Array
    deviation: Array
    pixels: Array
    camera: PixelCamera
    noise: float


@dataclass(frozen=True)
class Part:
    """Fault that is fitted: its columns, and the size from which on it is worth naming."""

    key: str
    columns: tuple[int, ...]
    smallest: float
    sentence: Callable[[float], str]


def _read(lines: str, first: str, last: str) -> Callable[[float], str]:
    """Sentence for a shutter that reads some lines one after another."""
    return lambda late: (
        f"{lines} of a picture are read one after another, within {1e3 * abs(late):.3g} ms, from the "
        f"{first if late > 0 else last} on"
    )


PARTS = (
    Part("rolling shutter", SHUTTER[:1], 2e-3, _read("columns", "left", "right")),
    Part("rolling shutter", SHUTTER[1:], 2e-3, _read("rows", "top", "bottom")),
    Part("board", SHAPE, 1e-3, lambda size: f"the board is bent or stretched, by about {1e3 * abs(size):.2g} mm"),
    Part("focus", FOCUS, 5e-3, lambda size: f"the focal length changes by about {100 * abs(size):.2g} % of its mean"),
    Part(
        "stabilisation",
        (*SHIFT, SINGLY),
        3,
        lambda size: f"pictures are shifted on the lens by about {abs(size):.2g} pixels",
    ),
    Part("stabilisation", SHIFT, 3, lambda size: f"pictures are shifted on the lens by about {abs(size):.2g} pixels"),
)

CHOICES = tuple(chain.from_iterable(combinations(PARTS, count) for count in range(len(PARTS) + 1)))
"""Sets of faults that are compared."""


@checked
def find_faults(sightings: Sightings, camera: PixelCamera, poses: Poses, blur: Array | None = None) -> Faults:
    """Find by name, and measure, what spoils a film of a board.

    Poses, lens and faults are fitted to the corners together.  A fault is named if the corners are surely likelier with
    it, whatever the others are, and if it is worth naming; noise that is correlated in time is allowed for.

    Parameters
    ----------
    sightings : Sightings
    camera : PixelCamera
        As it was calibrated.
    poses : Poses
        Of the camera on the board, X_board = R X_camera + p, at some of the sightings' times.
    blur : array of shape (K, m), optional
        Widths of edges in the frames, by `edge_widths`.

    Returns
    -------
    Faults

    Raises
    ------
    ValueError
        If there are too few frames or corners, or a pose is at no frame's time.

    See Also
    --------
    diagnose : Finds mistakes in recordings.

    Examples
    --------
    A camera goes around the board, and after a second its focal length is 3 % longer:

    >>> from scipy.spatial.transform import Rotation
    >>> board, time, draw = Board(), np.arange(60) / 30, np.random.default_rng(1)
    >>> camera, middle = PixelCamera((1000, 1000), (640, 360), (1280, 720)), np.mean(board.points, axis=0)
    >>> turns = Rotation.from_rotvec(np.stack([0.4 * np.sin(3 * time), 0.4 * np.cos(3 * time), 0 * time], axis=1))
    >>> poses = Poses(time, middle - turns.apply([0, 0, 0.6]), turns.as_matrix())
    >>> local = (board.points - poses.position[:, None]) @ turns.as_matrix()
    >>> zoom = (1 + 0.03 * (time > 1))[:, None, None]
    >>> pixels = [640, 360] + 1000 * zoom * local[..., :2] / local[..., 2:] + draw.normal(0, 0.1, (60, 24, 2))
    >>> found = find_faults(Sightings(time, pixels, board.points, (1280, 720)), camera, poses)
    >>> [each.sentence for each in found.findings]
    ['the focal length changes by about 1 % of its mean']
    """
    rows, size = np.searchsorted(sightings.time, poses.time), np.array(sightings.size, dtype=float)
    if rows[-1] >= len(sightings.time) or (sightings.time[rows] != poses.time).any():
        raise ValueError("a pose is at a time that no frame has; give poses at times of the sightings")
    pixels = sightings.pixels[rows]
    enough = int((np.isfinite(pixels).all(axis=-1).sum(axis=1) >= FEWEST_CORNERS).sum())
    if enough < FEWEST:
        raise ValueError(
            f"{enough} frames with a pose show {FEWEST_CORNERS} corners; {FEWEST} are needed: film the board for longer, "
            "or print one with more squares"
        )
    corners, state = start(pixels, sightings.places, size, camera, poses)
    parts: tuple[Part, ...] = ()
    left = []
    for passes in (1, *[PASSES] * ROUNDS):  # at first at the given lens, for a wrong one may stand for a fault
        state, fit = adjusted(corners, state, _columns(parts), passes)
        left.append(fit.left)
        before, parts = parts, max(CHOICES, key=lambda each: _worth(fit, each))
        if parts == before and passes > 1:
            break
    fall = f"with all that is named, what is left of the corners falls from {left[0]:.2g} to {left[-1]:.2g} pixels"
    sizes = {part: _size(corners, state, fit, part, before) for part in PARTS}
    found = [
        Finding(part.key, part.sentence(size), fall, size, deviation)
        for part, (size, deviation) in sizes.items()
        if part in before and abs(size) >= part.smallest
    ]
    found += _of_fit(corners, state, fit, before)
    found += _of_path(sightings, corners, state)
    if blur is not None:
        found += _of_blur(corners, fit, numbers(blur, "the blur", "K", "m")[rows])
    straight = sightings.pixels.copy()
    straight[rows] -= fit.moved
    lens = corners.lens.copy()
    lens[:9] += state.own[0, LENS] * ([lens[0]] * 4 + [1] * 5)
    fitted = PixelCamera(lens[:2].tolist(), lens[2:4].tolist(), sightings.size, lens[4:].tolist())
    readout = [sizes[part] for part in PARTS[:2]]
    return Faults(
        tuple(found),
        np.array([size for size, _ in readout]),
        np.array([deviation for _, deviation in readout]),
        straight,
        fitted,
        fit.noise,
    )


def _columns(parts: tuple[Part, ...]) -> list[int]:
    """Columns of the lens and of faults."""
    return [*LENS, *chain.from_iterable(part.columns for part in parts)]


def _worth(fit: Fit, parts: tuple[Part, ...]) -> float:
    """Logarithm of the corners' likelihood, less what each fault must add to it."""
    columns = _columns(parts)
    return fit.normal(columns).likelihood(columns) - SURELY**2 / 2 * len(parts)


def _size(corners: Corners, state: State, fit: Fit, part: Part, parts: tuple[Part, ...]) -> tuple[float, float]:
    """Root mean square of a fault over time, with the sign that it has at first, and its standard deviation."""
    columns = _columns((*parts, part))
    normal, values = fit.normal(columns), state.own[:, part.columns[:4] if SINGLY not in part.columns else SHIFT]
    chosen, _, covariance = normal.solved(columns)
    own = [normal.owner[chosen] == column for column in part.columns if column != SINGLY]
    spread = [
        np.mean((corners.bases[c] @ covariance[np.ix_(o, o)]) * corners.bases[c]) * o.sum()
        for c, o in zip(part.columns, own)
    ]
    return math.copysign(math.sqrt((values**2).sum(axis=1).mean()), values[0, 0]), fit.wider * math.sqrt(sum(spread))


def _of_fit(corners: Corners, state: State, fit: Fit, parts: tuple[Part, ...]) -> Iterator[Finding]:
    """Findings of what the fit leaves, and of the focal length."""
    if fit.excess > UNEXPLAINED and fit.sure > SURELY:
        said = f"something is not known: {fit.excess:.2g} pixels of the corners are neither explained nor noise"
        yield Finding("unknown", said, f"their noise is {fit.noise:.2g} pixels", fit.excess, fit.excess / fit.sure)
    if fit.noise > SCATTER:
        yield Finding("noise", f"the corners scatter by {fit.noise:.2g} pixels", "within single frames", fit.noise)
    columns = _columns(parts)
    covariance = fit.normal(columns).solved(columns)[2]
    more, deviation = float(state.own[0, 0]), math.sqrt(covariance[0, 0])
    if abs(more) > max(WRONG, SURELY * deviation):
        said = f"the focal length is {1 + more:.3f} times the camera's"
        yield Finding("lens", said, "all frames together say so", 1 + more, deviation)
    if deviation > UNKNOWN:
        said = f"the focal length is hardly known, to {100 * deviation:.2g} %: tilt the camera against the board more"
        yield Finding("focal length", said, "distances are as uncertain", 1 + more, deviation)


def _of_path(sightings: Sightings, corners: Corners, state: State) -> Iterator[Finding]:
    """Findings of times, of the board's size and of the camera's path."""
    steps = np.diff(sightings.time)
    low, middle, high = np.quantile(steps, [0.05, 0.5, 0.95])
    if steps.min() <= 0 or high - low > UNEVEN * middle:
        said = f"the frames' times are uneven, {1e3 * low:.3g} to {1e3 * high:.3g} ms apart"
        evidence = f"{int((steps <= 0).sum())} of {len(steps)} do not increase; times are used as they are"
        yield Finding("frame rate", said, evidence, float((high - low) / middle))
    seen = np.where(corners.seen[..., None], corners.pixels, np.nan)
    share = float(np.median((np.nanmax(seen, axis=1) - np.nanmin(seen, axis=1)).max(axis=1)) / corners.size.max())
    if share < SMALL:
        said = (
            f"the board is small, {100 * share:.2g} % of the picture's longer side: come nearer, or print a larger one"
        )
        yield Finding("small board", said, f"{100 * SMALL:.0f} % are wanted", share)
    from_board = -(np.swapaxes(state.R, 1, 2) @ state.p[..., None])[..., 0] - corners.places.mean(axis=0)
    far = np.linalg.norm(from_board, axis=1)
    rays = from_board / far[:, None]
    mean = rays.mean(axis=0) / np.linalg.norm(rays.mean(axis=0))
    around = 2 * math.degrees(np.quantile(np.arccos(np.minimum(rays @ mean, 1)), 0.95))
    if around < LEVEL:
        nearer = float(np.ptp(np.quantile(far, [0.05, 0.95])) / np.median(far))
        moved = f"the camera goes {around:.2g} degrees around the board, and by {100 * nearer:.2g} % of the distance"
        if nearer < NEARER:
            yield Finding(
                "no parallax", f"{moved}: it hardly moves; move it sideways", "turns show no distance", around
            )
        else:
            said = f"{moved} towards it: move it sideways as well"
            yield Finding("along the axis", said, "distances show least along the optical axis", around)


def _of_blur(corners: Corners, fit: Fit, widths: Array) -> Iterator[Finding]:
    """Finding of wide edges, with the time of exposure that explains them by the edges' speeds."""
    from scipy.optimize import curve_fit
    from scipy.special import erf

    width = float(np.nanquantile(widths, 0.9))
    if not width > BLURRED:
        return
    begin, end = _neighbours(corners.places).T
    along = corners.pixels[:, end] - corners.pixels[:, begin]
    across = np.stack([-along[..., 1], along[..., 0]], axis=-1) / np.linalg.norm(along, axis=-1, keepdims=True)
    speed = np.abs(((fit.speed[:, begin] + fit.speed[:, end]) / 2 * across).sum(axis=-1))
    good = np.isfinite(widths + speed)

    def of_exposure(speed: Array, soft: float, exposure: float) -> Array:
        path = exposure * speed + 1e-9  # a box of this width, after a normal curve
        return np.asarray(path / erf(path / (math.sqrt(8) * soft)))

    (_, exposure), spread = curve_fit(of_exposure, speed[good], widths[good], (0.7, 0.005), bounds=(1e-3, [50, 0.1]))
    deviation = math.sqrt(spread[1, 1])
    said = f"edges are blurred, one in ten over {width:.2g} pixels"
    if exposure > SURELY * deviation:
        said += f", as by an exposure of {1e3 * exposure:.2g} ms"
    yield Finding("blur", f"{said}: more light helps", f"sharp ones are under {BLURRED:g}", width, deviation)


def _neighbours(places: Array) -> Indices:
    """Numbers of corners next to each other, shape (m, 2)."""
    apart = np.linalg.norm(places[:, None] - places, axis=-1)
    pairs = np.argwhere(apart < 1.2 * apart[apart > 0].min())
    return np.asarray(pairs[pairs[:, 0] < pairs[:, 1]])


@checked
def edge_widths(picture: Any, board: Board, pixels: Array) -> Array:
    """Return the widths of the edges between neighbouring corners, in pixels.

    An edge is as wide as a straight slope, with the greatest slope across it, needs from black to white.

    Parameters
    ----------
    picture : array of shape (h, w)
        Grey values.
    board : Board
    pixels : array of shape (n, 2)
        All corners, NaN where unseen.

    Returns
    -------
    array of shape (m,)
        In an order that depends on the board only, NaN where an end was not seen.

    See Also
    --------
    find_faults : Takes them.

    Examples
    --------
    >>> board = Board()
    >>> float(np.median(edge_widths(board.picture(), board, 1000 * board.points[:, :2] - 0.5))).__round__(2)
    0.98
    """
    needed("film", "cv2")
    import cv2

    begin, end = np.swapaxes(numbers(pixels, "the pixels", "n", 2)[_neighbours(board.points)], 0, 1)[..., None, None, :]
    normal = (end - begin)[..., ::-1] * [-1, 1]
    reach = REACH * (board.square - board.marker) / 2 / board.square
    at = (
        begin
        + np.linspace(0.25, 0.75, 15)[:, None, None] * (end - begin)
        + np.linspace(-reach, reach, 33)[:, None] * normal
    )
    seen = np.isfinite(at).all(axis=(1, 2, 3))
    x, y = np.moveaxis(np.nan_to_num(at).astype(np.float32).reshape(-1, 33, 2), -1, 0)
    grey = cv2.remap(np.asarray(picture, dtype=np.float32), x, y, cv2.INTER_CUBIC).reshape(len(at), -1, 33).mean(axis=1)
    contrast = np.abs(grey[:, -3:].mean(axis=1) - grey[:, :3].mean(axis=1))
    slope = np.abs(np.gradient(grey, axis=1)).max(axis=1) / (reach / 16 * np.linalg.norm(normal[:, 0, 0], axis=-1))
    return np.where(seen & (contrast > FAINT), contrast / np.maximum(slope, 1e-9), np.nan)
