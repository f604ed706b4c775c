"""Checks of what comes in: slips are told by what to write instead, work is limited beforehand, files are whole."""

import math
import warnings
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from examples import BOTH
from numpy.typing import ArrayLike
from refusals import refuses

from percept_obs import (
    BehindCamera,
    Camera,
    PerspectiveSystem,
    PointsForm,
    Scenario,
    affine,
    ekf,
    ensemble,
    ibo,
    instantaneous,
    lie_derivatives,
    linear,
    pinhole,
    record,
    rigid,
    scenarios,
    steered,
    track,
)
from percept_obs.exercises import reach
from percept_obs.figures import image_plane, signals
from percept_obs.observers import lao
from percept_obs.observers.gains import grid
from percept_obs.points import PointsScenario, independent_points
from percept_obs.points.scenarios import moving_body
from percept_obs.recording import render
from percept_obs.recording.path import varying_path
from percept_obs.studies.comparison import compare
from percept_obs.system.motion import TIME, AreTheseDegrees
from percept_obs.validation import TooMuchWork, WrongKind, checked, expression

SYSTEM = PerspectiveSystem(affine(), pinhole())
SHORT = record(scenarios.ma2005_eq35(), 1, Camera(0.1))
STILL = affine(np.zeros((3, 3)), np.zeros(3))


@pytest.mark.parametrize(
    ("slip", "told"),
    [
        (lambda: Camera(noise=0.01), r"noise is the number 0.01; expected a Uniform or a Gaussian: .*Uniform\(0.01\)"),
        (lambda: record("ma2005_eq35"), r"scenario is the text 'ma2005_eq35'; .*scenarios.ma2005_eq35\(\)"),
        (lambda: record(scenarios.ma2005_eq35), r"the function ma2005_eq35; .*: call it: ma2005_eq35\(\)"),
        (lambda: ibo(["y1", "y2"]), r"form is the list \['y1', 'y2'\]; .*measure\(\"y1\", \"y2\"\)"),
        (lambda: track(SHORT, ibo), r"the function identifier_based; .*: call it: identifier_based\(form\)"),
        (lambda: compare(SHORT, ibo(BOTH)), "recordings is a Recording; .*: put it into a list"),
        (lambda: compare([SHORT], ibo(BOTH)), "observers is an Observer; .*: put it into a list"),
        (lambda: PerspectiveSystem(affine(), "pinhole"), r"surface is the text 'pinhole'; .*pinhole\(\)"),
        (lambda: SYSTEM.measure(["y1", "y2"]), r"pass its entries one by one: .*measure\('y1', 'y2'\)"),
        (lambda: track(SHORT), "missing a required argument: 'observer'; it takes track"),
        (lambda: Camera(peroid=0.1), "unexpected keyword argument 'peroid'; it takes Camera"),
        (lambda: ibo(BOTH, gain="3"), "gain is the text '3'; expected a real number"),
        (lambda: track(SHORT, ibo(BOTH), start="zero"), "start is the text 'zero'"),
        (lambda: Camera(period=True), "period is True; expected a real number"),
        (lambda: affine(1j * np.eye(3), np.ones(3)), "A is an array .* of type|A is an array of shape"),
    ],
)
def test_a_slip_is_told_by_what_to_write_instead(slip, told):
    with pytest.raises(WrongKind, match=told) as told_of:
        slip()
    assert isinstance(told_of.value, ValueError)
    assert isinstance(told_of.value, TypeError)


def test_a_motion_of_another_size_is_refused():
    with pytest.raises(ValueError, match=r"4 states.*affine\(\) or rigid\(\)"):
        PerspectiveSystem(linear(states=4), pinhole())


def test_a_system_stands_for_all_it_can_measure():
    assert ibo(SYSTEM).form == BOTH
    assert ekf(SYSTEM).form.measured == ("y1", "y2")


def test_exact_numbers_of_formulas_stay_exact():
    _, radius = instantaneous(BOTH).circle(sp.Rational(1, 7))
    assert radius.atoms(sp.Float) == set()


@pytest.mark.parametrize(
    "value", ["x", "1", b"1", 1j, np.complex64(1), math.nan, math.inf, sp.oo, sp.nan, sp.I, True, None]
)
def test_what_is_no_real_number_becomes_no_expression(value):
    with pytest.raises(WrongKind, match=r"the gain is .*never text"):
        expression(value, "the gain")


def test_numbers_become_expressions():
    assert [expression(v, "it") for v in (2, Fraction(1, 3), sp.Symbol("a"), np.float64(0.5))] == [
        sp.Integer(2),
        sp.Rational(1, 3),
        sp.Symbol("a"),
        sp.Float(0.5),
    ]


def at_time(*entries):
    """A point whose motion is given by expressions of time."""
    return Scenario("s", affine(sp.zeros(3, 3), entries), (1, 1, 3), 2, pinhole()).points([0.0, 2.0])


test_what_has_no_sense_is_refused_in_a_sentence = refuses(
    lambda call: call(),
    (lambda: at_time(0, 0, sp.gamma(TIME)), "the motion of 's' has no value at 0 s"),
    (lambda: at_time(0, 0, 1 / TIME), "it changes too fast: slow it down"),
    (lambda: at_time(sp.sin(10**6 * TIME), 0, 0), "it changes too fast: slow it down"),
    (lambda: affine(np.eye(3), lambda: 1), "the motion's b .* must be a function of a time alone: too many"),
    (lambda: PointsForm(rigid(camera_angular_velocity=[0, 0, -1]), np.zeros((2, 3, 3))), "a block of C is 0"),
    (lambda: render(SHORT, 0), "0 frames of 160 pixels a side are none"),
    (lambda: render(SHORT, size=10**6), "pixels, from 11 frames of the size 1000000, "),
    (lambda: image_plane(SHORT, ax=5), "ax is the number 5; expected an Axes"),
    (
        lambda: signals(track(SHORT, ibo(BOTH)), axes=[1, 2, 3, 4]),
        "axes is the list .*; expected a sequence, each entry an Axes",
    ),
    (lambda: grid(gain=5), "gain is the number 5; .*: put it into a list"),
    (lambda: reach(1.0, lambda gain: {"seconds": "soon"}, seconds=2), "the experiment gives no number seconds"),
)


test_too_much_work_is_refused_before_it_begins = refuses(
    lambda work: work(),
    (lambda: record(scenarios.ma2005_eq35(), 1e9), "1e\\+11 samples.*shorten the duration"),
    (lambda: record(scenarios.ma2005_eq35(), 10, Camera(1e-9)), "samples.*lengthen the camera's period"),
    (lambda: record(moving_body(9), 1e5), "samples"),
    (lambda: track(SHORT, ibo(BOTH), step=1e-9), "1e\\+09 steps.*take longer steps"),
    (lambda: track(SHORT, ibo(BOTH), step=2e-7), r"3\.5e\+07 numbers, from 5e\+06 steps"),
    (lambda: steered(replace(scenarios.ma2005_eq35(), duration=1e9)), "numbers of a velocity.*take a shorter"),
    (lambda: lie_derivatives(BOTH, orders=6), r"2\.46e\+04 terms of Lie derivatives"),
    (lambda: lao(BOTH, iterates=2000), "2e\\+03 iterates.*take fewer"),
    (lambda: moving_body(2000), "points of a body.*take fewer points"),
    (lambda: independent_points(rigid(), 10**6), "points of a body"),
    (lambda: linear(states=2000), "entries of A.*fewer states"),
    (lambda: scenarios.ma2005_eq35().points(range(10**9)), r"1e\+09 entries of a range"),
    (lambda: ensemble(scenarios.ma2005_eq35(), ibo(BOTH), seeds=range(10**20)), r"1e\+20 entries of a range"),
    (lambda: ensemble(scenarios.ma2005_eq35(), ibo(BOTH), {"gain": range(10**12)}), r"1e\+12 runs"),
    (
        lambda: Scenario("s", affine(1e9 * np.diag([-1, 0, 0]), [0, 0, 0]), (1, 1, 1), 1, pinhole()).points([1.0]),
        "slow",
    ),
    error=TooMuchWork,
)


def test_a_constant_motion_is_exact_however_fast():
    times = [0.0, 0.01, 0.02]
    fast = Scenario("fast", affine(np.diag([-400.0, 0, 0]), np.zeros(3)), (1, 1, 1), 1, pinhole())
    np.testing.assert_allclose(fast.points(times)[:, 0], np.exp(-400 * np.array(times)), rtol=1e-12)
    for w in (1.0, 57.3, 200.0, 5000.0):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", AreTheseDegrees)
            circle = Scenario("circle", rigid(camera_angular_velocity=[0, 0, -w]), (1, 0, 2), 1, pinhole())
        times = np.linspace(0, 20, 401)
        expected = np.stack([np.cos(w * times), np.sin(w * times), 2 + 0 * times], axis=-1)
        np.testing.assert_allclose(circle.points(times), expected, atol=1e-13 * (1 + 20 * w))


def test_a_motion_that_varies_is_as_exact():
    """A turn of rate 40 cos(5 t) about the axis has the angle 8 sin(5 t)."""
    times = np.linspace(0, 1, 101)
    turn = rigid(camera_angular_velocity=lambda t: [0, 0, -40 * np.cos(5 * t)])
    angle = 8 * np.sin(5 * times)
    expected = np.stack([np.cos(angle), np.sin(angle), 2 + 0 * times], axis=-1)
    found = Scenario("swing", turn, (1, 0, 2), 3, pinhole()).points(times)
    np.testing.assert_allclose(found, expected, atol=1e-8)
    form = independent_points(turn, 1)
    np.testing.assert_allclose(PointsScenario("swing", form, (1, 0, 2), 3).coordinates(times), expected, atol=1e-8)


def test_a_motion_that_changes_too_fast_is_refused(monkeypatch):
    monkeypatch.setattr("percept_obs.recording.path.MOST_EVALUATIONS", 2000)
    with pytest.raises(TooMuchWork, match="it changes too fast: slow it down"):
        varying_path(lambda t, x: 1e5 * np.cos(1e5 * t) * np.ones(1), np.zeros(1), np.array([0.0, 10.0]))


@pytest.mark.parametrize("period", [1.0, 0.5])
def test_a_dip_behind_the_camera_between_samples_is_seen(period):
    around = rigid(camera_angular_velocity=[0, -2 * np.pi / period, 0])
    dips = Scenario("dips", around, (0, 0, 1), 3, pinhole())
    with pytest.raises(BehindCamera, match="'dips' the point dips behind the pinhole between two samples, at about"):
        record(dips, camera=Camera(period))
    beside = replace(dips, position=(0, 0.1, 1), motion=affine(np.zeros((3, 3)), [0, 0, -0.3]))
    assert record(beside, camera=Camera(period)).distance[-1] == pytest.approx(0.1)


def test_degrees_are_asked_for():
    with pytest.warns(AreTheseDegrees, match=r"30 rad/s.*were degrees meant.*np.radians"):
        rigid(camera_angular_velocity=[0, 0, -30])
    with pytest.warns(AreTheseDegrees):
        rigid(camera_angular_velocity=np.full((3, 3), 20.0), times=[0, 1, 2])
    turning = rigid(camera_angular_velocity=lambda t: [0, 0, -30 * t])
    with pytest.warns(AreTheseDegrees) as told:
        record(Scenario("turns", turning, (1, 0, 2), 1, pinhole()), camera=Camera(0.1))
    assert told[0].filename == __file__
    rigid(camera_angular_velocity=[0, 0, -20])


@pytest.mark.parametrize("nothing", [np.nan, np.float64("nan"), np.array(np.nan), sp.nan])
def test_nan_is_no_real_number_also_after_numbers_were_seen(nothing):
    for _ in range(2):
        Camera(0.1), Camera(np.float64(0.1))
        with pytest.raises(WrongKind, match="expected a real number"):
            Camera(nothing)


def test_an_array_is_looked_at_once_by_the_type_of_its_entries():
    @checked
    def total(values: ArrayLike, pair: tuple[float, float] = (0.0, 0.0)) -> float:
        return float(np.sum(values)) + sum(pair)

    @checked
    def mean(values: ArrayLike) -> float:
        return float(np.mean(values))

    for function in (total, mean):
        assert function(np.ones(2)) == function(np.ones(2)) == function(np.ones(2))
        with pytest.raises(WrongKind, match="values is"):
            function(np.array(["1", "2"]))
        with pytest.raises(WrongKind, match="values is"):
            function(np.array([1, "2"], dtype=object))
    assert total(np.ones(2), np.ones(2)) == 4
    with pytest.raises(WrongKind, match="pair is"):
        total(np.ones(2), np.ones(3))
