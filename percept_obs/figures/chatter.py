"""The figure of chatter: what a sign costs at fixed steps, and what it does to the steps of adaptive solvers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from matplotlib.axes import Axes

from percept_obs.figures.base import Drawing, canvases, figure, legend_above
from percept_obs.figures.look import style
from percept_obs.figures.words import letter
from percept_obs.studies.chatter import Effort

if TYPE_CHECKING:
    import pandas as pd


@figure("there is nothing to draw on one of the sides, or there are not two axes")
def chatter(
    errors: Mapping[str, pd.DataFrame], efforts: Mapping[str, Effort], axes: Sequence[Axes] | None = None
) -> Drawing:
    """Errors over the step of integration on the left, steps of adaptive solvers over time on the right.

    Parameters
    ----------
    errors : mapping of labels to tables
        From `percept_obs.studies.chatter.chatter`; the last coordinate, the inverse distance, is drawn.
    efforts : mapping of labels to Effort
        From `percept_obs.studies.chatter.effort`.  Curves with the same label look the same on both sides.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, figures, pinhole, record, scenarios, smo
    >>> from percept_obs.studies.chatter import chatter, effort
    >>> scene, observer = scenarios.ma2005_eq35(), smo(PerspectiveSystem(affine(), pinhole()))
    >>> errors = chatter(record(scene, 1), observer, [0.01, 0.005])
    >>> len(figures.chatter({"smo": errors}, {"smo": effort(scene, observer, 0.2)}).axes)
    2
    """
    if not errors or not efforts:
        raise ValueError(f"there are {len(errors)} tables and {len(efforts)} efforts; at least one of each is needed")
    left, right = canvases(axes, ["errors", "steps"], 3.6, ncols=2)
    looks = {label: style(number) for number, label in enumerate({**errors, **efforts})}
    yield "Left, rms error over the step of integration; right, steps of adaptive solvers; logarithmic axes."
    for label, table in errors.items():
        inverse = table.columns[-1]
        left.plot(table["step"], table[inverse], label=label, **looks[label])
        told = [f"{row['step']:.2g} s {row[inverse]:.2g}" for _, row in table.iterrows()]
        yield f"{label}: error at a step of {', '.join(told)}."
    left.set(xscale="log", yscale="log")
    left.set(xlabel="step of integration (s)", ylabel=f"rms error of {letter(inverse)} (1/m)")
    for label, one in efforts.items():
        name = "_" + label if label in errors else label
        right.plot(one.time[1:], one.steps, linewidth=1.2, label=name, **looks[label] | {"marker": ""})
        how = "arrived at" if one.finished else "gave up at"
        yield (
            f"{label}: {one.method} {how} {one.time[-1]:.2g} s after {one.evaluations[-1]} evaluations; its steps "
            f"were {one.steps.min():.2g} to {one.steps.max():.2g} s long."
        )
    right.set(yscale="log", xlabel="time (s)", ylabel="step that the solver took (s)")
    legend_above(left, fitting=40)
    if set(efforts) - set(errors):
        legend_above(right, fitting=40)
    return [left, right]
