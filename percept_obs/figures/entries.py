"""Which entries of the believed motion an estimate depends on, over time."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures import axis, curves, given, look, words
from percept_obs.figures.base import Drawing, canvas, figure, legend_above
from percept_obs.studies.sensitivity import SHARE, Sensitivity


@figure("it is something else, or fewer than one entry is asked for")
def entries(found: Sensitivity, most: int = 4, share: float = SHARE, ax: Axes | None = None) -> Drawing:
    """By how much the distance moves when one entry of the motion is off, for those entries that matter most.

    Parameters
    ----------
    found : Sensitivity
    most : int
        How many entries to draw.
    share : float
        By which share of the motion's size an entry is off: of all of A, or of all of b.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, figures, ibo, pinhole, record, scenarios
    >>> from percept_obs.studies.sensitivity import sensitivity
    >>> observer = ibo(PerspectiveSystem(affine(), pinhole()))
    >>> found = sensitivity(record(scenarios.ma2005_eq35(), 10), observer)
    >>> print(figures.entries(found, most=1).text.split(". ")[1])
    a32: 9.4 % in the median of the last half
    """
    given.one(found, Sensitivity, "studies.sensitivity.sensitivity()")
    if most < 1:
        raise ValueError(f"the {most} most important entries were asked for; draw one at least")
    ax = canvas(ax, 3.2)
    ranking, changes = found.ranking(share), 100 * found.distance_change(share)
    drawn = list(ranking)[:most]
    shown = np.array([changes[:, found.entries.index(name)] for name in drawn])
    labels = [words.letter(name) for name in drawn]
    curves.draw(ax, found.run.elapsed, shown, labels, [look.style(number) for number in range(len(drawn))])
    ax.set(xlabel="time (s)", ylabel=f"{words.depth_or_range(found.run.view)[0]} moves by (%)")
    size = f"{100 * share:g} % of the motion's size"
    yield f"By how much the estimated distance moves when one entry of the motion is off by {size}, for {len(drawn)}."
    yield "; ".join(f"{name}: {100 * ranking[name]:.2g} % in the median of the last half" for name in drawn) + "."
    others = list(ranking)[most:]
    yield f"Less than these: {', '.join(others)}." if others else ""
    late = shown[:, len(found.run.time) // 10 :]
    yield axis.linear(ax, axis.bulk(late), shown, "the changes", reach=0.5)
    legend_above(ax)
    return [ax]
