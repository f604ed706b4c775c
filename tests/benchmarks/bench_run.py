"""Cost of one run: derivation and loops, the loop beside C, `track` around it, and every observer's operations.

    python tests/benchmarks/bench_run.py [--rounds 101] [--part core c track operations]

(35), 80 s at 100 Hz.  Every round runs each contender once, so that a busy machine slows all alike; medians of CPU
time, and of the ratios of a round.  Exits with 1 if a bar is not kept.
"""

from __future__ import annotations

import argparse
import ast
import inspect
import os
import subprocess
import sys
import tempfile
import time
from unittest import mock

import numpy as np
import sympy as sp
from bench_ensemble import BOTH, FORM, SCENARIO, STEP, alone_on_a_core
from other_packages import Work, in_c
from scipy.integrate import solve_ivp

from percept_obs import ibo, record, track, with_point
from percept_obs.compile import Table, kernels, machine_code, solve, source, vector_functions
from percept_obs.observers import OBSERVERS
from percept_obs.tracking import following

DURATION = 80.0
RUNS = 1024


def interleaved(rounds, contenders):
    """CPU seconds of each, shape (rounds,), every round running all of them in turn."""
    found = {name: np.empty(rounds) for name in contenders}
    for k in range(rounds):
        for name, run in contenders.items():
            begin = time.process_time()
            run()
            found[name][k] = time.process_time() - begin
    return found


def ratio(found, above, below):
    """The median over the rounds of what one took to what another took."""
    return float(np.median(found[above] / found[below]))


DERIVATION = """
import time
from percept_obs import PerspectiveSystem, affine, pinhole
begin = time.perf_counter()
PerspectiveSystem(affine(), pinhole()).rate
print(time.perf_counter() - begin)
"""


def core(rounds):
    """Derivation in a fresh process, compiling, and the loop of point and observer beside scipy's RK45."""
    together, times = with_point(ibo(FORM)), STEP * np.arange(round(DURATION / STEP) + 1)
    derivation = float(subprocess.check_output([sys.executable, "-c", DERIVATION]))
    start = [*record(SCENARIO, 1).truth[0], 0.0, 0.0, 0.0]
    steps = len(times) - 1
    table = Table(np.diff(times), np.zeros((steps, 3, 0)), SCENARIO.motion.known(0.0), np.zeros((steps + 1, 0)))
    gains, flow = [gain.value for gain in together.gains], together.lambdify(SCENARIO.motion)
    contenders = {
        "scipy RK45": lambda: solve_ivp(flow, (0, DURATION), start, "RK45", times),
        "Python": lambda: solve(together.equations, start, table, gains, "python"),
        "numba": lambda: solve(together.equations, start, table, gains, "numba"),
    }
    with tempfile.TemporaryDirectory() as folder, mock.patch.dict(os.environ, NUMBA_CACHE_DIR=folder):
        kernels._compiled.cache_clear()  # so that the loop is compiled here
        machine_code.cache_clear()
        begin = time.perf_counter()
        contenders["numba"]()
        compiling = time.perf_counter() - begin
    found = interleaved(min(rounds, 15), contenders)
    for name, taken in found.items():
        print(f"  {name:10} {1e3 * np.median(taken):8.3f} ms")
    lines = source(together.equations).count("\n")
    print(f"  derived in {1e3 * derivation:.1f} ms, compiled in {compiling:.2f} s, {lines} lines")
    faster, slower = ratio(found, "scipy RK45", "numba"), ratio(found, "Python", "scipy RK45")
    return {
        "derivation under 0.3 s": derivation < 0.3,
        f"numba at least 30 times faster than RK45: {faster:.0f} times": faster >= 30,
        f"Python at most 2 times slower than RK45: {slower:.2f} times": slower <= 2,
    }


def loop_of(equations, start, table, gains):
    """The machine code alone, on arrays that are there already."""
    blocks = (start, table.steps, table.measured, table.parameters, table.samples, gains)
    inputs = [np.array(block, dtype=float).ravel() for block in blocks]
    count = len(table.steps) + 1
    states, resets = np.empty(count * len(equations.state)), np.zeros(count, dtype=bool)
    loop, varying = kernels._compiled(equations), len(table.parameters) > 1
    return lambda: loop(*inputs, varying, states, resets)


def beside_c(rounds):
    """The loop of point and observer together, and the call around it, beside the same expressions in C."""
    together, steps = with_point(ibo(FORM)), round(DURATION / STEP)
    start = np.array([*record(SCENARIO, 1).truth[0], 0.0, 0.0, 0.0])
    table = Table(np.full(steps, STEP), np.zeros((steps, 3, 0)), SCENARIO.motion.known(0.0), np.zeros((steps + 1, 0)))
    numbers = {gain.symbol: gain.value for gain in together.gains}
    (gain,) = (each.symbol for each in together.gains if each.name == "gain")
    values = SCENARIO.motion.values | {symbol: value for symbol, value in numbers.items() if symbol != gain}
    flow = tuple(e.subs(values) for e in together.equations.flow)
    runs = np.full(16, numbers[gain])
    work = Work(together.equations.state, gain, flow, start, runs, STEP * np.arange(steps + 1))
    with tempfile.TemporaryDirectory() as folder:
        in_machine_code, _ = in_c(work, folder, 1, len(runs))
        contenders = {
            "C": in_machine_code,
            "loop": loop_of(together.equations, start, table, [*numbers.values()]),
            "call": lambda: solve(together.equations, start, table, [*numbers.values()], "numba"),
        }
        ends = [contenders["C"]()[:, 0], contenders["call"]().states[-1]]
        found = interleaved(rounds, contenders)
    for name, times in found.items():
        print(f"  {name:6} {1e6 * np.median(times):8.0f} us")
    print(f"  they end {np.abs(ends[0] - ends[1]).max():.1e} apart")
    of_loop, of_call = ratio(found, "loop", "C"), ratio(found, "call", "C")
    print(f"  loop {of_loop:.2f} times C, call {of_call:.2f} times C")
    return {f"one run at most 1.0 times C: {of_call:.2f}": of_call <= 1}


def around_the_loop(rounds):
    """`track` beside its own loop, for every observer."""
    recording, ratios = record(SCENARIO, DURATION), {}
    for make in OBSERVERS:
        observer, handed = make(BOTH), []
        with mock.patch.object(following, "solve", lambda *given, kept=handed: kept.append(given) or solve(*given)):
            track(recording, observer, language="numba")
        ((equations, start, table, gains, _),) = handed
        found = interleaved(
            rounds,
            {
                "loop": loop_of(equations, start, table, gains),
                "track": lambda one=observer: track(recording, one, language="numba"),
            },
        )
        ratios[make.key] = ratio(found, "track", "loop")
        loop, whole = (1e6 * np.median(found[name]) for name in ("loop", "track"))
        print(f"  {observer.name:26} {loop:8.0f} us, track {whole:8.0f} us: {ratios[make.key]:.2f}")
    found = ratios["identifier_based"]
    return {f"track at most 1.3 times its loop, identifier-based: {found:.2f}": found <= 1.3}


def arithmetic(*functions):
    """How many operations and comparisons stand in the text of functions, without those of constants alone."""
    nodes = [node for each in functions for node in ast.walk(ast.parse(inspect.getsource(each)))]
    found = [node for node in nodes if isinstance(node, ast.BinOp | ast.Compare)]
    return sum(any(isinstance(inside, ast.Name) for inside in ast.walk(node)) for node in found)


def operations(rounds):
    """Many runs of 20 s side by side: what an operation of each observer's flow costs."""
    contenders, calls, counts = {}, {}, {}
    inside = arithmetic(vector_functions.tanh, vector_functions.parts)
    for make in OBSERVERS:
        one = make(BOTH)
        over = {one.gains[0].name: np.full(RUNS, one.gains[0].value)}
        contenders[make.key] = lambda one=one, over=over: alone_on_a_core(
            SCENARIO, one, over, duration=20, language="numba"
        )
        contenders[make.key]()
        shared, left = sp.cse([*one.equations.flow])
        flow = [*left, *(e for _, e in shared)]
        calls[make.key] = sum(e.count(sp.tanh) for e in flow)
        counts[make.key] = sp.count_ops(flow) + (inside - 1) * calls[make.key]
    found = interleaved(max(3, rounds // 20), contenders)
    each = {key: times / (RUNS * 2000 * 4 * counts[key]) for key, times in found.items()}
    ratios = {key: ratio(each, key, "identifier_based") for key in each}
    for key, times in found.items():
        cost, nanoseconds = 1e6 * np.median(times) / RUNS, 1e9 * np.median(each[key])
        as_one = ratios[key] * counts[key] / (counts[key] - (inside - 1) * calls[key])
        said = f"{counts[key]:4d} operations of {nanoseconds:.3f} ns: {ratios[key]:.2f}"
        print(f"  {key:26} {cost:6.1f} us, {said}" + f", {as_one:.2f} with tanh as one" * (calls[key] > 0))
    print(f"  a hyperbolic tangent counts as the {inside} operations of its text")
    slowest = max(ratios, key=lambda key: ratios[key])
    return {f"no observer above 3 times the IBO an operation: {slowest} {ratios[slowest]:.2f}": ratios[slowest] <= 3}


PARTS = {
    "core": ("Point and observer together, y1 alone", core),
    "c": ("One run of point and observer together, y1 alone", beside_c),
    "track": ("track, both outputs", around_the_loop),
    "operations": ("Operations, both outputs", operations),
}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=101)
    parser.add_argument("--part", nargs="+", choices=PARTS, default=[*PARTS])
    options = parser.parse_args()
    bars = {}
    for part in options.part:
        title, measure = PARTS[part]
        print(f"\n{title}")
        bars |= measure(options.rounds)
    for bar, kept in bars.items():
        print(f"{'kept' if kept else 'NOT KEPT':9} {bar}")
    return 0 if all(bars.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
