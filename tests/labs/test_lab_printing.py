"""The printed files of the page are shipped, current and whole, and a lab opens with them at once."""

import subprocess
import threading
from itertools import islice

import numpy as np
import pytest
from lab_settings import whole_model
from sample_sizes import sampled

from percept_obs.labs import derivation_desk, observer_lab, points_lab, printing, structure_lab
from percept_obs.labs.shared.printed import file_of, packed, part, unpacked

MAKERS = {
    "observer_lab": observer_lab,
    "structure_lab": structure_lab,
    "points_lab": points_lab,
    "desk_lab": derivation_desk,
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", printing.LABS)
def test_what_is_shipped_is_what_the_package_prints(kind, monkeypatch):
    """The model and one of its forms; all with ALL_SAMPLES=1."""
    made = dict(islice(printing.LABS[kind](), sampled(2, None)))
    monkeypatch.setattr(printing, "LABS", {kind: made.items})
    changed = set(printing.changed(kind))
    assert not sampled(changed & made.keys(), changed), "run python -m percept_obs.labs.printing"


def test_a_file_that_differs_is_told_by_its_places_and_written_anew(monkeypatch, tmp_path, capsys):
    texts = {"": {"plant": "x"}, "forms/one": {"w": "y"}, "forms/two": {"w": "z"}}
    monkeypatch.setattr(printing, "LABS", {"a lab": texts.items})
    monkeypatch.setattr(printing, "file_of", lambda kind: tmp_path / kind)
    assert printing.changed("a lab") == list(texts)
    printing.main()
    assert "a lab" in capsys.readouterr().out
    assert printing.changed("a lab") == []
    texts["forms/one"]["w"] = "changed"
    del texts["forms/two"]
    assert printing.changed("a lab") == ["forms/one", "forms/two"]


def test_the_same_texts_are_the_same_bytes_and_come_back():
    texts = {"": {"plant": "function ẋ() {\n}\t", "same": ["{\n}\t"]}, "forms/one": {"w": [1, None]}}
    assert packed(texts.items()) == packed(texts.items())
    assert unpacked(packed(texts.items())) == texts
    with pytest.raises(ValueError, match="JSON"):
        packed([("", {"bound": np.inf})])


@pytest.mark.parametrize("kind", MAKERS)
def test_a_lab_is_whole_when_it_opens_without_threads_processes_or_printing(kind, monkeypatch):
    for owner, name in ((threading.Thread, "start"), (subprocess, "Popen")):
        monkeypatch.setattr(owner, name, lambda *_, **__: pytest.fail("something runs beside"))
    for name in ("function_source", "source"):
        monkeypatch.setattr(f"percept_obs.labs.shared.observer_texts.{name}", lambda *_: pytest.fail("printed again"))
    lab = MAKERS[kind]()
    assert lab.texts == file_of(kind).read_bytes()
    assert set(part(kind)) <= set(whole_model(lab))
    assert set(lab.model).isdisjoint(part(kind))


def test_all_texts_together_are_small():
    assert sum(file_of(kind).stat().st_size for kind in MAKERS) < 250_000
