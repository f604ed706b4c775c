"""Chwa 2019, section VII: constants, simulations, and the experiment's cases."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from percept_obs.compile import vectorised
from percept_obs.observers.integral_sliding_mode import integral_sliding_mode
from percept_obs.papers.base import column, equal, exactly, identities, reader
from percept_obs.papers.entries import Finding, Known, Printed, Values, Verdict, at, judged, not_checkable
from percept_obs.recording import record
from percept_obs.structure import COROLLARIES, ScaledDepthCamera
from percept_obs.structure.dynamics import OUTPUTS, d_s
from percept_obs.structure.pixels import CHWA_CAMERA, SignalToNoise
from percept_obs.structure.scenarios import chwa2019_experiment, chwa2019_simulation
from percept_obs.system.surfaces import POINT, pinhole
from percept_obs.tracking.following import track
from percept_obs.tracking.run import Run

y01, y02, y03, ybar01, ybar02, ybar03 = sp.symbols("y_01 y_02 y_03 ybar_01 ybar_02 ybar_03", real=True)
ghat01, ghat02, ghat03, yhat01, yhat02, yhat03 = sp.symbols(
    "ghat_01 ghat_02 ghat_03 yhat_01 yhat_02 yhat_03", real=True
)
A_c = sp.MatrixSymbol("A_c", 3, 3)
IMAGE_SIZE = (640, 480)
"""The size, in pixels, of an image whose centre is the printed principal point."""

SECTIONS = ("IV.A", "IV.B", "V.B", "VI.B", "VI.C")
"""The experiment's cases."""


def velocity(name: str, section: str) -> sp.MatrixSymbol:
    """The letter of a velocity in one of the experiment's cases."""
    return sp.MatrixSymbol(f"{name}^{section}", 3, 1)


def hundredths(*values: int) -> sp.ImmutableMatrix:
    """A column of hundredths."""
    return column(*(sp.Rational(value, 100) for value in values))


def numbers_of(printed: Printed) -> dict[sp.Basic, sp.Basic]:
    """Values of the printed constants."""
    return {line.lhs: line.rhs for line in printed}


@cache
def velocities() -> Values:
    """Velocities of the package's scenarios of the experiment."""
    values: Values = {}
    for section in SECTIONS:
        motion = exactly(chwa2019_experiment(section).motion.values)
        for name in ("v_c", "v_p"):
            letters = (next(symbol for symbol in motion if symbol.name == f"{name}{k}") for k in (1, 2, 3))
            values[velocity(name, section)] = column(*(motion[letter] for letter in letters))
    return values


@cache
def followed(section: str, duration: float, period: float = 1e-3, switch: str = "ideal", decibels: float = 0) -> Run:
    """The observer on one of the experiment's cases, from yhat(0) = 0; exactly seen, or with noise of a ratio."""
    setup = chwa2019_experiment(section)
    ratio = SignalToNoise(decibels) if decibels else None
    recording = record(setup, duration, ScaledDepthCamera(period, pixels=CHWA_CAMERA, ratio=ratio))
    observer = integral_sliding_mode(setup.choice.form, switch)
    return track(recording, observer, [0.0] * 6, hold="zero" if decibels else "exact", step=period)


@cache
def gains() -> Values:
    """The gains that the package's observer has unless asked otherwise."""
    return dict(exactly(integral_sliding_mode(COROLLARIES[0].choice().form, "sign").gain_values))


def scaled_start(printed: Printed) -> Finding:
    """ybar(0) follows from y(0) and d_s as (6) has it."""
    given = numbers_of(printed)
    scale, image, scaled = (given.get(x) for x in (d_s, column(y01, y02, y03), column(ybar01, ybar02, ybar03)))
    if scale is None or image is None or scaled is None:
        return judged(False)
    return judged(scaled == column(image[0], image[1], image[2] / scale))


def start_of_ghat(printed: Printed) -> Finding:
    """ghat(0) is no free choice: (11) with s_e(0) = v(0) = 0 gives gamma tanh(a e_s(0)), here for the simulation."""
    estimate, image = (numbers_of(printed)[column(*x)] for x in ((ghat01, ghat02, ghat03), (yhat01, yhat02, yhat03)))
    form = COROLLARIES[0].choice().form
    observer = integral_sliding_mode(form, "sign")
    state = observer.equations.state
    begun = dict(zip(form.x1, numbers_of(SIMULATION)[column(ybar01, ybar02, ybar03)], strict=True))
    begun |= dict(zip(state[:3], image, strict=True))
    start = dict(zip(state, (entry.subs(begun) for entry in observer.start), strict=True))
    rate = column(*observer.equations.flow[:3]) - form.phi
    found = rate.subs(start).subs(begun | observer.gain_values)
    return judged(found == estimate, Verdict.FALSE, {f"ghat{k + 1}(0)": float(v) for k, v in enumerate(found)})


def in_metres(printed: Printed) -> Finding:
    """Powers of the unit of length in the coordinates of a point."""
    unit = sp.Symbol("unit", positive=True)
    larger = {coordinate: unit * coordinate for coordinate in POINT}
    coordinates = (*pinhole().image, 1 / pinhole().distance)
    powers = [sp.degree(sp.expand(sp.cancel(unit**2 * e.xreplace(larger) / e)), unit) - 2 for e in coordinates]
    numbers = {f"power of length in y{k + 1}": int(power) for k, power in enumerate(powers)}
    return judged(all(power == 1 for power in powers), Verdict.FALSE, numbers)


def pixels(image: NDArray[np.float64]) -> NDArray[np.float64]:
    """Pixels of image coordinates (y1, y2), by the printed camera."""
    camera = np.array(CAMERA.rhs, dtype=float)
    return np.concatenate([image[..., :2], np.ones_like(image[..., :1])], axis=-1) @ camera[:2].T


def sees_its_point(printed: Printed) -> Finding:
    """The pixel of the simulation's point at the start."""
    u, v = pixels(np.array(numbers_of(SIMULATION)[column(y01, y02, y03)], dtype=float).ravel())
    return Finding(Verdict.NOT_CHECKABLE, {"u": float(u), "v": float(v)})


def sees_the_experiment(printed: Printed) -> Finding:
    """When each of the experiment's points leaves the image of the only camera that is printed."""
    times = np.arange(0, 2, 0.001)
    leaves = {}
    for section in SECTIONS:
        outside = (pixels(chwa2019_experiment(section).coordinates(times)) >= IMAGE_SIZE).any(axis=1)
        leaves[f"leaves in {section} at s"] = float(times[outside][0]) if outside.any() else math.inf
    return Finding(Verdict.NOT_CHECKABLE, leaves)


def robust_at(printed: Printed) -> Finding:
    """Noise of the printed ratio in pixels, and the spread of d_s from 9 to 10 s in IV.A with it and with more."""
    numbers, spread = {}, {}
    clean = pixels(chwa2019_experiment("IV.A").coordinates(np.arange(0, 10, 0.01)))
    for decibels in (100, 60):
        run = followed("IV.A", 10.0, decibels=decibels)
        spread[decibels] = float(run.estimate[run.time > 9, 3].std())
        numbers[f"pixels at {decibels} dB"] = SignalToNoise(decibels).sigma(clean)
        numbers[f"spread of d_s at {decibels} dB"] = spread[decibels]
    return judged(spread[100] < 0.02 * 10.4, Verdict.FALSE, numbers)


def found_in_time(printed: Printed) -> Finding:
    """The five cases: the worst error of d_s at 1 s and of a velocity at 1.5 s, with s = 0."""
    numbers = {"worst d_s, share of it": 0.0, "worst velocity in m/s": 0.0}
    for section in SECTIONS:
        run, choice = followed(section, 2.0), chwa2019_experiment(section).choice
        found, true = (choice.quantities(x[run.time >= 1][:, 3:]) for x in (run.estimate, run.truth))
        for name, values in found.items():
            error = np.abs(values - true[name])
            if name == d_s.name:
                share = float((error / true[name]).max())
                numbers["worst d_s, share of it"] = max(numbers["worst d_s, share of it"], share)
            else:
                size = float(error[run.time[run.time >= 1] >= 1.5].max())
                numbers["worst velocity in m/s"] = max(numbers["worst velocity in m/s"], size)
    holds = numbers["worst d_s, share of it"] < 0.005 and numbers["worst velocity in m/s"] < 0.01
    return judged(holds, Verdict.FALSE, numbers)


def error_of_g(run: Run) -> NDArray[np.float64]:
    """Error of ghat, shape (T, 3): what the unknowns' errors make of it."""
    form = run.observer.form.canonical_form()
    entries = vectorised(form.x1, list(form.w.T), run.recording.motion.values)(*run.truth[:, :3].T)
    return np.asarray(np.einsum("ijt,tj->ti", np.reshape(entries, (3, 3, -1)), run.error[:, 3:]))


@cache
def wandering() -> Run:
    """The observer on a moving object, with velocities that vary at up to 1 rad/s, from yhat(0) = 0."""
    setup = chwa2019_simulation("IV.B")
    recording = record(setup, 30.0, ScaledDepthCamera(0.01, pixels=CHWA_CAMERA))
    return track(recording, integral_sliding_mode(setup.choice.form, "ideal"), [0.0] * 6, hold="exact", step=0.01)


def tends_to_g(printed: Printed) -> Finding:
    """Theorem 1 (iv): the largest error of ghat in IV.A, and where the object wanders, in windows one after the other.

    Where g varies it falls as 1 / (a + b t).
    """
    numbers = {}
    for name, run, starts in (
        ("IV.A", followed("IV.A", 25.0, 0.005), (1, 5, 20)),
        ("varying g", wandering(), (1, 8, 22)),
    ):
        for k in starts:
            part = (run.time >= k) & (run.time < k + (4 if name == "IV.A" else 7))
            numbers[f"{name}, from {k} s on"] = float(np.abs(error_of_g(run)[part]).max())
    still, moving = list(numbers.values())[:3], list(numbers.values())[3:]
    falls = all(sizes[0] > sizes[1] > sizes[2] for sizes in (still, moving))
    return judged(falls and still[2] < 1e-4 and moving[2] < 0.3 * moving[0], Verdict.FALSE, numbers)


def from_any_place(printed: Printed) -> Finding:
    """When d_s has entered 1 % for good in IV.A, for several yhat(0), and its error at the end; s = 0."""
    numbers: dict[str, float] = {}
    ends = []
    for start in ((0.32, 0.3, 0.05), (0.0, 0.0, 0.0), (3.0, 3.0, 3.0)):
        setup = chwa2019_experiment("IV.A")
        recording = record(setup, 1.5, ScaledDepthCamera(1e-3, pixels=CHWA_CAMERA))
        observer = integral_sliding_mode(setup.choice.form, "ideal")
        run = track(recording, observer, [*start, 0.0, 0.0, 0.0], hold="exact", step=1e-3)
        off = ~(np.abs(run.estimate[:, 3] / run.truth[:, 3] - 1) <= 0.01)
        numbers[f"within 1 % from s, yhat(0) = {start}"] = float(run.time[off][-1])
        ends.append(float(abs(run.estimate[-1, 3] / run.truth[-1, 3] - 1)))
    numbers["largest share of d_s after 1.5 s"] = max(ends)
    first, *_, last = numbers.values()
    times = list(numbers.values())[:3]
    depends = times[2] > 2 * times[0] and last < 1e-3 and first > 0
    return Finding(Verdict.DEPENDS if depends else Verdict.FALSE, numbers)


def may_vary(printed: Printed) -> Finding:
    """Worst error of the object's velocity from 2 s on, over its largest speed, constant or varying."""
    numbers = {}
    for name, run, setup in (
        ("constant", followed("IV.B", 10.0, 0.005), chwa2019_experiment("IV.B")),
        ("varying", wandering(), chwa2019_simulation("IV.B")),
    ):
        found, true = (setup.choice.quantities(x[run.time >= 2][:, 3:]) for x in (run.estimate, run.truth))
        worst = max(float(np.abs(found[k] - true[k]).max()) for k in found)
        numbers[name] = worst / max(float(np.abs(values).max()) for values in true.values())
    steps = [corollary.section for corollary in COROLLARIES if corollary.earlier]
    numbers["cases that carry v_c over from another"] = len(steps)
    depends = max(numbers["constant"], numbers["varying"]) < 0.01 and steps == ["IV.B"]
    return Finding(Verdict.DEPENDS if depends else Verdict.FALSE, numbers)


def kept_velocity(printed: Printed) -> Finding:
    """Section IV takes v_c of the second step from the first one; the experiment's differ.

    The velocity of the object that follows is v_p less the change of v_c.
    """
    given = numbers_of(printed)
    change = given[velocity("v_c", "IV.B")] - given[velocity("v_c", "IV.A")]
    follows = given[velocity("v_p", "IV.B")] - change
    numbers = {f"v_p{k + 1} that follows": float(value) for k, value in enumerate(follows[:2])}
    return judged(change.is_zero_matrix, Verdict.FALSE, numbers)


def needs_forward_motion(printed: Printed) -> Finding:
    """Determinants of the two cases that are left out, with v_c3 = 0: only the first one vanishes."""
    given = numbers_of(EXPERIMENT)
    here = {OUTPUTS[2]: given[column(ybar01, ybar02, ybar03)][2], d_s: given[d_s], sp.Symbol("v_c3", real=True): 0}
    numbers = {}
    for number in (3, 5):
        corollary = COROLLARIES[number - 1]
        numbers[f"determinant of {corollary.section}"] = float(corollary.choice().determinant.subs(here))
    return judged(all(value == 0 for value in numbers.values()), Verdict.FALSE, numbers)


CAMERA = equal(A_c, sp.ImmutableMatrix([[720, 0, 320], [0, 720, 240], [0, 0, 1]]))
reads = reader()

ZERO_START = reads("[ghat_01, ghat_02, ghat_03] = [0, 0, 0]; [yhat_01, yhat_02, yhat_03] = [0, 0, 0]")
SIMULATION = (
    equal(column(y01, y02, y03), hundredths(40, 40, 20)),
    *reads("d_s = 4"),
    equal(column(ybar01, ybar02, ybar03), hundredths(40, 40, 5)),
)
EXPERIMENT = (
    equal(column(y01, y02, y03), hundredths(32, 30, 52)),
    *reads("d_s = 104/10"),
    equal(column(ybar01, ybar02, ybar03), hundredths(32, 30, 5)),
)
VELOCITIES = (
    equal(velocity("v_c", "IV.A"), hundredths(-22, -23, 0)),
    equal(velocity("v_c", "IV.B"), hundredths(-44, -47, 0)),
    equal(velocity("v_c", "V.B"), hundredths(-44, -23, 0)),
    equal(velocity("v_c", "VI.B"), hundredths(-44, -47, 0)),
    equal(velocity("v_c", "VI.C"), hundredths(-44, -23, 0)),
    equal(velocity("v_p", "IV.A"), hundredths(0, 0, 0)),
    equal(velocity("v_p", "IV.B"), hundredths(-22, -23, 0)),
    equal(velocity("v_p", "V.B"), hundredths(-22, 0, 0)),
    equal(velocity("v_p", "VI.B"), hundredths(-22, -23, 0)),
    equal(velocity("v_p", "VI.C"), hundredths(-22, 0, 0)),
)

ENTRIES = (
    at("gains", "11", "VII.A", "constants of the observer")(
        reads("k1 = 15; gamma = 15; a = 1; k2 = 1; b = 1/10"),
        identities(gains),
        "the package's own",
        known=Known.IMPLEMENTED,
    ),
    at("ghat(0) = 0", "11", "VII.A", "both estimates start at zero")(
        ZERO_START, start_of_ghat, "ghat has no start of its own: by (11) it is gamma tanh(a e_s(0))", Verdict.FALSE
    ),
    at("start of the simulation", "11", "VII.A", "y(0), d_s and ybar(0)")(SIMULATION, scaled_start),
    at("(m)", "11", "VII.A", "y(0) and ybar(0) are in metres")(
        (), in_metres, "y1, y2 are numbers, y3 is in 1/m; so is d_s, and ybar3 is a number", Verdict.FALSE
    ),
    at("A_c", "11", "VII.A", "the camera of the simulation")(
        (CAMERA,),
        sees_its_point,
        "a choice; no size of the image is printed: in 640 x 480 pixels, whose centre is (320, 240), the"
        " point would start below the lower edge",
        Verdict.NOT_CHECKABLE,
        known=Known.DEFINITION,
    ),
    at("100 dB", "11", "VII.A", "noise of 100 dB validates the robustness")(
        (),
        robust_at,
        "at 100 dB, of the powers of pixel coordinates and noise, in IV.A with ybar3 exact; no camera is that good",
        known=Known.RUNS,
    ),
    at("Theorem 1 (iv)", "6", "III", "ghat converges to g")(
        (),
        tends_to_g,
        "in IV.A, and with an object that wanders so that g varies, where the error falls as 1/(a + b t); s = 0",
        known=Known.RUNS,
    ),
    at("any start", "2", "I", "performance does not depend on initial conditions of object and camera")(
        (),
        from_any_place,
        "in the end it does not; at first ghat errs by gamma tanh((a + b t) e_s), and e_s(0) is the object's place if"
        " yhat(0) = 0",
        Verdict.DEPENDS,
        known=Known.RUNS,
    ),
    at("velocities may vary", "2", "I", "velocities are found, be they constant or not")(
        (),
        may_vary,
        "in V and VI; section IV takes a constant v_c (assumption 3), for its second step has it from the first",
        Verdict.DEPENDS,
        known=Known.RUNS,
    ),
    at("transients of [50]", "9", "VII.A", "transients are better than with reference [50]")(
        (),
        not_checkable,
        "the text does not tell what was made of [50], which is for two objects; a stand-in would prove nothing",
        Verdict.NOT_CHECKABLE,
        known=Known.NOT_REPRODUCED,
    ),
    at("figures 5 to 7", "9", "VII.A", "simulations converge")(
        (),
        not_checkable,
        "the velocities are not printed, nor is what became of reference [50]",
        Verdict.NOT_CHECKABLE,
        known=Known.NOT_REPRODUCED,
    ),
    at("start of the experiment", "14", "VII.B", "y(0), d_s and ybar(0)")(EXPERIMENT, scaled_start),
    at("velocities", "14", "VII.B", "velocities in the five cases")(
        VELOCITIES, identities(velocities), "the package's own", known=Known.IMPLEMENTED
    ),
    at("figures 9 to 11", "13", "VII.B", "the five cases converge")(
        (), found_in_time, "without noise, s = 0, yhat(0) = 0; d_s from 1 s, velocities from 1.5 s on", known=Known.RUNS
    ),
    at("experiment in the image", "14", "VII.B", "the camera sees the experiment's points")(
        (CAMERA,),
        sees_the_experiment,
        "its camera is not printed; in 640 x 480 pixels with the A_c of the simulation the points would leave at once",
        Verdict.NOT_CHECKABLE,
        known=Known.NOT_REPRODUCED,
    ),
    at("v_c constant", "14", "VII.B", "the second step keeps the first one's v_c")(
        VELOCITIES,
        kept_velocity,
        "assumption 3 wants it constant; with the estimate of IV.A the moving object would seem to stand still",
        Verdict.FALSE,
    ),
    at("V.A, VI.A left out", "14", "VII.B", "neither can be tried with v_cz = 0")(
        (), needs_forward_motion, "V.A cannot; VI.A can, for its determinant does not depend on v_c", Verdict.FALSE
    ),
)
