"""The observer lab's settings define its runs, are completed, and are refused with a reason when they make no sense."""

import numpy as np
import pytest
from lab_settings import KEYS, whole_model

from percept_obs import Camera, Recording, Scenario, affine, ibo, record, scenarios, track
from percept_obs.labs.observer.lab import observer_lab
from percept_obs.labs.observer.texts import BY_NAME, OF_THE_PINHOLE, SIZE, SURFACES, WAYS, form_of, key_of, system_of
from percept_obs.recording.utias import UTIAS_CUT, load_utias
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import BehindCamera, pinhole

NOISY = {"kind": "uniform", "size": 0.01}


@pytest.fixture(scope="module")
def lab():
    return observer_lab("ma2005_eq35")


@pytest.mark.slow
def test_the_model_is_complete_and_is_json(lab):
    model = whole_model(lab)
    assert set(model["surfaces"]) == set(SURFACES)
    assert set(model["observers"]) == set(BY_NAME)
    assert model["opening"] == observer_lab("ma2005_eq35").settings
    choices = {name: system_of(name).output_choices for name in SURFACES}
    assert [key_of(name, outputs) for name in SURFACES for outputs in choices[name]] == KEYS
    assert list(model["forms"]) == [*KEYS, key_of("pinhole", SIZE)]
    for name in SURFACES:
        sized = [SIZE] if name == "pinhole" else []
        assert model["surfaces"][name]["outputs"] == [list(outputs) for outputs in (*choices[name], *sized)]


@pytest.mark.parametrize("key", KEYS)
def test_every_form_has_every_observer_in_every_way_or_a_reason(lab, key):
    texts = whole_model(lab)["forms"][key]
    assert set(texts["observers"]) | set(texts["refused"]) == set(BY_NAME)
    surface, outputs = key.split()
    form = form_of(surface, tuple(outputs.split("+")))
    own = texts["refused"].keys() & {*OF_THE_PINHOLE}
    refused = {name: why for name, why in texts["refused"].items() if not (name in own and "on the pinhole" in why)}
    reasons = {name: make.refusal(form) for name, make in BY_NAME.items()}
    assert refused == {name: why for name, why in reasons.items() if why}
    assert not key.startswith("pinhole y1") or refused == texts["refused"]
    if surface in ("pinhole", "chained", "plane"):
        one = {"range_identification", "integral_sliding_mode", "equivariant_filter"}
        assert refused.keys() - own == (set() if "+" in key else one) - own
    for name, kernels in texts["observers"].items():
        assert set(kernels) == set(WAYS[name])


def test_terms_of_a_gain_that_is_zero_are_left_out_of_the_equations(lab):
    for observer in whole_model(lab)["observers"].values():
        for variant in (variant for variants in observer["equations"].values() for variant in variants):
            text = "".join(variant["lines"])
            assert not [gain for gain in variant["zero"] if f'data-letter="{gain}"' in text]
    filtered = whole_model(lab)["observers"]["extended_kalman"]["equations"][""]
    assert [len(variant["zero"]) for variant in filtered] == [4, *[3] * 4, 0]


def test_a_point_that_leaves_is_followed_until_then(lab):
    lab.settings = {**observer_lab("ma2005_eq35").settings, "b": [0.5, 0.25, -0.9]}
    run = lab.run()["identifier_based"]
    assert 0.1 < run.time[-1] < 80
    assert (run.truth[:, 2] > 0).all()
    beyond = Scenario("beyond", affine(lab.settings["A"], lab.settings["b"]), (1, 1.5, 2.5), 80, pinhole())
    with pytest.raises(BehindCamera):
        record(beyond, duration=run.time[-1] + 0.01)


def test_an_own_scenario_and_a_recording_open_the_lab():
    motion = affine(np.zeros((3, 3)), [0.1, 0.0, 0.2])
    own = Scenario("straight on", motion, (1, 1, 5), 10, pinhole())
    lab = observer_lab(own)
    assert lab.settings["b"] == [0.1, 0.0, 0.2]
    assert lab.settings["duration"] == 10
    recording = record(own, camera=Camera(0.05), seed=1)
    alone = Recording(recording.time, recording.outputs[:, :1], ("y1",), pinhole(), motion, source="one row")
    lab = observer_lab(alone)
    assert lab.settings["outputs"] == ["y1"]
    assert "no truth" in lab.run()["identifier_based"].verdict()
    with pytest.raises(ValueError, match="it must be one of"):
        observer_lab(alone, outputs=["y2"])
    with pytest.raises(ValueError, match="first"):
        observer_lab(alone, hold="exact")


def test_a_real_track_gives_the_run_of_its_rigid_motion():
    recording = load_utias(UTIAS_CUT)[2]
    run = observer_lab(recording).run()["identifier_based"]
    system = PerspectiveSystem(recording.motion, recording.view)
    bare = PerspectiveSystem(type(recording.motion)("rigid", *_rigid(recording.motion)), recording.view)
    assert system.coordinates == bare.coordinates
    expected = track(recording, ibo(bare.measure("y1", "y2")))
    np.testing.assert_allclose(run.estimate, expected.estimate, rtol=0, atol=1e-9)


def _rigid(motion):
    return motion.A, motion.b, motion.parameters


@pytest.mark.slow
@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"observers": ["extended_kalman"]}, "claims to know the inverse distance"),
        ({"outputs": ["y1"], "noise": NOISY}, "noise pushes the estimate of y2"),
        ({"duration": 10.0}, "eigenvalues -10, -4.96+4.93j, -4.96-4.93j per second; over the last 10 s a small error"),
        ({"observers": ["extended_kalman"], "noise": NOISY}, "it is consistent"),
        ({"observers": ["extended_kalman"], "noise": {"kind": "uniform", "size": 0.03}}, "it is overconfident"),
        ({"observers": ["extended_kalman"]}, "it is conservative"),
        (
            {"observers": ["integral_sliding_mode"], "switches": {"integral_sliding_mode": "hyperbolic tangent"}},
            "too fast",
        ),
    ],
)
def test_the_analysis_says_what_python_found(settings, words):
    opening = {"A": scenario_motion(settings), **settings} if "scenario" in settings else settings
    lab = observer_lab(settings.get("scenario", "ma2005_eq35"), **{k: v for k, v in opening.items() if k != "scenario"})
    lab.summary = {"serial": 7}
    assert lab.analysis["serial"] == 7
    assert any(words in sentence for sentence in lab.analysis["sentences"])


def test_an_observer_of_which_python_has_nothing_to_say_is_not_run(monkeypatch):
    lab = observer_lab(observers=["range_identification", "immersion_and_invariance"])
    monkeypatch.setattr("percept_obs.labs.observer.lab.track", lambda *_: pytest.fail("it was run"))
    lab.summary = {"serial": 1}
    assert len(lab.analysis["sentences"]) == 1  # of what windows show, whoever observes


def scenario_motion(settings):
    return np.array(scenarios.ma2005_eq36().motion.signal.samples[0][:9]).reshape(3, 3).tolist()


def test_questions_begin_with_the_same_settings_whatever_the_lab_was_opened_with():
    own = observer_lab("ma2005_eq36", outputs=["y1"], duration=5.0, noise={"kind": "uniform", "size": 0.01})
    assert own.model["standard"] == observer_lab("ma2005_eq35").model["opening"]
    assert own.model["standard"] != own.model["opening"]
