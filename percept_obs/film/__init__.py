"""Films of one's own: a printed board gives poses, lens and true distances."""

from percept_obs.film.board import Board

__all__ = ["Board"]
