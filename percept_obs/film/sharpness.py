"""Sharpness of a picture, by the edges of a board in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from percept_obs.compile import Array
from percept_obs.film.board import Board


@dataclass(frozen=True)
class Limits:
    """Where the grey of an edge is looked at."""

    share: float = 0.75  # of the edges are narrower than a picture's: motion blurs only those across it
    reach: float = 0.9  # share of the white between square and marker in which the grey across an edge is looked at
    faint: float = 20.0  # contrast in grey values up to which an edge is not looked at: noise would be its slope
    along: int = 15  # places along an edge, of which the mean grey is taken,
    across: int = 33  # and places across it


LIMITS = Limits()


def edge_width(picture: Any, corners: Array, board: Board) -> float:
    """Return the width of the board's edges in a grey picture in pixels, from its corners, NaN where unseen.

    It is the length in which the grey goes from black to white at its greatest slope, NaN if no edge is seen.
    """
    import cv2

    begin, end = np.moveaxis(corners[board.neighbours], 1, 0)[..., None, None, :]
    normal = (end - begin)[..., ::-1] * [-1, 1]
    reach = LIMITS.reach * (board.square - board.marker) / 2 / board.square
    along = np.linspace(0.25, 0.75, LIMITS.along)[:, None, None]
    across = np.linspace(-reach, reach, LIMITS.across)[:, None]
    places = begin + along * (end - begin) + across * normal
    seen = np.isfinite(places).all(axis=(1, 2, 3))
    if not seen.any():
        return float("nan")
    x, y = np.moveaxis(places[seen].astype(np.float32).reshape(-1, LIMITS.across, 2), -1, 0)
    grey = cv2.remap(picture, x, y, cv2.INTER_CUBIC).reshape(-1, LIMITS.along, LIMITS.across).mean(axis=1)
    contrast = np.ptp(grey, axis=1)
    step = 2 * reach / (LIMITS.across - 1) * np.linalg.norm(normal[seen, 0, 0], axis=-1)
    slope = np.abs(np.gradient(grey, axis=1)).max(axis=1) / step
    clear = contrast > LIMITS.faint
    return float(np.quantile(contrast[clear] / slope[clear], LIMITS.share)) if clear.any() else float("nan")
