"""Sentences of Python on a run: excitation, error dynamics, bias by noise, consistency of a filter."""

from collections.abc import Callable
from functools import lru_cache, reduce

import numpy as np
import sympy as sp
from scipy.linalg import expm

from percept_obs.compile import vectorised
from percept_obs.observability import error_gramian
from percept_obs.observers import Observer
from percept_obs.observers.parts import hats
from percept_obs.recording import Recording
from percept_obs.studies.consistency import check_consistency
from percept_obs.system.forms import PartitionedSystem
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import number

INSTANTS = 200
"""Largest number of instants of the window at which the error dynamics are linearised."""

Chosen = tuple[Observer, str]
"""An observer with its default gains, and its way to switch."""


def excitation_in_words(form: PartitionedSystem, recording: Recording, window: float) -> list[str]:
    """Sentences on the coordinates that outputs show in windows of this length, in seconds, with dynamics counted."""
    if form.culprits:
        return [f"There is no canonical form, and so no w: {', '.join(form.culprits)} do not enter linearly."]
    if recording.truth is None:
        return []
    shown = error_gramian(recording, form, window)
    counted = "With the dynamics counted, the outputs of"
    if shown.holds:
        return [f"{counted} each window of {window:g} s show all of {', '.join(shown.names)}."]
    lost, begin = shown.lost(), shown.time[shown.weakest]
    missed = [direction if direction in shown.names else f"the direction {direction}" for direction in lost]
    told = [name for name in shown.names if not any(name in direction.split() for direction in lost)]
    rest = f" They show {' and '.join(told)}." if told else ""
    return [
        f"{counted} the {window:g} s that begin at {begin:.3g} s do not show {' and '.join(missed)}: "
        f"no observer can find it there.{rest}"
    ]


def has_words(chosen: Chosen) -> bool:
    """Return True if there are sentences on an observer, so that it is worth the seconds of a run in Python."""
    observer, _ = chosen
    return observer.covariance is not None or observer.fastest is not None or _can_be_linearised(chosen)


def run_in_words(chosen: Chosen, run: Run, window: float) -> list[str]:
    """Sentences on an observer's run; none where it diverged."""
    if run.diverged_at is not None:
        return []
    if run.recording.truth is None:
        sentences = [f"{run.observer.name}: {run.trust().sentence}"]
        return [*sentences, _consistency_in_words(run)] if run.observer.covariance is not None else sentences
    if run.observer.covariance is not None:
        spread = f"{2 * np.sqrt(max(0.0, run.covariance[-1, -1, -1])):.2g} (2σ) at the end"
        claim = f"{run.observer.name}: it claims to know the inverse distance to within {spread}."
        return [claim, _consistency_in_words(run)]
    if not _can_be_linearised(chosen):
        return []
    return _error_in_words(chosen, run, window)


def _consistency_in_words(run: Run) -> str:
    if not np.isfinite(run.nis).any():
        return f"{run.observer.name}: there is no complete sample besides its start to test its innovations by."
    found = check_consistency(run, samples=1)
    return f"{run.observer.name}: it is {found.summary}."


def _can_be_linearised(chosen: Chosen) -> bool:
    """Return True if the estimate is a part of the state, and the flow smooth where the error is zero."""
    observer, way = chosen
    form = observer.form
    estimate = hats((*form.x1, *form.x2))
    return observer.equations.state[: len(estimate)] == estimate and way != "sign"


@lru_cache
def _at_the_truth(chosen: Chosen) -> Callable[..., list[np.ndarray]]:
    """The flow's Jacobian, and its derivative by noise_variance, where the estimate is the truth."""
    observer, _ = chosen
    form, equations = observer.form, observer.equations
    truth = (*form.x1, *form.x2)
    estimate = equations.state[: len(truth)]
    flow = sp.ImmutableMatrix(equations.flow[: len(truth)])
    variance = next((gain.symbol for gain in observer.gains if gain.name == "noise_variance"), sp.Dummy())
    found = [*flow.jacobian(estimate), *flow.diff(variance)]
    there = dict(zip(estimate, truth, strict=True))
    symbols = (*truth, *equations.state[len(truth) :], *form.parameters, *equations.gains)
    return vectorised(symbols, [entry.subs(there, simultaneous=True) for entry in found])


def _error_in_words(chosen: Chosen, run: Run, window: float) -> list[str]:
    """Sentences on the growth of a small error and its bias by noise, from the flow linearised at the truth."""
    observer, recording = run.observer, run.recording
    assert recording.truth is not None
    names = [s.name for s in observer.form.coordinates]
    order = [names.index(name) for name in (*observer.form.measured, *observer.form.hidden)]
    size = len(names)
    late = np.flatnonzero(run.time >= run.time[-1] - window)
    at = late[np.unique(np.linspace(0, len(late) - 1, INSTANTS).astype(int))]
    known = np.broadcast_to(recording.motion.known(run.time[at]), (len(at), 12))
    shape = [recording.view.values[s] for s in recording.view.parameters]
    gains = {gain.name: gain.value for gain in observer.gains}
    others = run.state[at, size:]
    entries = _at_the_truth(chosen)(*recording.truth[at][:, order].T, *others.T, *known.T, *shape, *gains.values())
    J = np.stack(entries[: size**2], axis=-1).reshape(-1, size, size)
    with np.errstate(all="ignore"):  # what grows beyond all numbers is said so below
        steps = expm(J[:-1] * np.diff(run.time[at])[:, None, None])
        carried = np.eye(size) if not len(steps) else reduce(lambda before, step: step @ before, steps)
    factor = float(np.linalg.norm(carried, 2)) if np.isfinite(carried).all() else np.inf
    roots = ", ".join(f"{root if root.imag else root.real:.3g}" for root in np.linalg.eigvals(J[-1]))
    share = number(factor, 2)
    does = "keeps its size" if share == "1" else f"{'shrinks' if factor < 1 else 'may grow'} to {share} of its size"
    sentences = [
        f"{observer.name}: its error dynamics end with the eigenvalues {roots} per second; over the last {window:g} s "
        f"a small error {does}."
    ]
    left = gains.get("noise_variance", 0.0) - (recording.effective_variance or 0.0)
    push = left * np.array([entry[-1] for entry in entries[size**2 :]])
    if np.abs(push).max() > 0:
        name, size_of = names[order[int(np.abs(push).argmax())]], push[np.abs(push).argmax()]
        sentences.append(
            f"{observer.name}: at the end noise pushes the estimate of {name} by {size_of:.2g} per second on average; "
            f"noise_variance takes it out where it equals that of the noise, {recording.effective_variance or 0.0:.3g}."
        )
    return sentences
