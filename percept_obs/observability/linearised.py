"""The system linearised along a true trajectory: how small errors of the coordinates move from sample to sample."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import sympy as sp

from percept_obs.compile import Array, Flags, Indices, vectorised
from percept_obs.compile.integrator import INSTANTS, LONGEST_STEP, step
from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.validation import limit

System = PartitionedSystem | PerspectiveSystem
Doubt = float | Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Linearised:
    """Small errors e of the coordinates along a recording's truth: e(t_k+1) = Phi_k e(t_k) + noise of covariance Q_k.

    Parameters
    ----------
    form : PartitionedSystem
    recording : Recording
    transitions : array of shape (K - 1, n, n)
        Phi_k, in the order of the form's coordinates.
    spreads : array of shape (K - 1, n, n)
        Q_k, what a doubt in the motion adds.
    """

    form: PartitionedSystem
    recording: Recording
    transitions: Array
    spreads: Array

    @property
    def measured(self) -> Indices:
        """Which of the coordinates are measured, shape (m,)."""
        return places(self.form, self.form.measured)

    @property
    def seen(self) -> Flags:
        """Which measured outputs were sampled, shape (K, m)."""
        columns = [self.recording.names.index(name) for name in self.form.measured]
        return np.isfinite(self.recording.outputs[:, columns])


def places(form: PartitionedSystem, names: tuple[str, ...]) -> Indices:
    """Where coordinates stand among those of a form."""
    known = [symbol.name for symbol in form.coordinates]
    return np.array([known.index(name) for name in names], dtype=int)


def as_form(system: System) -> PartitionedSystem:
    """The form itself, or a perspective system's with all image coordinates measured."""
    if isinstance(system, PartitionedSystem):
        return system
    return system.partition(*(symbol.name for symbol in system.surface.image_coordinates))


def fitting(system: System, recording: Recording) -> PartitionedSystem:
    """The form of a system, for a recording with a truth.

    Raises
    ------
    ValueError
        If they do not fit each other, or the recording has no truth.
    """
    form = as_form(system)
    if recording.truth is None or not np.isfinite(recording.truth).all():
        raise ValueError(
            "the recording has no truth at all of its samples; what can be known is asked along a true trajectory: "
            "simulate one with record(scenario), or cut the recording with between(begin, end)"
        )
    if form.view is None or not form.view.fits(recording.view):
        name = "no view" if form.view is None else f"the {form.view.name}"
        raise ValueError(f"the system is seen on {name}, the recording on the {recording.view.name}; use the same view")
    missing = [name for name in form.measured if name not in recording.names]
    if missing:
        raise ValueError(
            f"the system measures {', '.join(missing)}, but the recording has {', '.join(recording.names)}"
        )
    expected = (*recording.motion.parameters, *recording.view.parameters)
    if form.parameters != expected:
        raise ValueError(
            f"the system was derived for a motion with {', '.join(map(str, form.parameters)) or 'numbers only'}, the "
            f"recording's has {', '.join(map(str, expected)) or 'numbers only'}; use the same kind of motion for both"
        )
    return form


def linearised(
    form: PartitionedSystem, recording: Recording, doubt: Doubt = 0.0, longest: float = LONGEST_STEP
) -> Linearised:
    """Linearise a form along the truth of a recording that fits it, by its own flow from sample to sample.

    Parameters
    ----------
    form, recording
        As from `fitting`.
    doubt : float or mapping of names to floats
        See `cramer_rao`.
    longest : float
        Longest step in seconds.
    """
    n, lengths = len(form.coordinates), np.diff(recording.time)
    count = max(1, int(np.ceil(lengths.max() / longest - 1e-4)))
    limit(len(lengths) * count * n, f"numbers, from {count} steps between two samples", "take longer steps")
    assert recording.truth is not None
    h, rate = lengths / count, _rates_along(form, recording, doubt)
    state = np.zeros((len(lengths), n, 2 * n + 1))
    state[:, :, 0], state[:, :, 1 : n + 1] = recording.truth[:-1], np.eye(n)
    for k in range(count):
        begins = recording.time[:-1] + k * h

        def moving(instant: int, state: Array, begins: Array = begins) -> Array:
            f, F, Q = rate(begins + float(INSTANTS[instant]) * h, state[:, :, 0])
            Phi, spread = state[:, :, 1 : n + 1], state[:, :, n + 1 :]
            turned = F @ spread
            return np.concatenate([f[:, :, None], F @ Phi, turned + np.swapaxes(turned, 1, 2) + Q], axis=2)

        state = step(state, h[:, None, None], moving)
    return Linearised(form, recording, state[:, :, 1 : n + 1], state[:, :, n + 1 :])


def flow_along(form: PartitionedSystem, recording: Recording) -> Callable[[Array, Array], Array]:
    """The rate, shape (T, n), as a function of times (T,) and coordinates (T, n), with a recording's known motion."""
    return _along(form, recording, list(rate_of(form)))


def _rates_along(
    form: PartitionedSystem, recording: Recording, doubt: Doubt
) -> Callable[[Array, Array], tuple[Array, Array, Array]]:
    """The same with the rate's Jacobian and a doubt's spread a second, both of shape (T, n, n)."""
    rate, n = rate_of(form), len(form.coordinates)
    at = _along(form, recording, [*rate, *rate.jacobian(form.coordinates), *_spread(form, rate, doubt)])

    def parts(times: Array, states: Array) -> tuple[Array, Array, Array]:
        f, F, Q = np.split(at(times, states), [n, n + n * n], axis=1)
        return f, F.reshape(-1, n, n), Q.reshape(-1, n, n)

    return parts


def rate_of(form: PartitionedSystem) -> sp.ImmutableMatrix:
    """The rate in the order of the form's coordinates."""
    by_name = dict(zip((*form.x1, *form.x2), form.rate, strict=True))
    return sp.ImmutableMatrix([by_name[symbol] for symbol in form.coordinates])


def _along(
    form: PartitionedSystem, recording: Recording, expressions: list[sp.Expr]
) -> Callable[[Array, Array], Array]:
    """Values of expressions, one a column, as a function of times and coordinates."""
    evaluate = vectorised((*form.coordinates, *form.parameters), expressions)
    surface = [recording.view.values[symbol] for symbol in recording.view.parameters]
    return lambda times, states: np.stack(evaluate(*states.T, *recording.motion.known(times).T, *surface), axis=-1)


def _spread(form: PartitionedSystem, rate: sp.ImmutableMatrix, doubt: Doubt) -> sp.ImmutableMatrix:
    """Covariance that a doubt adds to the coordinates a second."""
    n, x = len(rate), form.coordinates
    if not isinstance(doubt, Mapping):
        _refuse_no_variance("the doubt", doubt)
        return sp.Float(doubt) * sp.eye(n)
    known = {symbol.name: symbol for symbol in (*x, *form.parameters)}
    unknown = [name for name in doubt if name not in known]
    if unknown:
        raise ValueError(f"there is no {', '.join(unknown)} to doubt; there are {', '.join(known)}")
    total = sp.zeros(n, n)
    for name, variance in doubt.items():
        _refuse_no_variance(f"the doubt in {name}", variance)
        symbol = known[name]
        column = sp.Matrix([int(symbol == s) for s in x]) if symbol in x else rate.diff(symbol)
        total += sp.Float(variance) * column * column.T
    return total


def _refuse_no_variance(what: str, value: float) -> None:
    if not (np.isfinite(value) and value >= 0):
        raise ValueError(f"{what} is {value}; it is a variance a second, finite and not negative")
