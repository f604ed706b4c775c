"""The law of units: a recording and its unit in millimetres, kilometres or feet give what they give in metres."""

import warnings
from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest
import sympy as sp

from percept_obs import (
    Camera,
    FirstSight,
    Gaussian,
    PerspectiveSystem,
    PointsScenario,
    Scenario,
    affine,
    chained,
    check_consistency,
    cramer_rao,
    diagnose,
    ekf,
    ellipsoid,
    ensemble,
    how_observable,
    ibo,
    luenberger,
    pinhole,
    record,
    rigid,
    scenarios,
    sphere,
    track,
    unified,
)
from percept_obs.labs import observer_lab
from percept_obs.observers import OBSERVERS, de_luca, ismo, spica
from percept_obs.points import independent_points, riccati
from percept_obs.structure import ScaledDepthCamera, StructureScenario, linear_view
from percept_obs.structure.scenarios import chwa2019_experiment
from percept_obs.studies.all_observers import all_observers, own_length
from percept_obs.studies.comparison import compare
from percept_obs.studies.consistency import claimed_distance
from percept_obs.studies.least_squares import moving_window_least_squares
from percept_obs.studies.sensitivity import sensitivity
from percept_obs.system.motion import TIME

UNITS = {"mm": 1000.0, "km": 0.001, "feet": 3.28084}
SYSTEMS = {kind: PerspectiveSystem(kind(), pinhole()) for kind in (affine, rigid)}
OUTPUTS = (("y1", "y2"), ("y1",))
NOISE = Gaussian(0.003)


@cache
def scene(unit, varying=False):
    """A scene with all of its lengths in a unit of which so many make a metre."""
    if varying:
        moving = rigid(
            camera_angular_velocity=lambda t: [-0.1 * np.sin(t), -0.2, -0.1],
            camera_velocity=lambda t: [unit * np.cos(t), 0.2 * unit, 0],
        )
        return Scenario("varying", moving, (0.3 * unit, -0.2 * unit, 4 * unit), 4, pinhole(), unit=unit)
    plain = scenarios.ma2005_eq35()
    A, b = np.split(plain.motion.known(0.0)[0], [9])
    place = unit * np.array(plain.position)
    return Scenario("Ma's", affine(A.reshape(3, 3), unit * b), place, 4, pinhole(), unit=unit)


@cache
def seen(unit, varying=False, seed=0):
    return record(scene(unit, varying), camera=Camera(0.05, NOISE), seed=seed)


def follow(recording, observer):
    return track(recording, observer, {"y3": 0.5 / recording.unit})


def numbers(table, unit, lengths=()):
    """Columns of a table, those that are one over a length times the unit."""
    columns = {str(name): np.asarray(table[name]) for name in table if name not in ("cost", "recording", "observer")}
    found = {name: values for name, values in columns.items() if values.dtype.kind == "f"}
    return {name: values * unit if name in lengths else values for name, values in found.items()}


def run_of(make, varying, form, unit):
    run = follow(seen(unit, varying), make(form))
    scale = np.array([1, 1, unit])
    found = {"estimate": run.estimate * scale, "shares": run.relative_error}
    found |= {"distance": run.distance / unit, "words": [run.verdict(), run.trust().kind, str(len(run.resets))]}
    if run.observer.covariance is not None:
        found |= {"covariance": run.covariance * np.outer(scale, scale), "nees": run.nees(), "nis": run.nis}
        # of the first sample R - P has lost all digits but three, where P begins 1e13 times as large as R
        found["likelihood"] = run.log_likelihood[1:]
    return found


def compared(form, unit):
    found = compare([seen(unit), seen(unit, seed=1)], [ibo(form), ekf(form)], {"y3": 0.5 / unit}, after=2)
    return numbers(found.table, unit, ("final", "rms", "worst"))


def all_of(form, unit):
    few = [replace(seen(unit, seed=seed), unit=1.0) for seed in range(2)]
    if form.measured == ("y1",):
        few = [replace(each, outputs=each.outputs[:, :1], names=("y1",), signal=None) for each in few]
    found = all_observers(few, candidates={make: make.candidates[:2] for make in (ekf, de_luca, spica)})
    return numbers(found.table, unit) | {"gains": [*found.table["gains"]], "start": found.start["y3"] * unit}


def many(form, unit):
    over = {"gain": [2.0, 10.0], "start_y3": [0.3 / unit, 0.5 / unit], "b1": [0.4 * unit, 0.5 * unit]}
    camera, found = Camera(0.05, NOISE), {}
    for name, observer in (("gain", ibo(form)), ("filter", ekf(form))):
        some = {key: values for key, values in over.items() if key != "gain" or name == key}
        data = ensemble(scene(unit), observer, some, 2, 3, camera, after=1)
        found |= {name + key: value for key, value in numbers(data, unit, ("final", "rms", "worst")).items()}
    return found


def sensed(form, unit):
    found = sensitivity(seen(unit), ibo(form), {"y3": 0.5 / unit}, entries=("a13", "b1", "b3"))
    per = np.array([1, 1, unit])[:, None] * np.array([1, unit, unit])
    return {"derivatives": found.derivatives * per, "ranking": found.ranking()["b3"]}


def consistent(form, unit):
    run = follow(seen(unit), ekf(form))
    found = check_consistency(run, 20, after=1)
    ends = [np.where(np.isfinite(end), end, 0) / unit for end in claimed_distance(run)]
    claims = run.covariance * np.outer([1, 1, unit], [1, 1, unit])
    return {"distance": ends, "claims": claims, "nis": found.averages, "correlation": found.autocorrelation}


def bounded(form, unit):
    found = cramer_rao(seen(unit), form, doubt=1e-4)
    shares, directions = found.kept()
    told = {"deviation": found.deviation * np.array([1, 1, unit]), "directions": np.abs(directions)}
    return told | {"relative": found.relative, "shares": shares}


def least(form, unit):
    run = moving_window_least_squares(seen(unit), 1.0)
    return {"error": run.relative_error, "estimate": run.estimate * np.array([1, 1, unit])}


def trusted(form, unit):
    run = follow(seen(unit), ibo(form))
    found, trust = run.information, run.trust()
    return {"deviation": found.deviation, "inverse": found.estimate[-1] * unit, "trusted": trust.trusted}


def diagnosed(form, unit):
    found = diagnose([seen(unit, True, seed) for seed in range(2)])
    return {"left": found.left, "named": found.named}


def observable(form, unit):
    found = how_observable(seen(unit), form, 2.0)
    return {"values": [each.value for each in found.measures], "words": str(found)}


STUDIES = (compared, all_of, many, sensed, least, trusted, diagnosed, observable)


def deviation(here, there):
    """Largest difference of numbers, relative to the largest ones; infinite if words or infinite ones differ."""
    worst = 0.0
    for name, value in here.items():
        one, other = np.asarray(value), np.asarray(there[name])
        if one.dtype.kind not in "fib":
            worst = max(worst, 0.0 if (one == other).all() else np.inf)
            continue
        one, other = one.astype(float), other.astype(float)
        finite = np.isfinite(one)
        if not np.array_equal(one[~finite], other[~finite], equal_nan=True):
            return np.inf
        size = np.abs(one[finite]).max(initial=1e-300)
        worst = max(worst, float(np.abs(one[finite] - other[finite]).max(initial=0) / size))
    return worst


def largest(ask):
    """Largest deviation of what is asked for in any unit from what it is in metres."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        metres = ask(1.0)
        return max(deviation(metres, ask(unit)) for unit in UNITS.values())


def forms_of(make):
    """Forms that a family observes, on the constant and on the varying motion, with all outputs that it allows."""
    for measured in OUTPUTS:
        for varying in (False,) if make.constant_motion else (False, True):
            form = SYSTEMS[rigid if varying else affine].partition(*measured)
            if not make.refusal(form):
                yield form, varying


@pytest.mark.slow
@pytest.mark.parametrize("make", OBSERVERS, ids=lambda make: make.key)
def test_an_observer_obeys_the_law(make):
    for form, varying in forms_of(make):
        assert largest(partial(run_of, make, varying, form)) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("measured", OUTPUTS, ids=len)
@pytest.mark.parametrize("study", STUDIES)
def test_a_study_obeys_the_law(study, measured):
    """The least squares of trust have directions that samples hardly tell, and differ by more than rounding."""
    bound = 1e-5 if study is trusted else 1e-9
    assert largest(partial(study, SYSTEMS[affine].partition(*measured))) < bound


@pytest.mark.parametrize("measured", OUTPUTS, ids=len)
@pytest.mark.parametrize("study", [consistent, bounded])
def test_a_filter_and_its_bound_obey_the_law(study, measured):
    assert largest(partial(study, SYSTEMS[affine].partition(*measured))) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize(("make", "section"), [(ekf, "IV.A"), (ibo, "IV.B"), (ismo, "VI.C")])
def test_structure_and_motion_obey_the_law(make, section):
    plain = chwa2019_experiment(section)

    def ask(view, unit):
        numbers = np.split(plain.motion.known(0.0)[0] * np.repeat([1, unit, unit], 3), 3)
        moving = rigid(camera_angular_velocity=numbers[0], camera_velocity=numbers[1], point_velocity=numbers[2])
        place, scale = unit * np.array(plain.position), plain.scale / unit
        choice = replace(plain.choice, scale=plain.choice.scale and scale)
        made = StructureScenario("scaled", moving, place, 1, pinhole(), unit=unit, scale=scale, choice=choice)
        recording = view(record(made, camera=ScaledDepthCamera(0.01, Gaussian(1e-3))))
        run = track(recording, make(recording.view.form))
        found = {"estimate": run.estimate * recording.scale, "error": run.relative_error}
        if run.observer.covariance is not None:
            found["claims"] = run.covariance * np.outer(recording.scale, recording.scale)
        return found | {"words": [run.verdict(), run.trust().kind]}

    for view in (lambda recording: recording, linear_view):
        assert largest(partial(ask, view)) < 1e-9


@pytest.mark.slow
def test_many_points_obey_the_law_without_a_unit():
    def ask(unit):
        form = independent_points(scene(unit, True).motion, 2)
        made = PointsScenario("two", form, unit * np.array([0, 0, 4, 1, 0, 5]), 3.0)
        recording = record(made, camera=Camera(0.02, NOISE))
        run = track(recording, luenberger(form, riccati(1.0, 0.3)), FirstSight(3 * unit))
        found = {"estimate": run.estimate / unit, "error": run.relative_error, "P": run.P, "verdict": run.verdict()}
        return found | {"trust": run.trust().kind, "deviation": run.information.deviation}

    assert largest(ask) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("shown", [seen, scene], ids=["recording", "scenario"])
def test_the_lab_obeys_the_law(shown):
    def ask(unit):
        lab = observer_lab(shown(unit), observers=["extended_kalman"], start={"mode": "zero", "values": [0, 0, 0]})
        (run,) = lab.runs(lab.settings).values()
        return {"error": run.relative_error, "estimate": run.estimate}

    assert largest(ask) < 1e-9


@pytest.mark.parametrize("surface", [pinhole(), sphere(), chained(), ellipsoid(np.diag([1, 1, 4])), unified(0.9)])
def test_only_the_last_coordinate_of_a_surface_has_a_length(surface):
    powers = surface.lengths[: len(surface.coordinates)]
    assert powers == (*[0] * len(surface.image_coordinates), -1)
    assert set(surface.lengths[len(powers) :]) <= {0}


@pytest.mark.parametrize("unit", [1.0, *UNITS.values()])
@pytest.mark.parametrize(("depth", "speed"), [(0.3, 0.05), (30, 12)], ids=["table top", "street"])
def test_default_gains_suit_a_recordings_own_unit(unit, depth, speed):
    """A scene in other sizes: with speed over depth as it is, only the unit says what is large."""
    fast = speed * unit
    moving = rigid(
        camera_angular_velocity=lambda t: [-0.1 * np.sin(t), -0.1, 0],
        camera_velocity=lambda t: [fast * np.cos(t / 2), 0.3 * fast, 0],
    )
    made = Scenario("own", moving, np.array([0.2, -0.1, 1]) * depth * unit, 5, pinhole())
    recording = record(made, camera=Camera(0.05, NOISE)).in_own_unit()
    assert recording.unit == pytest.approx(recording.motion.speed(recording.time) / 0.6)
    runs = [track(recording, make(SYSTEMS[rigid].measure("y1", "y2"))) for make in (ibo, ekf)]
    assert [run.relative_error[-1] < 0.03 for run in runs] == [True, True]
    strict = runs[1].observer.with_gains(noise_variance=NOISE.variance)
    assert np.nanmean(track(recording, strict).nis) < 3


def test_the_table_of_gains_has_its_own_unit_and_a_camera_at_rest_has_1():
    few = [replace(seen(1.0), unit=3.0), *(seen(unit) for unit in UNITS.values())]
    for measured in OUTPUTS:
        lengths = [own_length(SYSTEMS[affine].partition(*measured), [each]) for each in few]
        np.testing.assert_allclose(lengths, lengths[0] * np.array([1, *UNITS.values()]), rtol=1e-12)
    still = Scenario("still", affine(np.zeros((3, 3)), [0, 0, 0]), (0, 0, 1), 1, pinhole())
    assert record(still, camera=Camera(0.1)).in_own_unit().unit == 1


def test_a_unit_that_makes_no_sense_is_refused():
    recording = seen(1.0)
    for wrong in (0.0, -1.0, np.inf):
        with pytest.raises(ValueError, match="the unit of length is"):
            replace(recording, unit=wrong)
    formula = affine([[0, 0, 0]] * 3, [sp.sin(TIME), 0, 0])
    with pytest.raises(ValueError, match="lengths in its formula"):
        replace(recording, motion=formula, unit=2.0)
    observer = ekf(PerspectiveSystem(formula, pinhole()).partition("y1", "y2"))
    with pytest.raises(ValueError, match="lengths in its formula"):
        track(replace(recording, unit=2.0), observer, believed=formula)


if __name__ == "__main__":  # prints the largest deviations
    for make in OBSERVERS:
        for form, varying in forms_of(make):
            found = largest(partial(run_of, make, varying, form))
            print(*form.measured, scene(1.0, varying).name, make.key, f"{found:.1e}", flush=True)
    for measured in OUTPUTS:
        for study in (consistent, bounded, *STUDIES):
            found = largest(partial(study, SYSTEMS[affine].partition(*measured)))
            print(*measured, study.__name__, f"{found:.1e}", flush=True)
