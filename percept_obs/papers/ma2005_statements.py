"""Ma, Chen and Moore 2005: what the text says without a formula of its own, judged by the paper's equations."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from scipy.linalg import expm

from percept_obs.compile import vectorised
from percept_obs.observability import instantaneous
from percept_obs.observers import identifier_based, sliding_mode
from percept_obs.observers.sliding_mode import alpha, delta
from percept_obs.papers.base import dot, reader, vanishes
from percept_obs.papers.entries import Finding, Known, Printed, Verdict, at, judged
from percept_obs.papers.ma2005_examples import EXAMPLES, FORMS, NOISE, SYSTEM
from percept_obs.papers.ma2005_observability import FIRST, SUM_BOTH
from percept_obs.papers.ma2005_observers import fhat1, fhat2, yhat3
from percept_obs.papers.ma2005_proofs import SMALL, Dynamics, e1, e2, in_the_layer, lam, sliding
from percept_obs.recording import Camera, Recording, record
from percept_obs.system.motion import affine
from percept_obs.system.surfaces import POINT, plane
from percept_obs.tracking.following import track

Array = NDArray[np.float64]

PERIOD = 0.01
"""Seconds between samples."""


def numbers_of(example: int) -> tuple[Array, Array]:
    """A and b of an example."""
    motion = EXAMPLES[example].motion
    A, b = (np.array(part.subs(motion.values).tolist(), dtype=float) for part in (motion.A, motion.b))
    return A, b.ravel()


def film(example: int, duration: float = 20.0, period: float = PERIOD) -> Recording:
    """An example without noise."""
    return record(replace(EXAMPLES[example], duration=duration), camera=Camera(period))


def small_denominators(printed: Printed) -> Finding:
    """Slope of the estimate of y3 in those of f1 and f2: one over the root of the denominator, on (35) where least."""
    w1, w2 = FORMS["y1, y2"].w
    both = (fhat1**2 + fhat2**2) / (w1**2 + w2**2)
    exact = {fhat1: w1 * yhat3, fhat2: w2 * yhat3}
    # of the root of both, which is y3's estimate
    slope = sum((both.diff(f) / (2 * yhat3)) ** 2 for f in (fhat1, fhat2)).xreplace(exact)
    same = vanishes(slope - 1 / (w1**2 + w2**2))
    truth = EXAMPLES[35].coordinates(np.arange(0, EXAMPLES[35].duration, PERIOD))
    squares = vectorised(SYSTEM.coordinates, [w1**2, w1**2 + w2**2], EXAMPLES[35].motion.values)(*truth.T)
    one, two = (float(square.min() ** -0.5) for square in squares)
    return judged(same and one > 10 * two, Verdict.FALSE, {"largest slope, y1 alone": one, "y1 and y2": two})


def stronger_than_excitation(printed: Printed) -> Finding:
    """Constant w: least eigenvalues of the printed w^T w and of w w^T, which persistency of excitation gathers."""
    numbers = {}
    for name, w in (("y1 alone, w = (1, 1)", np.ones((2, 1))), ("y1 and y2, w = (1, 1)", np.ones((1, 2)))):
        for label, matrix in (("w^T w", w.T @ w), ("w w^T", w @ w.T)):
            numbers[f"least of {label}, {name}"] = round(float(np.linalg.eigvalsh(matrix)[0]), 9)
    alone, as_meant, both, excited = numbers.values()
    return Finding(Verdict.DEPENDS if alone > as_meant == both == 0 < excited else Verdict.FALSE, numbers)


def same_sums(printed: Printed) -> Finding:
    """Operations in the two sums of (20), and the size and rank of the matrices of (17) and (18)."""
    first = sum(entry**2 for entry in FIRST.w)
    of_first = instantaneous(FIRST)
    numbers = {"operations, y1 and y2": SUM_BOTH.count_ops(), "y1 alone": first.count_ops()}
    numbers |= {"rows of w w^T, y1 alone": len(FIRST.x2), "its rank": of_first.rank}
    alike = numbers["operations, y1 and y2"] == numbers["y1 alone"] and not of_first.suffices
    return Finding(Verdict.DEPENDS if alike else Verdict.FALSE, numbers)


def large_against_the_start(printed: Printed) -> Finding:
    """Rate of e1 on both sides of e1 = 0 for n1 = n2 = 1: towards it just where lambda is more than |w^T e2|."""
    values = sliding(SMALL)
    (rate,), (error,), (hidden,), (w,) = values[dot(e1)], values[e1], values[e2], SMALL.w
    same = all(vanishes(rate.subs(sp.sign(error), side) - (w * hidden - side * lam)) for side in (1, -1))
    return judged(same, numbers={f"|w^T e2| up to which e1 = 0 is kept, lambda = {size}": size for size in (1, 10)})


def ends_at(dynamics: Dynamics) -> float:
    """Mean |e1| in the last of 20 s, explicit Euler with steps of 10 ms, n1 = n2 = 1, w = 1, g = 0, listed gains."""
    values = dynamics(replace(SMALL, g=sp.ImmutableMatrix.zeros(1, 1)))
    letters = (*values[e1], *values[e2])
    gains = {alpha: 5.0, lam: 1.0, delta: 0.2, SMALL.w[0]: 1.0}
    rate = vectorised(letters, [*values[dot(e1)], *values[dot(e2)]], gains)
    error, sizes = np.array([0.1, 0.05]), []
    for _ in range(2000):
        error = error + PERIOD * np.array([float(entry) for entry in rate(*error)])
        sizes.append(abs(error[0]))
    return float(np.mean(sizes[-100:]))


def inhibits_chattering(printed: Printed) -> Finding:
    """Mean |e1| that is left of (26) by explicit Euler with the sign and with e1 / (|e1| + delta); slope of that."""
    with_sign, with_layer = ends_at(sliding), ends_at(in_the_layer)
    x = sp.Symbol("x", positive=True)
    slope = sp.limit((x / (x + delta)).diff(x), x, 0)
    numbers = {"mean |e1| with the sign": with_sign, "with the layer": with_layer}
    return judged(with_layer < 1e-3 * with_sign and slope == 1 / delta, Verdict.FALSE, numbers)


def any_start_of_lambda(printed: Printed) -> Finding:
    """When the SMO's hidden errors have entered 0.05 on (36), y1 alone, no noise; or how often it is reset."""
    found, last = {}, 0.0
    for start, period in ((0.01, 0.01), (10, 0.01), (100, 0.01), (100, 0.001)):
        run = track(film(36, period=period), sliding_mode(FIRST, switching_gain=start), [0.0] * 3)
        found[start, period] = run.settling_time(0.05, *FIRST.hidden)
        if math.isinf(found[start, period]):
            last = float(np.abs(run.error[-1, 1:]).max())
    numbers = {f"lambda(0) = {s}, samples of {p} s: settles at s": t for (s, p), t in found.items() if t < math.inf}
    lost = [key for key, time in found.items() if math.isinf(time)]
    depends = lost == [(100, 0.01)]
    numbers |= {"lambda(0) = 100, samples of 0.01 s: error after 20 s": last} if lost else {}
    return Finding(Verdict.DEPENDS if depends else Verdict.FALSE, numbers)


def spread(example: int, outputs: str) -> float:
    """Relative change of the IBO's y3 from 5 s on, rms, for 1 % in each row of A and each of b, all independent."""
    seen, form = film(example, period=0.02), FORMS[outputs]
    A, b = numbers_of(example)
    start = [float(y) for y in seen.truth[0]] if seen.truth is not None else []
    exact = track(seen, identifier_based(form), start)
    late, total = seen.time > 5, 0.0
    for row in range(3):
        for scaled in ("A", "b"):
            wrong = A.copy(), b.copy()
            wrong[scaled == "b"][row] *= 1.01
            run = track(
                replace(seen, motion=affine(wrong[0].tolist(), wrong[1].tolist())), identifier_based(form), start
            )
            total += float(np.mean(((run.state - exact.state)[late, 2] / exact.truth[late, 2]) ** 2))
    return math.sqrt(total)


def more_severe(printed: Printed) -> Finding:
    """Relative change of y3's estimate for 1 % in the motion's parameters, with one output and with both."""
    numbers = {f"{outputs} on ({k})": spread(k, outputs) for k in (36, 35) for outputs in ("y1, y2", "y1 alone")}
    both36, one36, both35, one35 = numbers.values()
    return judged(both36 < one36 < 1.2 * both36 and one35 > both35, Verdict.FALSE, numbers)


def deviation(normal: tuple[float, float, float], outputs: int) -> float:
    """Least relative deviation of the depth after 1 s of (35), for equal noise in each output of a plane n . X = 1."""
    A, b = numbers_of(35)
    motion = np.block([[A, b[:, None]], [np.zeros((1, 4))]])
    surface = plane(normal, outputs=outputs)
    slope = vectorised(POINT, list(sp.Matrix(surface.image).jacobian(POINT)), surface.values)
    information, point = np.zeros((3, 3)), np.array(EXAMPLES[35].position)
    for time in np.arange(0, 1 + PERIOD / 2, PERIOD):
        whole = expm(motion * time)
        now = whole[:3, :3] @ point + whole[:3, 3]
        rows = np.array([float(e) for e in slope(*now)]).reshape(outputs, 3) @ whole[:3, :3]
        information += rows.T @ rows
    variance = float(NOISE.rhs) ** 2 / 3
    least = whole[2, :3] @ np.linalg.inv(information) @ whole[2, :3] * variance
    return float(np.sqrt(least) / now[2])


def third_output(printed: Printed) -> Finding:
    """Remark 2: Cramer-Rao bounds of the depth after 1 s of (35), 101 samples, with equal noise in each output."""
    tilted, other = (0.8, 0.5, 1.0), (-0.2, 0.0, 1.0)
    usual = deviation((0.0, 0.0, 1.0), 2)
    numbers = {"pinhole": usual}
    numbers |= {f"n = {n}, {k} outputs": deviation(n, k) for n in (tilted, other) for k in (2, 3)}
    _, two, three, _, better = numbers.values()
    adds, varies = three < 0.95 * two, better < usual < three
    return Finding(Verdict.DEPENDS if adds and varies else Verdict.FALSE, numbers)


ENTRIES = (
    at("Remark 2", "71", "4", "a general plane outperforms the pinhole")(
        (),
        third_output,
        "on n; the third output follows from the other two, n1 yg1 + n2 yg2 + n3 yg3 = 1, but brings noise of its own,"
        " and so it adds",
        Verdict.DEPENDS,
        asks=lambda: reader()("n1 y_g1 + n2 y_g2 + n3 y_g3 = 1"),
    ),
    at("denominators", "65", "3", "small denominators make the RIO's estimate err")(
        (), small_denominators, "an error of f1 is multiplied by 1/|w|; with y1 alone b1 = b3 y1 is enough for that"
    ),
    at("(14) is stronger", "66", "3.1", "(14) is stronger than persistency of excitation")(
        (),
        stronger_than_excitation,
        "as printed it is with y1 and y2, and weaker with y1 alone; mended, see (14), it is that condition itself",
        Verdict.DEPENDS,
    ),
    at("same complexity", "67", "3.1", "(17) and (18) are of the same complexity")(
        (),
        same_sums,
        "the sums of (20) are; of (18), the second is the larger eigenvalue, and the smallest is 0 whatever y1 is",
        Verdict.DEPENDS,
    ),
    at("lambda(0)", "67", "3.2", "lambda may start at any positive number")(
        (),
        any_start_of_lambda,
        "on the sampling: a layer of 0.2 with lambda = 100 is too fast for samples of 10 ms; (36), y1 alone, no noise",
        Verdict.DEPENDS,
        known=Known.RUNS,
    ),
    at("lambda and the start", "68", "3.3", "lambda is to be large against the start")(
        (), large_against_the_start, "e1 = 0 is kept where lambda > |w^T e2|, and e2 begins with the start's error"
    ),
    at("Remark 1, chattering", "69", "3.3", "the layer reduces chattering and the singularity at e = 0")(
        (),
        inhibits_chattering,
        "explicit Euler with 10 ms; the layer has the slope 1/delta at e = 0, where the sign has none",
        known=Known.RUNS,
    ),
    at("sensitivity", "71", "5", "errors of the motion matter slightly more with one output")(
        (),
        more_severe,
        "IBO from the true start, 20 s without noise, 1 % in each row of A and entry of b; a conjecture of the paper",
        known=Known.RUNS,
    ),
)
