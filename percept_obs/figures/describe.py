"""Names and sentences for what a figure shows: coordinates, spans of values, the verdict on a run."""

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.figures.base import Array
from percept_obs.system.surfaces import POINT, ImagingSurface
from percept_obs.system.view import View
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import TOLERANCE


def finite(values: ArrayLike) -> Array:
    """The values that are neither NaN nor infinite, in one row."""
    array = np.asarray(values, dtype=float).ravel()
    return array[np.isfinite(array)]


def span(values: ArrayLike) -> str:
    """The range of values."""
    seen = finite(values)
    if not seen.size:
        return "nowhere finite"
    return f"from {seen.min():.3g} to {seen.max():.3g}" if seen.min() < seen.max() else f"{seen[0]:.3g}"


def times(run: Run) -> str:
    """From when to when a run goes."""
    return f"{run.elapsed[0]:.4g} to {run.elapsed[-1]:.4g} s"


def place(coordinates: Array) -> str:
    """Coordinates in brackets."""
    return f"({', '.join(f'{value:.3g}' for value in coordinates)})"


def depth_or_range(view: View) -> tuple[str, str]:
    """The word for a view's distance, and its letter."""
    if not isinstance(view, ImagingSurface):
        return "depth", "Z"
    if view.distance.is_Symbol:
        return "depth", str(view.distance)
    slopes = [view.distance.diff(axis) for axis in POINT]
    straight = all(slope.free_symbols.isdisjoint(POINT) for slope in slopes)
    return ("depth", "l") if straight else ("range", "R")


def letter(name: str) -> str:
    """The symbol of a coordinate such as y1, for matplotlib."""
    return f"${sp.latex(sp.Symbol(name))}$"


def label(name: str, view: View) -> str:
    """How an axis names a coordinate: its symbol, what it is and its unit."""
    if not _is_inverse_distance(name, view):
        return letter(name)
    return f"{letter(name)[:-1]} = 1/{depth_or_range(view)[1]}$ (1/m)"


def coordinate(name: str, view: View) -> str:
    """How a sentence names a coordinate."""
    return f"{name} = 1/{depth_or_range(view)[1]}" if _is_inverse_distance(name, view) else name


def _is_inverse_distance(name: str, view: View) -> bool:
    return isinstance(view, ImagingSurface) and name == view.inverse_distance.name


def joined(*sentences: str) -> str:
    """The sentences that are not empty."""
    return " ".join(filter(None, sentences))


def story(run: Run, tolerance: float = TOLERANCE) -> str:
    """What happened to a run, in sentences: its verdict, resets, divergence and lost samples."""
    if not tolerance > 0:
        raise ValueError(f"the tolerance is {tolerance}; it must be positive")
    verdict, diverged = run.verdict(tolerance), run.diverged_at is not None
    resets = "once" if len(run.resets) == 1 else f"{len(run.resets)} times"
    columns = [run.recording.names.index(name) for name in run.measured]
    lost = int(np.isnan(run.recording.outputs[:, columns]).any(axis=1).sum())
    missing = int(np.isnan(run.estimate).any(axis=1).sum())
    return joined(
        f"{verdict[0].upper()}{verdict[1:]}.",
        f"Before that it was reset {resets}." if diverged and len(run.resets) else "",
        f"From there on {missing} estimates are missing: the curve ends." if missing else "",
        f"{lost} of {len(run.elapsed)} samples were lost." if lost else "",
    )
