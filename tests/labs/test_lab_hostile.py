"""Whatever a page sends, a lab's settings stay valid, no text is run or taken for a file, and errors are ours."""

import json

import pytest
import traitlets
from hostile_messages import CANARY, messages
from sample_sizes import sampled

from percept_obs.labs import derivation_desk, observer_lab, points_lab, structure_lab

LABS = {"observer": observer_lab, "structure": structure_lab, "points": points_lab, "desk": derivation_desk}


@pytest.mark.parametrize("name", LABS)
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_settings_stay_valid_under_hostile_messages(name, seed, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lab = LABS[name]()
    kept = {trait: getattr(lab, trait) for trait in ("kind", "texts", "model")}
    taken = refused = 0
    for message in messages(lab, sampled(400, 1000) if seed else 80, seed, with_summary=0.02 if seed else 0):
        try:
            lab.set_state(message)
        except traitlets.TraitError as error:
            refusal = error
        else:
            refusal = None
        taken, refused = taken + (refusal is None), refused + (refusal is not None)
        assert refusal is None or str(refusal) in lab.error
        assert lab.check(lab.settings) == lab.settings
        assert json.loads(json.dumps(lab.settings, allow_nan=False)) == lab.settings
    assert min(taken, refused) > 10
    assert {trait: getattr(lab, trait) for trait in kept} == kept
    assert not any(CANARY in path.name for path in tmp_path.iterdir())


SPINNING = [[0.0, -1000.0, 1000.0], [1000.0, 0.0, -1000.0], [-1000.0, 1000.0, 0.0]]


@pytest.mark.parametrize(
    ("name", "fast"),
    [
        ("observer", {"A": SPINNING, "duration": 120.0}),
        ("structure", {"duration": 60.0, "period": 0.01, "w_c": [0.0, 900.0, 0.0], "v_p_swing": [0.1, 0.0, 0.0]}),
        ("structure", {"duration": 100.0, "w_c": [900.0, 900.0, 900.0]}),
        ("points", {"spin": 10.0, "duration": 120.0}),
        ("observer", {"motion": "b1 = sin(1000 t)"}),
        ("structure", {"motion": "v_c1 = sin(1000 t)", "duration": 60.0, "period": 0.01}),
        ("points", {"motion": "w_c1 = sin(1000 t)"}),
    ],
)
def test_what_would_keep_the_kernel_busy_is_said_and_not_begun(name, fast, monkeypatch):
    for solver in ("scipy.integrate.DOP853", "scipy.linalg.expm"):
        monkeypatch.setattr(solver, None)
    (sentence,) = LABS[name](**fast).analyse()["sentences"]
    assert sentence.startswith("Python says nothing on so fast or long a motion")


@pytest.mark.parametrize(("name", "period"), [("observer", 1.0), ("points", 0.2)])
def test_a_window_shorter_than_the_time_between_samples_is_as_long_as_that(name, period):
    given = {"period": period, "duration": 5.0}
    said, wide = (LABS[name](window=window, **given).analyse()["sentences"] for window in (0.15, period))
    assert said == wide


@pytest.mark.parametrize("name", ["observer", "structure"])  # those of many points are never so short
def test_a_run_of_a_single_sample_is_told(name):
    assert LABS[name](duration=0.5, period=1.0).analyse() == {
        "sentences": ["a duration of 0.5 s holds no two samples 1 s apart; record longer"]
    }
