"""Inaba, Abdursul and Ghosh 2005, section 3: Theorem 3.4, on runs of examples."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from percept_obs.papers.base import less, reader, separates, vectors
from percept_obs.papers.entries import Finding, Known, Printed, Verdict, at, judged
from percept_obs.papers.scalars import Norm
from percept_obs.points import (
    LyapunovMatrix,
    PointsForm,
    PointsRun,
    PointsScenario,
    constant,
    luenberger,
    scheduled,
)
from percept_obs.points.gramian import Gramian, gramian
from percept_obs.points.scenarios import moving_body
from percept_obs.recording import Camera, record
from percept_obs.system.motion import TIME, linear
from percept_obs.tracking import track

Array = NDArray[np.float64]

WINDOW = 8.0
"""T of (14), in seconds."""

PERIOD = 0.01
"""Seconds between the times at which integrals are sampled."""

DURATION = 40.0
"""Seconds that each example lasts."""

# Numbers
t, t0 = sp.symbols("t t0", real=True)
alpha, beta = sp.symbols("alpha beta", positive=True)

# Vectors and matrices
n, p = sp.symbols("n p", integer=True, positive=True)
rho, rho0 = vectors("rho rho0", n)
y = sp.MatrixSymbol("y", 2 * p, 1)


SIDEWAYS = sp.Matrix([2 * sp.sin(TIME), 2])
WEAKENING = sp.ImmutableMatrix(-sp.eye(2) / (2 * (1 + TIME)))
ERROR = (0.3, -0.2, 0.5, 0.2, -0.1, 0.3)
"""rho at the start, as far as there are states."""

body = cache(moving_body)


@cache
def fading() -> PointsScenario:
    """A point that is kept at (2 sin t, 0, 2) while A = -I / (2 (1 + t)), and P = (1 + t) I meets (15)."""
    motion = linear(WEAKENING, SIDEWAYS.diff(TIME) - WEAKENING * SIDEWAYS)
    return PointsScenario("fading", PointsForm(motion, [[[1, 0], [0, 0], [0, 1]]]), (0.0, 2.0), DURATION)


@cache
def followed(scenario: PointsScenario, P: LyapunovMatrix | None = None, off: tuple[float, ...] = ERROR) -> PointsRun:
    """An example, seen exactly, from a start that is off by this; P is the identity when left out."""
    recording = record(scenario, DURATION, Camera(PERIOD))
    start = [x - e for x, e in zip(scenario.state, off, strict=False)]
    run = track(recording, luenberger(scenario.form, P or constant()), start, hold="first")
    assert isinstance(run, PointsRun)
    return run


@cache
def gathered(scenario: PointsScenario) -> Gramian:
    """(14) over all windows of an example."""
    return gramian(followed(scenario).recording, WINDOW)


@cache
def transition(A: sp.ImmutableMatrix) -> Array:
    """Phi(t, 0) at the samples, shape (K, n, n): states that nothing drives, from unit starts."""
    n, time = A.rows, np.arange(0, DURATION + PERIOD / 2, PERIOD)
    side_by_side = linear(sp.diag(*[A] * n), sp.zeros(n * n, 1))
    form = PointsForm(side_by_side, [np.kron(unit, np.eye(3)[:, -n:]) for unit in np.eye(n)])
    columns = PointsScenario("unit starts", form, np.eye(n).ravel().tolist(), DURATION).coordinates(time)
    return columns.reshape(-1, n, n).transpose(0, 2, 1)


def on_both_examples(printed: Printed) -> Finding:
    """(13): the largest image coordinates of both examples."""
    (line,) = printed
    images = [record(scenario, 20.0, Camera(PERIOD)).outputs for scenario in map(body, (1, 2))]
    largest = [float(np.linalg.norm(of_one, axis=-1).max()) for of_one in images]
    holds = all(separates(line, Norm(y), size, math.inf, {}) for size in largest)
    return judged(holds, Verdict.FALSE, {"largest |y(k)|, one point": largest[0], "two points": largest[1]})


def exponential(printed: Printed) -> Finding:
    """Theorem 3.4 (ii): both examples keep the bound with an alpha just below their rate, and need its beta."""
    (line,) = printed
    numbers: dict[str, float] = {}
    outcomes = []
    for name, scenario in (("one point", body(1)), ("two points", body(2))):
        run = followed(scenario)
        sizes, fitted = run.deviation, run.decay_rate(10, 40)
        numbers |= {f"least of (14), {name}": gathered(scenario).least, f"decay from 10 s on in 1/s, {name}": fitted}
        slow = 0.9 * fitted
        factor = float((sizes * np.exp(slow * run.time)).max() / sizes[0])
        chosen = [0, len(sizes) // 2, len(sizes) - 1, int((sizes * np.exp(slow * run.time)).argmax())]
        for share, kept in ((1.0001, sp.true), (0.999, sp.false)):
            here = [
                line.xreplace({Norm(rho): sp.Float(sizes[k]), Norm(rho0): sp.Float(sizes[0])}).subs(
                    {alpha: slow, beta: share * factor, t: run.time[k] + 3, t0: 3}
                )
                for k in chosen
            ]
            outcomes.append(sp.And(*here) == kept)
    return judged(all(outcomes), Verdict.FALSE, numbers)


def not_exponential(printed: Printed) -> Finding:
    """A = -I / (2 (1 + t)), P = (1 + t) I: all is met but the bound on Phi backwards, and the rate halves."""
    run, forwards = followed(fading(), scheduled(lambda t: 1 + t)), transition(WEAKENING)
    least = gathered(fading()).least
    rates = {f"decay from {k} to {2 * k} s in 1/s": run.decay_rate(k, 2 * k) for k in (10, 20)}
    early, late = rates.values()
    halves = 0.4 < late / early < 0.6
    stable = float(np.linalg.norm(forwards, 2, axis=(1, 2)).max()) <= 1 + 1e-9
    refuted = least > 0.5 and stable and run.conditions().printed_holds and halves
    backwards = float(np.linalg.norm(np.linalg.inv(forwards[-1]), 2))
    return judged(not refuted, Verdict.FALSE, {"least of (14)": least, "|Phi(0, 40 s)|": backwards, **rates})


BOUNDED = less(Norm(y), sp.oo)

reads = reader(alpha, beta, rho, rho0)
EXPONENTIAL = reads("norm(rho) <= beta exp(-alpha (t - t0)) norm(rho0)")

ENTRIES = (
    at("(13)", "3", "3", "images are continuous and bounded")(
        (BOUNDED,),
        on_both_examples,
        "20 s of two examples; printed as spaces of functions of t >= t0",
        known=Known.RUNS,
    ),
    at("Theorem 3.4 (ii)", "5", "3", "the error converges exponentially")(
        EXPONENTIAL,
        exponential,
        "with (i) as printed: a bound on Phi backwards bounds P above; runs of two examples, P = I",
        known=Known.RUNS,
    ),
    at("Theorem 3.4 (ii), Lyapunov stable", "1", "abstract", "the same for a system that is Lyapunov stable")(
        EXPONENTIAL,
        not_exponential,
        "Phi bounded for t >= s; A = -I/(2(1 + t)), P = (1 + t) I: the gain fades, and |rho| falls as a power of t",
        Verdict.FALSE,
        known=Known.RUNS,
    ),
)
