"""Example of a film of a board: film.mp4, drawn so that all is known, and distances.csv, true distances in it."""

from pathlib import Path


def example_film() -> Path:
    """Return the path of a drawn film of the default board, 6 s of 480 x 270, with boxes and cards around it.

    Beside it stands distances.csv: times in s, pixels u and v, and the true depth in m of what is seen there.  The
    camera's focal length is 405 pixels.

    See Also
    --------
    percept_obs.film.read_film : Reads it.

    Examples
    --------
    >>> from percept_obs.film import example_film
    >>> example_film().with_name("distances.csv").read_text().splitlines()[0]
    'time,u,v,depth'
    """
    return Path(__file__).with_name("film.mp4")
