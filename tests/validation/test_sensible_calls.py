"""What is sensible is taken, and means what the plain call means; the nearest thing that has no sense is refused."""

import math
from datetime import datetime, timedelta
from decimal import Decimal
from fractions import Fraction

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
PASSED, DAY = (1000 * T).astype("timedelta64[ms]"), datetime(2024, 1, 1)
LATER = [timedelta(seconds=t) for t in T.tolist()]
A, B = np.array([[0, 0.1, 0], [0, 0, 0], [0, 0, 0.1]]), np.array([0.3, 0.1, 0.2])
TURNS = Rotation.from_rotvec(np.outer(T, [0, 0, 0.1]))
SCENE, Y3, G = scenarios.ma2005_eq35(), sp.Symbol("y3"), sp.Symbol("gain")
SHORT, OBSERVER = record(SCENE, 1, Camera(0.1)), ibo(BOTH)
RUN = track(SHORT, OBSERVER)


def seen(time=T, outputs=SEEN, names=("y1", "y2"), **more):
    return Recording(time, outputs, names, pinhole(), rigid(camera_velocity=[0.3, 0, 0]), **more)


def outputs(given):
    return seen(outputs=given)


def names(given):
    return seen(names=given)


def constant(b):
    return affine(A, b)


def sampled(times):
    return affine(A, np.outer(T, B), times)


def varying(b):
    return affine(A, b).known(T)


def turned(orientations):
    return Poses(T, np.outer(T, [1, 0, 0]), orientations)


def moved(orientations):
    return rigid_from_poses(T, np.outer(T, [1, 0, 0]), orientations)


def drawn(seed):
    return record(SCENE, 1, Camera(0.1, Gaussian(0.01)), seed).outputs


def placed(position):
    return Scenario("s", affine(A, B), position, 2.0, pinhole())


def started(start):
    return track(SHORT, OBSERVER, start)


def gained(gain):
    return ibo(BOTH, gain=gain)


def over(values):
    return ensemble(SCENE, OBSERVER, values, duration=0.5, camera=Camera(0.1)).rms.values


def structured(*names):
    return np.array(list(map(tuple, GAP)), dtype=[(name, float) for name in names])


def table(recordings, of=len):
    return compare(recordings, [OBSERVER], columns={"of": lambda run: of(run.time)}).table["of"].tolist()


def lab(settings):
    return dict(observer_lab(**settings).settings)


def letters(letter):
    return PerspectiveSystem(affine(sp.zeros(3, 3), [letter, 0, 0]), pinhole()).parameters


class Tensor:
    """What torch has: an array where one is asked for."""

    def __init__(self, values):
        self.values = np.asarray(values)

    def __array__(self, dtype=None, copy=None):
        return np.array(self.values, dtype)


class Column:
    """What polars has."""

    def __init__(self, values):
        self.to_numpy = lambda: np.asarray(values)


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
    # gaps
    (outputs, np.ma.masked_invalid(GAP), GAP, np.ma.array(SEEN > 0), "type bool"),
    (outputs, NONE, GAP, [["None"] * 2] * 11, "expected an array of real numbers or a table"),
    (outputs, FRAME.astype("Float64"), GAP, FRAME.astype(str), "outputs is a DataFrame"),
    (outputs, FRAME.astype(object).where(FRAME.notna(), pd.NA), GAP, FRAME > 0, "outputs is a DataFrame"),
    (outputs, SEEN.astype(int), SEEN.astype(int) * 1.0, SEEN > 0, "type bool"),
    (lambda v: seen(distances={"laser": v}), pd.Series([1, None] * 5 + [2], dtype="Int64"), [1, np.nan] * 5 + [2],
     [1, None] * 5 + [-2], "must be positive numbers or NaN"),
    # times
    (seen, PASSED, T, np.datetime64(DAY) + PASSED, "for example t - t"),
    (seen, LATER, T, [DAY + later for later in LATER], "for example t - t"),
    (sampled, pd.to_timedelta(T, unit="s"), T, pd.Timestamp(DAY) + pd.to_timedelta(T, unit="s"), "for example t - t"),
    (Camera, np.timedelta64(100, "ms"), 0.1, np.datetime64(DAY), "expected a real number"),
    (Camera, timedelta(seconds=0.1), 0.1, DAY, "period is a datetime"),
    (seen, T[:, None], T, T[None], r"times of shape \(1, 11\)"),
    (sampled, T[:, None], T, T[None], "has shape"),
    (placed(np.array([1, 1, 3])).points, T[:, None], T, T[None], "the times must be a list"),
    (seen, FRAME.set_index(T).index, T, FRAME.set_index(T.astype(str)).index, "time is an Index"),
    (seen, (k / 10 for k in range(11)), np.arange(11) / 10, {*T.tolist()}, "time is the set"),
    (seen, 1.7e9 + T, (1.7e9 + T).tolist(), (1e9 * (1.7e9 + T)).astype(int), "if they are nanoseconds since 1970"),
    # tables
    (outputs, FRAME[["y2", "y1"]], GAP, FRAME[["y1"]], "it needs y2"),
    (outputs, structured("y1", "y2"), GAP, structured("u", "v"), "the columns u, v; it needs y1, y2"),
    (outputs, xr.Dataset({name: ("time", FRAME[name]) for name in FRAME}), GAP, xr.Dataset({"y1": ("time", T)}), "y2"),
    (names, FRAME.columns, ("y1", "y2"), pd.Index(["u", "v"]), "there are y1, y2"),
    (names, pinhole().image_coordinates, ("y1", "y2"), sp.symbols("u v"), "there are y1, y2"),
    (names, iter(["y1", "y2"]), ("y1", "y2"), {"y1", "y2"}, "names is the set"),
    # rotations and columns
    (turned, TURNS, TURNS.as_quat(), TURNS[:5], "expected 11 rows"),
    (moved, list(TURNS), TURNS.as_quat(), list(TURNS.as_rotvec()), "a quaternion is x, y, z, w"),
    (constant, B[:, None], B, B[None], r"has shape \(1, 3\); expected \(3,\); samples need times="),
    (varying, lambda t: [[t], [0], [0]], lambda t: [t, 0, 0], lambda t: [[t, 0, 0]], r"has shape \(1, 3\)"),
    (turned, pd.DataFrame(np.roll(TURNS.as_quat(), 1, axis=1), columns=["qw", "qx", "qy", "qz"]), TURNS.as_quat(),
     pd.DataFrame(TURNS.as_rotvec(), columns=["x", "y", "z"]), "a quaternion is x, y, z, w"),
    (placed, [[1], [1], [3]], (1, 1, 3), [[1, 1], [3, 3]], "expected a sequence, each entry a real number"),
    (placed, pd.Series({"Z": 3, "X": 1, "Y": 2}), (1, 2, 3), pd.Series({"Z": 3, "X": None, "Y": 2}), "finite numbers"),
    (lambda d: PixelCamera((500, 500), (320, 240), distortion=d), np.zeros((1, 5)), np.zeros(5), np.zeros((2, 5)),
     "distortion is an array of shape"),
    (lambda v: linear(A, v), sp.Matrix(B), B, [B], r"has shape \(1, 3\)"),
    # seeds
    (drawn, np.array(3), 3, 2**32, r"a whole number from 0 to 2\^32 - 1, or None"),
    (lambda seed: drawn(seed).shape, None, 0, "0", "seed is the text '0'"),
    # names
    (started, {Y3: 0.5}, {"y3": 0.5}, {2 * Y3: 0.5}, "expected a mapping from text"),
    (started, pd.Series({"y3": 0.5, "y1": 0.1, "y2": 0.2}), [0.1, 0.2, 0.5], pd.Series({"y4": 0.5}), "coordinate y4"),
    (started, [[0.1], [0.2], [0.5]], [0.1, 0.2, 0.5], [[0.1, 0.2, 0.5]] * 2, "expected a mapping from text"),
    (over, {G: [2, 3]}, {"gain": [2, 3]}, {sp.Symbol("G"): [2, 3]}, "over has G, which cannot vary"),
    (over, {"gain": iter([2, 3])}, {"gain": [2, 3]}, {"gain": iter("ab")}, "over gain is the list"),
    (AFFINE.measure, AFFINE.coordinates[0], "y1", AFFINE.coordinates[2], "cannot measure 'y3'"),
    (letters, sp.Symbol("c"), sp.Symbol("c"), sp.Symbol("y1"), "has the letter y1"),
    # numbers
    (Camera, np.array([0.1]), 0.1, np.array([0.1, 0.2]), "expected a real number"),
    (Camera, pd.Series([0.1]), 0.1, [0.1], "period is the list"),
    (Camera, xr.DataArray(0.1), 0.1, xr.DataArray(True), "expected a real number"),
    (Camera, np.float32(0.1), 0.1, np.complex64(0.1), "the complex number"),
    (drawn, 3.0, 3, 3.5, "seed is the number 3.5"),
    (Camera, Decimal("0.1"), 0.1, Decimal("NaN"), "period is a Decimal"),
    (Camera, Fraction(1, 10), 0.1, Fraction(-1, 10), "it must be positive"),
    (lambda angle: Camera(field_of_view=angle), sp.pi, math.pi, 4 * sp.pi, "at most 2 pi"),
    (gained, sp.Rational(5), 5, sp.Symbol("q"), "gain is a Symbol"),
    (constant, [Decimal("0.3"), Fraction(1, 10), sp.Rational(1, 5)], B, [Decimal(1), "2", 3], "b is the list"),
    (lambda window: how_observable(SHORT, BOTH, window).window, Decimal("0.5"), 0.5, "0.5", "window is the text"),
    (lambda zero: Clock(zero, np.array(0.001)), np.int64(5), 5, Decimal("inf"), "zero is a Decimal"),
    (lab, {"duration": Decimal(5), "X0": pd.Series([1, 1, 3])}, {"duration": 5, "X0": [1, 1, 3]}, {"duration": "5"},
     "duration is '5'"),
    (lab, {"observers": pd.Index(["de_luca"])}, {"observers": ["de_luca"]}, {"observers": {"x"}}, "observers"),
    # arrays
    (constant, Tensor(B), B, Tensor(1j * B), "b is a Tensor"),
    (seen, Column(T), T, Column(list("abcdefghijk")), "time is a Column"),
    (gained, Quantity(5.0), 5.0, Quantity(5.0, "Hz"), "a quantity in Hz; .* pass numbers, in seconds, metres"),
    (constant, Quantity(B), B, Quantity(B, "m/s"), "a quantity in m/s"),
    (constant, [*map(Quantity, B)], B, [Quantity(b, "m/s") for b in B], "a quantity in m/s"),
    (outputs, np.asfortranarray(SEEN), SEEN, np.asfortranarray(SEEN.T), r"outputs of shape \(2, 11\)"),
    (seen, memoryview(T), T, memoryview(b"0123"), r"outputs of shape \(11, 2\); expected \(4, 2\)"),
    (lambda P: cramer_rao(record(SCENE, 1, Camera(0.1, Gaussian(0.01))), BOTH, P).covariance, pd.DataFrame(np.eye(3)),
     np.eye(3), pd.DataFrame(-np.eye(3)), "definite"),
    # several things
    (table, iter([SHORT]), [SHORT], SHORT, "put it into a list"),
    (lambda of: table({"a": SHORT}.values(), of), lambda time: time[-1:], lambda time: time[-1], np.copy, "11 numbers"),
    (lambda axes: signals(RUN, axes=axes).text, Figure().subplots(4).flat, list(Figure().subplots(4)),
     Figure().subplots(4)[0], "put it into a list"),
    (lambda name: runs_over_time([RUN], coordinate=name).text, AFFINE.coordinates[2], "y3", sp.Symbol("y9"), "y9"),
]  # fmt: skip
"""A call, what is sensible to give it, what it means, the nearest that is refused, and a part of the reason."""


@pytest.mark.parametrize("row", CALLS, ids=[f"{n}: {row[-1]:.30}" for n, row in enumerate(CALLS)])
def test_what_is_sensible_is_taken_and_what_is_next_to_it_is_refused(row):
    call, sensible, plain, refused, reason = row
    assert difference(call(plain), call(sensible)) == ""
    with pytest.raises(ValueError, match=reason):
        call(refused)
