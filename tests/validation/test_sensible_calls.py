"""What is sensible is taken, and means what the plain call means; the nearest thing that has no sense is refused."""

import math
from datetime import datetime, timedelta
from decimal import Decimal
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
import sympy as sp
import xarray as xr
from equal_values import difference
from examples import AFFINE, BOTH
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

from percept_obs import (
    Camera,
    Clock,
    Gaussian,
    PerspectiveSystem,
    PixelCamera,
    Poses,
    Recording,
    Scenario,
    affine,
    cramer_rao,
    ensemble,
    how_observable,
    ibo,
    linear,
    pinhole,
    record,
    rigid,
    rigid_from_poses,
    scenarios,
    track,
)
from percept_obs.figures import runs_over_time, signals
from percept_obs.labs import observer_lab
from percept_obs.studies.comparison import compare

T = np.arange(11) / 10
SEEN = np.column_stack([0.1 + 0.1 * T, 0.2 - 0.1 * T])
GAP = np.where(np.arange(11)[:, None] == 3, np.nan, SEEN)
NONE = [[None if math.isnan(v) else v for v in row] for row in GAP.tolist()]
FRAME = pd.DataFrame(GAP, columns=["y1", "y2"])
FIELDS = np.array([*map(tuple, GAP)], dtype=[("y1", float), ("y2", float)])
PASSED, DAY = (1000 * T).astype("timedelta64[ms]"), datetime(2024, 1, 1)
LATER = [timedelta(seconds=t) for t in T.tolist()]
INDEX = pd.to_timedelta(T, unit="s")
A, B = np.array([[0, 0.1, 0], [0, 0, 0], [0, 0, 0.1]]), np.array([0.3, 0.1, 0.2])
PLACES, TURNS = np.outer(T, [1, 0, 0]), Rotation.from_rotvec(np.outer(T, [0, 0, 0.1]))
WXYZ = pd.DataFrame(np.roll(TURNS.as_quat(), 1, axis=1), columns=["qw", "qx", "qy", "qz"])
SCENE, NOISY, Y3 = scenarios.ma2005_eq35(), Camera(0.1, Gaussian(0.01)), sp.Symbol("y3")
TRUTH = np.column_stack([SEEN, np.full(11, 0.5)])
SHORT, OBSERVER, IN_FOUR = record(SCENE, 1, Camera(0.1)), ibo(BOTH), Figure().subplots(4)
RUN = track(SHORT, OBSERVER)


def seen(time=T, outputs=SEEN, names=("y1", "y2"), **more):
    return Recording(time, outputs, names, pinhole(), rigid(camera_velocity=[0.3, 0, 0]), **more)


def table(recordings, of=len):
    return compare(recordings, [OBSERVER], columns={"of": lambda run: of(run.time)}).table["of"].tolist()


class Tensor:
    """What torch has: an array where one is asked for."""

    def __init__(self, values):
        self.values = np.asarray(values)

    def __array__(self, dtype=None, copy=None):
        return np.array(self.values, dtype)


def with_gradient(values):
    """What torch has of a tensor that keeps its gradient: an array after `detach` only."""

    class Gradient:
        def __array__(self, dtype=None, copy=None):
            raise RuntimeError("call detach() first")

        def detach(self):
            return np.array(values)

    return Gradient()


def labelled(values, names, order):
    """An array of xarray whose entries of a row have names, in another order."""
    values = np.asarray(values)[..., order]
    return xr.DataArray(values, coords={"name": names.split()}, dims=["row", "name"][-values.ndim :])


class Quantity(Tensor):
    """What pint has."""

    def __init__(self, magnitude, units=""):
        super().__init__(magnitude)
        self.magnitude, self.units = magnitude, units

    def m_as(self, units):
        if self.units != units:
            raise TypeError(f"{self.units} are no {units}")
        return self.magnitude


CALLS = [
    (lambda outputs: seen(outputs=outputs), [
        (np.ma.masked_invalid(GAP), GAP, np.ma.array(SEEN > 0), "type bool"),
        (NONE, GAP, [["None"] * 2] * 11, "expected an array of real numbers or a table"),
        (FRAME.astype("Float64"), GAP, FRAME.astype(str), "outputs is a DataFrame"),
        (FRAME.astype(object).where(FRAME.notna(), pd.NA), GAP, FRAME > 0, "outputs is a DataFrame"),
        (SEEN.astype(int), SEEN.astype(int) * 1.0, SEEN > 0, "type bool"),
        (FRAME[["y2", "y1"]], GAP, FRAME[["y1"]], "it needs y2"),
        (FIELDS, GAP, FIELDS.astype([("u", float), ("v", float)]), "the columns u, v; it needs y1, y2"),
        (xr.Dataset({name: ("time", FRAME[name]) for name in FRAME}), GAP, xr.Dataset({"y1": ("time", T)}), "needs y2"),
        (np.asfortranarray(SEEN), SEEN, np.asfortranarray(SEEN.T), r"outputs of shape \(2, 11\)"),
    ]),
    (lambda outputs: seen(outputs=outputs, names=["y1"]), [
        (SEEN[:, 0], SEEN[:, :1], SEEN.ravel(), "the times come first"),
    ]),
    (lambda truth: seen(truth=truth).truth, [
        (labelled(TRUTH, "y3 y1 y2", [2, 0, 1]), TRUTH, labelled(TRUTH, "u v w", [0, 1, 2]), "it needs y1, y2, y3"),
        (FRAME.assign(y3=T + 1), np.c_[GAP, T + 1], FRAME, "it needs y3: rename them, or fill them with NaN"),
    ]),
    (lambda laser: seen(distances={"laser": laser}), [
        (pd.Series([1, None] * 5 + [2], dtype="Int64"), [1, np.nan] * 5 + [2], [1, None] * 5 + [-2], "positive"),
    ]),
    (lambda time: seen(time), [
        (PASSED, T, np.datetime64(DAY) + PASSED, "for example t - t"),
        (LATER, T, [DAY + later for later in LATER], "for example t - t"),
        (T[:, None], T, T[None], r"times of shape \(1, 11\)"),
        (FRAME.set_index(T).index, T, FRAME.set_index(T.astype(str)).index, "time is an Index"),
        ((k / 10 for k in range(11)), T, {*T.tolist()}, "time is the set"),
        (1.7e9 + T, (1.7e9 + T).tolist(), (1e9 * (1.7e9 + T)).astype(int), "if they are nanoseconds since 1970"),
        (memoryview(T), T, memoryview(b"0123"), r"expected \(4, 2\)"),
        (SimpleNamespace(to_numpy=T.copy), T, SimpleNamespace(to_numpy=T.astype(str).copy), "is a SimpleName"),
    ]),
    (lambda times: affine(A, np.outer(T, B), times), [
        (INDEX, T, DAY + INDEX, "for example t - t"),
        (T[:, None], T, T[None], "has shape"),
    ]),
    (Scenario("s", affine(A, B), (1, 1, 3), 2.0, pinhole()).points, [(T[:, None], T, T[None], "times must be a list")]),
    (lambda names: seen(names=names), [
        (FRAME.columns, ("y1", "y2"), pd.Index(["u", "v"]), "there are y1, y2"),
        (pinhole().image_coordinates, ("y1", "y2"), sp.symbols("u v"), "there are y1, y2"),
        (iter(["y1", "y2"]), ("y1", "y2"), {"y1", "y2"}, "names is the set"),
    ]),
    (lambda orientations: Poses(T, PLACES, orientations), [
        (TURNS, TURNS.as_quat(), TURNS[:5], "expected 11 rows"),
        (WXYZ, TURNS.as_quat(), WXYZ[["qx", "qy", "qz"]], "a quaternion is x, y, z, w"),
        (pd.Series(list(TURNS.as_quat())), TURNS.as_quat(), pd.Series(["0 0 0 1"] * 11), "orientation is a Series"),
    ]),
    (lambda turn: Poses(T, PLACES, TURNS).mounted(sp.Matrix([0, 0, 1]), turn), [
        (pd.Series({"qw": 0.8, "qx": 0.6, "qy": 0, "qz": 0}), [0.6, 0, 0, 0.8], [0.6, 0, 0], "of a quaternion"),
    ]),
    (lambda sigma: Poses(T, PLACES, TURNS, sigma), [((0.01, sp.pi / 90), (0.01, np.pi / 90), (0.01, 2.0), "radians")]),
    (pinhole().project, [
        (pd.Series({"X": 1, "Y": 2, "Z": 4}), [1, 2, 4], pd.Series({"Z": 4, "X": 1, "Y": 2}), "labels Z, X, Y, and"),
        (with_gradient([1.0, 2, 4]), [1, 2, 4], with_gradient(["a"]), "points is a Gradient"),
    ]),
    (PixelCamera((500, 500), (320, 240)).image, [
        (pd.DataFrame({"u": [820], "v": [240]}), [[820, 240]], pd.DataFrame({"v": [240], "u": [820]}), "labels v, u"),
    ]),
    (lambda v: rigid(camera_velocity=v), [
        (pd.Series([1, 2, 3], ["vx", "vy", "vz"]), [1, 2, 3], pd.Series([3, 1, 2], ["vz", "vx", "vy"]), "in order"),
    ]),
    (lambda orientations: rigid_from_poses(T, PLACES, orientations), [
        (list(TURNS), TURNS.as_quat(), list(TURNS.as_rotvec()), "a quaternion is x, y, z, w"),
    ]),
    (lambda b: affine(A, b), [
        (B[:, None], B, B[None], r"has shape \(1, 3\); expected \(3,\); samples need times="),
        ([Decimal("0.3"), Fraction(1, 10), sp.Rational(1, 5)], B, [Decimal(1), "2", 3], "b is the list"),
        (Tensor(B), B, Tensor(1j * B), "b is a Tensor"),
        (Quantity(B), B, Quantity(B, "m/s"), "a quantity in m/s; .* pass numbers, in seconds, metres"),
        ([*map(Quantity, B)], B, [Quantity(b, "m/s") for b in B], "a quantity in m/s"),
    ]),
    (lambda b: affine(A, b).known(T), [
        (lambda t: [[t], [0], [0]], lambda t: [t, 0, 0], lambda t: [[t, 0, 0]], r"has shape \(1, 3\)"),
    ]),
    (lambda v: linear(A, v), [(sp.Matrix(B), B, [B], r"has shape \(1, 3\)")]),
    (lambda place: Scenario("s", affine(A, B), place, 2.0, pinhole()), [
        ([[1], [1], [3]], (1, 1, 3), [[1, 1], [3, 3]], "expected a sequence, each entry a real number"),
        (pd.Series({"Z": 3, "X": 1, "Y": 2}), (1, 2, 3), pd.Series({"Z": 3, "X": None, "Y": 2}), "finite numbers"),
    ]),
    (lambda distortion: PixelCamera((500, 500), (320, 240), distortion=distortion), [
        (np.zeros((1, 5)), np.zeros(5), np.zeros((2, 5)), "distortion is an array of shape"),
    ]),
    (lambda seed: record(SCENE, 1, NOISY, seed).outputs, [
        (np.array(3), 3, 2**32, r"a whole number from 0 to 2\^32 - 1, or None"),
        (3.0, 3, 3.5, "seed is the number 3.5"),
    ]),
    (lambda seed: record(SCENE, 1, NOISY, seed).outputs.shape, [(None, 0, "0", "seed is the text '0'")]),
    (lambda start: track(SHORT, OBSERVER, start), [
        ({Y3: 0.5}, {"y3": 0.5}, {2 * Y3: 0.5}, "expected a mapping from text"),
        (pd.Series({"y3": 0.5, "y1": 0.1, "y2": 0.2}), [0.1, 0.2, 0.5], pd.Series({"y4": 0.5}), "no coordinate y4"),
        ([[0.1], [0.2], [0.5]], [0.1, 0.2, 0.5], [[0.1, 0.2, 0.5]] * 2, "expected a mapping from text"),
        (labelled([0.1, 0.2, 0.5], "y3 y1 y2", [2, 0, 1]), [0.1, 0.2, 0.5], {"y3": 0.4, Y3: 0.5}, "a mapping"),
    ]),
    (lambda over: ensemble(SCENE, OBSERVER, over, duration=0.5, camera=NOISY).rms.values, [
        ({sp.Symbol("gain"): [2, 3]}, {"gain": [2, 3]}, {sp.Symbol("G"): [2, 3]}, "over has G, which cannot vary"),
        ({"gain": iter([2, 3])}, {"gain": [2, 3]}, {"gain": iter("ab")}, "over gain is the list"),
        ({"gain": 2.0}, {"gain": [2]}, {"gain": "2"}, "over gain is the text"),
        ({"gain": sp.Matrix([2, 3])}, {"gain": [2, 3]}, {"gain": np.eye(2) + 1}, r"values of shape \(2, 2\)"),
        ({"gain": {"a": 2, "b": 3}.values()}, {"gain": [2, 3]}, {"gain": {"a": 2}}, "over gain is the dict"),
    ]),
    (AFFINE.measure, [(AFFINE.coordinates[0], "y1", AFFINE.coordinates[2], "cannot measure 'y3'")]),
    (lambda c: PerspectiveSystem(affine(sp.zeros(3), [c, 0, 0]), pinhole()).rate, [
        (sp.Symbol("c"), sp.Symbol("c"), sp.Symbol("y1"), "has the letter y1"),
    ]),
    (Camera, [
        (np.timedelta64(100, "ms"), 0.1, np.datetime64(DAY), "expected a real number"),
        (timedelta(seconds=0.1), 0.1, DAY, "period is a datetime"),
        (np.array([0.1]), 0.1, np.array([0.1, 0.2]), "expected a real number"),
        (pd.Series([0.1]), 0.1, [0.1], "period is the list"),
        (xr.DataArray(0.1), 0.1, xr.DataArray(True), "expected a real number"),
        (np.float32(0.1), 0.1, np.complex64(0.1), "the complex number"),
        (Decimal("0.1"), 0.1, Decimal("NaN"), "period is a Decimal"),
        (Fraction(1, 10), 0.1, Fraction(-1, 10), "it must be positive"),
    ]),
    (lambda angle: Camera(field_of_view=angle), [(sp.pi, math.pi, 4 * sp.pi, "at most 2 pi")]),
    (lambda gain: ibo(BOTH, gain=gain), [
        (sp.Rational(5), 5, sp.Symbol("q"), "gain is a Symbol"),
        (Quantity(5.0), 5.0, Quantity(5.0, "Hz"), "a quantity in Hz"),
    ]),
    (lambda window: how_observable(SHORT, BOTH, window).window, [(Decimal("0.5"), 0.5, "0.5", "window is the text")]),
    (lambda zero: Clock(zero, np.array(0.001)), [(np.int64(5), 5, Decimal("inf"), "zero is a Decimal")]),
    (lambda P: cramer_rao(record(SCENE, 1, NOISY), BOTH, P).covariance, [
        (pd.DataFrame(np.eye(3)), np.eye(3), pd.DataFrame(-np.eye(3)), "definite"),
    ]),
    (lambda noise: cramer_rao(SHORT, BOTH, noise_variance=noise).covariance, [
        (pd.Series({"y2": 2e-4, "y1": 1e-4}), [1e-4, 2e-4], {"y1": 1e-4}, "names y1; name all of y1, y2"),
    ]),
    (lambda settings: dict(observer_lab(**settings).settings), [
        ({"b": sp.Matrix([1, 0, 2])}, {"b": [1, 0, 2]}, {"b": [[1, 2, 3]]}, "a list of 3"),
        ({"outputs": sp.Symbol("y1")}, {"outputs": ["y1"]}, {"outputs": Y3}, "at least one of y1, y2"),
        ({"seed": 3.0}, {"seed": 3}, {"seed": 3.5}, "seed is 3.5"),
        ({"noise": Gaussian(0.01)}, {"noise": {"kind": "gaussian", "size": 0.01}}, {"noise": Camera()}, "a mapping of"),
        ({"X0": pd.Series([1, 1, 3], [*"XYZ"])}, {"X0": [1, 1, 3]}, {"X0": pd.Series([3, 1, 1], [*"ZXY"])}, "Z, X, Y"),
        ({"duration": Decimal(5)}, {"duration": 5}, {"duration": "5"}, "duration is '5'"),
        ({"X0": pd.Series([1, 1, 3])}, {"X0": [1, 1, 3]}, {"X0": pd.Series([1, 1])}, "a list of 3"),
        ({"observers": pd.Index(["de_luca"])}, {"observers": ["de_luca"]}, {"observers": {"de_luca"}}, "observers"),
    ]),
    (table, [(iter([SHORT]), [SHORT], SHORT, "put it into a list")]),
    (lambda of: table({"a": SHORT}.values(), of), [(lambda t: t[-1:], lambda t: t[-1], np.copy, "11 numbers")]),
    (lambda axes: signals(RUN, axes=axes).text, [(IN_FOUR.flat, list(IN_FOUR), IN_FOUR[0], "put it into a list")]),
    (lambda name: runs_over_time([RUN], coordinate=name).text, [(AFFINE.coordinates[2], "y3", sp.Symbol("y9"), "y9")]),
    (lambda hold: track(SHORT, OBSERVER, hold=hold), [("first", "first", "second", "'zero', 'first', 'exact'")]),
]  # fmt: skip
"""A call of one argument, and for it: what is sensible, what that means, the nearest that is refused, and why."""

ROWS = [(call, *row) for call, rows in CALLS for row in rows]


@pytest.mark.parametrize("row", ROWS, ids=[f"{n}: {row[-1]:.30}" for n, row in enumerate(ROWS)])
def test_what_is_sensible_is_taken_and_what_is_next_to_it_is_refused(row):
    call, sensible, plain, refused, reason = row
    assert difference(call(plain), call(sensible)) == ""
    with pytest.raises(ValueError, match=reason):
        call(refused)
