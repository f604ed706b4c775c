"""An observer, a surface, a motion that somebody brings are computed by the page as by Python, or refused first."""

import json

import numpy as np
import pytest
import sympy as sp
from lab_settings import as_array, copied_runs, run_in_node, whole_model
from refusals import refuses
from test_lab_engine import assert_same_run
from test_points_lab import assert_same_gramian
from test_points_lab import assert_same_run as assert_same_points

from percept_obs import Camera, Scenario, Uniform, affine, extended_kalman, ibo, record, rigid
from percept_obs.compile.equations import Equations
from percept_obs.labs import observer_lab, points_lab, structure_lab
from percept_obs.labs.shared.samples import MOST_SAMPLES
from percept_obs.labs.structure.lab import unknowns_of
from percept_obs.observers import Observer
from percept_obs.observers.family import Derived, family
from percept_obs.observers.gains import Gain
from percept_obs.observers.parts import hats, innovation, output_injection
from percept_obs.points import PointsForm, independent_points
from percept_obs.structure import ImpossibleChoice, StructureAndMotion, StructureScenario
from percept_obs.system.motion import TIME, linear
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import POINT, ImagingSurface, pinhole

X, Y, Z = POINT
y1, y2 = sp.symbols("y1 y2", real=True)
K, L = sp.symbols("K L", real=True)
MOTION = "a12 = -0.2 - 0.1 sin(t); b = [0.4 cos(t), 0.3 sin(t/2), b3]"
SHORT = {"duration": 1.0, "period": 0.04, "window": 0.3, "X0": [1.0, 0.5, 4.0]}
CALM = {"A": np.zeros((3, 3)).tolist(), "b": [0.1, 0.1, 0.05]}


@family(
    name="cubic",
    title="Observer with a cubic correction",
    source="a reader",
    needs="any outputs with a canonical form",
    claim="none",
    gains=(
        Gain(K, "measured_gain", 8, 1, 40, "1/s", "pull on the outputs", K > 0, "it must pull towards the samples"),
        Gain(L, "hidden_gain", 20, 1, 200, "1/m^2", "pull on what is hidden", L > 0, "it must pull as well"),
    ),
)
def cubic(form):
    """x1hat' = K (e + e^3) + w^T x2hat + phi, x2hat' = L w (e + e^3) + g, with e = x1 - x1hat."""
    correction = innovation(form).applyfunc(lambda e: e + e**3)
    return Derived(hats((*form.x1, *form.x2)), output_injection(form, correction, K, L))


def slanted():
    """The image plane Z + Y/5 = 1."""
    depth = Z + Y / 5
    return ImagingSurface("slanted", (X / depth, Y / depth), depth, (y1, y2, 1 - y2 / 5))


def watched(form):
    """An observer that is written as `Observer` itself, with another order of its state than the coordinates'."""
    x = (*form.x2, *form.x1)
    e = innovation(form)
    known = dict(zip(form.x2, hats(form.x2), strict=True))
    flow = [*(4 * form.w * e + form.g.subs(known)), *(6 * e + form.w.T * sp.Matrix(hats(form.x2)) + form.phi)]
    equations = Equations(hats(x), tuple(flow), form.x1, form.parameters)
    return Observer("watched", form, equations, hats(form.coordinates), (), hats(x))


def assert_same_recording(answer, recording):
    """To 1e-9, for the page steps a motion that varies, and Python solves it to 1e-10 a step."""
    assert answer["time"] == pytest.approx(recording.elapsed.tolist(), abs=1e-12)
    for name in ("truth", "outputs"):
        expected = getattr(recording, name)
        np.testing.assert_allclose(as_array(answer[name], expected.shape[1]), expected, rtol=1e-9, atol=1e-10)


def assert_same_points_and_code(node, lab, tasks, form=None):
    """The page, Python and the code that the page copies make the same runs of many points."""
    for settings, answer in zip(tasks, run_in_node(node, lab, tasks), strict=True):
        run, names = lab.runs(settings), {"form": form}
        assert_same_points(answer, run)
        exec(answer["code"], names)
        np.testing.assert_allclose(names["run"].estimate, run.estimate, rtol=1e-8, atol=1e-9)
        yield settings, answer, run, names["run"]


@pytest.fixture(scope="module")
def lab():
    return observer_lab(observers=[cubic, watched, "extended_kalman"], surface=slanted, motion=MOTION, **CALM, **SHORT)


@pytest.mark.slow
def test_what_is_brought_opens_the_lab_with_its_gains_and_its_texts(lab):
    assert lab.settings["observers"] == ["cubic", "watched", "extended_kalman"]
    assert lab.settings["surface"] == "slanted"
    assert lab.settings["gains"]["cubic"] == {"measured_gain": 8.0, "hidden_gain": 20.0}
    model = whole_model(lab)
    assert model["surfaces"]["slanted"]["outputs"] == [["y1", "y2"], ["y1"], ["y2"]]
    assert set(model["forms"]["slanted y1"]["observers"]) == {
        *("cubic", "watched", "extended_kalman", "identifier_based")
    }
    assert "open it with observers=" in model["forms"]["slanted y1"]["refused"]["sliding_mode"]
    assert "cubic" in model["forms"]["pinhole y1"]["observers"]
    assert json.dumps(model, allow_nan=False)
    with pytest.raises(ValueError, match="K > 0 is needed; it must pull"):
        lab.settings = {**lab.settings, "gains": {"cubic": {"measured_gain": -1}}}


def tasks_of(lab):
    """Settings on every surface that matters: typed and constant motions, one output, each hold."""
    changes = [
        {},
        {"outputs": ["y1"], "hold": "first", "noise": {"kind": "uniform", "size": 0.01}, "dropout": 0.2},
        {"surface": "sphere", "outputs": ["y1", "y2"], "observers": ["cubic"], "hold": "exact"},
        {"motion": "", "gains": {"cubic": {"measured_gain": 11.5}}},
        {"motion": "q = 0.3 t\nb3 = q^2 sqrt(1 + q) - b1", "start": {"mode": "zero", "values": [0.0] * 3}},
        {"believed": {"A": [[0.1] * 3] * 3, "b": [0.1, 0.2, 0.3]}},
    ]
    return [lab.check({**lab.settings, **change}) for change in changes]


@pytest.mark.slow
@pytest.mark.node
def test_page_and_python_agree_on_all_of_it_and_copied_code_makes_the_same_run(lab, node):
    tasks = tasks_of(lab)
    for settings in tasks:
        lab.write_down(settings)
    for settings, answer in zip(tasks, run_in_node(node, lab, tasks), strict=True):
        copied = copied_runs(answer, settings, cubic=cubic, watched=watched, slanted=slanted)
        for name, run in lab.runs(settings).items():
            assert_same_recording(answer, run.recording)
            assert_same_run(answer["runs"][name], run, 1e-9)
            assert answer["summary"]["verdicts"][name] == run.verdict()
            np.testing.assert_allclose(copied[name].estimate, run.estimate, rtol=1e-8, atol=1e-9)


SPUN = "v_c1 = -0.22 - 0.1 sin(2t); w_c = [0.1 if t < 0.1234 else -0.2 t, 0, w_c3]; v_p2 = 0.3 exp(-t)"


@pytest.fixture(scope="module")
def structure():
    return structure_lab(observers=["ideal", cubic], duration=0.3, period=0.004, step=0.002, motion=SPUN)


@pytest.mark.slow
@pytest.mark.node
def test_of_structure_a_brought_observer_and_a_typed_motion_agree(structure, node):
    changes = ({}, {"unknown": ["d_s", "v_p1"], "hold": "exact", "w_c": [0.0, 0.0, 0.2], "v_p_swing": [0.1] * 3})
    tasks = [structure.check({**structure.settings, **change}) for change in changes]
    for settings, answer in zip(tasks, run_in_node(node, structure, tasks), strict=True):
        copied = copied_runs(answer, settings, cubic=cubic)
        for name, run in structure.runs(settings).items():
            found = as_array(answer["runs"][name]["estimate"], run.estimate.shape[1])
            np.testing.assert_allclose(found, run.estimate, rtol=1e-9, atol=1e-9)
            np.testing.assert_allclose(copied[name].estimate, run.estimate, rtol=1e-8, atol=1e-9)


def test_what_is_typed_decides_what_is_known_to_be_zero(structure):
    assert "v_p2" not in unknowns_of(structure.settings).zero
    zero = {**structure.settings, "motion": "v_c1 = 0 t", "v_c": [0.3, 0.0, 0.0]}
    with pytest.raises(ImpossibleChoice, match="none is known that is not zero"):
        unknowns_of(structure.check(zero))


SWUNG = "w_c = [-0.2 step(t - 0.3333), -0.3 cos(t), w_c3 - 0.2]; v_c1 = v_c1 - 0.5 sin(2t); w_b2 = 0.1 t"
OF_POINTS = {"duration": 1.0, "period": 0.1, "step": 0.1, "window": 0.5}


@pytest.mark.slow
@pytest.mark.node
def test_of_points_a_typed_motion_and_a_typed_P_agree(node):
    lab = points_lab(state="body")
    places = [[0.1 * k, 1.2 - 0.1 * k, 2.5 + 0.05 * k] for k in range(12)]
    typed = {"weight": "typed", "P": "P = P + exp(-t) / 2", "size": 0.7}
    changes = [{"state": "origin", "spin": 0.3, "motion": SWUNG, **typed}, {"state": "independent", "motion": SWUNG}]
    changes.append({"points": places, "hidden": [None] * 12, **typed, "P": "1 + t", "start": "error"})
    first = {"weight": "riccati", "size": 0.05, "hidden": [None, [0.0, 0.4], None]}
    changes += [
        {"P": "q = exp(-t); P = [P + 1, 1 + q/2, 1 + t]", "start": "error"},
        {"P": "[1, 2, P]", "size": 4.0, "state": "independent"},
        {"P": [1.5, 2, 3], "start": "error", "hidden": [None, [0.2, 0.6], None]},
        {**first, "P0": "P = [2P, 2P, P/4]", "state": "origin", "spin": 0.3},
        {**first, "P0": "[0.1, 0.2, P]", "state": "independent"},
        {"weight": "lyapunov", "P0": "[2, 1, 1]", "decrease": 0.02},
    ]
    tasks = [lab.check({**lab.settings, **OF_POINTS, **change}) for change in changes]
    assert tasks[2]["P"] == "P = 1 + t"
    for settings in tasks:
        lab.write_down(settings)
    assert len([*assert_same_points_and_code(node, lab, tasks)]) == len(tasks)


test_a_bad_text_is_a_sentence_with_the_place_and_is_never_run = refuses(
    lambda make, settings: make(**settings),
    (
        observer_lab,
        {"motion": "a12 = 0.3 foo(t)"},
        r'"foo" is no letter here; there are .*\n.*a12 = 0.3 foo\(t\)\n +\^',
    ),
    (observer_lab, {"motion": "b = [1, 2]"}, r"b has the shape \(2, 1\); expected \(3, 1\)"),
    (observer_lab, {"motion": "b1 = 1; b = [1, 2, 3]"}, "b1 is given twice"),
    (observer_lab, {"motion": "sin(t)"}, "each line begins with what it gives, such as b3 = "),
    (observer_lab, {"motion": "b1 = 1 / (t - 1)", "duration": 2.0}, r"b1 is -?[\d.]+e\+\d+ at 1 s"),
    (observer_lab, {"motion": "b1 = sqrt(1 - t)", "duration": 2.0}, "b1 is nan at 1.004 s"),
    (points_lab, {"motion": "w_c = [0, 0, 1/(t - 1.0031)]"}, r"w_c3 is -?[\d.]+e\+\d+ at 1.003 s"),
    (observer_lab, {"motion": "b1 = tan(t)"}, r"b1 is -?[\d.]+e\+\d+ at 1.571 s"),
    (observer_lab, {"motion": "b = step([1, 2, 3])"}, "step is of one number"),
    (observer_lab, {"motion": "b1 = 1 if 2 else 0"}, '"if" is of a whole entry'),
    (observer_lab, {"motion": "b1 = 2 (1 if t < 2 else 0)"}, '"if" is of a whole entry'),
    (observer_lab, {"motion": "b1 = t; vc1 = 2"}, "vc1 is given, and nothing uses it; there are "),
    (observer_lab, {"motion": "b1 = sech(t)"}, "cannot be printed alike in Python and JavaScript"),
    (observer_lab, {"motion": "b1 = 9^9^9^9"}, "a power of a power needs brackets"),
    (structure_lab, {"motion": "b1 = 1; v_c1 = q"}, '"q" is no letter here'),
    (points_lab, {"motion": "P = t"}, "motion gives P; give it as P="),
    (points_lab, {"weight": "typed", "P": "w_c1 = t"}, "P gives no value; it must be one expression"),
    (points_lab, {"weight": "typed", "P": "P = 1 - t"}, "P is .* at 1.02 s; it must be from 1e-9"),
    (points_lab, {"P": "[1, 1, 1 - t]"}, "P is .* at 1.02 s; it must be from 1e-9"),
    (points_lab, {"P": [1, 1]}, r"P is .*; it must be a number or a diagonal \[a, b, c\]"),
    (points_lab, {"P": "[[1, t, 0], [t, 1, 0], [0, 0, 1]]"}, r"it must be a number or a diagonal \[a, b, c\]"),
    (points_lab, {"P": "1; P = 2"}, "P gives an expression, P; it must be one expression"),
    (points_lab, {"P": "P = 1; P = 2"}, "P gives P, P; it must be one expression"),
    (points_lab, {"weight": "riccati", "P0": "1 + t"}, "P0 has t in it"),
)


TIMES = np.array([0.0, 0.133, 0.4, 0.71])
STAMPS = np.array([0.0, 0.013, 0.1, 0.17, 0.3])
VARYING = {
    "expressions of time": affine(
        sp.Matrix(3, 3, lambda i, j: sp.sin(TIME) / 5 * (i - j)), [0.1, sp.cos(2 * TIME), 0.05]
    ),
    "jumps": affine(
        sp.zeros(3, 3),
        [sp.sign(sp.sin(9 * TIME)), sp.Piecewise((1, TIME < 0.331), (0, True)), sp.Abs(TIME - 0.2573) + sp.atan(TIME)],
    ),
    "pulse": affine(sp.zeros(3, 3), [sp.Heaviside(TIME - 0.25) - sp.Heaviside(TIME - 0.2537), 0, 0.1]),
    "samples": affine(np.zeros((3, 3)), np.column_stack([np.cos(9 * TIMES), 0.2 - TIMES, 0.1 * TIMES]), TIMES),
    "a function": affine(lambda t: np.zeros((3, 3)), lambda t: [np.sin(t), 0.1, 0.1]),
}


@pytest.mark.slow
@pytest.mark.node
@pytest.mark.parametrize("kind", VARYING)
def test_a_scenario_whose_motion_varies_is_the_same_in_the_page_and_as_recorded(kind, node):
    scenario = Scenario("own", VARYING[kind], (0.5, 0.2, 5.0), 0.6, pinhole())
    lab = observer_lab(scenario, period=0.04, window=0.2)
    typed = kind in ("expressions of time", "jumps")
    assert bool(lab.settings["motion"]) == typed
    settings = lab.settings
    # the steps of both periods are as many, and stand elsewhere
    tasks = [lab.check({**settings, "period": 0.02}), settings]
    for task, answer in zip(tasks, run_in_node(node, lab, tasks), strict=True):
        (run,) = lab.runs(task).values()
        assert_same_recording(answer, run.recording)
        assert_same_run(answer["runs"]["identifier_based"], run, 1e-9)
    asked = record(scenario, camera=Camera(0.04))
    # a function is taken as samples every 10 ms
    np.testing.assert_allclose(run.recording.truth, asked.truth, rtol=0, atol=1e-6 if kind == "a function" else 1e-9)
    if not typed:
        with pytest.raises(ValueError, match="'own' has its own; choose another scenario"):
            lab.settings = {**settings, "motion": "b1 = t"}


@pytest.mark.slow
def test_what_cannot_be_run_is_refused_with_the_reason_before_the_lab_opens():
    def rounded(form):
        whole = cubic(form)
        flow = (sp.floor(whole.equations.flow[0]), *whole.equations.flow[1:])
        return Observer(
            "rounded",
            form,
            Equations(whole.equations.state, flow, form.x1, form.parameters, (K, L)),
            whole.estimate,
            whole.gains,
            whole.start,
        )

    def nothing(form):
        return None

    def fails(form):
        return {"y1": 1}[form.measured]

    walk = record(Scenario("walk", VARYING["samples"], (0.5, 0.2, 5.0), 0.5, pinhole()), camera=Camera(0.1))
    deep = ImagingSurface("deep", (X / Z, Y / Z, (X + Y) / Z), Z, (y1, y2, 1))
    rigid_form = PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2")
    for brought, reason in (
        (
            {"observers": [rounded]},
            "rounded cannot be used in this lab: the page cannot run it: floor.* cannot be printed",
        ),
        ({"observers": [nothing]}, "nothing gave NoneType for a form; it must give an Observer"),
        ({"recordings": {"a": 5}}, "recordings is the dict .*; expected a mapping from text to a Recording"),
        ({"recordings": {"planar": walk}}, "a recording and a scenario have the name 'planar'; give the recording"),
        ({"scenario": walk, "frames": 5}, "frames is the number 5; expected a Frames or a mapping"),
        ({"scenario": walk, "frames": {"a": 5}}, "frames is the dict"),
        ({"scenario": 5}, "scenario is the number 5; expected text or a Scenario or a Recording"),
        ({"observers": [fails]}, r"fails for y1, y2 measured on the pinhole: KeyError: \('y1', 'y2'\)"),
        ({"observers": [cubic, cubic]}, "there is an observer cubic already"),
        ({"observers": [3]}, "3 is no observer; bring its name, a function of a form, or an Observer"),
        ({"observers": "cubic"}, "it must be a list of names, functions of a form, or observers"),
        (
            {"observers": [ibo(rigid_form)]},
            r"made for a form with the parameters w_c1, .*PerspectiveSystem\(affine\(\)",
        ),
        ({"surface": deep}, "has 3 image coordinates; the lab draws images with two"),
        ({"surface": 4}, "surface is 4; bring an ImagingSurface"),
        ({"surface": "slanted"}, "surface is 'slanted'; it must be one of pinhole"),
    ):
        with pytest.raises(ValueError, match=reason):
            observer_lab(**brought)


@pytest.mark.slow
def test_an_observer_of_one_form_opens_the_lab_there_and_a_partitioned_system_will_do():
    bent = ImagingSurface("bent", (X / Z, Y / Z + (X / Z) ** 2), Z, (y1, y2 - y1**2, 1))
    system = PerspectiveSystem(affine(), bent)
    assert system.partition("y2").culprits
    lab = observer_lab(observers=[extended_kalman(system.partition("y2"))], duration=1.0)
    assert (lab.settings["surface"], lab.settings["outputs"]) == ("bent", ["y2"])
    assert lab.settings["observers"] == ["extended_kalman"] or lab.settings["observers"] == ["my_extended_kalman"]


def own_form(coupled=False):
    """Two points that turn around a vertical axis and drift, as nothing of the package does."""
    turn = sp.Matrix([[0, 0, sp.cos(TIME) / 3], [0, 0, 0], [-sp.cos(TIME) / 3, 0, 0]])
    A = sp.diag(turn, turn)
    A[0, 3] = int(coupled)
    v = [0.1, 0.2 * sp.sin(TIME), 0.3, 0.1, 0.2 * sp.sin(TIME), 0.3]
    return PointsForm(linear(A, v), np.eye(6).reshape(2, 3, 6))


@pytest.mark.node
def test_of_points_a_form_of_ones_own_agrees_or_is_refused(node):
    form = own_form()
    lab = points_lab(form, **OF_POINTS)
    assert (lab.settings["state"], len(lab.settings["points"])) == ("own", 2)
    tasks = [lab.settings, lab.check({**lab.settings, "weight": "riccati", "size": 0.02, "hidden": [None, [0.0, 0.4]]})]
    numbers = independent_points(affine([[0, 0.1, 0], [0, 0, 0], [0, 0, 1 / 3]], [0.3, 0.1, 0.2]), 2)
    plain = points_lab(numbers, **OF_POINTS)
    assert len([*assert_same_points_and_code(node, plain, [plain.settings], numbers)]) == 1
    assert len([*assert_same_points_and_code(node, lab, tasks, form)]) == len(tasks)
    for brought, settings, reason in (
        (of_samples(STAMPS[1:]), {}, "from 0.013 to 0.3 s, but a run of the lab begins at 0 s"),
        (of_samples(STAMPS[:1]), {}, "has one sample, at 0 s; bring two at least"),
        (of_samples(), {"duration": 9.0}, "lasts 9 s, but the motion is sampled up to 2.4 s only; shorten"),
        (own_form(coupled=True), {}, "only blocks of 3 x 3 on its diagonal"),
        (PointsForm(linear(states=3), np.eye(3)[None]), {}, "no expression in time for a11, a12"),
        (form, {"points": [[0.0, 0.0, 2.0]]}, "there are 1 points; it must be 2"),
        (form, {"motion": "w_c1 = t"}, "it must be empty with your own form"),
        (PerspectiveSystem(affine(), pinhole()).measure("y1"), {}, r"form is a CanonicalForm; expected a PointsForm"),
        (5, {}, "form is the number 5; expected a PointsForm"),
    ):
        with pytest.raises(ValueError, match=reason):
            points_lab(brought, **settings)


def of_samples(times=8 * STAMPS):
    """Two points that move by measured coefficients."""
    A = np.sin(times)[:, None, None] * np.array([[0, -0.2, 0.1], [0.2, 0, 0], [-0.1, 0, 0.05]])
    b = np.column_stack([0.5 * np.cos(9 * times), 0.1 * times, 0 * times])
    return independent_points(affine(A, b, times), 2)


@pytest.mark.slow
@pytest.mark.node
def test_of_points_a_motion_in_samples_agrees(node):
    form = of_samples()
    lab = points_lab(form, period=0.1, step=0.05, window=0.5)
    assert lab.settings["duration"] == 2.4
    changes = ({}, {"period": 0.05, "hold": "exact"}, {"weight": "riccati", "size": 0.02, "duration": 2.0})
    tasks = [lab.check({**lab.settings, **change}) for change in changes]
    for settings, answer, run, copied in assert_same_points_and_code(node, lab, tasks, form):
        assert_same_gramian(answer, settings, run.recording)
        assert copied.verdict() == run.verdict() == answer["summary"]["verdict"]
    lab.summary = {"serial": 1}
    assert lab.analysis["sentences"]


@pytest.mark.node
@pytest.mark.slow
def test_a_recording_on_a_surface_of_ones_own_is_followed_alike(node):
    motion = affine(np.zeros((3, 3)), lambda t: [np.sin(t), 0.1, 0.1])
    scenario = Scenario("walk", motion, (0.5, 0.2, 5.0), 1.0, slanted())
    recording = record(scenario, camera=Camera(0.04, Uniform(0.001)), seed=3)
    lab = observer_lab(recording, observers=[cubic, "identifier_based"])
    assert lab.settings["surface"] == "slanted"
    (answer,) = run_in_node(node, lab, [lab.settings])
    assert "# recording = the one that you gave to the lab" in answer["code"]
    for name, run in lab.run().items():
        assert_same_recording(answer, recording)
        assert_same_run(answer["runs"][name], run, 1e-9)


@pytest.mark.slow
@pytest.mark.node
def test_of_structure_a_choice_a_form_and_a_scenario_of_ones_own_open_the_lab(node):
    choice = StructureAndMotion(("v_p1", "v_p3"), zero=("v_p2", "v_c2"))
    opened = structure_lab(choice.form, duration=0.2, period=0.01)
    assert opened.settings == structure_lab(choice, duration=0.2, period=0.01).settings
    found = unknowns_of(opened.settings)
    assert found.unknown == choice.unknown
    assert set(found.zero) >= set(choice.zero)
    moving = rigid(
        camera_angular_velocity=(-0.1, 0.0, -0.2), camera_velocity=(0.2, 0.0, -0.1), point_velocity=(0.05, 0.0, 0.1)
    )
    mine = StructureScenario("mine", moving, (0.5, 0.4, 4.0), 0.3, pinhole(), scale=2.0, choice=choice)
    lab = structure_lab(mine, period=0.01, observers=["identifier_based"])
    (run,) = lab.run().values()
    np.testing.assert_allclose(run.truth, mine.coordinates(run.time), rtol=1e-9, atol=1e-12)
    (answer,) = run_in_node(node, lab, [lab.settings])
    found = as_array(answer["runs"]["identifier_based"]["estimate"], 5)
    np.testing.assert_allclose(found, run.estimate, rtol=1e-9, atol=1e-9)
    with pytest.raises(ValueError, match="scaled inverse"):
        structure_lab(PerspectiveSystem(affine(), pinhole()).measure("y1"))


MEASURED = np.column_stack([-0.2 - 0.1 * np.sin(9 * STAMPS), 0.3 - STAMPS, 0 * STAMPS])


def velocities(v_c=MEASURED, times=STAMPS):
    """Velocities that a robot has measured; its object moves along an axis."""
    return rigid(
        camera_angular_velocity=[-0.1, 0.0, 0.2],
        camera_velocity=v_c,
        point_velocity=np.column_stack([0 * STAMPS, 0.2 * STAMPS, 0 * STAMPS])[: len(v_c)],
        times=times,
    )


@pytest.mark.slow
@pytest.mark.node
def test_of_structure_velocities_in_samples_agree_and_copied_code_makes_the_same_run(node):
    motion = velocities()
    choice = StructureAndMotion(("d_s", "v_c2", "v_p3"), zero=("v_c3", "v_p1"))
    place = (0.5, 0.4, 4.0)
    moved = rigid(
        camera_angular_velocity=(-0.1, 0, 0),
        camera_velocity=lambda t: [0.2 + t, 0.1, 0.0],
        point_velocity=lambda t: [0.0, 0.1 * t, 0.0],
    )
    mine, other = (
        StructureScenario("mine", m, place, 0.25, pinhole(), scale=2.0, choice=choice) for m in (motion, moved)
    )
    labs = [structure_lab(given, period=0.01, step=0.005) for given in (motion, mine, other)]
    changes = (
        {"observers": ["ideal", "identifier_based"], "noise": {"kind": "uniform", "size": 1e-4, "depth": 1e-5}},
        {"unknown": ["v_p1", "v_c2"], "hold": "exact", "period": 0.02},
        {"velocities": "set"},
    )
    assert [lab.settings["duration"] for lab in labs] == [0.3, 0.25, 0.25]
    for lab, given in zip(labs, (motion, motion, moved), strict=True):
        assert lab.settings["velocities"] == "samples"
        tasks = [lab.settings, *(lab.check({**lab.settings, **change}) for change in changes)]
        for settings, answer in zip(tasks, run_in_node(node, lab, tasks), strict=True):
            copied = copied_runs(answer, settings, motion=given)
            for name, run in lab.runs(settings).items():
                assert_same_recording(answer, run.recording)
                found = as_array(answer["runs"][name]["estimate"], run.estimate.shape[1])
                np.testing.assert_allclose(found, run.estimate, rtol=1e-9, atol=1e-9)
                assert answer["summary"]["verdicts"][name] == run.verdict(settings["tolerance"])
                assert copied[name].verdict(settings["tolerance"]) == run.verdict(settings["tolerance"])
                # the lab takes a function as samples every 10 ms
                near = 1e-4 if given is moved else 1e-9
                np.testing.assert_allclose(copied[name].estimate, run.estimate, rtol=near, atol=near)
    scale = labs[0].check({**labs[0].settings, "unknown": ["d_s", "v_c1", "v_c2"]})
    (answer,) = run_in_node(node, labs[0], [scale])
    with pytest.raises(ImpossibleChoice, match="none is known that is not zero") as refused:
        unknowns_of(scale, labs[0]._samples)
    assert answer["refusal"] == str(refused.value)


def test_of_structure_samples_stay_apart_from_what_is_set():
    lab = structure_lab(velocities(), unknown=["d_s", "v_p1"])
    assert unknowns_of(lab.settings, lab._samples).zero == ("v_c3", "v_p3")
    assert unknowns_of({**lab.settings, "velocities": "set"}, lab._samples).zero == ("v_c3", "v_p2", "v_p3")
    assert lab.model["opening"]["velocities"] == "samples"
    assert lab.model["standard"]["velocities"] == "set"
    lab.summary = {"serial": 1}
    assert "last tenth of the run" in lab.analysis["sentences"][0]
    still = structure_lab(rigid(camera_angular_velocity=[-0.1, 0, 0], camera_velocity=[0.2, 0, 0.1]))
    assert (still.settings["velocities"], still.settings["v_c"]) == ("set", [0.2, 0.0, 0.1])


BROKEN = np.where(MEASURED > 0.2, np.nan, MEASURED)
MANY = np.arange(MOST_SAMPLES + 1) / 100


test_of_structure_samples_that_do_not_suit_are_refused_with_what_to_do = refuses(
    lambda bring, settings: structure_lab(bring(), **settings),
    (lambda: velocities(BROKEN), {}, "camera_velocity .* is not finite; remove or repair the NaN"),
    (lambda: velocities(MEASURED[:, :2]), {}, r"has shape \(5, 2\); expected \(3,\) or \(5, 3\)"),
    (lambda: velocities(MEASURED[:4]), {}, r"has shape \(4, 3\); expected \(3,\) or \(5, 3\)"),
    (lambda: velocities(times=STAMPS[[0, 2, 1, 3, 4]]), {}, "times go from 0.1 to 0.013 s; sort the samples"),
    (lambda: velocities(MEASURED[:1], STAMPS[:1]), {}, "has one sample, at 0 s; bring two at least"),
    (lambda: velocities(MEASURED[:0], STAMPS[:0]), {}, "times of the motion are empty; give one for each"),
    (lambda: velocities(times=STAMPS + 7), {}, "from 7 to 7.3 s, but a run .* begins at 0 s; .*times - times.0."),
    (velocities, {"duration": 0.4}, "lasts 0.4 s, but the motion is sampled up to 0.3 s only; shorten the"),
    (velocities, {"motion": "v_c1 = t"}, "are those of your samples; leave it empty, or take velocities="),
    (lambda: rigid(camera_velocity=np.zeros((len(MANY), 3)), times=MANY), {}, "1e.04 are allowed; bring fewer"),
    (lambda: rigid(camera_velocity=lambda t: [t, 0, 0]), {}, "nothing says how long they last; bring samp"),
    (affine, {}, "a motion 'affine' of a11, .* without numbers; bring rigid"),
    (lambda: None, {"velocities": "samples"}, "must be one of set; there is .* opened with rigid"),
)
