"""Sharpness of a picture, by the edges of a board in it."""

from __future__ import annotations

from typing import Any

import numpy as np

from percept_obs.compile import Array
from percept_obs.film.board import Board

SHARE = 0.75
"""Quantile of the edges' widths that stands for all: motion blurs the edges across it only, which are the widest."""

REACH = 0.9
"""Share of the white between square and marker in which the grey across an edge is looked at."""

FAINT = 20.0
"""Contrast in grey values up to which an edge is not looked at."""

ALONG, ACROSS = 15, 33
"""Numbers of places at which an edge is looked at."""


def edge_width(picture: Any, corners: Array, board: Board) -> float:
    """Return the width of the board's edges in a grey picture in pixels, from its corners, NaN where unseen.

    It is the length in which the grey goes from black to white at its greatest slope, NaN if no edge is seen.
    """
    import cv2

    begin, end = np.moveaxis(corners[board.neighbours], 1, 0)[..., None, None, :]
    normal = (end - begin)[..., ::-1] * [-1, 1]
    reach = REACH * (board.square - board.marker) / 2 / board.square
    along, across = np.linspace(0.25, 0.75, ALONG)[:, None, None], np.linspace(-reach, reach, ACROSS)[:, None]
    places = begin + along * (end - begin) + across * normal
    seen = np.isfinite(places).all(axis=(1, 2, 3))
    if not seen.any():
        return float("nan")
    x, y = np.moveaxis(places[seen].astype(np.float32).reshape(-1, ACROSS, 2), -1, 0)
    grey = cv2.remap(picture, x, y, cv2.INTER_CUBIC).reshape(-1, ALONG, ACROSS).mean(axis=1)
    contrast = np.ptp(grey, axis=1)
    step = 2 * reach / (ACROSS - 1) * np.linalg.norm(normal[seen, 0, 0], axis=-1)
    slope = np.abs(np.gradient(grey, axis=1)).max(axis=1) / step
    clear = contrast > FAINT
    return float(np.quantile(contrast[clear] / slope[clear], SHARE)) if clear.any() else float("nan")
