"""The runs behind Chwa's figures, by number, and what noise does to each observer of structure and motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from percept_obs.observers import (
    Observer,
    de_luca,
    extended_kalman,
    identifier_based,
    integral_sliding_mode,
    range_identification,
)
from percept_obs.recording import Recording, record
from percept_obs.structure import DepthSource, LinearView, ScaledDepthCamera, StructureAndMotion, linear_view
from percept_obs.structure.pixels import CHWA_CAMERA, PixelCamera, SignalToNoise
from percept_obs.structure.scenarios import chwa2019_experiment, chwa2019_semigeneral, chwa2019_simulation
from percept_obs.structure.simulation import EXACT_DEPTH
from percept_obs.structure.stages import SemigeneralRun, semigeneral
from percept_obs.tracking.following import track
from percept_obs.tracking.run import Run

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

PROPOSED = "integral sliding mode"
STAND_IN = "range identification, a stand-in for the method using [50]"
"""What the paper compares with cannot be recovered from its text; Dixon's observer on ybar stands in for it."""

EXPERIMENT_CAMERA = PixelCamera((150, 150), (320, 240), (640, 480))
"""A camera that keeps the points of the experiment in view for ten seconds; that of the simulations would not."""

_MAKERS: dict[str, Callable[..., Observer]] = {PROPOSED: integral_sliding_mode, STAND_IN: range_identification}
_FROM_ZERO = {"y1": 0.0, "y2": 0.0, "ybar3": 0.0}

FIGURES = {
    5: ("simulation", ("IV",)),
    6: ("simulation", ("V.A", "V.B")),
    7: ("simulation", ("VI.A", "VI.B", "VI.C")),
    9: ("experiment", ("IV",)),
    10: ("experiment", ("V.B",)),
    11: ("experiment", ("VI.B", "VI.C")),
}
"""Set-up and sections of each of the paper's figures that show runs."""


@dataclass(frozen=True, eq=False)
class Curves:
    """What a figure shows of one section: quantities over time, true and estimated.

    Parameters
    ----------
    section : str
    time : array of shape (K,)
        Seconds.
    true : mapping of names to arrays of shape (K,)
        y1, y2, y3 = 1/Z in 1/m, and the unknown quantities.
    estimated : mapping of observers to such mappings
        NaN in a gap.
    """

    section: str
    time: Array
    true: Mapping[str, Array]
    estimated: Mapping[str, Mapping[str, Array]]


def figure_runs(number: int, duration: float = 10.0, decibels: float = 100.0, seed: int = 0) -> tuple[Curves, ...]:
    """The curves of a figure of Chwa (2019).

    Parameters
    ----------
    number : int
        5, 6 or 7 for the simulations, 9, 10 or 11 for the experiment, here simulated with its stated values.
    duration : float
        Seconds.  The object of section IV starts to move in the middle; the paper does not state when.
    decibels : float
        Signal-to-noise ratio of the pixels, as `SignalToNoise` defines it.
    seed : int
        Of the noise.

    Returns
    -------
    tuple of Curves
        One a section; section IV gives two, for the standing and the moving object.

    Raises
    ------
    ValueError
        If the paper has no such figure of runs.
    """
    if number not in FIGURES:
        raise ValueError(f"there is no figure {number!r} of runs; there are {', '.join(map(str, FIGURES))}")
    set_up, sections = FIGURES[number]
    pixels = CHWA_CAMERA if set_up == "simulation" else EXPERIMENT_CAMERA
    camera_ = ScaledDepthCamera(pixels=pixels, ratio=SignalToNoise(decibels))
    curves: list[Curves] = []
    for section in sections:
        if section == "IV":
            setup = chwa2019_semigeneral(set_up, duration / 2)
            recording = record(setup, camera=camera_, seed=seed)
            camera: Literal["kept", "given"] = "kept" if set_up == "simulation" else "given"
            both = {
                name: semigeneral(
                    recording,
                    setup.motion,
                    duration / 2,
                    make=make,
                    camera=camera,
                    scale=setup.scale,
                    hold="first",
                    step=1e-3,
                )
                for name, make in _MAKERS.items()
            }
            curves += [_curves(f"IV.{part}", _stages(both, stage)) for part, stage in zip("AB", _STAGES, strict=True)]
        else:
            setups = {"simulation": chwa2019_simulation, "experiment": chwa2019_experiment}
            setup = setups[set_up](section)
            recording = record(setup, duration, camera_, seed)
            curves.append(_curves(section, {n: _run(recording, make) for n, make in _MAKERS.items()}))
    return tuple(curves)


_STAGES = ("static", "moving")


def _stages(runs: Mapping[str, SemigeneralRun], stage: str) -> dict[str, Run]:
    return {name: getattr(run, stage) for name, run in runs.items()}


def _run(recording: Recording, make: Callable[..., Observer]) -> Run:
    choice = recording.view
    assert isinstance(choice, StructureAndMotion)
    return track(recording, make(choice.form), _FROM_ZERO, hold="first", step=1e-3)


def _curves(section: str, runs: Mapping[str, Run]) -> Curves:
    first = next(iter(runs.values()))
    return Curves(
        section,
        first.time,
        _named(first.recording, first.truth),
        {name: _named(run.recording, run.estimate) for name, run in runs.items()},
    )


def _named(recording: Recording, coordinates: Array) -> dict[str, Array]:
    """y1, y2, y3 and the unknown quantities, from coordinates of the recording's choice."""
    choice = recording.view
    assert isinstance(choice, StructureAndMotion)
    image = {"y1": coordinates[:, 0], "y2": coordinates[:, 1], "y3": choice.inverse(coordinates)}
    return image | choice.quantities(coordinates[:, 3:])


def competitors(recording: Recording) -> dict[str, tuple[Recording, Observer]]:
    """Observers of structure and motion on one recording, each in the coordinates that suit it.

    The filters doubt each unknown with a process noise of 1 per second and know the variance of the noise.

    Parameters
    ----------
    recording : Recording
        Of (y1, y2, ybar3), with the variance of its noise.

    Returns
    -------
    mapping of names to recordings and observers
        The Kalman filter uses the linear view.  So do the identifier-based observer and De Luca's: their single gain
        cannot serve the columns of Omega_g, which differ in size by a factor ybar3, as the one without shows.

    Raises
    ------
    ValueError
        If the recording is of something else, or has no noise.
    """
    straight = linear_view(recording)
    choice, view = recording.view, straight.view
    assert isinstance(choice, StructureAndMotion)
    assert isinstance(view, LinearView)
    variance = recording.noise_variance
    if not variance:
        raise ValueError("the filters need the variance of the noise, and the recording has none; record it with noise")
    # noise of y1 or y2 is 1 / ybar3 times as large in the linear view
    there = variance / float(np.nanmean(recording.outputs[:, 2])) ** 2
    prior = {"hidden_process_noise": 1.0, "hidden_variance": 100.0}
    return {
        "ISMO, ideal switch": (recording, integral_sliding_mode(choice.form)),
        "ISMO, boundary layer": (recording, integral_sliding_mode(choice.form, "hyperbolic tangent")),
        "ISMO, ideal switch, b = 0": (recording, integral_sliding_mode(choice.form, sharpening=0)),
        "RIO, the stand-in": (recording, range_identification(choice.form)),
        "EKF": (recording, extended_kalman(choice.form, noise_variance=variance, measured_variance=variance, **prior)),
        "Kalman filter, linear view": (
            straight,
            extended_kalman(view.form, noise_variance=there, measured_variance=there, **prior),
        ),
        "IBO": (recording, identifier_based(choice.form, bound=1e3)),
        "IBO, linear view": (straight, identifier_based(view.form, lyapunov=-5.0, bound=1e3)),
        "De Luca, linear view": (straight, de_luca(view.form, measured_gain=10.0, hidden_gain=100.0)),
    }


def scale_spread(
    decibels: Sequence[float] = (100.0, 80.0, 60.0, 40.0),
    depth: DepthSource = EXACT_DEPTH,
    windows: Sequence[tuple[float, float]] = ((9.0, 10.0),),
    seed: int = 0,
) -> pd.DataFrame:
    """How far d_s scatters in case IV.A of the experiment, for every competitor and every ratio of noise.

    Parameters
    ----------
    decibels : sequence of floats
        Signal-to-noise ratios of the pixels of the simulations' camera, as `SignalToNoise` defines them.
    depth : DepthSource
        Where ybar3 comes from; exact when left out.
    windows : sequence of pairs of floats
        Times in seconds between which the scatter is taken.
    seed : int
        Of the noise, the same for all.

    Returns
    -------
    pandas.DataFrame
        One row for an observer, a ratio and a window: observer, decibels, begin, end, mean and std of the estimates of
        d_s in 1/m where there are any, missing (share of samples in a gap), true.
    """
    import pandas as pd

    setup = chwa2019_experiment("IV.A")
    rows = []
    for ratio in decibels:
        camera = ScaledDepthCamera(pixels=CHWA_CAMERA, ratio=SignalToNoise(ratio), depth=depth)
        recording = record(setup, max(end for _, end in windows), camera, seed)
        for name, (seen, observer) in competitors(recording).items():
            run = track(seen, observer, hold="first", step=1e-3)
            for begin, end in windows:
                found = run.estimate[(run.time >= begin) & (run.time <= end), 3]
                there = found[np.isfinite(found)]
                rows.append(
                    {
                        "observer": name,
                        "decibels": ratio,
                        "begin": begin,
                        "end": end,
                        "mean": float(there.mean()) if len(there) else np.nan,
                        "std": float(there.std()) if len(there) else np.nan,
                        "missing": 1 - len(there) / len(found),
                        "true": setup.scale,
                    }
                )
    return pd.DataFrame(rows)
