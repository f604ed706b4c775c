"""Observers, runs and what is asked of them: calls that strangers made, each refused with what to do."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from examples import BOTH
from refusals import refuses

import percept_obs as po
from percept_obs import Camera, ekf, figures, ibo, pinhole, track
from percept_obs.observers import gains, ismo, parts
from percept_obs.observers.integral_sliding_mode import ultimate_bound
from percept_obs.points import constant, scenarios, scheduled
from percept_obs.recording import plausibility
from percept_obs.structure import seen_as
from percept_obs.structure.competitors import scale_spread
from percept_obs.structure.pixels import homography
from percept_obs.structure.scenarios import chwa2019_experiment, chwa2019_simulation
from percept_obs.studies import comparison, fields, servoing, tuning
from percept_obs.studies.all_observers import all_observers
from percept_obs.studies.sensitivity import misbelieved, sensitivity
from percept_obs.tracking import smoothing, transition

SEEN = po.record(po.scenarios.ma2005_eq35(), 1, Camera(0.1, po.Gaussian(0.01)))
EARLY = SEEN.between(0, 0.9)
TWO = po.record(scenarios.moving_body(2), 1, Camera(0.1))
RUN, RUN_OF_TWO, SCENE = track(SEEN, ekf(BOTH)), track(TWO, po.luenberger(TWO.view)), chwa2019_experiment("IV.A")
TURNED, FORWARDS = po.PerspectiveSystem(po.rigid(), pinhole()), po.affine(np.zeros((3, 3)), (0, 0, -0.5))
MAP = po.bound_map(po.PerspectiveSystem(FORWARDS, pinhole()), resolution=3)
NEGATIVE = po.FunctionObserver("f", BOTH, np.copy, lambda s, *_: s, np.copy, lambda s: -np.eye(3))

test_what_is_of_one_point_says_so = refuses(
    lambda call: call(),
    (lambda: track(TWO, ibo(BOTH)), "the form is of one point; the recording shows 2 points"),
    (lambda: comparison.compare([TWO], [ibo(BOTH)]), "a comparison is of one point; the recording shows 2 points"),
    (lambda: po.lie_derivatives(BOTH).along(TWO), "the form is of one point; the recording shows 2 points"),
    (lambda: figures.distance(RUN_OF_TWO), "this figure is of one point; the recording shows 2 points"),
    (lambda: po.check_consistency(RUN_OF_TWO), "claims no covariance"),
)
test_they_are_refused_with_what_to_do = refuses(
    lambda call: call(),
    (lambda: ibo(BOTH, switch="sign"), "has no gain switch"),
    (lambda: ibo.refusal(None), "form is None"),
    (lambda: parts.noise_bias(BOTH, sp.ImmutableMatrix([1])), r"expected \(2, 1\)"),
    (lambda: parts.kept_within((), ()), "at least one"),
    (lambda: gains.Gain(sp.Symbol("K"), "k", 1, 10, 0, "1/s", "pull"), "the lower end first"),
    (lambda: replace(ibo, gains=ibo.gains[0]), "put it into a list"),
    (lambda: ibo(BOTH).lambdify(po.rigid(), lambda t: (0, 0)), "give such a motion"),
    (lambda: po.with_point(po.with_point(ibo(BOTH))), "has its point already"),
    (lambda: replace(ibo(BOTH), form=TURNED.measure("y1", "y2")), "which its form has not"),
    (lambda: track(SEEN, NEGATIVE), "negative variance at 0 s"),
    (lambda: transition(BOTH)(np.zeros(3), 0.1, {}), "known has no a11"),
    (lambda: replace(RUN, estimate=np.zeros((3, 3))), r"expected \(\.\.\., 11, 3\)"),
    (lambda: RUN.estimate.__setitem__((0, 0), 5.0), "read-only"),
    (lambda: track(SEEN, ekf(BOTH), smoothing.Belief(np.zeros(3), -np.eye(3))), "must be positive semidefinite"),
    (lambda: MAP.at(100, 0), "the map goes from -1 to 1"),
    (lambda: po.efficiency([RUN, RUN], po.cramer_rao(SEEN, BOTH)), "each once"),
    (lambda: replace(po.check_consistency(RUN, 5), samples=0), "samples is 0"),
    (lambda: comparison.compare([SEEN], [ibo(BOTH)], columns={"rms": len}), "has already"),
    (lambda: tuning.best_setting([SEEN], [ibo(BOTH, gain=3)], lambda *_: RUN, [0.1]), "runs another observer"),
    (lambda: fields.field_bound(pinhole(), FORWARDS, np.pi), "take a smaller one"),
    (lambda: servoing.servo([[0, 0, 0, 0, 0, 30]], "true"), "were degrees meant"),
    (lambda: constant(2.0).at([0.0]), "no size yet"),
    (lambda: SCENE.choice.theta_values(4, FORWARDS, [0.0]), r"none of rigid\(\)"),
    (lambda: SCENE.choice.inverse([0.1] * 3), r"expected \(\.\.\., 6\)"),
    (lambda: seen_as(SEEN, SCENE.choice, SCENE.motion), "needs the outputs"),
    (lambda: po.luenberger(TWO.view, lambda: 1.0), r"a function of 1 argument or .*: it takes \(\)"),
    (lambda: comparison.compare([SEEN], [ibo(BOTH)], columns={"x": lambda: 1}), "to a function of 1 argument"),
    (lambda: po.semigeneral(SEEN, SCENE.motion, 0.5, lambda: 5), "expected a function of 1 argument"),
    (lambda: comparison.compare([SEEN], [ibo(BOTH)], columns={"x": lambda _: None}), "column 'x' of a run is None"),
    (lambda: comparison.compare([SEEN], [ibo(BOTH)], columns={"x": lambda r: r.time}), "11 numbers; let its function"),
    (
        lambda: all_observers([SEEN, EARLY], after=[0.5], columns={"x": str}, candidates={ibo: [{}]}),
        "'x' of a run is the",
    ),
    (lambda: po.ensemble(po.scenarios.ma2005_eq35(), ibo(BOTH), duration=-1), "duration is -1.0; it must be positive"),
    (lambda: sensitivity(SEEN, ibo(BOTH), entries=["b3", "b3"]), "entries has b3 twice; give each once"),
    (lambda: sensitivity(SEEN, ibo(BOTH), entries=["b3"]).change(b3=np.inf), "give finite ones"),
    (lambda: sensitivity(SEEN, ibo(BOTH), entries=["b3"]).distance_change(500), "was it in %"),
    (lambda: fields.field_bound(pinhole(), FORWARDS, measured=("y1", "y1")), "measured has y1 twice"),
    (lambda: fields.field_bound(pinhole(), FORWARDS, size=3).within(0, 25), "from 0 to pi"),
    (lambda: po.ensemble(po.scenarios.ma2005_eq35(), ibo(BOTH), {"gain": [5, 5]}), "over gain has 5.0 twice"),
    (lambda: all_observers([SEEN, EARLY], after=(1, 1)), "after has 1 twice"),
    (lambda: all_observers([SEEN], choosing=[EARLY], split="earlier and later"), "and so does split"),
    (lambda: servoing.servo(np.zeros((0, 6)), "true"), "give finite rows"),
    (lambda: servoing.servo(servoing.starts(1), ekf(servoing.FORM), ratio=0.5), "leave it out with an observer"),
    (lambda: servoing.servo(servoing.starts(1), "true", noise=10), "below 1"),
    (lambda: servoing.servo(servoing.starts(1), "true", looking=-1), "a speed and a whole number from 0 on"),
    (lambda: servoing.servo(servoing.starts(1), "true", duration=0.1).camera(True), "expected a whole number"),
    (lambda: servoing.starts(10**9), "take fewer"),
    (lambda: scheduled(lambda t: 1 + t, times=[0, 1]), "give one of the two"),
    (lambda: chwa2019_simulation("V.A", (0.1, 0.2)), r"expected \(\.\.\., 3\)"),
    (lambda: ultimate_bound(ibo(BOTH), 0.5), "has no feedback"),
    (lambda: ultimate_bound(ismo(BOTH), -5.0), r"is -5.0; it is the largest \|g\|"),
    (lambda: track(TWO, po.luenberger(TWO.view), {"r_x": 1, "foo": 2}), "no coordinate foo; give estimates of r_x"),
    (lambda: tuning.best_setting([SEEN], [ibo(BOTH)], lambda r: RUN), "expected a function of 2 arguments"),
    (lambda: tuning.best_setting([SEEN], [ibo(BOTH)], lambda r, o: o), "its result is an Observer"),
    (lambda: comparison.compare([SEEN, SEEN], [ibo(BOTH)]), "twice; give each once"),
    (lambda: RUN.outcome(np.inf), "must be positive and finite"),
    (lambda: po.efficiency([RUN, track(SEEN, ibo(BOTH))], po.cramer_rao(SEEN, BOTH)), "run 2 is of the identifier-b"),
    (lambda: po.windowed(BOTH, SEEN, 0.01), "shorter than the 0.1 s between two samples"),
    (lambda: po.bound_map(MAP.system, 0.01), "give at least 0.05"),
    (lambda: replace(MAP, distance=-5.0), "distance is -5.0"),
    (lambda: po.StructureAndMotion(("v_p1",), ("v_c1",), ("v_c1",), 4.0), "cannot be zero and estimated earlier"),
    (lambda: chwa2019_simulation("IV.A", (0, 1)), r"expected \(\.\.\., 3\)"),
    (lambda: homography([[0, 0], [1, 0], [0, 1], [1, 1]], np.full((4, 2), 2.0)), "the same one"),
    (lambda: scale_spread(windows=[(10, 9)]), "the earlier one first"),
    (lambda: scale_spread([60.0], windows=[(0.1, 0.2)], observers=["KF"]), "'KF' is none of the competitors"),
    (lambda: misbelieved(SEEN.motion), "none is named"),
    (lambda: po.lie_derivatives(po.PerspectiveSystem(po.affine(), po.sphere()), 4), "fewer orders"),
)


def test_lists_are_arrays_and_per_cent_are_doubted():
    assert replace(MAP, y1=[-1, 0, 1], relative=[[0, 1, 2]] * 3).at(0, 0) == 1
    with pytest.warns(plausibility.Unlikely, match="the tolerance is 10, more than"):
        RUN.settling_time(10)
