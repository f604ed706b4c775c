"""Many runs of (35), y1 alone, without noise: an ensemble beside C, numpy, one run a thread, scipy and others.

    python tests/benchmarks/bench_ensemble.py [--runs 1024] [--duration 80] [--rounds 5]

Every round runs each of them once on the same work, so that a busy machine slows all alike; the table has medians of
CPU seconds on one thread and their ratios to the ensemble.  What is not installed is left out and named.  Exits with
1 if a bar is not kept.  The C code is sympy's print of the same flow, by gcc -O3 -march=native -ffast-math
-fopenmp-simd, with the point's motion in the state, as for scipy; the ensemble also makes samples and counts.
"""

from __future__ import annotations

import argparse
import ctypes
import importlib.util
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from unittest import mock

import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp

from percept_obs import PerspectiveSystem, affine, ensemble, ibo, pinhole, record, scenarios, track, with_point
from percept_obs.compile import Table, solve
from percept_obs.observers import OBSERVERS
from percept_obs.studies import filling

SCENARIO = scenarios.ma2005_eq35()
FORM = PerspectiveSystem(affine(), pinhole()).measure("y1")
BOTH = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
STEP = 0.01
LANES = 16


def flow_in_c(together, gains):
    """The flow's lines in C, of x0 ... with the numbers of motion and gains put in."""
    equations = together.equations
    numbers = dict(SCENARIO.motion.values) | {s: v for s, v in gains.items() if s.name != "G"}
    names = {s: sp.Symbol(f"x{k}") for k, s in enumerate(equations.state)}
    names |= {s: sp.Symbol("gain") for s in gains if s not in numbers}
    shared, rates = sp.cse([e.subs(numbers).xreplace(names) for e in equations.flow])
    lines = [f"double {symbol} = {sp.ccode(e)};" for symbol, e in shared]
    return lines, [sp.ccode(e) for e in rates]


def c_program(together, gains, lanes):
    """Text of the classical Runge-Kutta method for so many lanes at once."""
    lines, rates = flow_in_c(together, gains)
    n = len(rates)
    per_lane = [f"double x{k} = s[{k}][i] + c*h*d[{k}][i];" for k in range(n)]
    inner = [*per_lane, "double gain = gains[i];", *lines]
    inner += [f"double r{k} = {rate};" for k, rate in enumerate(rates)]
    inner += [f"d[{k}][i] = r{k}; q[{k}][i] += w*r{k};" for k in range(n)]
    stage = "\n".join(inner)
    return f"""
#include <math.h>
void run(double *start, double *gains, long runs, long steps, double h, double *end) {{
  for (long b = 0; b < runs; b += {lanes}, gains += {lanes}) {{
    double s[{n}][{lanes}], d[{n}][{lanes}], q[{n}][{lanes}];
    static const double cs[4] = {{0, 0.5, 0.5, 1}}, ws[4] = {{1.0/6, 1.0/3, 1.0/3, 1.0/6}};
    for (int k = 0; k < {n}; k++) for (int i = 0; i < {lanes}; i++) s[k][i] = start[k];
    for (long t = 0; t < steps; t++) {{
      for (int k = 0; k < {n}; k++) for (int i = 0; i < {lanes}; i++) d[k][i] = q[k][i] = 0;
      for (int j = 0; j < 4; j++) {{
        double c = cs[j], w = ws[j];
        #pragma omp simd
        for (int i = 0; i < {lanes}; i++) {{ {stage} }}
      }}
      for (int k = 0; k < {n}; k++) for (int i = 0; i < {lanes}; i++) s[k][i] += h*q[k][i];
    }}
    for (int k = 0; k < {n}; k++) for (int i = 0; i < {lanes}; i++) end[(b + i)*{n} + k] = s[k][i];
  }}
}}
"""


def compiled_c(text, folder, name):
    """The program as a function of numpy arrays."""
    source, library = folder / f"{name}.c", folder / f"{name}.so"
    source.write_text(text)
    flags = ["-O3", "-march=native", "-ffast-math", "-fopenmp-simd", "-shared", "-fPIC"]
    subprocess.run(["gcc", *flags, str(source), "-o", str(library), "-lm"], check=True)
    return ctypes.CDLL(str(library)).run


def alone_on_a_core(*arguments, **settings):
    """An ensemble on one thread, as all others: two threads of one core count more CPU seconds for the same work."""
    with mock.patch.object(filling.os, "cpu_count", return_value=1):
        return ensemble(*arguments, **settings)


def timed(rounds, contenders):
    """Median CPU seconds of each, every round running all of them in turn."""
    found = {name: [] for name in contenders}
    for _ in range(rounds):
        for name, run in contenders.items():
            begin = time.process_time()
            run()
            found[name].append(time.process_time() - begin)
    return {name: float(np.median(times)) for name, times in found.items()}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=1024)
    parser.add_argument("--duration", type=float, default=80.0)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    runs, steps = options.runs // LANES * LANES, round(options.duration / STEP)
    observer = ibo(FORM)
    together = with_point(observer)
    gains = np.linspace(1.0, 30.0, runs)
    start = np.array([*record(SCENARIO, 1).truth[0], 0.0, 0.0, 0.0])
    letters = {gain.symbol: gain.value for gain in together.gains}
    numbers = np.array([gain.value for gain in together.gains])
    which = [gain.name for gain in together.gains].index("gain")
    times = STEP * np.arange(steps + 1)
    table = Table(np.diff(times), np.zeros((steps, 3, 0)), SCENARIO.motion.known(0.0), np.zeros((steps + 1, 0)))
    right = together.lambdify(SCENARIO.motion)
    flow = sp.lambdify(
        [together.equations.state, next(s for s in letters if s.name == "G")],
        [e.subs({**SCENARIO.motion.values, **{s: v for s, v in letters.items() if s.name != "G"}}) for e in
         together.equations.flow],
        "numpy",
        cse=True,
    )  # fmt: skip

    def by_numpy():
        state = np.repeat(start[:, None], runs, axis=1)
        for _ in range(steps // 20):  # a twentieth of the work, for it takes so long
            a = np.array(flow(state, gains))
            b = np.array(flow(state + STEP / 2 * a, gains))
            c = np.array(flow(state + STEP / 2 * b, gains))
            d = np.array(flow(state + STEP * c, gains))
            state = state + STEP / 6 * (a + 2 * b + 2 * c + d)

    def one_after_the_other():
        for k in range(0, runs, 16):  # a sixteenth
            solve(
                together.equations, start, table, np.where(np.arange(len(numbers)) == which, gains[k], numbers), "numba"
            )

    def many():
        return alone_on_a_core(SCENARIO, observer, {"gain": gains}, duration=options.duration, language="numba")

    share = {"vectorised numpy": 20, "one run after the other in numba": 16, "scipy RK45": runs, "C, one lane": 16}
    contenders = {
        "ensemble": many,
        "vectorised numpy": by_numpy,
        "one run after the other in numba": one_after_the_other,
        "scipy RK45": lambda: solve_ivp(right, (0, options.duration), start, "RK45", times),
    }
    with tempfile.TemporaryDirectory() as place:
        if shutil.which("gcc"):
            pointer = ctypes.POINTER(ctypes.c_double)
            for name, lanes, number in (("C, OpenMP SIMD", LANES, runs), ("C, one lane", 1, runs // 16)):
                call = compiled_c(c_program(together, letters, lanes), Path(place), f"lanes{lanes}")
                ends = np.empty((number, len(start)))
                call.argtypes = [pointer, pointer, ctypes.c_long, ctypes.c_long, ctypes.c_double, pointer]
                arguments = (start.ctypes.data_as(pointer), gains.ctypes.data_as(pointer), number, steps, STEP)
                contenders[name] = lambda c=call, a=arguments, e=ends: c(*a, e.ctypes.data_as(pointer))
        found = many()
        by_numpy()
        one_after_the_other()
        took = timed(options.rounds, contenders)
    whole = {name: seconds * share.get(name, 1) for name, seconds in took.items()}
    print(f"{runs} runs of {options.duration:g} s at 100 Hz, {options.rounds} rounds; CPU seconds, medians")
    for name, seconds in sorted(whole.items(), key=lambda item: item[1]):
        print(f"  {name:34} {seconds:9.3f} s  {runs / seconds:9.0f} runs/s  {seconds / whole['ensemble']:8.2f} of it")
    wanted = ("control", "jitcode", "heyoka", "diffrax")
    print("not installed, left out:", ", ".join(m for m in wanted if not importlib.util.find_spec(m)) or "none")

    recording = record(SCENARIO, 20)
    error = abs(track(recording, observer.with_gains(gain=gains[0])).error[-1, 2])
    other = ensemble(SCENARIO, observer, {"gain": gains[:1]}, duration=20, language="numba").final.item()
    print(f"the first run's final error: {other:.15g}, track's: {error:.15g}")

    print("\nEvery observer, both outputs, 2,048 runs of 20 s: CPU us a run, ns an operation of its flow")
    costs = {}
    for make in OBSERVERS:
        one = make(BOTH)
        name = one.gains[0].name
        over = {name: np.full(2048, one.gains[0].value)}

        def each(one=one, over=over):
            return alone_on_a_core(SCENARIO, one, over, duration=20, language="numba")

        each()
        seconds = timed(options.rounds, {"it": each})["it"] / 2048
        work = sp.count_ops(sp.cse([*one.equations.flow])[1]) + sum(
            sp.count_ops(e) for _, e in sp.cse([*one.equations.flow])[0]
        )
        costs[make.key] = seconds / (2000 * 4 * work)
        print(f"  {one.name:26} {1e6 * seconds:8.1f} us  {work:5d} operations  {1e9 * costs[make.key]:.3f} ns")
    bars = {}
    own = whole["ensemble"]
    bars[f"20 times vectorised numpy: {whole['vectorised numpy'] / own:.1f}"] = whole["vectorised numpy"] >= 20 * own
    alone = whole["one run after the other in numba"]
    bars[f"5 times one run a thread: {alone / own:.1f}"] = alone >= 5 * own
    if "C, OpenMP SIMD" in whole:
        c = whole["C, OpenMP SIMD"]
        bars[f"at most 1.3 times C with OpenMP SIMD: {own / c:.2f}"] = own <= 1.3 * c
        bars[f"one run at most 1.0 times C: {alone / whole['C, one lane']:.2f}"] = alone <= whole["C, one lane"]
    slowest = max(costs, key=lambda key: costs[key])
    ratio = costs[slowest] / costs["identifier_based"]
    bars[f"no observer above 3 times the IBO an operation: {slowest} {ratio:.2f}"] = ratio <= 3
    assert np.isfinite(found.final).all()
    for bar, kept in bars.items():
        print(f"{'kept' if kept else 'NOT KEPT':9} {bar}")
    return 0 if all(bars.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
