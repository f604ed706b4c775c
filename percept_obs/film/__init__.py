"""Films of one's own: a printed board gives poses, lens and true distances."""

from percept_obs.film.board import Board
from percept_obs.film.printing import board_pdf

__all__ = ["Board", "board_pdf"]
