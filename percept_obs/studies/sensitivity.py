"""Sensitivity of an observer's estimate to each entry of the motion that it believes in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.compile import Array
from percept_obs.compile.variation import slope, slopes, variation
from percept_obs.observers.base import Observer
from percept_obs.recording import Recording
from percept_obs.system.motion import TIME, Motion
from percept_obs.system.signal import Signal
from percept_obs.system.view import refuse_several
from percept_obs.tracking.following import track
from percept_obs.tracking.run import Run
from percept_obs.validation import checked, once

SHARE = 0.01
"""Default error of an entry, as a share of the motion's size."""


@checked
@dataclass(frozen=True, eq=False, repr=False)
class Sensitivity:
    """Derivatives of an estimate with respect to entries of the believed motion.

    Parameters
    ----------
    run : Run
        With the motion as it is believed.
    entries : tuple of str
        Names of q entries, such as "a13", "b3" or "w_c2".
    derivatives : array of shape (K, n, q)
        Of the estimates at the samples; NaN where there is no estimate.
    sizes : array of shape (q,)
        Root mean square over the run of the motion's size: of A in 1/s for its entries, of b in m/s for those of b.

    See Also
    --------
    sensitivity : Computes it.
    percept_obs.figures.entries : Draws it.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ibo, pinhole, record, scenarios
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> found = sensitivity(record(scenarios.ma2005_eq35(), 5), ibo(form), entries=("a13", "b3"))
    >>> {name: round(share, 4) for name, share in found.ranking().items()}
    {'a13': 0.0815, 'b3': 0.0033}
    """

    run: Run
    entries: tuple[str, ...]
    derivatives: Array
    sizes: Array

    def change(self, **errors: float) -> Array:
        """Change of the estimates, to first order, when entries are believed larger by so much, shape (K, n)."""
        if unknown := sorted(set(errors) - set(self.entries)):
            raise ValueError(f"the sensitivity has no entry {', '.join(unknown)}; it has {', '.join(self.entries)}")
        if not np.isfinite([*errors.values()]).all():
            raise ValueError(f"the errors are {errors}; give finite ones")
        return np.asarray(self.derivatives @ [errors.get(name, 0.0) for name in self.entries])

    def distance_change(self, share: float = SHARE) -> Array:
        """Relative change of the distance when each entry is off by a share of the motion's size, shape (K, q)."""
        if not abs(share) <= 1:
            raise ValueError(f"share is {share}; it is a part of the motion's size, at most all of it: was it in %?")
        view = self.run.view
        inverse = view.inverse(self.run.estimate)
        slope_of_inverse = np.stack([view.inverse(each) for each in np.moveaxis(self.derivatives, -1, 0)], axis=-1)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(-slope_of_inverse * share * self.sizes / inverse[:, None])

    def ranking(self) -> dict[str, float]:
        """Entries with the median size of their `distance_change` over the last half of the run, the largest first."""
        late = np.abs(self.distance_change()[len(self.run.time) // 2 :])
        medians = [float(np.median(column[np.isfinite(column)])) for column in late.T]
        order = np.argsort(medians)[::-1]
        return {self.entries[k]: medians[k] for k in order}

    def __repr__(self) -> str:
        largest = ", ".join(f"{name} {100 * value:.2g} %" for name, value in list(self.ranking().items())[:3])
        return (
            f"<Sensitivity of the {self.run.observer.name} observer to {len(self.entries)} entries; {100 * SHARE:g} % "
            f"of the motion's size in one moves the distance most for {largest}>"
        )


@checked
def sensitivity(
    recording: Recording,
    observer: Observer,
    start: Any = None,
    entries: Sequence[str] | None = None,
    **settings: Any,
) -> Sensitivity:
    """Return the derivative of an observer's estimate with respect to entries of the motion, along a run.

    The variational equations are integrated: the observer's flow, measurement update, reset, start and estimate,
    each differentiated.

    Parameters
    ----------
    recording : Recording
    observer : Observer
    start : see `track`
    entries : sequence of str, optional
        Such as "a13", "b3" or "w_c2"; every entry of the motion when left out.
    **settings
        Passed to `track`, such as ``hold``.

    Raises
    ------
    ValueError
        If the motion has no such entry, or none at all, or no entry or one twice is named.
    DoesNotFit
        If the observer cannot follow the recording.

    See Also
    --------
    misbelieved : a motion with wrong entries, to compare with
    percept_obs.figures.entries : draws the entries that matter most

    Notes
    -----
    Where an observer switches by a sign, or a change of the motion moves a reset, a first derivative predicts little.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ibo, pinhole, record, scenarios
    >>> from percept_obs.studies.sensitivity import sensitivity
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> found = sensitivity(record(scenarios.ma2005_eq35(), 5), ibo(form), entries=("a13", "b3"))
    >>> found.derivatives.shape
    (501, 3, 2)
    """
    refuse_several("the observer", recording.view)
    if entries is not None and not len(entries):
        raise ValueError("the sensitivity has no entry; name some, such as 'b3', or leave entries out for all")
    once(entries=[] if entries is None else entries)
    motion = recording.motion
    moved = _moved(motion, entries)
    run = track(recording, observer, start, **settings)
    form, eq = observer.form, observer.equations
    others = form.parameters[len(motion.parameters) :]
    known = (*motion.parameters, *slopes(moved), *others)
    varied = replace(
        observer,
        form=replace(form, parameters=known),
        equations=replace(variation(eq, moved), parameters=known),
        start=(*observer.start, *slope(observer.start, moved)),
        estimate=slope(observer.estimate, (*eq.state, *moved)),
        covariance=None,
        unobservable=(),
        fastest=None,
    )
    runs = []
    for direction in np.eye(len(moved)):  # the changes of the entries are further parameters of the motion
        signal = _mapped(motion, partial(_with_columns, direction))
        changed = replace(motion, parameters=(*motion.parameters, *slopes(moved)), signal=signal)
        runs.append(track(recording, varied, start, believed=changed, **settings))
    of_unit = [recording.unit ** motion.lengths[motion.parameters.index(symbol)] for symbol in moved]
    derivatives = np.stack([each.estimate for each in runs], axis=-1) / of_unit
    derivatives[np.isnan(run.estimate)] = np.nan
    return Sensitivity(run, tuple(symbol.name for symbol in moved), derivatives, _sizes(motion, moved, recording.time))


@checked
def misbelieved(motion: Motion, **errors: float) -> Motion:
    """Return the motion with some entries larger by so much at all times.

    Parameters
    ----------
    motion : Motion
        With numbers.
    **errors : float
        By names of entries, such as ``b3=0.006``.

    Raises
    ------
    ValueError
        If the motion has no such entry.

    See Also
    --------
    sensitivity : To first order, without a second run.

    Examples
    --------
    >>> from percept_obs import scenarios
    >>> from percept_obs.studies.sensitivity import misbelieved
    >>> b3 = misbelieved(scenarios.ma2005_eq35().motion, b3=0.006).values
    >>> [round(value, 4) for symbol, value in b3.items() if symbol.name == "b3"]
    [0.306]
    """
    moved = _moved(motion, tuple(errors))
    change = np.array([errors[s.name] if s in moved else 0.0 for s in motion.parameters])
    return replace(motion, signal=_mapped(motion, partial(np.add, change)))


def _moved(motion: Motion, entries: Sequence[str] | None) -> tuple[sp.Symbol, ...]:
    """The entries' symbols."""
    there = {symbol.name: symbol for symbol in motion.parameters if symbol != TIME}
    if not there or motion.signal is None:
        raise ValueError(f"the {motion.name} motion has no entries with numbers that could be wrong; give it some")
    names = [*there] if entries is None else list(entries)
    unknown = [name for name in names if name not in there]
    if unknown or not names:
        said = ", ".join(unknown) or "to err, for none is named"
        raise ValueError(f"the {motion.name} motion has no entry {said}; it has {', '.join(there)}")
    return tuple(there[name] for name in names)


def _mapped(motion: Motion, of: Any) -> Signal:
    assert motion.signal is not None
    return motion.signal.mapped(of)


def _with_columns(more: Array, rows: Array) -> Array:
    return np.hstack([rows, np.tile(more, (len(rows), 1))])


def _sizes(motion: Motion, moved: Sequence[sp.Symbol], time: Array) -> Array:
    """Root mean square over time of the norm of A, or of b, for each entry of it."""
    rows = motion.known(time)
    in_A = np.array([symbol in motion.A.free_symbols for symbol in motion.parameters])
    sizes = {group: float(np.sqrt((rows[:, in_A == group] ** 2).sum(axis=1).mean())) for group in (True, False)}
    return np.array([sizes[symbol in motion.A.free_symbols] for symbol in moved])
