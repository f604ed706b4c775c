"""What every lab shares: one bundle, errors that show, one lab a cell, formulas whose letters carry names."""

import gc
import hashlib
import shutil
import subprocess
import weakref

import pytest
import sympy as sp
from lab_settings import FRONT
from needs import missing

from percept_obs.labs.observer.lab import observer_lab
from percept_obs.labs.shared import lab as base
from percept_obs.labs.shared import markup


@pytest.fixture(scope="session")
def npm(node):
    """Run a script of the front end with npm, where its packages are installed."""
    npm = shutil.which("npm")
    if npm is None or not (FRONT / "node_modules").exists():
        missing("node", f"The front end's packages are missing: get npm, and run npm ci in {FRONT}.")
    return lambda *script: subprocess.run(
        [npm, "run", "--silent", *script], cwd=FRONT, capture_output=True, encoding="utf-8"
    )


@pytest.mark.node
@pytest.mark.slow
@pytest.mark.parametrize(("script", "name"), [("build", "lab.js"), ("build:exercises", "exercises.js")])
def test_a_bundle_is_the_build_of_the_sources(npm, tmp_path, script, name):
    npm(script, "--", f"--outfile={tmp_path / name}").check_returncode()
    built, committed = (hashlib.sha256((folder / name).read_bytes()).hexdigest() for folder in (tmp_path, FRONT))
    assert built == committed, f"run npm ci && npm run {script} in percept_obs/labs/front"


@pytest.mark.node
@pytest.mark.slow
@pytest.mark.parametrize("script", ["lint", "types", "test"])
def test_the_sources_pass_their_linter_their_types_and_their_own_tests(npm, script):
    answer = npm(script)
    assert answer.returncode == 0, answer.stdout + answer.stderr


def test_the_bundle_loads_nothing_from_a_network():
    assert "http" not in base.BUNDLE.read_text("utf-8").replace("http://www.w3.org/", "")


def test_a_name_is_shown_and_is_never_markup():
    bad = "<img src=x onerror=alert(1)>"
    shown = markup.markup(sp.Symbol(bad) + sp.MatrixSymbol(bad, 1, 1)[0, 0] + sp.Symbol(f"x_{bad}"))
    assert "<img" not in shown + markup.words(f"while {bad}")
    assert shown.count("&lt;img") == 3


def test_an_error_from_the_page_s_settings_shows_and_goes_with_the_next_good_ones():
    lab = observer_lab("ma2005_eq35")
    with pytest.raises(ValueError, match="whole number"):
        lab.set_state({"settings": {**lab.settings, "seed": -1}, "summary": {"serial": 1}})
    assert lab.error.startswith("BadSettings: seed is -1")
    lab.set_state({"settings": {**lab.settings, "seed": 1}, "summary": {"serial": 2}})
    assert lab.error == ""
    assert lab.analysis["serial"] == 2


def test_a_cell_that_runs_again_closes_its_lab_and_leaves_those_of_other_cells(monkeypatch):
    now = ["first cell", "run 1"]
    monkeypatch.setattr(base, "_running_cell", lambda: tuple(now))
    one, two = observer_lab("ma2005_eq35"), observer_lab("ma2005_eq35")
    now[:] = ["second cell", "run 2"]
    other = observer_lab("ma2005_eq35")
    assert all(lab.comm is not None for lab in (one, two, other))
    now[:] = ["first cell", "run 3"]
    again = observer_lab("ma2005_eq35")
    assert one.comm is None
    assert two.comm is None
    assert other.comm is not None
    assert again.comm is not None
    assert one.layout.comm is None
    kept = weakref.ref(one)
    del one
    gc.collect()
    assert kept() is None, "nothing holds a lab that was closed"


def test_a_cell_that_runs_again_leaves_its_lab_where_another_cell_shows_it(monkeypatch):
    now = ["first cell", "run 1"]
    monkeypatch.setattr(base, "_running_cell", lambda: tuple(now))
    lab = observer_lab("ma2005_eq35")
    lab._repr_mimebundle_()
    now[:] = ["second cell", "run 2"]
    lab._repr_mimebundle_()
    now[:] = ["first cell", "run 3"]
    again = observer_lab("ma2005_eq35")
    again._repr_mimebundle_()
    assert lab.comm is not None
    now[:] = ["first cell", "run 4"]
    observer_lab("ma2005_eq35")
    assert lab.comm is not None
    assert again.comm is None


def test_letters_carry_the_names_of_their_gains_and_longer_ones_come_first():
    alpha, alpha1 = sp.symbols("alpha alpha1", real=True)
    text = markup.markup(alpha * alpha1, {"weight": alpha, "growth": alpha1})
    assert text.count('data-letter="weight"') == text.count('data-letter="growth"') == 1
    assert '<mrow data-letter="growth"><msub>' in text


def test_hats_matrices_and_cases_become_markup_that_browsers_know():
    x = sp.Symbol("xhat1", real=True)
    assert '<mover accent="true"><mi>x</mi><mo>^</mo></mover>' in markup.markup(x)
    assert markup.markup(sp.Matrix([[x]])).count('<mtable class="matrix">') == 1
    assert "otherwise" in markup.markup(sp.Piecewise((x, x > 1), (0, True)))


def test_what_python_prints_while_it_answers_the_page_does_not_fill_the_log(capsys, monkeypatch):
    lab = observer_lab("ma2005_eq35")
    monkeypatch.setattr(type(lab), "analyse", lambda self: print("moving: 50 %") or {})
    lab.set_state({"settings": lab.settings, "summary": {"serial": 7}})
    assert lab.analysis["serial"] == 7
    assert capsys.readouterr() == ("", "")
