"""Ma, Chen and Moore 2005, sections 4 and 5: the two examples, the observers' constants, and what the figures show."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import sympy as sp

from percept_obs.observers import Observer, identifier_based, sliding_mode
from percept_obs.observers.identifier_based import A, P
from percept_obs.observers.parts import gamma, sigma2
from percept_obs.observers.sliding_mode import delta, lambda0
from percept_obs.papers.base import at_most, column, dot, equal, exactly, explicit, identities, reader, separates
from percept_obs.papers.entries import Check, Finding, Known, Printed, Values, Verdict, at, judged, not_checkable
from percept_obs.papers.ma2005_proofs import SMALL, with_g_left_out
from percept_obs.papers.scalars import Norm
from percept_obs.recording import Camera, Recording, Uniform, record
from percept_obs.recording.scenarios import ma2005_eq35, ma2005_eq36
from percept_obs.system.motion import affine
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import pinhole
from percept_obs.system.surfaces.base import POINT
from percept_obs.tracking.following import track
from percept_obs.tracking.run import Run

SYSTEM = PerspectiveSystem(affine(), pinhole())
FORMS = {"y1 alone": SYSTEM.measure("y1"), "y1, y2": SYSTEM.measure("y1", "y2")}
FIRST = FORMS["y1 alone"]
OBSERVERS: dict[str, Callable[..., Observer]] = {"IBO": identifier_based, "SMO": sliding_mode}
EXAMPLES = {35: ma2005_eq35(), 36: ma2005_eq36()}
SEEDS = (0, 1, 2)

X0, Y0, Z0, y01, y02, y03 = sp.symbols("X_0 Y_0 Z_0 y_01 y_02 y_03", real=True)
yhat01, yhat02, yhat03, noise, delta1 = sp.symbols("yhat_01 yhat_02 yhat_03 n delta1", real=True)
n1, n = sp.symbols("n1 n", integer=True, positive=True)
A_, P_, Q_ = (sp.MatrixSymbol(name, n1, n1) for name in "APQ")
xhat = sp.MatrixSymbol("xhat", n, 1)


def example(number: int) -> Callable[[], Values]:
    """Velocity and start of an example, in exact numbers."""

    def derive() -> Values:
        scenario = EXAMPLES[number]
        start = exactly(dict(zip(POINT, scenario.position, strict=True)))
        velocity = scenario.motion.A * column(*POINT) + scenario.motion.b
        return {
            **dict(zip(map(dot, POINT), velocity.xreplace(exactly(scenario.motion.values)), strict=True)),
            **dict(zip((X0, Y0, Z0), start.values(), strict=True)),
        }

    return derive


def seen_at_the_start() -> Values:
    """Coordinates of a point from which a motion starts."""
    start = dict(zip(POINT, (X0, Y0, Z0), strict=True))
    image = (*SYSTEM.surface.image, 1 / SYSTEM.surface.distance)
    return dict(zip((y01, y02, y03), (entry.xreplace(start) for entry in image), strict=True))


def gains_of(name: str) -> Callable[[], Values]:
    """The gains that the package's observer has unless asked otherwise."""

    def derive() -> Values:
        values = exactly(OBSERVERS[name](FIRST).gain_values)
        return values | ({delta1: values[delta]} if delta in values else {})

    return derive


@cache
def recorded(number: int, seed: int, period: float = 0.01) -> Recording:
    """An example with the printed noise; the paper does not say how often it samples."""
    return record(EXAMPLES[number], camera=Camera(period, Uniform(float(NOISE.rhs))), seed=seed)


@cache
def followed(number: int, name: str, outputs: str, seed: int, period: float = 0.01) -> Run:
    """An observer on an example, from the printed start."""
    return track(recorded(number, seed, period), OBSERVERS[name](FORMS[outputs]), list(map(float, START.rhs)))


def settling(number: int, name: str, outputs: str) -> float:
    """When the hidden coordinates' error has entered 0.05 for good with every seed; infinite if one never does."""
    return max(followed(number, name, outputs, seed).settling_time(0.05, *FORMS[outputs].hidden) for seed in SEEDS)


def converges(number: int, *runs: tuple[str, str]) -> Check:
    """A check that holds when the runs of an example, by observer and outputs, settle with every seed."""

    def check(printed: Printed) -> Finding:
        """When the hidden errors have entered 0.05 for good, with three seeds; or how often they are reset."""
        numbers = {}
        for name, outputs in runs:
            label, time = f"{name}, {outputs}", settling(number, name, outputs)
            if math.isfinite(time):
                numbers[f"{label} settles at s"] = time
                continue
            seeded = [followed(number, name, outputs, seed) for seed in SEEDS]
            numbers[f"{label} resets"] = min(len(run.resets) for run in seeded)
            numbers[f"{label} last error"] = float(min(np.abs(run.error[-1, 1:]).max() for run in seeded))
        return judged(all(math.isfinite(settling(number, *run)) for run in runs), Verdict.FALSE, numbers)

    return check


@cache
def never_reset(name: str, every: float) -> int:
    """Number of five runs on (35), y1 alone, without a reset, for noise drawn at this period and held between."""
    clean, count = record(EXAMPLES[35], camera=Camera(0.01)), 0
    held, edge = round(every / 0.01), float(NOISE.rhs)
    for seed in range(5):
        drawn = np.random.default_rng(seed).uniform(-edge, edge, (len(clean.time) // held + 1, 2))
        noisy = replace(clean, outputs=clean.outputs + np.repeat(drawn, held, axis=0)[: len(clean.time)])
        count += not len(track(noisy, OBSERVERS[name](FIRST), list(map(float, START.rhs))).resets)
    return count


def with_slower_noise(name: str) -> dict[str, float]:
    """Numbers of runs without a reset for noise drawn every 10 ms and every second."""
    intervals = {"10 ms": 0.01, "1 s": 1.0}
    label = "of 5 runs never reset, noise drawn every"
    return {f"{name}, y1 alone, {label} {words}": never_reset(name, every) for words, every in intervals.items()}


def first_figure(printed: Printed) -> Finding:
    """Runs of both observers with y1 alone; and of the SMO where noise is drawn less often."""
    as_listed = converges(35, *BOTH_OBSERVERS_Y1)(printed)
    numbers = with_slower_noise("SMO")
    refuted = as_listed.verdict == Verdict.FALSE and max(numbers.values()) < 3
    return judged(not refuted, Verdict.FALSE, {**as_listed.numbers, **numbers})


def second_figure(printed: Printed) -> Finding:
    """Runs of the IBO with both outputs, which settle, and with y1 alone, where it depends on the noise."""
    both = converges(35, IBO_BOTH_WAYS[0])(printed)
    numbers = with_slower_noise("IBO")
    depends = both.verdict == Verdict.HOLDS and list(map(bool, numbers.values())) == [False, True]
    return Finding(Verdict.DEPENDS if depends else Verdict.FALSE, {**both.numbers, **numbers})


def similar(printed: Printed) -> Finding:
    """Settling times of both observers with y1 alone on (36), and their errors from 20 s on, with three seeds."""
    numbers = {f"{name} settles at s": settling(36, name, "y1 alone") for name in OBSERVERS}
    for name in OBSERVERS:
        seeded = [followed(36, name, "y1 alone", seed) for seed in SEEDS]
        late = [np.sqrt(np.square(run.error[run.time > 20, 1:]).mean()) for run in seeded]
        numbers[f"{name}, rms error from 20 s on"] = float(max(late))
    ibo, smo = (numbers[f"{name} settles at s"] for name in OBSERVERS)
    return judged(abs(ibo - smo) < 0.1 * ibo, Verdict.FALSE, numbers)


def listed(name: str) -> Check:
    """A check of a list of constants: the package's own, and the signs of A and P, or of alpha, are those of (11)."""

    def check(printed: Printed) -> Finding:
        """The package has these numbers; with them the error dynamics are stable at 0 for n1 = n2 = 1, w = 1, g = 0."""
        found = identities(gains_of(name))(printed)
        if found.verdict != Verdict.HOLDS:
            return found
        made = OBSERVERS[name](with_g_left_out(SMALL))
        here = {line.lhs: line.rhs for line in printed} | dict.fromkeys((*made.error, sigma2), 0)
        here |= {SMALL.w[0]: 1, delta: here.get(delta1, 0)}
        here |= {s: here[lambda0] for s in made.equations.state if s.name.startswith("lambda")}
        slope = made.error_dynamics()[:2, :].jacobian(made.error).subs(here)
        largest = max(float(sp.re(value)) for value in slope.eigenvals(multiple=True))
        return replace(found, numbers={"largest real part": largest}) if largest < 0 else judged(False)

    return check


def slower_with_one_output(printed: Printed) -> Finding:
    """Section 5: on (36) each observer settles later with y1 alone, with every seed."""
    times = {
        (name, outputs): [
            followed(36, name, outputs, seed).settling_time(0.05, *FORMS[outputs].hidden) for seed in SEEDS
        ]
        for name in OBSERVERS
        for outputs in FORMS
    }
    later = [
        one > both
        for name in OBSERVERS
        for one, both in zip(times[name, "y1 alone"], times[name, "y1, y2"], strict=True)
    ]
    numbers = {f"{name}, {outputs} settles at s": max(t) for (name, outputs), t in times.items()}
    return judged(all(later), Verdict.FALSE, numbers)


def estimate_is_bounded(printed: Printed) -> Finding:
    """The bound in the run that is reset most: y1 alone on (35)."""
    (line,) = printed
    run = followed(35, "IBO", "y1 alone", 0)
    largest = float(np.linalg.norm(run.state, axis=1).max())
    gains = {symbol: sp.Float(value) for symbol, value in run.observer.gain_values.items()}
    holds = bool(len(run.resets)) and separates(line, Norm(xhat), largest, 2 * largest, gains)
    return judged(holds, Verdict.FALSE, {"largest norm": largest, "resets": len(run.resets)})


def resets_at_every_step(printed: Printed) -> Finding:
    """The share of resets that are followed by another one in the next step, for the printed ratio and for 1.01."""
    (line,) = printed
    observer, step = identifier_based(FIRST), 0.001
    condition = observer.equations.reset_condition.subs(gamma, line.rhs)
    as_printed = replace(observer, equations=replace(observer.equations, reset_condition=condition))
    shares = []
    for candidate in (as_printed, observer):
        run = track(recorded(35, 0).between(0, 46), candidate, list(map(float, START.rhs)), step=step)
        shares.append(float(np.mean(np.diff(run.resets) < 1.5 * step)))
    numbers = dict(zip(("resets followed by another at once", "with 1.01"), shares, strict=True))
    return judged(not shares[1] < 0.01 < 0.99 < shares[0], Verdict.FALSE, numbers)


def positive_definite(printed: Printed) -> Finding:
    """The Lyapunov equation with the listed A and P; and the signs that it asks for, put into (11) on (35)."""
    equation, positive = printed
    listed = {line.lhs: line.rhs for line in IBO_LIST}
    values = {A_: column(listed[A]), P_: column(listed[P])}
    q = -explicit(equation.lhs, values)[0]
    as_asked = identifier_based(FORMS["y1, y2"], injection=-float(listed[A]), lyapunov=-float(listed[P]))
    run = track(recorded(35, 0), as_asked, list(map(float, START.rhs)))
    numbers = {"P": float(listed[P]), "Q": float(q), "resets with A = -1, P = 1/2": len(run.resets)}
    return judged(bool(positive.subs(P, listed[P])) and q > 0, Verdict.FALSE, numbers)


reads = reader(xhat)

IBO_LIST = reads("G = 10; A = 1; P = -1/2; M = 10")
SMO_LIST = reads("alpha = 5; lambda0 = 1; alpha1 = 10; delta1 = 1/5; M = 10")
NOISE = at_most(sp.Abs(noise), sp.Rational(1, 100))
START = equal(column(yhat01, yhat02, yhat03), column(0, 0, 0))
POSITION = equal(column(X0, Y0, Z0), column(1, sp.Rational(3, 2), sp.Rational(5, 2)))
BOTH_OBSERVERS_Y1 = (("IBO", "y1 alone"), ("SMO", "y1 alone"))
IBO_BOTH_WAYS = (("IBO", "y1, y2"), ("IBO", "y1 alone"))

ENTRIES = (
    at("P positive definite", "65", "3.1", "P > 0 solves the Lyapunov equation")(
        (equal(A_.T * P_ + P_ * A_, -Q_), sp.StrictGreaterThan(P, 0, evaluate=False)),
        positive_definite,
        "section 4 lists P = -1/2; A = -1, P = 1/2 fulfil it and are driven to the bound, see (11)",
        Verdict.FALSE,
    ),
    at("bound on the estimate", "65", "3.1", "(11), (12) keep the estimate bounded")(
        reads("norm(xhat) <= gamma M"), estimate_is_bounded, "at the samples, after the reset", known=Known.RUNS
    ),
    at("(35)", "70", "4", "first example")(
        (
            *reads("[X', Y', Z'] = [[-2, 4, -6], [1, -2, 3], [3, -4, 4]] / 10 * [X, Y, Z] + [50, 25, 30] / 100"),
            POSITION,
        ),
        identities(example(35)),
        known=Known.IMPLEMENTED,
    ),
    at("y0", "70", "4", "coordinates at the start of (35), (36)")(
        reads("[y_01, y_02, y_03] = [X_0 / Z_0, Y_0 / Z_0, 1 / Z_0]"), identities(seen_at_the_start)
    ),
    at("noise", "70", "4", "uniform noise within 0.01")(
        (NOISE,), not_checkable, "a choice; the runs below use it", Verdict.NOT_CHECKABLE, known=Known.DEFINITION
    ),
    at("start", "70", "4", "estimates start at zero")(
        (START,), not_checkable, "a choice; the runs below use it", Verdict.NOT_CHECKABLE, known=Known.DEFINITION
    ),
    at("IBO list", "70", "4", "constants of the IBO")(
        IBO_LIST,
        listed("IBO"),
        "the package's own; with these signs the printed equations are stable; for gamma see below",
        known=Known.IMPLEMENTED,
    ),
    at("SMO list", "70", "4", "constants of the SMO")(
        SMO_LIST,
        listed("SMO"),
        "the package's own; with these signs the printed equations are stable; for gamma see below",
        known=Known.IMPLEMENTED,
    ),
    at("gamma = 1", "70", "4", "gamma in both lists")(
        reads("gamma = 1"),
        resets_at_every_step,
        "against gamma > 1: the reset maps the bound to itself, and the estimate sticks to it",
        Verdict.FALSE,
        known=Known.RUNS,
    ),
    at("figure 3", "70", "4", "(35), y1 alone: both observers converge")(
        (),
        first_figure,
        "with the listed constants, noise and start both are driven to the bound with every seed; where "
        "noise is drawn once a second, the SMO still is",
        Verdict.FALSE,
        known=Known.RUNS,
    ),
    at("figure 4", "70", "4", "(35): the IBO converges both ways")(
        (),
        second_figure,
        "with y1 and y2 it does; with y1 alone it depends on how often noise is drawn, which is not printed",
        Verdict.DEPENDS,
        known=Known.RUNS,
    ),
    at("(36)", "71", "4", "second example")(
        (
            *reads("[X', Y', Z'] = [[-2, 4, -6], [1, -2, 3], [-4, 4, -4]] / 10 * [X, Y, Z] + [50, 25, 30] / 100"),
            POSITION,
        ),
        identities(example(36)),
        known=Known.IMPLEMENTED,
    ),
    at("figure 5", "71", "4", "(36), y1 alone: both observers converge")(
        (), converges(36, *BOTH_OBSERVERS_Y1), "hidden errors below 0.05 from 5 s on, every seed", known=Known.RUNS
    ),
    at("figure 6", "71", "4", "(36): the IBO converges both ways")(
        (), converges(36, *IBO_BOTH_WAYS), "caption lost by the scan", known=Known.RUNS
    ),
    at("speed", "71", "5", "one output converges more slowly")(
        (), slower_with_one_output, "on (36), every seed", known=Known.RUNS
    ),
    at("IBO about SMO", "67", "3.2", "with y1 alone both perform alike")(
        (), similar, "on (36), every seed; on (35) neither converges, see figure 3", known=Known.RUNS
    ),
)
