"""Calls that strangers made and that were accepted, or refused in words that help nobody."""

import math

import pytest
from examples import BOTH
from refusals import refuses

from percept_obs import affine, cli, ensemble, ibo, instantaneous, record, scenarios, track
from percept_obs.exercises import individual, reach, students_copy
from percept_obs.exercises.copies import stub
from percept_obs.labs import derivation_desk, observer_lab
from percept_obs.papers import find
from percept_obs.studies.servoing import starts
from percept_obs.validation import needed

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
    (lambda: derivation_desk(typed={"zz": "a"}), "the part, the step and the line"),
    (lambda: affine([[0, 0, 0]] * 3), "an affine motion"),
)


def test_settings_that_are_changed_in_place_say_how_to_set_them():
    lab = observer_lab()
    with pytest.raises(TypeError, match=r"lab\.settings = "):
        lab.settings.update(duration=-5)
    assert {**lab.settings, "duration": 5.0}["duration"] == 5.0


def test_a_film_that_is_not_there_is_named(capsys):
    assert cli.main(["film", "nope.mp4"]) == 2
    assert "nope.mp4" in capsys.readouterr().err


def test_a_paper_is_found_by_the_name_of_its_ledger_too():
    assert find(paper="ma2005") == find(paper="Ma, Chen")


def test_of_several_missing_modules_it_is_told_that_they_are_missing():
    with pytest.raises(ModuleNotFoundError, match="no_such, nor_this are missing; get them with"):
        needed("course", "no_such", "nor_this")
