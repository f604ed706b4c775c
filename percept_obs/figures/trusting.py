"""How far an estimate can be trusted over a run, and what each experiment of a diagnosis leaves of the samples."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures import axis, given, look, words
from percept_obs.figures.base import Drawing, canvas, figure, legend_above
from percept_obs.studies.diagnosis import Diagnosis
from percept_obs.studies.trust import TrustOverTime


@figure("it is something else")
def trust(found: TrustOverTime, ax: Axes | None = None) -> Drawing:
    """The estimated distance with what the samples told of it, shaded where they hardly told anything.

    Parameters
    ----------
    found : TrustOverTime

    Examples
    --------
    >>> from percept_obs import Camera, PerspectiveSystem, affine, figures, ibo, pinhole, record, scenarios, track
    >>> from percept_obs.studies.trust import trust_over_time
    >>> recording = record(scenarios.ma2005_eq35(), 5, Camera(0.05))
    >>> run = track(recording, ibo(PerspectiveSystem(affine(), pinhole())))
    >>> print(figures.trust(trust_over_time(run, count=3)).text.split(". ")[0])
    Estimated depth in metres over 0 to 5 s, with what the samples tell at 3 times
    """
    given.one(found, TrustOverTime, "studies.trust.trust_over_time(run)")
    ax, run = canvas(ax, 3.2), found.run
    word, symbol = words.depth_or_range(run.view)
    _shade(ax, found)
    told, spread = found.told, 2 * found.deviation
    there = np.isfinite(told) & (spread < 1)
    ends = told[there] * spread[there] / np.array([1 + spread[there], 1 - spread[there]])
    name = r"what the samples tell, $\pm 2\sigma$"
    ax.errorbar(found.time[there], told[there], ends, color=look.BLUE, linestyle="", marker=".", capsize=2, label=name)
    estimate = np.where(np.isfinite(run.distance), run.distance, np.nan)
    ax.plot(run.elapsed, estimate, **look.ESTIMATE)
    if run.recording.truth is not None:
        ax.plot(run.elapsed, run.recording.distance, **look.TRUTH)
    ax.set_xlim(run.elapsed[0], run.elapsed[-1])
    ax.set(xlabel="time (s)", ylabel=f"{word} ${symbol}$ (m)")
    yield f"Estimated {word} in metres over {words.times(run)}, with what the samples tell at {len(found.time)} times."
    yield found.sentence
    firm = told[there & (spread < 0.5)]
    yield axis.linear(ax, firm if firm.size else axis.bulk(estimate), estimate, f"the estimated {word}", reach=1.0)
    legend_above(ax)
    return [ax]


def _shade(ax: Axes, found: TrustOverTime) -> None:
    """Shade the seconds in which the samples told nothing."""
    time = found.run.elapsed
    ends = zip(found.time, found.unexcited, strict=True)
    told_nothing = np.any([(time >= end - length) & (time <= end) & (length > 0) for end, length in ends], axis=0)
    band: dict[str, Any] = {"color": look.ORANGE, "alpha": 0.3, "linewidth": 0, "label": "hardly excited"}
    if told_nothing.any():
        ax.fill_between(time, 0, 1, where=told_nothing, transform=ax.get_xaxis_transform(), **band)


@figure("it is something else, or nothing was found that has values to scan")
def scan(found: Diagnosis, ax: Axes | None = None) -> Drawing:
    """What is left of the samples for each value of what was found first, such as each time offset.

    Parameters
    ----------
    found : Diagnosis

    Examples
    --------
    >>> from dataclasses import replace
    >>> import numpy as np
    >>> from percept_obs import Camera, Gaussian, Scenario, diagnose, figures, pinhole, record, rigid
    >>> def motion(late=0):
    ...     return rigid(lambda t: [0.3 * np.sin(2 * t - 2 * late), 0.3 * np.cos(t - late), 0], [1, 0, 0], [0, 0, 0])
    >>> scene = Scenario("mine", motion(), (0.2, 0.1, 5), 4, pinhole())
    >>> seen = record(scene, camera=Camera(0.05, Gaussian(0.002)))
    >>> print(figures.scan(diagnose(replace(seen, motion=motion(0.1)))).text.split(": ")[1])
    time offset. It looks as if the images are 0.099 s early against the motion
    """
    given.one(found, Diagnosis, "diagnose(recordings)")
    if not found.findings or len(found.findings[0].tried) < 2:
        raise ValueError(f"{found.named} has no values that could be drawn")
    first = found.findings[0]
    ax = canvas(ax, 2.8)
    ax.plot(first.tried, 1000 * np.array(first.left), color=look.BLUE, marker="o", label="undone by so much")
    ax.axhline(1000 * found.left, color=look.VERMILLION, linestyle="--", label="as the recordings are")
    if np.isfinite(first.value):
        ax.axvline(first.value, color=look.BLACK, linewidth=1, linestyle=":", label="best")
    ax.set(xlabel=first.key, ylabel="left of the samples (1/1000)")
    ax.set_ylim(bottom=0)
    yield f"What is left of the samples for {len(first.tried)} values, {words.span(first.tried)}, of: {first.key}."
    yield found.sentence
    legend_above(ax)
    return [ax]
