"""Films of one's own: a printed board gives poses, lens and true distances."""

from percept_obs.film.board import Board
from percept_obs.film.example import example_film
from percept_obs.film.film import Film
from percept_obs.film.printing import board_pdf
from percept_obs.film.reading import read_film

__all__ = ["Board", "Film", "board_pdf", "example_film", "read_film"]
