"""Cost of one run: derivation and loops, the loop beside C, and `track` around it.

    python tests/benchmarks/bench_run.py [--rounds 101] [--part core c track]

(35), 80 s at 100 Hz.  Every round runs each contender once, so that a busy machine slows all alike; medians of CPU
time, and of the ratios of a round.  Exits with 1 if a bar is not kept.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from unittest import mock

import numpy as np
from bench_ensemble import BOTH, FORM, SCENARIO, STEP
from measured import exit_code, interleaved, ratio
from other_packages import in_c, together_of
from scipy.integrate import solve_ivp

from percept_obs import ibo, record, track
from percept_obs.compile import kernels, machine_code, solve, source
from percept_obs.observers import OBSERVERS
from percept_obs.tracking import following

DURATION = 80.0


DERIVATION = """
import time
from percept_obs import PerspectiveSystem, affine, pinhole
begin = time.perf_counter()
PerspectiveSystem(affine(), pinhole()).rate
print(time.perf_counter() - begin)
"""


def core(rounds):
    """Derivation in a fresh process, compiling, and the loop of point and observer beside scipy's RK45."""
    together, work, table = together_of(SCENARIO, ibo(FORM), np.ones(1), DURATION, STEP)
    derivation = float(subprocess.check_output([sys.executable, "-c", DERIVATION]))
    gains, flow = [gain.value for gain in together.gains], together.lambdify(SCENARIO.motion)
    contenders = {
        "scipy RK45": lambda: solve_ivp(flow, (0, DURATION), work.start, "RK45", work.times),
        "Python": lambda: solve(together.equations, work.start, table, gains, "python"),
        "numba": lambda: solve(together.equations, work.start, table, gains, "numba"),
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
    observer = ibo(FORM)
    together, work, table = together_of(SCENARIO, observer, np.full(16, observer.gains[0].value), DURATION, STEP)
    numbers = [gain.value for gain in together.gains]
    with tempfile.TemporaryDirectory() as folder:
        in_machine_code, _ = in_c(work, folder, 1, len(work.gains))
        contenders = {
            "C": in_machine_code,
            "loop": loop_of(together.equations, work.start, table, numbers),
            "call": lambda: solve(together.equations, work.start, table, numbers, "numba"),
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


PARTS = {
    "core": ("Point and observer together, y1 alone", core),
    "c": ("One run of point and observer together, y1 alone", beside_c),
    "track": ("track, both outputs", around_the_loop),
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
    return exit_code(bars)


if __name__ == "__main__":
    sys.exit(main())
