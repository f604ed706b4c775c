"""The figure of imaging surfaces side by side: how well distance can be known in each direction."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm

from percept_obs.figures import given
from percept_obs.figures.base import Drawing, canvases, figure
from percept_obs.studies.fields import FieldBound

FINEST = 1.3
"""Factor between the ends of the colours that a figure has at least, so that no round-off is seen."""


@figure("there is none, something else is among them, or the number of labels or axes is wrong")
def fields(
    found: FieldBound | Sequence[FieldBound], labels: Sequence[str] | None = None, axes: Sequence[Axes] | None = None
) -> Drawing:
    """The least error of the range over the field of view, a map for each, with the same colours in all of them.

    Parameters
    ----------
    found : FieldBound or sequence of FieldBound

    Examples
    --------
    >>> from percept_obs import affine, figures, sphere
    >>> from percept_obs.studies.fields import AngleNoise, field_bound
    >>> sideways = affine([[0.0] * 3] * 3, [0.5, 0, 0])
    >>> found = field_bound(sphere(), sideways, AngleNoise(), 2.0, size=5)
    >>> print(figures.fields(found).text.split(". ")[1])
    sphere, y1, y2 measured: 0.53 % in the middle of the picture, 0.75 % near its edge, 0.53 to 96 % in all.
    """
    found = given.several(found, FieldBound, "field_bound()")
    names = given.labels_for(labels, [each.surface.name for each in found])
    percent = [100 * each.relative for each in found]
    low = min(float(np.nanmin(each)) for each in percent)
    # what leaves the field of view at once is hardly known, and would take all of the colours
    high = max(float(np.nanpercentile(each, 97)) for each in percent)
    own = axes is None
    columns = next(count for count in (3, 2, 1) if len(found) % count == 0)
    rows = -(-len(found) // columns)
    maps = canvases(axes, names, 2.7 * rows, nrows=rows, ncols=min(columns, len(found)), sharex=True, sharey=True)
    yield "Least relative standard deviation of the range in each direction, in degrees from the optical axis."
    for ax, each, values, name in zip(maps, found, percent, names, strict=True):
        edge = np.degrees(each.angles[-1])
        colours: dict[str, Any] = {"norm": LogNorm(low, max(high, FINEST * low)), "cmap": "viridis_r"}
        picture = ax.imshow(values, extent=(-edge, edge, -edge, edge), origin="lower", **colours)
        ax.grid(False)
        ax.set_title(name, fontsize="medium")
        ax.set_xlabel("to the right (°)")
        middle, rim = each.within(0, np.radians(edge) / 3), each.within(2 * np.radians(edge) / 3, np.radians(edge))
        yield (
            f"{name}, {', '.join(each.measured)} measured: {100 * middle:.2g} % in the middle of the picture, "
            f"{100 * rim:.2g} % near its edge, {np.nanmin(values):.2g} to {np.nanmax(values):.2g} % in all."
        )
    maps[0].set_ylabel("up (°)")
    if own:
        whole: Any = maps[0].get_figure(root=True)
        whole.colorbar(picture, ax=maps, shrink=0.8, label="least error of the range (%)")
    return maps
