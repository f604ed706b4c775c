"""Calls that strangers made and that were accepted, or refused in words that help nobody."""

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from examples import BOTH
from refusals import refuses

from percept_obs import (
    Camera,
    Gaussian,
    NotAffine,
    PerspectiveSystem,
    PixelCamera,
    Recording,
    StructureAndMotion,
    affine,
    check,
    cli,
    ekf,
    ensemble,
    figures,
    ibo,
    instantaneous,
    pinhole,
    read_folder,
    read_tum,
    record,
    rigid,
    scenarios,
    sphere,
    track,
    windowed,
)
from percept_obs.checking import target_of
from percept_obs.exercises import derive, individual, reach, students_copy
from percept_obs.exercises.copies import stub
from percept_obs.exercises.models import notebooks
from percept_obs.film import Board, example_film, read_film
from percept_obs.labs import derivation_desk, observer_lab, points_lab, structure_lab
from percept_obs.papers import MA2005, find, judge
from percept_obs.recording import Frames, render
from percept_obs.recording.footage import Footage
from percept_obs.recording.imu import Imu, read_imu
from percept_obs.recording.plausibility import Unlikely
from percept_obs.recording.poses import Poses
from percept_obs.recording.recording import Sighting
from percept_obs.recording.track_files import write_tracks
from percept_obs.recording.worked import WORKED_CAMERA, worked_folder
from percept_obs.structure import GivenDepth, PatchDepth, ScaledDepthCamera, grid_patch, seen_as
from percept_obs.structure.pixels import SignalToNoise
from percept_obs.structure.scenarios import chwa2019_experiment
from percept_obs.studies.servoing import servo, starts
from percept_obs.system.bearings import bearings_only
from percept_obs.system.inertial import imu
from percept_obs.validation import needed

SYSTEM, SEEN = PerspectiveSystem(affine(), pinhole()), record(scenarios.ma2005_eq35(), 1)
HOUSE, LINE, SOME = chwa2019_experiment("IV.A"), bearings_only(), np.random.default_rng(0)
SAMPLED = affine(np.zeros((3, 3)), np.zeros((11, 3)), np.linspace(0, 1, 11))
POSES = Poses([0, 1], [[0, 0, 0], [0, 0, 1]], [[0, 0, 0, 1]] * 2)


def _task(rules):
    said = {"tags": ["exercise"], "percept_obs": rules}
    return {"cells": [{"cell_type": "markdown", "id": "task", "source": ["in 10 s"], "metadata": said}]}


test_they_are_refused_with_what_to_do = refuses(
    lambda call: call(),
    (lambda: instantaneous(BOTH).circle(-1), "a negative number: give one from 0 on"),
    (lambda: starts(-1), "at least 1"),
    (lambda: track(record(scenarios.ma2005_eq35(), 1), ibo(BOTH)).trust(math.inf), "such as 0.1 for 10 %"),
    (lambda: reach(1.0, lambda gain: {}), "nothing is to be reached"),
    (lambda: ensemble(scenarios.ma2005_eq35(), ibo(BOTH), seeds=[1, 1]), "a seed stands twice"),
    (lambda: individual({}, "Ada"), "this is no notebook"),
    (lambda: students_copy(None), "this is no notebook"),
    (lambda: stub({}), "expected text"),
    (lambda: derive("y1' = b1", SYSTEM, "y9'"), "there is no line y9'"),
    (lambda: derive("y1' = b1", SYSTEM, "y1'", letters={"q": 2}), "no letter can have the factor of q"),
    (lambda: track(SEEN, ekf(BOTH)).nees("y3", "y3"), "stands twice"),
    (lambda: track(record(scenarios.held_phone(), 0.2), ibo(BOTH)), "was seen as camera with an IMU"),
    (lambda: windowed(BOTH, replace(SEEN, motion=rigid(camera_velocity=(0, 0, 1))), 1), "the same kind of motion"),
    (lambda: windowed(BOTH, SEEN, 0.5).lost(10**6), "there are"),
    (lambda: ensemble(scenarios.ma2005_eq35(), ibo(BOTH), {"start_y3": [0.1]}, start={"y3": 0.5}), "one of the two"),
    (lambda: servo(starts(1), "true", seed=-1), "a whole number from 0 on"),
    (lambda: servo(starts(1), "true", duration=1e7), "take a shorter duration"),
    (lambda: servo(starts(1), "true", duration=0.1).recording(9), "there are 4, from 0 to 3"),
    (lambda: grid_patch(0.2, 10001), "take fewer along a side"),
    (lambda: derivation_desk(typed={"zz": "a"}), "the part, the step and the line"),
    (lambda: affine([[0, 0, 0]] * 3), "an affine motion"),
    (lambda: affine(times=[0, 1]), "times are those of samples"),
    (lambda: SAMPLED.known(math.nan), "asked for from nan"),
    (lambda: imu(np.zeros(3), np.zeros((5, 3))), r"specific_force .* samples need times="),
    (lambda: pinhole().sees([0, 0, 1, 1]), "the points have the shape"),
    (lambda: pinhole().inverse([0.1, 0.2]), "the coordinates y1, y2, y3 have the shape"),
    (lambda: pinhole().relative_error(*map(np.ones, ((5, 3), (4, 3), (1, 9)))), "the truth is of shape"),
    (lambda: replace(pinhole(), values={sp.Symbol("q"): 1.0}), "give its own letters finite numbers"),
    (lambda: replace(LINE, powers=(1,)), "powers of the bearing alone has 1 entries"),
    (lambda: replace(BOTH, w=sp.ImmutableMatrix([[1]])), r"w has the shape \(1, 1\)"),
    (lambda: replace(BOTH, x2=BOTH.x1), "in one of them, once"),
    (lambda: replace(BOTH, x1=("y1", "y2")), "x1 is the tuple"),
    (lambda: NotAffine("y1", "y2"), "put it into a list"),
    (lambda: HOUSE.choice.theta_values(0, HOUSE.motion, [0.0]), "give a positive number"),
    (lambda: seen_as(SEEN, StructureAndMotion(("v_c1",)), HOUSE.motion), "needs the outputs"),
    (lambda: GivenDepth().depths(np.ones(2), np.ones(3), np.ones(2), SOME), "the exact depths have shape"),
    (lambda: PatchDepth(np.zeros((4, 3))), "fewer than four points"),
    (lambda: ScaledDepthCamera(noise=Gaussian(1.0), ratio=SignalToNoise(20.0)), "a noise or a ratio"),
    (lambda: Gaussian(1e300), "at most 1e150"),
    (lambda: Imu(turning_noise=-1), "turning_noise is -1"),
    (lambda: Camera().drawn([0], (-1, 2)), "sizes from 0 on"),
    (lambda: Camera().samples(HOUSE, np.zeros(2), np.zeros((5, 6)), SOME), "5 rows for 2 times"),
    (lambda: replace(SEEN, outputs=np.full((101, 2), math.nan)), "of one point one at least is needed"),
    (lambda: Sighting("a", 0, 1), "a whole number"),
    (lambda: render(record(HOUSE, 0.1)), "image coordinates of one point"),
    (lambda: Frames([np.full((2, 2), 1000.0)], [0.0], (-1, 1, -1, 1)), "expected 0 to 1"),
    (lambda: Frames(5, [0.0], (-1, 1, -1, 1)), "a sequence of files or arrays"),
    (lambda: observer_lab(xi=0.5), "surface is 'pinhole', not 'unified'"),
    (lambda: observer_lab(duration=5, window=50), "window is 50, but duration is 5"),
    (lambda: observer_lab(duration=10, sight=[50, 60]), "the run is from 0 to 10 s"),
    (lambda: observer_lab(SEEN, X0=[0, 0, 5]), "scenario is"),
    (lambda: observer_lab().runs(None), "they must be a mapping"),
    (lambda: points_lab(P0=3), "weight is 'constant', not 'lyapunov' or 'riccati'"),
    (lambda: points_lab(hidden=[[50, 60], None, None]), "duration is 30"),
    (lambda: derivation_desk(student="Ada", motion="rigid"), "student is 'Ada'"),
    (lambda: derivation_desk(typed={"rate 6 y9'": "a13"}), "this step has y1', y2', y3'"),
    (lambda: check("y1' = b1", PerspectiveSystem), "the class PerspectiveSystem"),
    (lambda: target_of({}), "there is no formula"),
    (lambda: target_of(SYSTEM).own("b1"), "formula is the text 'b1'"),
    (lambda: MA2005.search(38), "expected text"),
    (lambda: judge(find([10], paper="Ma"), processes=0), "processes is 0"),
    (lambda: reach(2.0, {"seconds": 2}, seconds=2), "expected a function"),
    (lambda: reach(2.0, lambda gain: None, seconds=2), "expected a mapping"),
    (lambda: individual({"cells": []}, None), "student is None"),
    (lambda: cli.copy_notebooks("new", "parents"), "there are students, teachers"),
    (lambda: read_film(example_film(), Board(), PixelCamera((9, 9), (5, 5)), POSES), "leave one of them out"),
    (lambda: figures.depth_errors({"a": [-0.1]}, 2), "from 0 on"),
    (lambda: students_copy({"cells": [{"cell_type": "code"}]}), "cell 1 is none of a notebook"),
    (lambda: stub("x = "), "no Python"),
    (lambda: individual(individual({"cells": []}, "Ada"), "Bob"), "Ada's own already"),
    (lambda: individual(_task({"number": {}}), "Ada"), "there are letters, numbers, rubric"),
    (lambda: individual(_task({"numbers": {"10": ["5", "15", "0", "in {} s"]}}), "Ada"), "a positive step"),
    (lambda: individual(_task({"numbers": {"10": ["5", "15", "1", "for {} s"]}}), "Ada"), "the place 'for {} s'"),
    (lambda: individual(students_copy(next(iter(notebooks().values()))), "Ada"), "the notebook with solutions"),
    (lambda: derive("y1' = b1", SYSTEM, "y1'", letters={"b1": math.inf}), "no letter can have the factor of b1"),
    (lambda: check(True, SYSTEM), "a bool is no formula"),
    (lambda: target_of(b"x = 1"), "compared with the bytes"),
    (lambda: judge([]), "no entry to judge"),
    (lambda: figures.scene(SEEN).save("."), "cannot write '.'"),
    (lambda: figures.runs_over_time([track(SEEN, ibo(BOTH))] * 2, ["a", "a"]), "a label of its own"),
    (lambda: figures.cases({"a": []}), "'a': 'no run'"),
    (lambda: observer_lab().save("lab.pdf"), "name 'lab.html', not 'lab.pdf'"),
    (lambda: derivation_desk(hints={"rate": 2}), 'such as "rate 6"'),
    (lambda: check(b"y1' = b1", SYSTEM), "a bytes is no formula"),
    (lambda: Board().detect(np.zeros((0, 0), np.uint8)), "picture is an array of shape"),
    (lambda: read_film(example_film(), camera=PixelCamera((9, 9), (5, 5), (19, 10))), "the film .480, 270."),
    (lambda: Footage((SEEN,), ("stereo",), render(SEEN, 2, 32), "x"), "names of their distances"),
    (lambda: affine(np.zeros((3, 3)), np.zeros(3), [0, 1, 2]), "the motion is constant"),
    (lambda: replace(scenarios.planar(), motion=affine()), "has no values for a11"),
    (lambda: replace(scenarios.planar(), motion=scenarios.own_ship_turns().motion), "a point has X, Y, Z"),
    (lambda: replace(scenarios.own_ship_turns(), motion=SAMPLED), "is none of bearing alone"),
    (lambda: Poses([0, 1e10], POSES.position, POSES.orientation).path(), "give seconds, or cut"),
    (lambda: read_folder(worked_folder(), rate=-5), "rate is -5"),
    (lambda: write_tracks(worked_folder(), [SEEN]), "is a folder"),
    (lambda: write_tracks("w.csv", [SEEN, record(scenarios.ma2005_eq35(sphere()), 1)]), "write two files"),
    (lambda: Recording.from_csv(worked_folder() / "tracks.csv", SEEN.motion, depth="time"), "is read as something"),
    (lambda: read_tum(worked_folder() / "tracks.csv"), "rows with 1 and with 3 cells"),
)


@pytest.mark.parametrize("make", [observer_lab, points_lab, structure_lab, derivation_desk])
def test_settings_that_were_read_back_may_do_nothing(make):
    idle = {"xi": 0.5, "P0": "P = 3", "decrease": 5.0, "rate": 2.0, "window": 100.0, "student": "Ada"}
    settings = make().settings
    assert make(**{**settings, **{name: idle[name] for name in idle if name in settings}})


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("exam a {}", "is a file"),
        ("lab --copy-only --student= new", "an empty name"),
        ("site --address here new", "it begins with https://"),
        ("site --address http:// new", "it begins with https://"),
        ("collect . -o marks.docx", "name 'marks.csv', not 'marks.docx'"),
    ],
)
def test_a_command_is_refused_before_it_works(command, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(command.format(__file__).split()) == 2
    assert said in capsys.readouterr().err


def test_settings_that_are_changed_in_place_say_how_to_set_them():
    lab = observer_lab()
    with pytest.raises(TypeError, match=r"lab\.settings = "):
        lab.settings.update(duration=-5)
    assert {**lab.settings, "duration": 5.0}["duration"] == 5.0


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n".encode("utf-16"), "save it as UTF-8"),
        (b"0,5 0,1 0,2 0 0 0 0 1\n", "decimal commas"),
        (b"0,0.1,0.2,0,0,0,0,1\n0.5,0.1,0.2,0,0,0,0,1\n", "TUM's have blanks"),
        (b"0;0,0;0,1;0,0;0,0;0,0;9,8\n", "decimal commas"),
        (b"PK\3\4", "save its table as CSV"),
        (b"1 " * 2000 + b"\n", "over a hundred numbers"),
        (b"2 0 0 0 0 1 0 0 0 0 1 0\n", "no rotation"),
    ],
)
def test_what_a_file_is_stands_in_its_refusal(text, said, tmp_path):
    (tmp_path / "poses.txt").write_bytes(text)
    with pytest.raises(ValueError, match=said):
        read_tum(tmp_path / "poses.txt")


def test_a_row_with_too_few_cells_is_no_lost_sample(tmp_path):
    (tmp_path / "track.csv").write_text("time,y1,y2\n0,1,2\n1,2\n")
    with pytest.raises(ValueError, match="2 cells in line 3, and 3 names"):
        Recording.from_csv(tmp_path / "track.csv", SEEN.motion)


def test_the_content_of_a_file_is_no_path_to_it():
    with pytest.raises(FileNotFoundError, match="'0 0 0 0 0 0 0 1', where there is no file"):
        read_tum("0 0 0 0 0 0 0 1\n" * 300)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda _: PixelCamera((500, 500), (3200, 2400), (640, 480)), "are both of one size"),
        (lambda _: PixelCamera((0.004, 0.004), (320, 240)), "are these pixels"),
        (lambda _: POSES.mounted([0, 0, 65], [0, 0, 0, 1]), "in millimetres"),
        (lambda _: Poses(50.0 * np.arange(6), np.zeros((6, 3)), [[0, 0, 0, 1]] * 6), "its times seconds"),
        (lambda file: Recording.from_csv(file, SEEN.motion, camera=WORKED_CAMERA), "in its corner"),
        (read_imu, "at rest it is 9.8"),
        (lambda _: Camera(30), "for 30 pictures a second, Camera.1/30"),
        (
            lambda _: replace(SEEN, time=1e9 * SEEN.time, motion=rigid(camera_velocity=(0, 0, 1))),
            "are its times seconds",
        ),
    ],
)
def test_what_is_hardly_meant_is_suspicious(call, said, tmp_path):
    (tmp_path / "file.csv").write_text("0,0,0,0,0,0,1\n" if call is read_imu else "time,u,v\n0,0.1,0.2\n1,0.1,0.2\n")
    with pytest.warns(Unlikely, match=said):
        call(tmp_path / "file.csv")


def test_a_setting_is_no_attribute_of_a_lab():
    with pytest.raises(AttributeError, match="duration is a setting"):
        observer_lab().duration = 5


def test_a_film_that_is_not_there_is_named(capsys):
    assert cli.main(["film", "nope.mp4"]) == 2
    assert "nope.mp4" in capsys.readouterr().err


def test_a_paper_is_found_by_the_name_of_its_ledger_too():
    assert find(paper="ma2005") == find(paper="Ma, Chen")


def test_of_several_missing_modules_it_is_told_that_they_are_missing():
    with pytest.raises(ModuleNotFoundError, match="no_such, nor_this are missing; get them with"):
        needed("course", "no_such", "nor_this")
