"""A page with a board, a PDF to true size: the board, a ruler that checks the print, and the board's name."""

from __future__ import annotations

import io
from collections.abc import Iterable
from typing import Any

import numpy as np

from percept_obs.film.board import Board
from percept_obs.validation import checked

PAPERS = {"A4": (297.0, 210.0), "letter": (279.4, 215.9)}
"""Width and height in mm, landscape."""
INCH = 25.4
EDGE = 8.0
"""White around the board in mm, at least, for printers leave the paper's edge white."""
FOOT, FOOT_WIDTH, CODE = 17.5, 252.0, 11.5
"""Height and width in mm of the foot, as wide as the default board, and the side of the code in it; 6 mm stay white."""
SMALLEST = 3.0
"""Least side of a marker in mm: a telephone sees it as 12 pixels of 1280 at a quarter of a metre."""
SHARE = 0.75
"""A marker's side over its square's, by default: the white around the marker is as wide as one of its cells."""


@checked
def board_pdf(board: Board, paper: str = "A4") -> bytes:
    """Return a PDF file with a board to true size on a page in landscape; the same board gives the same bytes.

    Below the board stand a ruler of 100 mm, the board's name, and a QR code that holds its `Board.text`.

    Parameters
    ----------
    board : Board
    paper : "A4" or "letter"

    Raises
    ------
    ValueError
        If there is no such paper, the markers are too small to be filmed, or the board is too large for the paper,
        with the squares that would fit.
    ModuleNotFoundError
        If OpenCV is missing, which knows the markers.

    See Also
    --------
    Board.printed : Takes the ruler as it was printed.

    Examples
    --------
    >>> from percept_obs.film import Board, board_pdf
    >>> board_pdf(Board())[:5]
    b'%PDF-'
    >>> board_pdf(Board(square=0.04))
    Traceback (most recent call last):
    ...
    ValueError: a board of 280 x 200 mm and its ruler do not fit on A4 paper; with squares of 36 mm they do
    """
    if paper not in PAPERS:
        raise ValueError(f"there is no paper {paper!r}; there are {', '.join(PAPERS)}")
    width, height = PAPERS[paper]
    square, marker = 1000 * board.square, 1000 * board.marker
    size = board.columns * square, board.rows * square
    if marker < SMALLEST:
        raise ValueError(f"markers of {marker:g} mm are too small to be filmed; give them {SMALLEST:g} mm at least")
    needs = _needs(board.columns, board.rows, square, marker)
    if np.any(np.subtract(needs, PAPERS[paper]) > 1e-9):
        largest = largest_square(board.columns, board.rows, marker / square, [paper])
        raise ValueError(
            f"a board of {size[0]:g} x {size[1]:g} mm and its ruler do not fit on {paper} paper; "
            f"with squares of {largest} mm they do"
        )
    left, foot, side = (width - size[0]) / 2, height - FOOT, (width - FOOT_WIDTH) / 2
    top = max(EDGE, marker / 6) + (height - needs[1]) / 2
    black = np.concatenate([_board(board, left, top), _code(board, width - side - CODE, foot)])

    import matplotlib.style
    from matplotlib.figure import Figure
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    with matplotlib.style.context("default"):  # the user's might cut the page
        figure = Figure((width / INCH, height / INCH))
        axes = figure.add_axes((0, 0, 1, 1), xlim=(0, width), ylim=(height, 0))
        axes.axis("off")
        # As one path, for between two a white line would show.
        axes.add_patch(PathPatch(Path.make_compound_path_from_polys(black), facecolor="black", linewidth=0))
        _ruler(axes, side, foot + 5.75, "mm", 1.0, 100, 10, 1)
        if paper == "letter":
            _ruler(axes, side, foot + 5.75, "in", INCH / 8, 31, 8, -1)  # not beyond the 100 mm
        axes.text(side + 110, foot + 3.5, board.name, size=9, weight="bold", va="center")
        advice = 'Print at 100 %, not "fit to page"; measure: the ruler must be 100 mm.'
        axes.text(side + 110, foot + 8.5, advice, size=8, va="center")
        file = io.BytesIO()
        figure.savefig(file, format="pdf", metadata={"Title": board.name, "CreationDate": None})
    return file.getvalue()


def largest_square(columns: int, rows: int, share: float = SHARE, papers: Iterable[str] = PAPERS) -> int:
    """Return the side in whole mm of the largest squares that fit on all papers; markers have a share of it."""
    least = np.min([PAPERS[paper] for paper in papers], axis=0) + 1e-9
    return max((s for s in range(1, 100) if np.all(_needs(columns, rows, s, share * s) <= least)), default=1)


def _needs(columns: int, rows: int, square: float, marker: float) -> tuple[float, float]:
    """Return width and height in mm of a board, the white around it, a marker's cell at least, and the foot."""
    edge = max(EDGE, marker / 6)
    return columns * square + 2 * edge, rows * square + edge + marker / 6 + FOOT


def _cells(black: Any, left: float, top: float, side: float) -> Any:
    """Return the corners of the black cells of a pattern, shape (n, 4, 2)."""
    row, column = np.nonzero(black)
    corners = np.stack([column, row], axis=1)[:, None] + [(0, 0), (1, 0), (1, 1), (0, 1)]
    return side * corners + (left, top)


def _board(board: Board, left: float, top: float) -> Any:
    """Return the corners of the board's black cells in mm; OpenCV places the markers and knows their cells."""
    chess = np.add.outer(np.arange(board.rows), np.arange(board.columns)) % 2 == 0
    places = 1000 * np.array(board.charuco.getObjPoints())[:, 0, :2] + (left, top)
    markers = [board.charuco.getDictionary().generateImageMarker(k, 6) for k in range(len(places))]
    drawn = [_cells(m == 0, x, y, 1000 * board.marker / 6) for m, (x, y) in zip(markers, places, strict=True)]
    return np.concatenate([_cells(chess, left, top, 1000 * board.square), *drawn])


def _code(board: Board, left: float, top: float) -> Any:
    """Return the corners of the black cells in mm of the QR code that holds the board's numbers."""
    import cv2

    black = cv2.QRCodeEncoder.create().encode(board.text) == 0
    white = int(np.argmax(black.any(axis=0)))  # cells at each side
    black = black[white:-white, white:-white]
    return _cells(black, left, top, CODE / len(black))


def _ruler(axes: Any, left: float, y: float, unit: str, step: float, count: int, named: int, up: int) -> None:
    """Draw a ruler with a tick each step, in mm; one in so many is named, and the ticks stand up or hang down."""
    x = left + step * np.arange(count + 1)
    length = np.select([np.arange(count + 1) % n == 0 for n in (named, named // 2)], [3.0, 2.1], 1.3)
    axes.vlines(x, y, y - up * length, color="black", linewidth=0.4)
    axes.hlines(y, x[0], x[-1], color="black", linewidth=0.4)
    for k in range(0, count + 1, named):
        text = f"{step * k if unit == 'mm' else k // named:g}"
        axes.text(x[k], y - 4.2 * up, text, size=6, ha="center", va="center")
    axes.text(left + 2, y - 4.2 * up, unit, size=6, va="center")
