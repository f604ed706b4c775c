"""The page and Python compute the same run of every choice of unknowns, and refuse the others in the same words."""

from itertools import combinations

import numpy as np
import pytest
import sympy as sp
from corollaries import corollary_of
from lab_settings import as_array, copied_runs, run_in_node, whole_model
from structure_settings import CASES, COROLLARIES, EVERY, assert_same_structure_runs, structure_runs_of

from percept_obs.labs.structure.lab import structure_lab, unknowns_of
from percept_obs.labs.structure.settings import DRIVE
from percept_obs.labs.structure.texts import general_form, key_of, observer_of, refused
from percept_obs.observers.integral_sliding_mode import tolerable_amplification
from percept_obs.structure import QUANTITIES, ImpossibleChoice, StructureAndMotion
from percept_obs.tracking.following import StepTooLong

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore::percept_obs.tracking.following.StepTooLong")]

POSSIBLE = [u for n in (1, 2, 3) for u in combinations(QUANTITIES, n) if key_of(u, False) not in refused()]


@pytest.fixture(scope="module")
def lab():
    return structure_lab(duration=3.0)


@pytest.fixture(scope="module")
def answers(lab, node):
    """Answers of the page's engine for each case, with the settings as Python completed them."""
    settings = {name: structure_lab(**case).settings for name, case in CASES.items()}
    found = run_in_node(node, lab, list(settings.values()))
    return {name: (settings[name], answer) for name, answer in zip(settings, found, strict=True)}


@pytest.mark.node
@pytest.mark.parametrize("case", CASES)
def test_the_page_computes_what_python_does_and_the_choice_s_determinant(answers, case):
    assert_same(*answers[case])
    assert_same_determinant(*answers[case])


def assert_same(settings, answer):
    assert answer["problem"] is None
    assert_same_structure_runs(settings, answer["runs"])
    for name, run in structure_runs_of(settings).items():
        recording, told = run.recording, answer["runs"][name]
        np.testing.assert_allclose(answer["time"], recording.time, rtol=0, atol=1e-12)
        np.testing.assert_allclose(as_array(answer["outputs"]), recording.outputs.ravel(), rtol=1e-9, atol=1e-10)
        np.testing.assert_allclose(as_array(answer["truth"]), recording.truth.ravel(), rtol=1e-9, atol=1e-10)
        np.testing.assert_allclose([gap[:2] for gap in told["gaps"]], run.unobservable_intervals, rtol=0, atol=1e-9)
        if name != "sign":
            assert answer["summary"]["verdicts"][name] == run.verdict(settings["tolerance"])
            found = recording.view.quantities(run.estimate[:, 3:])
            for quantity, values in found.items():
                np.testing.assert_allclose(as_array(told["quantities"][quantity]), values, rtol=1e-6, atol=1e-9)
            far = np.where(np.isfinite(run.distance), run.distance, np.nan)
            np.testing.assert_allclose(as_array(told["range"]), far, rtol=1e-6)


def assert_same_determinant(settings, answer):
    (run, *_) = structure_runs_of(settings).values()
    choice, recording = run.recording.view, run.recording
    for k, digits in ((0, 1e-9), (-1, 1e-5)):  # near the camera the last digits of a place are magnified
        known = recording.motion.known(recording.time[k])[0]
        at = dict(zip(choice.form.x1, recording.outputs[k], strict=True))
        at |= dict(zip(choice.form.parameters, [*known, *choice.values.values()], strict=True))
        assert answer["determinant"][k] == pytest.approx(float(choice.determinant.subs(at)), rel=digits)


@pytest.mark.node
@pytest.mark.parametrize("case", CASES)
def test_the_copied_code_makes_the_same_run(answers, case):
    settings, answer = answers[case]
    copied = copied_runs(answer, settings)
    for name, run in structure_runs_of(settings).items():
        np.testing.assert_allclose(copied[name].estimate, run.estimate, rtol=0, atol=1e-12)
        assert copied[name].verdict(settings["tolerance"]) == run.verdict(settings["tolerance"])


@pytest.mark.node
def test_every_choice_is_possible_with_its_corollary_or_refused_in_the_same_words(lab, node):
    tasks = []
    for count in range(8):
        for unknown in combinations(QUANTITIES, count):
            for values in ([-0.22, -0.23, 0.1], [0.0, -0.23, 0.0]):
                changes = {"unknown": list(unknown), "v_c": values, "duration": 0.1, "earlier": count % 2 == 0}
                tasks.append(lab.check({**lab.model["opening"], **changes}))
    for settings, answer in zip(tasks, run_in_node(node, lab, tasks), strict=True):
        reason = refusal_of(settings)
        assert answer["refusal"] == reason
        assert ("# is refused" in answer["code"]) == bool(reason)
        if reason:
            with pytest.raises(ImpossibleChoice):
                exec(answer["code"], {})
        else:
            known = corollary_of(unknowns_of(settings))
            # velocities that happen to be zero besides make a special case of the same corollary
            assert known is None or answer["corollary"] == known.number


def refusal_of(settings):
    """Why Python refuses a choice; empty if it does not."""
    try:
        unknowns_of(settings)
    except ImpossibleChoice as error:
        return str(error)
    return ""


@pytest.mark.parametrize("unknown", POSSIBLE, ids=" ".join)
@pytest.mark.parametrize("earlier", [False, True])
def test_the_general_form_is_the_form_of_every_choice(unknown, earlier):
    choice = StructureAndMotion(unknown, earlier=("d_s",) if earlier and "d_s" not in unknown else ())
    M, m = choice.translation
    general = general_form(len(unknown))
    put = dict(zip(general.parameters[3:], [*M, *m], strict=True))
    for part in ("w", "phi"):
        difference = getattr(general, part).xreplace(put) - getattr(choice.form, part)
        assert difference.expand() == sp.zeros(*difference.shape)


def test_the_model_is_complete_and_is_json(lab):
    model = whole_model(lab)
    assert model["opening"] == structure_lab(duration=3.0).settings
    assert set(model["forms"]) == {"1", "2", "3"}
    assert all(set(form["observers"]) == set(EVERY) for form in model["forms"].values())
    assert [corollary["number"] for corollary in model["corollaries"]] == list(range(1, 8))
    possible = set(model["unknowns"])
    assert {key_of(u, e) for u in POSSIBLE for e in (False, True)} == possible
    assert model["refused"] == refused()
    assert possible | set(refused()) == {
        key_of(u, e) for n in range(8) for u in combinations(QUANTITIES, n) for e in (False, True)
    }


@pytest.mark.parametrize("case", COROLLARIES)
def test_each_corollary_is_one_click_and_converges(case):
    settings = structure_lab(**COROLLARIES[case]).settings
    (run,) = structure_runs_of(settings).values()
    assert run.verdict(settings["tolerance"]).startswith("converged")
    found = run.recording.view.quantities(run.estimate[-1, 3:])
    true = run.recording.view.quantities(run.truth[-1, 3:])
    for name, value in found.items():
        assert value == pytest.approx(true[name], rel=5e-3, abs=5e-3)


@pytest.mark.node
@pytest.mark.slow
def test_a_layer_that_is_not_resolved_is_told_before_the_run(lab, node):
    forgotten = lab.check({"duration": 60.0, "observers": ["layer"]})
    cured = lab.check({"duration": 60.0, "observers": ["ideal", "layer"], "gains": {"layer": {"sharpening": 0.0}}})
    answers = run_in_node(node, lab, [forgotten, cured])
    (limit,) = answers[0]["limits"]
    assert limit["time"] == pytest.approx(34.4, abs=0.1)
    assert answers[1]["limits"] == []
    with pytest.warns(StepTooLong, match=r"from 34\.4 s on"):
        (lost,) = lab.runs(forgotten).values()
    assert np.abs(lost.error[lost.time > 55, 3]).max() > 100
    assert all(run.verdict(0.05).startswith("converged") for run in structure_runs_of(cured).values())


def test_a_lab_that_is_given_nothing_opens_with_a_drive_whose_gains_fit_its_noise():
    settings = structure_lab().settings
    assert {**settings, **DRIVE, "gains": settings["gains"]} == settings
    assert refusal_of(settings).startswith("4 unknowns")
    gains = settings["gains"]["ideal"]
    observer = observer_of("ideal").with_gains(**gains)
    deviation = settings["noise"]["size"] / 3**0.5
    tolerable = tolerable_amplification(observer, deviation, settings["scale"], settings["duration"])
    assert gains["largest_amplification"] <= tolerable


def test_a_lab_opens_with_a_choice_that_is_impossible_and_says_why():
    lab = structure_lab(unknown=["v_c2", "v_p2"])
    with pytest.raises(ImpossibleChoice, match="act through their difference only"):
        lab.run()
    lab.summary = {"serial": 1}
    assert "act through their difference only" in lab.analysis["sentences"][0]


def test_the_analysis_says_what_is_off_and_how_much_it_scatters():
    lab = structure_lab(bias=1e-4, duration=2.0)
    lab.summary = {"serial": 3}
    assert lab.analysis["serial"] == 3
    assert lab.analysis["sentences"][0].startswith("ISMO, ideal switch, last tenth of the run: d_s is off by -")
    assert len(lab.analysis["sentences"]) == 3
