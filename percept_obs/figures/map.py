"""The figure of a map: one number of an ensemble over two of its settings."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures.base import Drawing, canvas, figure
from percept_obs.figures.look import LIGHT


@figure("the values do not have exactly two dimensions of several settings")
def settings_map(values: Any, ax: Axes | None = None) -> Drawing:
    """A number over two settings; grey where it is infinite or there is none.

    Parameters
    ----------
    values : xarray.DataArray
        With two dimensions, such as ``ensemble(...).settling_time.isel(seed=0)``; the first one goes up.

    Examples
    --------
    >>> import xarray as xr
    >>> from percept_obs import figures
    >>> errors = xr.DataArray([[1.0, 2.0], [3.0, 4.0]], {"gain": [5, 10], "noise": [0.0, 0.1]}, name="error")
    >>> print(figures.settings_map(errors).text.split(". ")[-1])
    Largest: 4 at noise 0.1 and gain 10.
    """
    values = values.squeeze()
    if values.ndim != 2:
        raise ValueError(f"a map needs two dimensions; there are {values.ndim}: {', '.join(values.dims) or 'none'}")
    up, right = values.dims
    ax = canvas(ax, 3.6)
    numbers = np.where(np.isfinite(values.values), values.values, np.nan)
    known = np.isfinite(numbers)
    ax.set_facecolor(LIGHT)
    drawn = ax.pcolormesh(values[right], values[up], numbers, shading="nearest", cmap="viridis")
    ax.grid(visible=False)
    ax.set(xlabel=_called(values[right]), ylabel=_called(values[up]))
    whole: Any = ax.get_figure(root=True)
    whole.colorbar(drawn, ax=ax, label=_called(values))
    yield f"{_called(values)} over {_called(values[right])} and, upwards, {_called(values[up])}."
    if not known.any():
        yield "There is no finite value."
        return [ax]
    for word, place in (("Least", np.nanargmin(numbers)), ("Largest", np.nanargmax(numbers))):
        row, column = np.unravel_index(place, numbers.shape)
        at = f"{right} {values[right].values[column]:.3g} and {up} {values[up].values[row]:.3g}"
        yield f"{word}: {numbers[row, column]:.3g} at {at}."
    yield f"Finite at {100 * known.mean():.0f} % of the places; grey elsewhere." if not known.all() else ""
    return [ax]


def _called(values: Any) -> str:
    """A name with its unit."""
    unit = values.attrs.get("units", "1")
    return str(values.name) if unit == "1" else f"{values.name} ({unit})"
