"""The system linearised along a trajectory: where it leads from sample to sample, and how small errors move."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import sympy as sp

from percept_obs.compile import Array, Flags, Indices, vectorised
from percept_obs.compile.integrator import LONGEST_STEP, step_along
from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.state_view import StateView
from percept_obs.validation import limit

Doubt = float | Mapping[str, float]
Rate = Callable[[Array, Array], Array]


@dataclass(frozen=True, eq=False)
class Linearised:
    """Small errors e of states at samples: e(t_k+1) = Phi_k e(t_k) + noise of covariance Q_k."""

    measured: Indices  # (m,), positions of the measured coordinates
    seen: Flags  # (K, m), measured outputs that were sampled
    arrivals: Array  # (K - 1, n), where each state but the last is at the next sample
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


def linearisation(
    form: PartitionedSystem, recording: Recording, doubt: Doubt = 0.0, longest: float = LONGEST_STEP
) -> Callable[[Array], Linearised]:
    """Return a function of states at a recording's samples, shape (K, n), such as its truth, that linearises there.

    Steps are up to the longest one in seconds.
    """
    n, lengths = len(form.coordinates), np.diff(recording.time)
    # as many steps between all samples, so that all intervals are integrated side by side
    count = max(1, int(np.ceil(lengths.max() / longest - 1e-4)))
    limit(len(lengths) * count * n, f"numbers, from {count} steps between two samples", "take longer steps")
    each = {} if isinstance(doubt, Mapping) else dict(zip(names_of(form), doubt / recording.scale**2, strict=True))
    doubts = {name: value for name, value in (doubt if isinstance(doubt, Mapping) else each).items() if value != 0}
    for name, variance in doubts.items():
        if not 0 <= variance < np.inf:
            raise ValueError(f"the doubt in {name} is {variance}; it is a variance a second, finite and not negative")
    sizes, rates = np.sqrt([*doubts.values()]), values_along(form, recording, [*_expressions(form, tuple(doubts))])
    h, seen = lengths / count, np.isfinite(outputs_of(form, recording))

    def moving(times: Array, whole: Array) -> Array:
        values = rates(times, whole[:, :, 0])
        F = values[:, n : n + n * n].reshape(-1, n, n)
        moved = values[:, n + n * n :].reshape(len(values), n, len(sizes)) * sizes
        turned = F @ whole[:, :, n + 1 :]
        spread = turned + np.swapaxes(turned, 1, 2) + moved @ np.swapaxes(moved, 1, 2)
        return np.concatenate([values[:, :n, None], F @ whole[:, :, 1 : n + 1], spread], axis=2)

    def linearised(states: Array) -> Linearised:
        # state, transition and spread are integrated together: x' = f, Phi' = F Phi, S' = F S + S F^T + Q
        whole = np.zeros((len(lengths), n, 2 * n + 1))
        whole[:, :, 0], whole[:, :, 1 : n + 1] = states[:-1], np.eye(n)
        for k in range(count):
            whole = step_along(whole, recording.time[:-1] + k * h, h, moving)
        arrivals, transitions, spreads = np.split(whole, [1, n + 1], axis=2)
        return Linearised(positions(form, form.measured), seen, arrivals[:, :, 0], transitions, spreads)

    return linearised


def rate_of(form: PartitionedSystem) -> sp.ImmutableMatrix:
    """The rate in the order of the form's coordinates."""
    by_name = dict(zip((*form.x1, *form.x2), form.rate, strict=True))
    return sp.ImmutableMatrix([by_name[symbol] for symbol in form.coordinates])


def values_along(form: PartitionedSystem, recording: Recording, expressions: list[sp.Expr]) -> Rate:
    """Values of expressions, one a column, as a function of times (T,) and coordinates (T, n) in the known motion."""
    evaluate = vectorised((*form.coordinates, *form.parameters), expressions)
    surface = [recording.view.values[symbol] for symbol in recording.view.parameters]
    return lambda times, states: np.stack(evaluate(*states.T, *recording.motion.known(times).T, *surface), axis=-1)


@lru_cache(maxsize=64)  # a smoother asks for the same again and again
def _expressions(form: PartitionedSystem, doubts: tuple[str, ...]) -> tuple[sp.Expr, ...]:
    """The rate, its Jacobian, and how noise in the doubted coordinates' rates and parameters moves the coordinates."""
    x, rate = form.coordinates, rate_of(form)
    view = form.view if isinstance(form.view, StateView) else None
    states = {} if view is None else {s.name: s for s in view.state}
    known = states | {symbol.name: symbol for symbol in (*x, *form.parameters)}
    unknown = [name for name in doubts if name not in known]
    if unknown:
        raise ValueError(f"there is no {', '.join(unknown)} to doubt; there are {', '.join(known)}")

    def moved(symbol: sp.Symbol) -> sp.Matrix:
        """Return what noise adds to the coordinates' rates: in a parameter, a coordinate, or a state of the view."""
        if symbol in form.parameters:
            return rate.diff(symbol)
        if view is None or symbol in x:
            return sp.Matrix([int(symbol == s) for s in x])
        back = dict(zip(view.state, view.back, strict=True))
        return sp.Matrix([view.formulas[s].diff(symbol).subs(back, simultaneous=True) for s in x])

    columns = [moved(known[name]) for name in doubts]
    return (*rate, *rate.jacobian(x), *sp.Matrix.hstack(sp.zeros(len(x), 0), *columns))
