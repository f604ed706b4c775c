"""Texts for the page come from a process of their own, once for all labs, and a failure is told."""

from types import SimpleNamespace

import pytest

from percept_obs.labs.observer.lab import observer_lab
from percept_obs.labs.observer.texts import texts_of
from percept_obs.labs.shared import printing

STRUCTURES = "percept_obs.labs.observer.texts"
KEYS = ["pinhole y1+y2", "chained y2"]


def all_of(press, keys):
    """What printing hands over, in its order, and what it complains of."""
    found, complaints = [], []
    press.ask(keys, lambda key, texts: found.append((key, texts)), complaints.append)
    if press._thread is not None:
        press._thread.join(120)
    return found, complaints


@pytest.fixture
def nothing_kept(monkeypatch, tmp_path):
    """A cache of its own for this test and the processes that it starts."""
    for name in ("XDG_CACHE_HOME", "HOME", "LOCALAPPDATA"):
        monkeypatch.setenv(name, str(tmp_path))
    return printing.kept_in(STRUCTURES)


@pytest.mark.slow
def test_another_process_prints_what_this_one_would_and_keeps_it(nothing_kept):
    assert not nothing_kept.exists()
    found, complaints = all_of(printing.Printing(STRUCTURES), KEYS)
    assert complaints == []
    assert found == [(key, texts_of(key)) for key in KEYS]
    assert {file.name for file in nothing_kept.iterdir()} == {f"{key}.json" for key in KEYS}


def test_what_is_kept_is_not_printed_again(nothing_kept, capsys):
    nothing_kept.mkdir(parents=True)
    (nothing_kept / "a part.json").write_text('{"of": "a part"}')
    printing.main(STRUCTURES, "a part")
    assert capsys.readouterr().out == '["a part", {"of": "a part"}]\n'


def test_another_line_of_the_package_has_other_texts(nothing_kept, monkeypatch, tmp_path):
    monkeypatch.setattr(printing, "__file__", str(tmp_path / "labs" / "printing.py"))
    (tmp_path / "one.py").write_text("")
    before = printing.kept_in(STRUCTURES)
    (tmp_path / "one.py").write_text("changed = True")
    assert len({nothing_kept, before, printing.kept_in(STRUCTURES)}) == 3


@pytest.mark.parametrize("place", ["a file", "half"])
def test_where_nothing_whole_is_or_can_be_kept_it_is_printed_all_the_same(monkeypatch, capsys, tmp_path, place):
    (tmp_path / "a file").write_text("")
    (tmp_path / "half").mkdir()
    (tmp_path / "half" / "a part.json").write_text('{"of": ')
    monkeypatch.setattr(printing, "kept_in", lambda module: tmp_path / place)
    monkeypatch.setattr(printing, "import_module", lambda module: SimpleNamespace(texts_of=lambda key: {"of": key}))
    printing.main(STRUCTURES, "a part")
    assert capsys.readouterr().out == '["a part", {"of": "a part"}]\n'


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
