"""Names and sentences for what a figure shows: coordinates, spans of values, the verdict on a run."""

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.figures.base import Array
from percept_obs.system.surfaces import POINT, ImagingSurface
from percept_obs.system.view import View
from percept_obs.tracking.run import Run


def finite(values: ArrayLike) -> Array:
    """Return the finite values, shape (K,)."""
    array = np.asarray(values, dtype=float).ravel()
    return array[np.isfinite(array)]


def span(values: ArrayLike) -> str:
    """Return the range of values as text."""
    seen = finite(values)
    if not seen.size:
        return "nowhere finite"
    return f"from {seen.min():.3g} to {seen.max():.3g}" if seen.min() < seen.max() else f"{seen[0]:.3g}"


def times(run: Run) -> str:
    """Return the beginning and the end of a run as text."""
    return f"{run.elapsed[0]:.4g} to {run.elapsed[-1]:.4g} s"


def place(coordinates: Array) -> str:
    """Return coordinates in brackets."""
    return f"({', '.join(f'{value:.3g}' for value in coordinates)})"


def depth_or_range(view: View) -> tuple[str, str]:
    """Return the word for a view's distance, and its letter."""
    if not isinstance(view, ImagingSurface):
        return "depth", "Z"
    if view.distance.is_Symbol:
        return "depth", str(view.distance)
    slopes = [view.distance.diff(axis) for axis in POINT]
    straight = all(slope.free_symbols.isdisjoint(POINT) for slope in slopes)
    return ("depth", "l") if straight else ("range", "R")


def in_metres(view: View) -> str:
    """Return the label of the axis of a view's distance."""
    word, symbol = depth_or_range(view)
    return f"{word} ${symbol}$ (m)"


def letter(name: str) -> str:
    """Return the symbol of a coordinate such as y1 in matplotlib's mathematics."""
    return f"${sp.latex(sp.Symbol(name))}$"


def label(name: str, view: View) -> str:
    """Return the label of a coordinate's axis, with its unit."""
    if not _is_inverse_distance(name, view):
        return letter(name)
    return f"{letter(name)[:-1]} = 1/{depth_or_range(view)[1]}$ (1/m)"


def coordinate(name: str, view: View) -> str:
    """Return the name of a coordinate in a sentence."""
    return f"{name} = 1/{depth_or_range(view)[1]}" if _is_inverse_distance(name, view) else name


def _is_inverse_distance(name: str, view: View) -> bool:
    return isinstance(view, ImagingSurface) and name == view.inverse_distance.name


def joined(*sentences: str) -> str:
    """Join the sentences that are not empty."""
    return " ".join(filter(None, sentences))


def story(run: Run) -> str:
    """Return the verdict on a run as a sentence, with missing estimates and lost samples."""
    verdict = run.verdict()
    columns = [run.recording.names.index(name) for name in run.measured]
    lost = int(np.isnan(run.recording.outputs[:, columns]).any(axis=1).sum())
    missing = int(np.isnan(run.estimate).any(axis=1).sum())
    return joined(
        f"{verdict[0].upper()}{verdict[1:]}.",
        f"From there on {missing} estimates are missing: the curve ends." if missing else "",
        f"{lost} of {len(run.elapsed)} samples were lost." if lost else "",
    )
