"""Texts for the page come from a process of their own, once for all labs, and a failure is told."""

import pytest

from percept_obs.labs import printing
from percept_obs.labs.observer_lab import observer_lab
from percept_obs.labs.structures import texts_of

STRUCTURES = "percept_obs.labs.structures"
KEYS = ["pinhole y1+y2", "chained y2"]


def all_of(press, keys):
    """What printing hands over, in its order, and what it complains of."""
    found, complaints = [], []
    press.ask(keys, lambda key, texts: found.append((key, texts)), complaints.append)
    if press._thread is not None:
        press._thread.join(120)
    return found, complaints


@pytest.mark.slow
def test_another_process_prints_what_this_one_would():
    press = printing.Printing(STRUCTURES)
    found, complaints = all_of(press, KEYS)
    assert complaints == []
    assert found == [(key, texts_of(key)) for key in KEYS]


def test_what_was_printed_is_handed_over_at_once_and_not_printed_again(monkeypatch):
    press = printing.Printing(STRUCTURES)
    press.texts = {key: {"of": key} for key in KEYS}
    monkeypatch.setattr(printing, "_printed_beside", lambda *_: pytest.fail("printed again"))
    assert all_of(press, KEYS) == ([(key, {"of": key}) for key in KEYS], [])


@pytest.mark.slow
def test_a_process_that_fails_is_told_and_the_next_lab_tries_again():
    press = printing.Printing("no.such.module")
    for _ in range(2):
        found, (complaint,) = all_of(press, KEYS)
        assert found == []
        assert "No module named 'no'" in complaint


def test_a_lab_takes_its_parts_and_one_that_is_gone_takes_none(monkeypatch):
    asked = []
    monkeypatch.setattr(printing.Printing, "ask", lambda self, keys, *takers: asked.append((keys, takers)))
    lab = observer_lab()
    assert not asked
    lab.missed = True
    ((keys, (take, complain)),) = asked
    assert keys == lab.parts
    take(keys[0], {"w": "text"})
    complain("no process")
    assert getattr(lab, keys[0]) == {"w": "text"}
    assert lab.unprinted == "no process"
    lab.close()
    del lab
    take(keys[1], {"w": "text"})
