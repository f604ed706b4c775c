"""Python, numba and JavaScript run the same loop, and what would differ between them is refused."""

import builtins
import os
import pickle
import subprocess
import sys
from dataclasses import fields
from functools import cache, partial
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from examples import BOTH, NOISY, ON_SPHERE, ONE, ZERO
from javascript import solve_in_node
from refusals import refuses
from scipy.integrate import solve_ivp

import percept_obs.tracking.following as tracking
from percept_obs import Camera, Uniform, ibo, record, scenarios, track
from percept_obs.compile import NotCompilable, Table, integrator, kernels, machine_code, solve, source, vector_functions
from percept_obs.compile.equations import Equations
from percept_obs.compile.integrator import EACH
from percept_obs.compile.machine_code import NotKept, is_kept
from percept_obs.compile.rows import by_row
from percept_obs.figures import look
from percept_obs.labs.printing import INTEGRATOR, LOOKS, MODELS, models
from percept_obs.observers import OBSERVERS, linear_approximation
from percept_obs.points import kernel as points_kernel

x, y, u, k, c = sp.symbols("x y u k c", real=True)
every_observer = pytest.mark.parametrize("make", OBSERVERS, ids=lambda make: make.key)


@cache
def observers_of(make):
    """One observer of each form that it fits; a short cascade has all that a long one has, and compiles sooner."""
    make_short = partial(make, iterates=2) if make is linear_approximation else make
    return [make_short(form) for form in (ONE, BOTH, ON_SPHERE.partition("y1")) if not make.refusal(form)]


def seen_by(observer, duration):
    return record(scenarios.ma2005_eq35(observer.form.view), duration, NOISY, seed=3)


def steps(count, length=0.1, measured=0, parameters=0):
    return Table(
        np.full(count, length),
        np.zeros((count, EACH + 1, measured)),
        np.zeros((1, parameters)),
        np.full((count + 1, measured), np.nan),
    )


def both_languages(equations, start, table, gains=()):
    return [solve(equations, start, table, gains, language) for language in ("python", "numba")]


@pytest.mark.slow
@every_observer
def test_python_and_numba_give_the_same_bits(make):
    for observer in observers_of(make):
        recording = seen_by(observer, 20)
        python, compiled = (track(recording, observer, ZERO, language=language) for language in ("python", "numba"))
        for name in ("state", "resets", "estimate", "unobservable"):
            np.testing.assert_array_equal(getattr(compiled, name), getattr(python, name), name)


@pytest.mark.slow
def test_rows_are_read_alike_in_numpy_and_in_machine_code_however_many_there_are():
    which = sp.Piecewise((1, x > u), (2, x > y), (0, True))
    expressions = (y, sp.tanh(k * u) / y, sp.exp(-k) + sp.sinh(x), u > y, which)
    python, compiled = (by_row(((x, u), (y,)), (k,), expressions, language) for language in ("python", "numba"))
    for count in (1, 5, 16, 37):
        table = np.random.default_rng(count).uniform(-1, 1, (count, 4))
        given = [table[:, 1:3], table[:, 3:]], np.array([0.7])
        np.testing.assert_allclose(compiled(*given), python(*given), rtol=1e-14, atol=1e-15)


def test_outputs_that_last_for_a_step_are_given_once():
    equations, rows = Equations((x,), (u - x,), (u,)), np.linspace(0, 1, 40)[:, None, None]
    each = Table(np.full(40, 0.1), np.repeat(rows, EACH + 1, axis=1), np.zeros((1, 0)), np.empty((0, 1)))
    once = Table(each.steps, rows, each.parameters, each.samples)
    there, here = (solve(equations, [1.0], table, (), "python").states for table in (each, once))
    assert there.tolist() == here.tolist()
    assert np.ptp(there) > 0.1


@pytest.mark.slow
@pytest.mark.node
@every_observer
def test_javascript_agrees(monkeypatch, node, make):
    """Over one step where the right-hand side switches."""
    duration, tolerance = (0.01, 1e-12) if make.key == "sliding_mode" else (30, 1e-9)
    handed = []
    monkeypatch.setattr(tracking, "solve", lambda *given: handed.append(given) or solve(*given))
    for observer in observers_of(make):
        track(seen_by(observer, duration), observer, ZERO, language="python")
        *given, _ = handed.pop()
        here, there = solve(*given, "python"), solve_in_node(node, *given)
        np.testing.assert_allclose(there.states, here.states, rtol=tolerance, atol=tolerance)
        assert there.diverged == here.diverged


@pytest.mark.slow
@pytest.mark.node
def test_resets_updates_and_functions_agree_in_javascript(node):
    flow = (sp.sin(x) * sp.exp(-(x**2)) + sp.tanh(u) + sp.sqrt(1 + x**2) - sp.sign(x) * sp.Abs(x) / 3 + sp.pi / x**3,)
    flow = (flow[0] + sp.asin(sp.tanh(x)) * sp.acos(sp.tanh(u)) / 9 + sp.atan(x) / 9,)
    condition = sp.And(x > 2, sp.Or(x < 9, k > 0))
    equations = Equations((x,), flow, (u,), (k,), (c,), ((x + c * (u - x),),), condition, (x / 2,))
    samples = np.full((41, 1), np.nan)
    samples[::7] = 1.5
    table = Table(np.full(40, 0.05), np.ones((40, EACH + 1, 1)), np.linspace(0, 1, 40 * EACH + 1)[:, None], samples)
    python, compiled = both_languages(equations, [1.0], table, [0.3])
    there = solve_in_node(node, equations, [1.0], table, [0.3])
    assert python.resets.any()
    for other in (compiled, there):
        np.testing.assert_allclose(other.states, python.states, rtol=1e-12)
        assert other.resets.tolist() == python.resets.tolist()


def test_the_loop_is_the_classical_runge_kutta_method():
    equations = Equations((x, y), (y, -x - k * y), (), (k,), ())
    table = steps(50, 0.02, parameters=1)
    varying = Table(table.steps, table.measured, np.linspace(0.1, 0.5, 50 * EACH + 1)[:, None], table.samples)
    trace = solve(equations, [1.0, 0.0], varying, (), "python")
    reference = solve_ivp(
        lambda t, s: [s[1], -s[0] - (0.1 + 0.4 * t) * s[1]], (0, 1), [1, 0], rtol=1e-12, atol=1e-13
    ).y[:, -1]
    np.testing.assert_allclose(trace.states[-1], reference, atol=1e-8)


@pytest.mark.parametrize("language", ["python", "numba"])
@pytest.mark.parametrize(("flow", "start"), [(x**2, 1.0), (1 / x, 0.0), (sp.exp(x * x), 1.0), (sp.sqrt(1 - x), 0.0)])
def test_a_run_that_diverges_says_when(language, flow, start):
    trace = solve(Equations((x,), (flow,)), [start], steps(100), (), language)
    assert trace.diverged is not None
    assert np.isfinite(trace.states[: trace.diverged]).all()
    assert np.isnan(trace.states[trace.diverged :]).all()


def test_numbers_compile_nothing(monkeypatch):
    recordings = [record(scenarios.ma2005_eq35(), 1, Camera(noise=Uniform(n)), seed=1) for n in (0.0, 0.02)]
    observer = ibo(ONE)
    track(recordings[0], observer, ZERO)
    before = kernels._python.cache_info().misses, source.cache_info().misses
    monkeypatch.setattr(builtins, "exec", None)
    other = scenarios.ma2005_eq36()
    for recording in (*recordings, record(other, 1)):
        for gain in (3, 20):
            track(recording, observer.with_gains(gain=gain, noise_variance=1e-4), ZERO, believed=other.motion)
    assert (kernels._python.cache_info().misses, source.cache_info().misses) == before


def test_the_call_alone_says_in_which_language_it_runs(monkeypatch):
    many = kernels.WORTH_COMPILING
    for steps, asked, expected in (
        (many - 1, None, "python"),
        (many, None, "numba"),
        (many, "python", "python"),
        (1, "numba", "numba"),
    ):
        assert kernels.choose(asked, steps) == expected
    assert points_kernel.choose(None, many / points_kernel.STATE_WORK) == "numba"
    assert points_kernel.choose(None, 1) == "python"
    monkeypatch.setattr(kernels, "find_spec", lambda name: None)
    assert kernels.choose(None, many) == "python"
    monkeypatch.setattr("percept_obs.validation.environment.find_spec", lambda name: None)
    with pytest.raises(ModuleNotFoundError, match=r"numba is missing; get it with: .*fast"):
        kernels.choose("numba", 1)


@pytest.mark.parametrize("compiled", ["nowhere", "here", "kept", "kept, but numba is not loaded"])
def test_a_short_run_takes_machine_code_that_is_there_already(monkeypatch, compiled):
    made, short, long = [], 10, kernels.WORTH_COMPILING
    equations = Equations((x,), (-k * x + sp.Rational(1, 7),), (), (k,))
    monkeypatch.setattr(kernels, "_ready", {equations: True} if compiled == "here" else {})
    monkeypatch.setattr(kernels, "is_kept", lambda text: compiled.startswith("kept"))
    monkeypatch.setitem(sys.modules, "numba", kernels)
    if compiled.endswith("not loaded"):
        monkeypatch.delitem(sys.modules, "numba")
    monkeypatch.setattr(kernels, "_compiled", lambda equations: lambda *given: made.append(len(given[1])) or -1)
    for count in (short, long):
        solve(equations, [1.0], steps(count, parameters=1))
    assert made == ([short, long] if compiled in ("here", "kept") else [long])


def test_what_is_kept_is_found(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path))  # which numba read when it was imported
    text = "def run(x):\n    return x / 9.0\n"
    assert not is_kept(text)
    machine_code(text, "(float64,)")
    assert is_kept(text)


LOOPS = """
from examples import BOTH
from percept_obs import ekf
from percept_obs.compile import kernels
compiled = kernels._compiled(ekf(BOTH).equations).stats.cache_misses
"""


@pytest.mark.slow
def test_another_process_compiles_nothing():
    """Whatever the order of sets in it, it prints the same text and finds its machine code."""
    exec(LOOPS, {})
    environment = os.environ | {"PYTHONHASHSEED": "1", "PYTHONPATH": os.pathsep.join(sys.path)}
    program = [sys.executable, "-c", f"{LOOPS}print(compiled)"]
    assert subprocess.check_output(program, env=environment, text=True) == "Counter()\n"


def test_functions_for_vector_instructions_are_those_of_the_library():
    sizes = np.geomspace(1e-12, 700, 400)
    for name in ("exp", "tanh"):
        own, library = getattr(vector_functions, name), getattr(np, name)
        np.testing.assert_allclose([own(x) for x in (*sizes, *-sizes)], library([*sizes, *-sizes]), rtol=1e-15)
        found = [own(np.float64(x)) for x in (0.0, np.inf, -np.inf, np.nan)]
        np.testing.assert_array_equal(found, library([0.0, np.inf, -np.inf, np.nan]))


def test_a_loop_is_kept_as_a_file_that_holds_its_text(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "new"))
    text = "def third(x):\n    return x / 3.0\n\n\ndef run(x):\n    return 1.0 + third(x)\n"
    assert machine_code(text, "(float64,)")(3.0) == 2.0
    (file,) = (tmp_path / "new").glob("*.py")
    assert file.read_text().endswith(text)


def full(*_, **__):
    raise OSError(28, "No space left on device")


@pytest.mark.parametrize("refusal", ["a file in the way", "a full disk", "a disk that fills later"])
def test_where_nothing_can_be_kept_the_loop_compiles_all_the_same_and_says_so_once(tmp_path, monkeypatch, refusal):
    place = tmp_path / "place"
    if refusal == "a file in the way":
        place.touch()
    elif refusal == "a full disk":
        monkeypatch.setattr(Path, "write_bytes", full)
    else:
        monkeypatch.setattr("numba.core.caching.IndexDataCacheFile._open_for_write", full)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(place / "new"))
    texts = [f"def run(x):\n    return x / {number}.0  # {refusal}\n" for number in (2, 3)]
    with pytest.warns(NotKept, match=r"compiled again the next time; .* free the disk") as told:
        halved, third = (machine_code(text, "(float64,)") for text in texts)
    assert (halved(6.0), third(6.0)) == (3.0, 2.0)
    assert len(told) == 1
    assert not [*tmp_path.rglob("*.py"), *tmp_path.rglob("*.nbi")]


@pytest.mark.parametrize("suffix", ["nbi", "nbc"])
def test_machine_code_that_was_cut_off_is_told_and_mended(tmp_path, monkeypatch, suffix):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path))  # which numba read when it was imported
    text = f"def run(x):\n    return x / 5.0  # {suffix}\n"
    machine_code.__wrapped__(text, "(float64,)")
    (kept,) = tmp_path.rglob(f"*.{suffix}")
    kept.write_bytes(kept.read_bytes()[:40])
    with pytest.warns(NotKept):
        assert machine_code.__wrapped__(text, "(float64,)")(5.0) == 1.0
    for misses in (1, 0):
        again = machine_code.__wrapped__(text, "(float64,)")
        assert (again(5.0), sum(again.stats.cache_misses.values())) == (1.0, misses)


@pytest.mark.parametrize(
    ("file", "printed"),
    [(INTEGRATOR, integrator.for_the_page), (LOOKS, look.for_the_page), (MODELS, models)],
)
def test_the_page_steps_by_the_same_method_and_draws_by_the_same_marks(file, printed):
    there = file.read_text(encoding="utf-8")
    assert there == printed(), "run python -m percept_obs.labs.printing and build the page"


def test_an_unknown_language_is_refused():
    with pytest.raises(ValueError, match="neither 'python' nor 'numba'"):
        solve(Equations((x,), (x,)), [1.0], steps(1), (), "fortran")
    with pytest.raises(ValueError, match="neither 'python' nor 'javascript'"):
        source(Equations((x,), (x,)), "fortran")


@pytest.mark.parametrize(
    "expression",
    [
        x ** sp.Rational(1, 3),
        x**k,
        x**9,
        sp.gamma(x),
        sp.Function("f")(x),
        sp.zoo,
        sp.nan,
        sp.floor(x),
        sp.Piecewise((1 / x, x > 0), (0, True)),
        sp.Piecewise((sp.log(x), x > 0), (0, True)),
        sp.Piecewise((x, x > 0)),
    ],
    ids=str,
)
def test_what_would_differ_between_languages_is_refused(expression):
    with pytest.raises(NotCompilable):
        source(Equations((x,), (expression,), (), (k,)))


def test_small_powers_are_products_in_both_languages():
    equations = Equations((x,), (y * x**3 / (c * k**2),), (y,), (k,), (c,))
    for language in ("python", "javascript"):
        text = source(equations, language)
        assert "(x0*x0*x0)" in text
        assert "**" not in text
        assert "pow" not in text


def test_names_that_are_words_of_a_language_do_not_matter():
    names = sp.symbols("lambda function h k", real=True)
    equations = Equations(names[:2], (names[1], -names[0] * names[2]), (), names[2:])
    trace = solve(
        equations, [1.0, 0.0], Table(np.full(9, 0.1), np.zeros((9, EACH + 1, 0)), np.ones((1, 2)), np.zeros((10, 0)))
    )
    np.testing.assert_allclose(trace.states[-1, 0], np.cos(0.9), atol=1e-5)


test_equations_that_do_not_close_are_refused = refuses(
    lambda arguments: Equations(*arguments),
    (((x,), (x, y)), "one expression for each"),
    (((x,), (y,)), "which nothing provides"),
    (((x, x), (x, x)), "listed twice"),
    (((x,), (x,), (), (sp.Symbol("x"),)), "listed twice"),
    (((x,), (x,), (u, y), (), (), ((x,),)), "1 updates were given for 2"),
)


def test_equations_take_no_hash_to_another_process():
    equations = Equations((x,), (-x,))
    hash(equations)
    copy = pickle.loads(pickle.dumps(equations))
    assert vars(copy).keys() == {field.name for field in fields(Equations)}
    assert copy == equations
    assert hash(copy) == hash(equations)


def test_equations_show_flow_update_and_reset():
    shown = Equations((x,), (-x,), (u,), (), (), ((u,),), x > 2, (sp.Integer(0),))._repr_latex_()
    assert r"\dot{x} &= - x" in shown
    assert r"x^+ &= u \quad \text{at a sample of } u" in shown
    assert r"x^+ &= 0 \quad \text{when } x > 2" in shown


@pytest.mark.parametrize(
    ("reset", "shown"),
    [((c * x, c * y), "c {0}"), (((1 + c) * x, (1 + c) * y), r"\left(c + 1\right) {0}"), ((y, 1), "{1}")],
)
def test_a_reset_that_scales_shows_its_factor_once_and_another_one_the_new_state(reset, shown):
    tex = Equations((x, y), (y, x), (), (), (c,), (), x > 2, tuple(map(sp.sympify, reset)))._repr_latex_()
    old, new = (rf"\left[\begin{{matrix}}{a}\end{{matrix}}\right]" for a in (r"x\\y", r"y\\1"))
    assert rf"{old}^+ &= {shown.format(old, new)} \quad \text{{when }} x > 2" in tex
