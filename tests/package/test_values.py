"""Every public value pickles into another process and copies, and is then equal in its parts and all it computes."""

import contextlib
import copy
import doctest
import enum
import inspect
import io
import pickle
import subprocess
import sys
import warnings
from functools import cache

import bad_calls
import equal_values
import numpy as np
import pytest
import sympy as sp
from equal_values import computed, difference, kept, swinging
from examples import AFFINE, BOTH, NOISY
from ipywidgets import Widget

import percept_obs as po
from percept_obs.checking import target_of
from percept_obs.film import example_film, read_film
from percept_obs.papers import MA2005
from percept_obs.papers.entries import Finding
from percept_obs.recording.camera_files import Mount
from percept_obs.recording.colmap import ColmapModel
from percept_obs.recording.stereo_mat import StereoTracks
from percept_obs.site.pages import public
from percept_obs.structure import COROLLARIES, linear_view
from percept_obs.structure.scenarios import chwa2019_semigeneral
from percept_obs.studies.sensitivity import misbelieved
from percept_obs.system.motion import TIME

KINDS = [
    kind
    for values in public().values()
    for _, kind in values
    if inspect.isclass(kind)
    and not (issubclass(kind, Widget) or inspect.isabstract(kind) or getattr(kind, "_is_protocol", False))
]
"""Public classes, but for labs, which live in a page, and those of which there are only values of other classes."""

POSES = po.Poses(np.arange(9.0), np.zeros((9, 3)), np.tile([0, 0, 0, 1.0], (9, 1)))
MADE = {
    type(po.ibo.about): lambda: po.ibo.about,
    type(COROLLARIES[0]): lambda: COROLLARIES[0],
    ColmapModel: lambda: ColmapModel(POSES, po.PixelCamera((9, 9), (5, 5)), np.eye(3), np.eye(2), np.eye(2), (7,)),
    po.FunctionObserver: lambda: po.FunctionObserver("kept", BOTH, np.copy, kept, np.copy),
    Finding: lambda: MA2005["(10)"].finding,  # which another test may have made already
    po.film.Film: lambda: read_film(example_film()),
    Mount: lambda: Mount((0.1, 0.0, 0.2), ((1, 0, 0), (0, 1, 0), (0, 0, 1))),
}
"""Values of classes whose docstrings make none."""

MOTIONS = {
    "motion of functions": po.rigid(camera_angular_velocity=swinging, camera_velocity=swinging),
    "motion of t": po.affine(sp.zeros(3, 3), [sp.Abs(sp.cos(TIME)), 0.1, 0.2]),
    "sampled motion": po.rigid(camera_angular_velocity=np.ones((2, 3)), camera_velocity=np.ones((2, 3)), times=[0, 1]),
}


def recorded():
    """A recording of 2 s."""
    return po.record(po.scenarios.ma2005_eq35(), 2, NOISY)


def others():
    """Further values, by what they are."""
    yield from MOTIONS.items()
    yield "misbelieved", misbelieved(MOTIONS["motion of functions"], v_c1=0.1)
    yield "seen on a sphere", po.seen_on(recorded(), po.sphere())
    scene = chwa2019_semigeneral("simulation")
    seen = po.record(scene, 2, po.Camera(0.01))
    yield "linear view", linear_view(seen)
    yield "semigeneral", po.semigeneral(seen, scene.motion, moves_at=1, step=0.01)
    body = po.points.rigid_body(2, [0, 0, 0.1], [0.1, 0, 0], [0, 0.2, 0])
    for thing in (AFFINE, BOTH, po.ekf(BOTH), po.luenberger(body, 0.5), COROLLARIES[0].choice(), BOTH.derivation()):
        yield f"target of a {type(thing).__name__}", target_of(thing)
    yield "review", po.check("y3' = b3 y3^2", AFFINE)
    for name, function, arguments in bad_calls.calls():
        found = function(*arguments.get("*", []), **{key: each for key, each in arguments.items() if key != "*"})
        if not isinstance(found, np.ndarray) and not inspect.isfunction(found):
            yield f"{name} of {', '.join(arguments)}", found


def example_of(kind):
    """A value of a class, as the examples in its docstring make one; an error may be of any words."""
    if kind in MADE:
        return MADE[kind]()
    if issubclass(kind, enum.Enum):
        return next(iter(kind))
    made, init = [], kind.__init__

    def noted(self, *args, **kwargs):
        init(self, *args, **kwargs)
        made.append(self)

    names, hook = dict(vars(sys.modules[kind.__module__])), sys.displayhook
    try:
        kind.__init__, sys.displayhook = noted, made.append
        for example in doctest.DocTestParser().get_examples(inspect.getdoc(kind)):
            if doctest.SKIP not in example.options:
                with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(Exception):
                    exec(compile(example.source, "example", "single"), names)
    finally:
        kind.__init__, sys.displayhook = init, hook
    found = next((value for value in (*made, *names.values()) if type(value) is kind), None)
    return kind("why") if found is None and issubclass(kind, Exception) else found


@cache
def values():
    """Public values by name: one of each class, and others."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        more = dict(others())
        MADE[StereoTracks] = lambda: more["read_stereo_mat of path, shortest, gap"]
        return {f"{kind.__module__}.{kind.__qualname__}": example_of(kind) for kind in KINDS} | more


def pickled(value):
    return pickle.loads(pickle.dumps(value))


@cache
def elsewhere():
    """The values and what they compute in another process."""
    texts = pickle.dumps([pickle.dumps(value) for value in values().values()])
    program = [sys.executable, equal_values.__file__]
    answer = io.BytesIO(subprocess.run(program, input=texts, stdout=subprocess.PIPE, check=True).stdout)
    return {name: (pickle.load(answer), pickle.load(answer)) for name in values()}


@pytest.mark.slow
def test_there_is_a_value_of_every_public_class():
    assert [name for name, value in values().items() if value is None] == []
    assert len(KINDS) > 90


@pytest.mark.slow
@pytest.mark.parametrize("way", [pickled, copy.copy, copy.deepcopy])
def test_it_is_equal_here_and_so_is_all_that_it_computes(way):
    wrong = {}
    for name, value in values().items():
        found = way(value)
        wrong[name] = difference(value, found) or difference(computed(value), computed(found))
    assert {name: why for name, why in wrong.items() if why} == {}


@pytest.mark.night
@pytest.mark.slow
def test_it_is_equal_in_another_process_and_so_is_all_that_it_computes():
    wrong = {}
    for name, value in values().items():
        found, what = elsewhere()[name]
        wrong[name] = difference(value, found) or difference(pickled(computed(value)), what)
    assert {name: why for name, why in wrong.items() if why} == {}


@pytest.mark.slow
def test_what_a_value_keeps_of_its_work_does_not_travel():
    larger = {}
    for name, value in values().items():
        fresh = pickled(value)
        size = len(pickle.dumps(fresh))
        computed(fresh)
        larger[name] = len(pickle.dumps(fresh)) / size
    assert {name: factor for name, factor in larger.items() if factor > 1.05} == {}


def test_observers_follow_copies_with_the_same_bits():
    for observer in (po.ekf(BOTH), po.ibo(BOTH), MADE[po.FunctionObserver]()):
        recording = recorded()
        states = po.track(recording, observer).estimate
        for way in (pickled, copy.copy, copy.deepcopy):
            assert po.track(way(recording), way(observer)).estimate.tobytes() == states.tobytes()


def test_a_function_without_a_name_copies_and_pickle_says_that_it_cannot():
    motion = po.rigid(camera_angular_velocity=lambda time: [time, 0, 0])
    assert copy.deepcopy(motion).known(2.0).tolist() == motion.known(2.0).tolist()
    with pytest.raises((pickle.PicklingError, AttributeError), match="lambda"):
        pickle.dumps(motion)
