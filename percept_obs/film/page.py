"""A page about a film: the distances drawn in, what was found, and the tables."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

from percept_obs.film.film import Film
from percept_obs.studies.comparison import Comparison

if TYPE_CHECKING:
    import pandas as pd

STYLE = (
    "body{font:16px/1.5 system-ui,sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem;color-scheme:light dark}"
    "video{width:100%}table{border-collapse:collapse;display:block;overflow-x:auto}"
    "td,th{padding:.2rem .6rem;text-align:left;border-bottom:1px solid #8886}"
)


def page(film: Film, points: pd.DataFrame, table: Comparison, video: str, lab: str) -> str:
    """Return a page of HTML about a film, its `distances` and observers, with links to what is drawn and to the lab."""
    trusted = points[points["trusted"]]
    columns = ["point", "seconds", "distance", "claimed", "reference", "known", "error", "trusted", "why"]
    units = {
        "seconds": "{:.1f} s",
        "distance": "{:.3f} m",
        "claimed": "± {:.3f} m",
        "known": "{:.3f} m",
        "error": "{:.1%}",
    }
    rows = points[columns].to_html(
        index=False, border=0, formatters={name: form.format for name, form in units.items()}
    )
    judged = f"{len(trusted)} of {len(points)} estimates are trusted."
    if len(trusted):
        judged += (
            f" They differ by {trusted['error'].median():.2%} in the median. The board's corners are compared with "
            "the board, other points with the triangulation of the whole film."
        )
    title = html.escape(f"How far things are in {film.source}")
    return "\n".join(
        [
            f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{title}</title>',
            f'<meta name="viewport" content="width=device-width"><style>{STYLE}</style><h1>{title}</h1>',
            f'<video src="{video}" controls muted loop playsinline aria-label="The film with the distance of each '
            'point by an extended Kalman filter, and two standard deviations"></video>',
            f"<p>{html.escape(judged)}</p>",
            f'<p><a href="{lab}">Open the live lab</a>: press play, and watch an observer find a distance.</p>',
            f"<p>{html.escape(film.sentence)}</p>",
            f"<h2>All observers</h2>{table._repr_html_()}",
            f"<h2>All points, by the extended Kalman filter</h2>{rows}",
        ]
    )
