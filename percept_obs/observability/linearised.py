"""The system linearised along a true trajectory: how small errors of the coordinates move from sample to sample."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import sympy as sp

from percept_obs.compile import Array, Flags, Indices, vectorised
from percept_obs.compile.integrator import LONGEST_STEP, step_along
from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.tracking.following import require_match
from percept_obs.validation import limit

System = PartitionedSystem | PerspectiveSystem
Doubt = float | Mapping[str, float]
Rate = Callable[[Array, Array], Array]


@dataclass(frozen=True, eq=False)
class Linearised:
    """Small errors e of coordinates along a recording's truth: e(t_k+1) = Phi_k e(t_k) + noise of covariance Q_k."""

    measured: Indices  # (m,), positions of the measured coordinates
    seen: Flags  # (K, m), measured outputs that were sampled
    transitions: Array  # (K - 1, n, n), Phi_k, in the order of the form's coordinates
    spreads: Array  # (K - 1, n, n), Q_k, from doubts in the motion


def names_of(form: PartitionedSystem) -> tuple[str, ...]:
    """Names of a form's coordinates, in its order."""
    return tuple(symbol.name for symbol in form.coordinates)


def positions(form: PartitionedSystem, names: tuple[str, ...]) -> Indices:
    """Positions of named coordinates among those of a form."""
    return np.array([names_of(form).index(name) for name in names], dtype=int)


def outputs_of(form: PartitionedSystem, recording: Recording) -> Array:
    """Samples of the outputs that a form measures, shape (K, m)."""
    return recording.outputs[:, [recording.names.index(name) for name in form.measured]]


def as_form(system: System) -> PartitionedSystem:
    """Return the form itself, or a perspective system's with all image coordinates measured."""
    if isinstance(system, PartitionedSystem):
        return system
    return system.partition(*(symbol.name for symbol in system.surface.image_coordinates))


def matching_form(system: System, recording: Recording) -> PartitionedSystem:
    """Return the form of a system; raise ValueError if it does not fit the recording, or that has no truth."""
    form = as_form(system)
    if recording.truth is None or not np.isfinite(recording.truth).all():
        raise ValueError(
            "the recording has no truth at all of its samples; what can be known is asked along a true trajectory: "
            "simulate one with record(scenario), or cut the recording with between(begin, end)"
        )
    require_match(form, recording, recording.motion)
    return form


def linearised(
    form: PartitionedSystem, recording: Recording, doubt: Doubt = 0.0, longest: float = LONGEST_STEP
) -> Linearised:
    """Linearise a form along the truth of a recording that it fits, with steps up to the longest one in seconds."""
    n, lengths = len(form.coordinates), np.diff(recording.time)
    # as many steps between all samples, so that all intervals are integrated side by side
    count = max(1, int(np.ceil(lengths.max() / longest - 1e-4)))
    limit(len(lengths) * count * n, f"numbers, from {count} steps between two samples", "take longer steps")
    assert recording.truth is not None
    f = rate_of(form)
    rates = values_along(form, recording, [*f, *f.jacobian(form.coordinates), *_spread(form, f, doubt, recording)])
    h = lengths / count
    # state, transition and spread are integrated together: x' = f, Phi' = F Phi, S' = F S + S F^T + Q
    whole = np.zeros((len(lengths), n, 2 * n + 1))
    whole[:, :, 0], whole[:, :, 1 : n + 1] = recording.truth[:-1], np.eye(n)

    def moving(times: Array, whole: Array) -> Array:
        values = rates(times, whole[:, :, 0])
        F, Q = values[:, n:].reshape(-1, 2, n, n).swapaxes(0, 1)
        turned = F @ whole[:, :, n + 1 :]
        spread = turned + np.swapaxes(turned, 1, 2) + Q
        return np.concatenate([values[:, :n, None], F @ whole[:, :, 1 : n + 1], spread], axis=2)

    for k in range(count):
        whole = step_along(whole, recording.time[:-1] + k * h, h, moving)
    seen = np.isfinite(outputs_of(form, recording))
    return Linearised(positions(form, form.measured), seen, whole[:, :, 1 : n + 1], whole[:, :, n + 1 :])


def rate_of(form: PartitionedSystem) -> sp.ImmutableMatrix:
    """The rate in the order of the form's coordinates."""
    by_name = dict(zip((*form.x1, *form.x2), form.rate, strict=True))
    return sp.ImmutableMatrix([by_name[symbol] for symbol in form.coordinates])


def values_along(form: PartitionedSystem, recording: Recording, expressions: list[sp.Expr]) -> Rate:
    """Values of expressions, one a column, as a function of times (T,) and coordinates (T, n) in the known motion."""
    evaluate = vectorised((*form.coordinates, *form.parameters), expressions)
    surface = [recording.view.values[symbol] for symbol in recording.view.parameters]
    return lambda times, states: np.stack(evaluate(*states.T, *recording.motion.known(times).T, *surface), axis=-1)


def _spread(
    form: PartitionedSystem, rate: sp.ImmutableMatrix, doubt: Doubt, recording: Recording
) -> sp.ImmutableMatrix:
    """Covariance per second that a doubt adds to the coordinates."""
    x = form.coordinates
    each = [] if isinstance(doubt, Mapping) else (doubt / recording.scale**2).tolist()
    doubts = doubt if isinstance(doubt, Mapping) else dict(zip(names_of(form), each, strict=True))
    known = {symbol.name: symbol for symbol in (*x, *form.parameters)}
    unknown = [name for name in doubts if name not in known]
    if unknown:
        raise ValueError(f"there is no {', '.join(unknown)} to doubt; there are {', '.join(known)}")
    total = sp.zeros(len(x), len(x))
    for name, variance in doubts.items():
        if not 0 <= variance < np.inf:
            raise ValueError(f"the doubt in {name} is {variance}; it is a variance a second, finite and not negative")
        symbol = known[name]
        # noise in a coordinate's rate acts on it alone, in a parameter on whatever rate depends on it
        column = sp.Matrix([int(symbol == s) for s in x]) if symbol in x else rate.diff(symbol)
        total += sp.Float(variance) * column * column.T
    return total
