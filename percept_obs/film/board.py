"""Boards to print: a chessboard with markers, whose corners are known to the millimetre and named in every picture."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, fields, replace
from functools import cached_property
from typing import Annotated, Any

import numpy as np

from percept_obs.compile import Array, Indices
from percept_obs.recording.text_table import PathLike
from percept_obs.validation import Kind, checked, limit, needed, read_json

DICTIONARY = "DICT_4X4_50"
"""OpenCV's markers of 4 x 4 cells, the largest cells that there are."""

FAMILIES = (
    *(f"DICT_{n}X{n}_1000" for n in (4, 5, 6, 7)),
    "DICT_ARUCO_ORIGINAL",
    *(f"DICT_APRILTAG_{name}" for name in ("16h5", "25h9", "36h10", "36h11")),
)
"""Dictionaries of OpenCV that hold all others."""

FEWEST_MARKERS = 4
"""Fewest markers of a dictionary in a picture that mean a board, and no accident."""

GREY = Kind(
    "grey values of 8 bits, shape (h, w)",
    lambda v: isinstance(v, np.ndarray) and (v.dtype, v.ndim) == ("u1", 2) and v.size > 0,
)

WINDOW = 0.7
"""Half of the window in which a corner is looked for, over the white between a square's edge and its marker."""


@checked
@dataclass(frozen=True)
class Board:
    """Chessboard whose white squares hold ArUco markers (a ChArUco board).

    Parameters
    ----------
    columns, rows : int
        Numbers of squares, 3 at least.
    square, marker : float
        Sides of a square and of a marker in metres.

    Raises
    ------
    ValueError
        If squares are too few, too many for the markers or over 1 m, or a marker does not fit into its square.

    See Also
    --------
    percept_obs.film.read_film : Reads a film of a board.

    Examples
    --------
    >>> board = Board()
    >>> board.points.shape, board.points[0].tolist()
    ((24, 3), [0.036, 0.036, 0.0])
    """

    columns: int = 7
    rows: int = 5
    square: float = 0.036
    marker: float = 0.027

    def __post_init__(self) -> None:
        if min(self.columns, self.rows) < 3 or self.columns * self.rows // 2 > 50:
            raise ValueError(
                f"the board has {self.columns} x {self.rows} squares; it needs 3 x 3 at least, and at most 100 squares"
            )
        if not 0 < self.marker < self.square <= 1:
            raise ValueError(
                f"marker {self.marker} m, square {self.square} m: the marker must be smaller, the square 1 m at most"
            )

    @classmethod
    def from_json(cls, path: PathLike) -> Any:
        """Return the board in a file that `percept-obs board` wrote."""
        try:
            given = read_json(path)
            if missing := [each.name for each in fields(cls) if each.name not in given]:
                raise ValueError(f"{', '.join(missing)} are not in it")
            return cls(**given)
        except (ValueError, TypeError) as error:
            raise ValueError(f"'{path}' is no file of a board, {error}; write one with: percept-obs board") from None

    @property
    def text(self) -> str:
        """The board's numbers as its file and its QR code hold them, JSON."""
        return json.dumps(asdict(self), separators=(",", ":"))

    def printed(self, ruler: float = 100.0) -> Board:
        """Return the board as it is on paper, where the ruler of 100 mm measures so many mm, from 50 to 200.

        >>> Board().printed(ruler=97.5).name
        '7 x 5 squares of 35.1 mm, markers of 26.325 mm'
        """
        if not 50 <= ruler <= 200:
            raise ValueError(f"the ruler measures {ruler:g} mm; expected about 100, from 50 to 200: measure it in mm")
        return replace(self, square=self.square * ruler / 100, marker=self.marker * ruler / 100)

    @property
    def name(self) -> str:
        """Name that is printed on it."""
        return (
            f"{self.columns} x {self.rows} squares of {1000 * self.square:g} mm, markers of {1000 * self.marker:g} mm"
        )

    @property
    def size(self) -> tuple[float, float]:
        """Width and height in metres."""
        return self.columns * self.square, self.rows * self.square

    @cached_property
    def points(self) -> Array:
        """Inner corners in metres, shape (n, 3): x along the rows from the upper left, y down, z into the board."""
        x, y = np.meshgrid(np.arange(1, self.columns), np.arange(1, self.rows))
        return np.stack([self.square * x.ravel(), self.square * y.ravel(), np.zeros(x.size)], axis=1)

    @cached_property
    def neighbours(self) -> Indices:
        """Numbers of inner corners with an edge of a square between them, shape (m, 2)."""
        apart = np.linalg.norm(self.points[:, None] - self.points, axis=-1)
        return np.argwhere(np.triu(np.abs(apart - self.square) < 0.1 * self.square))

    @cached_property
    def charuco(self) -> Any:
        """The board as OpenCV's `CharucoBoard`."""
        needed("film", "cv2")
        from cv2 import aruco

        markers = aruco.getPredefinedDictionary(getattr(aruco, DICTIONARY))
        return aruco.CharucoBoard((self.columns, self.rows), self.square, self.marker, markers)

    @cached_property
    def _detector(self) -> Any:
        from cv2 import aruco

        return aruco.CharucoDetector(self.charuco)

    def picture(self, pixels: int = 40) -> Any:
        """Return the board in grey values, shape (h, w), with so many pixels a square, a multiple of 4."""
        limit(self.columns * self.rows * pixels**2, "pixels", "take fewer a square")
        if pixels < (least := 6 * self.square / self.marker):  # a marker has 6 cells along its side
            raise ValueError(f"pixels is {pixels}; give at least {np.ceil(least):g} a square, to draw the markers")
        return self.charuco.generateImage((self.columns * pixels, self.rows * pixels))

    def detect(self, picture: Annotated[Any, GREY]) -> tuple[Indices, Array, bool]:
        """Return the numbers of the corners in a grey picture, shape (m,), and their pixels, shape (m, 2).

        The last value is True if a marker is seen twice, so that there are two boards.
        """
        import cv2

        corners, numbers, _, markers = self._detector.detectBoard(picture)
        twice = markers is not None and len(np.unique(markers)) < len(markers)
        if numbers is None:
            return np.empty(0, dtype=int), np.empty((0, 2)), twice
        found = np.full((len(self.points), 2), np.nan)
        found[np.ravel(numbers)] = np.reshape(corners, (-1, 2))
        edges = np.linalg.norm(np.diff(found[self.neighbours], axis=1)[:, 0], axis=1)
        free = WINDOW * (self.square - self.marker) / 2 / self.square
        half = max(2, int(free * np.nanmedian(edges))) if np.isfinite(edges).any() else 2
        until = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 50, 1e-3)
        finer = cv2.cornerSubPix(picture, corners, (half, half), (-1, -1), until)
        return np.ravel(numbers).astype(int), np.reshape(finer, (-1, 2)).astype(np.float64), twice


def other_markers(picture: Any) -> list[str]:
    """Return what else a grey picture may show than our markers, in words: another dictionary, or white on black."""
    from cv2 import aruco

    found = []
    for shown, colours in ((picture, ""), (255 - picture, "white on black, of ")):
        for family in FAMILIES:
            detector = aruco.ArucoDetector(aruco.getPredefinedDictionary(getattr(aruco, family)))
            numbers = detector.detectMarkers(shown)[1]
            known = 0 if numbers is None else len(np.unique(numbers))
            ours = family == FAMILIES[0] and known and np.median(numbers) < 50  # one may be read wrong
            if known >= FEWEST_MARKERS and ours and not colours:
                return []
            if known >= FEWEST_MARKERS:
                which = f"the dictionary {DICTIONARY}" if ours else f"another dictionary, {family}"
                found.append((known, f"markers {colours}{which}"))
    return [max(found)[1]] if found else []
