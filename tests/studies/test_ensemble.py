"""An ensemble says of every run what `track` says of it, in any chunks; an interrupt ends it."""

import signal
from dataclasses import replace

import numpy as np
import pytest
from examples import AFFINE, BOTH, NOISY, ONE, SURFACES
from numpy.testing import assert_array_equal
from refusals import refuses

from percept_obs import (
    Camera,
    DoesNotFit,
    Gaussian,
    PerspectiveSystem,
    Scenario,
    affine,
    ekf,
    ensemble,
    ibo,
    ismo,
    pinhole,
    record,
    scenarios,
    smo,
    sphere,
    track,
)
from percept_obs.observers import OBSERVERS
from percept_obs.recording.many import with_numbers
from percept_obs.studies.plan import OUTCOMES, STATUS, Plan
from percept_obs.validation import environment

pytestmark = pytest.mark.usefixtures("xr")

EQ35 = scenarios.ma2005_eq35()
LOSSY = Camera(0.02, NOISY.noise, dropout=0.1)


def expected(run, after):
    """Statistics of a run of `track`."""
    error, late = np.abs(run.error[:, -1]), run.elapsed >= after - 1e-9
    found = run.outcome()
    told = {
        "outcome": OUTCOMES.index(found.kind),
        "settling_time": found.settled if found.converged else np.inf,
        "judged": run.relative_error[-1],
        "final": error[-1],
        "rms": np.sqrt(np.mean(error[late] ** 2)),
        "worst": error[late].max(),
        "resets": len(run.resets),
        "diverged_at": np.inf if run.diverged_at is None else run.diverged_at,
    }
    for name in ("final", "rms", "worst"):
        told[name] = told[name] if np.isfinite(told[name]) else np.inf
    return told


def assert_alike(one, run, after, rtol):
    for name, value in expected(run, after).items():
        np.testing.assert_allclose(one[name].item(), value, rtol=rtol, atol=1e-12, err_msg=name)


@pytest.mark.slow
@pytest.mark.parametrize("make", OBSERVERS, ids=lambda make: make.key)
def test_a_run_is_that_of_track(make):
    observer = make(BOTH)
    gain = observer.gains[0]
    over = {gain.name: [gain.value, 1.1 * gain.value], "start_y3": [0.0, 0.3]}
    found = ensemble(EQ35, observer, over, [3], 1.5, LOSSY, after=0.5)
    recording = record(EQ35, 1.5, LOSSY, 3)
    for value in found[gain.name].values:
        for start in (0.0, 0.3):
            run = track(recording, observer.with_gains(**{gain.name: float(value)}), {"y3": start})
            assert_alike(found.sel({gain.name: value, "start_y3": start, "seed": 3}), run, 0.5, 1e-10)


def test_a_filter_that_was_not_told_the_noise_takes_that_of_each_run():
    sizes, make = [0.003, 0.02], (ekf(BOTH), ekf(BOTH, noise_variance=1e-4))
    for observer in make:
        found = ensemble(EQ35, observer, {"noise": sizes}, duration=2, camera=Camera(noise=Gaussian(0.01)))
        runs = [track(record(EQ35, 2, Camera(noise=Gaussian(size)), seed=0), observer) for size in sizes]
        np.testing.assert_allclose(found.final[0], [expected(run, 0)["final"] for run in runs], rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("observer", [ibo(ONE), ekf(ONE), ismo(BOTH)], ids=lambda observer: observer.name)
def test_machine_code_says_the_same(xr, observer):
    over = {"b1": [0.4, 0.5], "noise": [0.0, 0.01], "believed_b2": [0.25, 0.2]}
    fast, slow = (
        ensemble(EQ35, observer, over, 2, 5, LOSSY, {"y1": 0.0}, after=2.5, language=language)
        for language in ("numba", "python")
    )
    xr.testing.assert_allclose(fast, slow, rtol=1e-10)
    for name in ("status", "outcome", "settling_time", "resets"):
        assert_array_equal(fast[name], slow[name])


@pytest.mark.slow
def test_true_and_believed_motion_and_surface_vary():
    surface = SURFACES["plane"]
    scenario = Scenario("plane", EQ35.motion, (1.0, 1.5, 2.5), 5.0, surface)
    observer = ekf(PerspectiveSystem(affine(), replace(surface, values={})).measure("y1"))
    over = {"b1": [0.5, 0.4], "X": [1.0, 1.1], "n1": [0.1, 0.2], "believed_b1": [0.5, 0.45]}
    found = ensemble(scenario, observer, over, 1, 2.0, Camera(0.02, Gaussian(0.01)))
    one = {"b1": 0.4, "X": 1.1, "n1": 0.2}
    scene = with_numbers(scenario, **one)
    believed = with_numbers(scenario, b1=0.45).motion
    run = track(record(scene, 2.0, Camera(0.02, Gaussian(0.01))), observer, believed=believed)
    assert_alike(found.sel(**one, believed_b1=0.45, seed=0), run, 0.0, 1e-9)


@pytest.mark.slow
def test_the_motion_may_vary_over_time_and_so_may_the_clock():
    motion = affine(EQ35.motion.A.subs(EQ35.motion.values), lambda t: [0.5, 0.25 + 0.1 * np.sin(t), 0.3])
    scenario = Scenario("waving", motion, (1.0, 1.5, 2.5), 5.0, pinhole())
    found = ensemble(scenario, ibo(BOTH), {"period": [0.01, 0.05], "dropout": [0.0, 0.2]}, [1], 2.0, NOISY)
    for period in (0.01, 0.05):
        recording = record(scenario, 2.0, replace(NOISY, period=period, dropout=0.2), 1)
        one = found.sel(period=period, dropout=0.2, seed=1)
        assert_alike(one, track(recording, ibo(BOTH)), 0.0, 1e-10)


def test_resets_divergence_and_points_out_of_sight_are_told():
    blown = ensemble(EQ35, smo(BOTH, bound=1e160), {"switching_gain": [1.0, 1e150]}, duration=2).isel(seed=0)
    run = track(record(EQ35, 2), smo(BOTH, bound=1e160, switching_gain=1e150))
    assert [OUTCOMES[k] for k in blown.outcome.values] == ["converged", "diverged"]
    assert blown.diverged_at.values.tolist() == [np.inf, run.diverged_at]
    assert blown.rms.values[1] == np.inf
    bounded = ensemble(EQ35, ibo(BOTH), {"bound": [0.3, 10.0]}, duration=2).isel(seed=0)
    assert bounded.resets.values.tolist() == [len(track(record(EQ35, 2), ibo(BOTH, bound=0.3)).resets), 0]
    toward = Scenario("toward", affine(np.zeros((3, 3)), [0.0, 0.1, -1.0]), (0.5, 0.5, 5.0), 4.0, pinhole())
    behind = ensemble(toward, ibo(BOTH), {"Z": [5.0, 3.0, -1.0]}).isel(seed=0)
    assert [STATUS[k] for k in behind.status.values] == ["done", "not_in_front", "not_in_front"]
    assert np.isnan(behind.rms.values[1:]).all()


def test_a_dip_between_samples_is_seen():
    turning = affine([[0, 0, 1.0], [0, 0, 0], [-1.0, 0, 0]], [0.0, 0.0, 0.0])
    scenario = Scenario("turning", turning, (1.0, 0.5, 2.0), 5.0, pinhole())
    camera = Camera(6.2)  # nearly a turn: in front at both samples, behind between
    found = ensemble(scenario, ibo(BOTH), {"X": [1.0]}, duration=6.2, camera=camera)
    assert found.status.item() == STATUS.index("not_in_front")


def test_the_chunks_do_not_matter(xr):
    over = {"gain": np.linspace(2, 20, 7), "b1": [0.4, 0.5]}
    whole = ensemble(EQ35, ibo(BOTH), over, 3, 0.5, LOSSY)
    xr.testing.assert_identical(ensemble(EQ35, ibo(BOTH), over, 3, 0.5, LOSSY, chunk=5), whole)
    assert whole.sizes == {"seed": 3, "gain": 7, "b1": 2}


def test_values_on_one_dimension_go_together(xr):
    draws = xr.DataArray([2.0, 10.0, 20.0], dims="draw")
    found = ensemble(EQ35, ibo(BOTH), {"gain": draws, "start_y3": draws / 20}, 2, 1.0)
    assert found.sizes == {"seed": 2, "draw": 3}
    assert_alike(found.isel(draw=2, seed=0), track(record(EQ35, 1), ibo(BOTH, gain=20), {"y3": 1.0}), 0, 1e-10)


def test_the_tolerance_is_that_of_the_outcome():
    found = ensemble(EQ35, ibo(BOTH), duration=3, tolerance=0.05, start=(0, 0, 0))
    outcome = track(record(EQ35, 3), ibo(BOTH), (0, 0, 0)).outcome(0.05)
    assert found.settling_time.item() == outcome.settled
    assert found.judged.item() == pytest.approx(outcome.final)


@pytest.mark.slow
def test_it_keeps_names_units_and_settings_in_files(xr, tmp_path):
    found = ensemble(EQ35, ekf(BOTH), {"b1": [0.4, 0.5], "start_y3": [0.2]}, 2, 1.0, NOISY)
    assert {name: found[name].attrs["units"] for name in ("b1", "start_y3", "settling_time", "rms")} == {
        "b1": "m/s",
        "start_y3": "1/m",
        "settling_time": "s",
        "rms": "1/m",
    }
    assert found.attrs["observer"] == "extended Kalman"
    assert found.outcome.attrs["flag_meanings"].split() == list(OUTCOMES)
    found.to_netcdf(tmp_path / "found.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "found.nc", engine="h5netcdf") as again:
        xr.testing.assert_identical(again.load(), found)


@pytest.mark.parametrize("language", ["python", "numba"])
def test_an_interrupt_ends_an_ensemble(monkeypatch, language):
    compute, calls = Plan.compute, []

    def interrupted(plan, chunk):
        calls.append(chunk)
        if len(calls) == 3:
            signal.raise_signal(signal.SIGINT)
        return compute(plan, chunk)

    monkeypatch.setattr(Plan, "compute", interrupted)
    with pytest.raises(KeyboardInterrupt):
        ensemble(EQ35, ibo(BOTH), {"gain": np.linspace(2, 20, 200)}, duration=0.5, chunk=2, language=language)
    assert len(calls) < 50


test_what_makes_no_sense_is_refused = refuses(
    lambda changes: ensemble(EQ35, ibo(BOTH), **({"duration": 1.0} | changes)),
    ({"over": {"gian": [1.0]}}, "over has gian, which cannot vary here; there are gain, "),
    ({"over": {"gain": [1.0, -3.0]}}, "gain = -3 is out of range"),
    ({"over": {"gain": []}}, "finite numbers"),
    ({"over": {"gain": range(10**9)}}, r"1e\+09 runs"),
    ({"over": {"gain": ["1", "2"]}}, "over gain is the list .* expected real numbers"),
    ({"step": 1e-12}, r"1e\+12 steps"),
    ({"step": 0.0}, "step is 0.0; it must be positive"),
    ({"over": {"gain": [np.nan]}}, "finite numbers"),
    ({"over": {"period": [0.01, 9.0]}}, "holds no two samples"),
    ({"over": {"dropout": [1.0]}}, "below 1"),
    ({"over": {"noise": [-1.0]}}, "must be finite and not negative"),
    ({"seeds": 0}, "the seeds"),
    ({"seeds": [-1]}, "the seeds"),
    ({"after": 5.0}, "after is 5"),
    ({"chunk": 0}, "a chunk of 0"),
    ({"tolerance": 0.0}, "must be positive"),
    ({"start": (0.0,)}, "expected 3"),
    ({"seeds": 10**9}, "at most 1e"),
)


def test_an_observer_that_does_not_fit_is_refused():
    with pytest.raises(DoesNotFit, match="surface"):
        ensemble(EQ35, ibo(PerspectiveSystem(affine(), sphere()).measure("y1", "y2")), duration=1.0)
    shaped = SURFACES["plane"]
    scenario = Scenario("plane", EQ35.motion, (1.0, 1.5, 2.5), 5.0, shaped)
    with pytest.raises(DoesNotFit, match="derived with numbers"):
        ensemble(scenario, ibo(PerspectiveSystem(affine(), shaped)), {"n1": [0.1, 0.2]}, duration=1.0)


def test_what_is_missing_is_told_with_how_to_get_it(monkeypatch):
    monkeypatch.setattr(environment, "find_spec", lambda name: None)
    with pytest.raises(ModuleNotFoundError, match=r'xarray is missing; get it with: .*"percept-obs\[course\]"'):
        ensemble(EQ35, ibo(AFFINE.measure("y1")))
