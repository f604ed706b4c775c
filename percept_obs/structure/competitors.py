"""Observers of structure and motion side by side under noise."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from percept_obs.observers import Observer, de_luca, ekf, ibo, ismo, rio
from percept_obs.recording import Recording, record
from percept_obs.structure import DepthSource, LinearView, ScaledDepthCamera, StructureAndMotion, linear_view
from percept_obs.structure.pixels import CHWA_CAMERA, SignalToNoise
from percept_obs.structure.scenarios import chwa2019_experiment
from percept_obs.structure.simulation import EXACT_DEPTH
from percept_obs.tracking.following import track
from percept_obs.validation import checked, load_pandas

if TYPE_CHECKING:
    import pandas as pd


@checked
def competitors(recording: Recording) -> dict[str, tuple[Recording, Observer]]:
    """Set up all observers of structure and motion for one recording, each in the coordinates that suit it.

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

    See Also
    --------
    scale_spread : Runs them all.

    Examples
    --------
    >>> from percept_obs import Gaussian, record
    >>> from percept_obs.structure.competitors import competitors
    >>> seen = record(chwa2019_experiment("IV.A"), 0.01, ScaledDepthCamera(1e-3, Gaussian(1e-3)))
    >>> list(competitors(seen))[:3]
    ['ISMO, ideal switch', 'ISMO, boundary layer', 'ISMO, ideal switch, b = 0']
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
        "ISMO, ideal switch": (recording, ismo(choice.form)),
        "ISMO, boundary layer": (recording, ismo(choice.form, "hyperbolic tangent")),
        "ISMO, ideal switch, b = 0": (recording, ismo(choice.form, sharpening=0)),
        "RIO, the stand-in": (recording, rio(choice.form)),
        "EKF": (recording, ekf(choice.form, noise_variance=variance, measured_variance=variance, **prior)),
        "Kalman filter, linear view": (
            straight,
            ekf(view.form, noise_variance=there, measured_variance=there, **prior),
        ),
        "IBO": (recording, ibo(choice.form, bound=1e3)),
        "IBO, linear view": (straight, ibo(view.form, lyapunov=-5.0, bound=1e3)),
        "De Luca, linear view": (straight, de_luca(view.form, measured_gain=10.0, hidden_gain=100.0)),
    }


@checked
def scale_spread(
    decibels: Sequence[float] = (100.0, 80.0, 60.0, 40.0),
    depth: DepthSource = EXACT_DEPTH,
    windows: Sequence[tuple[float, float]] = ((9.0, 10.0),),
    seed: int = 0,
    observers: Sequence[str] | None = None,
) -> pd.DataFrame:
    """Scatter of d_s in case IV.A of the experiment, for observers and ratios of noise.

    Parameters
    ----------
    decibels : sequence of floats
        Signal-to-noise ratios of the pixels of the simulations' camera, as `SignalToNoise` defines them.
    depth : DepthSource
        Source of ybar3; exact when left out.
    windows : sequence of pairs of floats
        Times in seconds between which the scatter is taken.
    seed : int
        Of the noise, the same for all.
    observers : sequence of str, optional
        Names of some `competitors`; all of them when left out.

    Returns
    -------
    pandas.DataFrame
        One row for an observer, a ratio and a window: observer, decibels, begin, end, mean and std of the estimates of
        d_s in 1/m where there are any, missing (share of samples in a gap), true.

    Raises
    ------
    ValueError
        If there is no ratio or no window, a window ends before it begins, or an observer is none of the competitors.

    See Also
    --------
    competitors : The observers.

    Examples
    --------
    >>> from percept_obs.structure.competitors import scale_spread
    >>> found = scale_spread(decibels=[60], windows=[(0.1, 0.2)]).set_index("observer")
    >>> found.loc["Kalman filter, linear view", ["mean", "true"]].astype(float).round(1).tolist()
    [10.5, 10.4]
    """
    pd = load_pandas()
    setup = chwa2019_experiment("IV.A")
    if not len(decibels) or not len(windows):
        raise ValueError(f"{len(decibels)} decibels and {len(windows)} windows: at least one of each is needed")
    for begin, end in windows:
        if not 0 <= begin < end < np.inf:
            raise ValueError(f"a window is {begin} to {end} s; give two times from 0 on, the earlier one first")
    rows = []
    for ratio in decibels:
        camera = ScaledDepthCamera(pixels=CHWA_CAMERA, ratio=SignalToNoise(ratio), depth=depth)
        recording = record(setup, max(end for _, end in windows), camera, seed)
        entrants = competitors(recording)
        for name in entrants if observers is None else observers:
            if name not in entrants:
                raise ValueError(f"{name!r} is none of the competitors; they are {', '.join(entrants)}")
            seen, observer = entrants[name]
            run = track(seen, observer, hold="first", step=1e-3)
            for begin, end in windows:
                found = run.estimate[(run.time >= begin) & (run.time <= end), 3]
                there = found[np.isfinite(found)]
                scatter = (there.mean(), there.std()) if len(there) else (np.nan, np.nan)
                rows.append((name, ratio, begin, end, *scatter, 1 - len(there) / len(found), setup.scale))
    return pd.DataFrame(rows, columns=["observer", "decibels", "begin", "end", "mean", "std", "missing", "true"])
