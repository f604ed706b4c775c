"""Boards to print: a chessboard with markers, whose corners are known to the millimetre and named in every picture."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from percept_obs.compile import Array, Indices
from percept_obs.recording.text_table import PathLike
from percept_obs.validation import checked, needed, write_whole

DICTIONARY = "DICT_4X4_50"
"""OpenCV's markers of 4 x 4 cells, the largest cells that there are."""


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
        If there are too few squares or too many for the markers, or a marker does not fit into its square.

    See Also
    --------
    percept_obs.film.read_film : Reads a film of a board.

    Examples
    --------
    >>> board = Board()
    >>> board.points.shape, board.points[0].tolist()
    ((24, 3), [0.04, 0.04, 0.0])
    """

    columns: int = 7
    rows: int = 5
    square: float = 0.04
    marker: float = 0.03

    def __post_init__(self) -> None:
        if min(self.columns, self.rows) < 3 or self.columns * self.rows // 2 > 50:
            raise ValueError(
                f"the board has {self.columns} x {self.rows} squares; it needs 3 x 3 at least, and at most 100 squares"
            )
        if not 0 < self.marker < self.square < np.inf:
            raise ValueError(
                f"the marker's side is {self.marker} m and the square's {self.square} m; the marker must be smaller"
            )

    @classmethod
    def from_json(cls, path: PathLike) -> Any:
        """Return the board in a file that `percept-obs board` wrote."""
        try:
            fields = json.loads(Path(path).read_text("utf-8"))
            return cls(**fields)
        except (ValueError, TypeError) as error:
            raise ValueError(f"'{path}' is no file of a board, {error}; write one with: percept-obs board") from None

    def to_json(self, path: PathLike) -> None:
        """Write the board's numbers, which `from_json` reads."""
        write_whole(Path(path), f"{json.dumps(asdict(self), indent=1)}\n".encode())

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
        return self.square * np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)

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
        return self.charuco.generateImage((self.columns * pixels, self.rows * pixels))

    def detect(self, picture: Any) -> tuple[Indices, Array]:
        """Return the numbers of the corners in a grey picture, and their pixels, shapes (m,) and (m, 2)."""
        corners, numbers, _, _ = self._detector.detectBoard(picture)
        if numbers is None:
            return np.empty(0, dtype=int), np.empty((0, 2))
        return np.ravel(numbers).astype(int), np.reshape(corners, (-1, 2)).astype(float)
