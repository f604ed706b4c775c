"""Many runs of (35), y1 alone, without noise: an ensemble beside C, numpy, one run a thread, scipy and others.

    python tests/benchmarks/bench_ensemble.py [--runs 1024] [--duration 80] [--rounds 5] [--page FILE]

Every round runs each of them once on the same work, so that a busy machine slows all alike; the table has medians of
CPU seconds and their ratios to the ensemble's, and may be written as a page of the site.  What is not installed is left
out and named.  Exits with 1 if a bar is not kept.
"""

from __future__ import annotations

import argparse
import resource
import sys
import tempfile
import time
from datetime import date
from pathlib import Path
from unittest import mock

import numpy as np
from measured import exit_code, interleaved
from other_packages import BATCH, contenders, together_of

from percept_obs import Camera, PerspectiveSystem, Uniform, affine, ensemble, ibo, pinhole, record, scenarios, track
from percept_obs.compile import solve
from percept_obs.studies import ensemble as module

SCENARIO = scenarios.ma2005_eq35()
FORM = PerspectiveSystem(affine(), pinhole()).measure("y1")
BOTH = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
STEP = 0.01

PAGE = """# How fast is an ensemble?

The same {runs:,} runs in this package and in others: Ma's example (35), {duration:g} s at 100 Hz, y1 alone, no noise,
the identifier-based observer with gains from 1 to 30. Medians of CPU seconds, in rounds in which all took turns;
look at the ratios, which depend less on the machine.

{table}

Measured on {date}; not installed then: {missing}.

The ensemble also makes the samples of the camera, holds each one until the next, and counts errors, resets and settling
times. All others integrate point and observer as one system and stop at the last state; the last column shows how far
their estimates agree. C is sympy's print of the same expressions, by `gcc -O3 -march=native -ffast-math -fopenmp-simd`.
C, numpy and numba take the classical Runge-Kutta method with the step of the camera, diffrax takes a method of order 5
with the same step, and the others choose their steps for a relative error of 1e-8. scipy made one
run, heyoka as many as a vector holds; their times are multiplied.

To repeat it, install what is to be compared, and write this page anew:

    pip install heyoka diffrax
    python tests/benchmarks/bench_ensemble.py --page percept_obs/site/texts/speed.md
"""


def alone_on_a_core(*arguments, **settings):
    """An ensemble on one thread, as all others: two threads of one core count more CPU seconds for the same work."""
    with mock.patch.object(module, "workers", return_value=1):
        return ensemble(*arguments, **settings)


def by_the_number(runs):
    """CPU us a run of so many of 20 s, over gains, noise and seeds, on all cores; prints it with the memory."""
    over = {"gain": np.linspace(1, 30, runs // 100), "noise": np.linspace(0, 0.02, 10)}
    begin = time.process_time()
    ensemble(SCENARIO, ibo(BOTH), over, 10, 20, Camera(STEP, Uniform(0.01)), language="numba")
    cost = 1e6 * (time.process_time() - begin) / runs
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**10
    print(f"{runs:8d} runs of 20 s with noise: {cost:6.1f} CPU us a run, at most {memory:.0f} MiB so far")
    return cost


def table_of(whole, final, runs):
    """Rows of Markdown, the fastest first: what, CPU seconds, runs a second, times the ensemble, final estimate."""
    yield "| what | CPU s | runs a CPU s | times the ensemble | estimate at the end |"
    yield "|---|--:|--:|--:|--:|"
    for name, seconds in sorted(whole.items(), key=lambda item: item[1]):
        ratio = seconds / whole["ensemble"]
        yield f"| {name} | {seconds:.3f} | {runs / seconds:,.0f} | {ratio:.2f} | {final.get(name, '')} |"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=1024)
    parser.add_argument("--duration", type=float, default=80.0)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--page", type=Path, help="write the table as a page of the site")
    options = parser.parse_args()
    per_run = [by_the_number(count) for count in (10**3, 10**3, 10**4, 10**5)]
    runs, observer = options.runs // BATCH * BATCH, ibo(FORM)
    gains = np.array([observer.gain_values[observer.gains[0].symbol], *np.linspace(1.0, 30.0, runs - 1)])
    together, work, table = together_of(SCENARIO, observer, gains, options.duration, STEP)

    def one_after_the_other():
        numbers = {each.symbol: each.value for each in together.gains}
        for k in reversed(range(0, runs, 16)):
            trace = solve(together.equations, work.start, table, [*(numbers | {work.gain: gains[k]}).values()], "numba")
        return trace.states[-1:].T

    def many():
        return alone_on_a_core(SCENARIO, observer, {"gain": gains}, duration=options.duration, language="numba")

    with tempfile.TemporaryDirectory() as folder:
        others, missing = contenders(work, folder)
        every = {"ensemble": (many, 1), "one run after the other in numba": (one_after_the_other, 16)} | others
        found, *ends = [run() for run, _ in every.values()]  # compiled, for the time does not count
        took = interleaved(options.rounds, {name: run for name, (run, _) in every.items()})
    whole = {name: float(np.median(seconds)) * every[name][1] for name, seconds in took.items()}
    final = {name: f"{end[5, 0]:.10f}" for name, end in zip([*every][1:], ends, strict=True)}
    final.pop("vectorised numpy")  # it did not come to the end
    lines = [*table_of(whole, final, runs)]
    print(f"{runs} runs of {options.duration:g} s at 100 Hz, {options.rounds} rounds; CPU seconds, medians")
    print("\n".join(lines))
    print("not installed, left out:", ", ".join(missing) or "none")
    if options.page:
        options.page.write_text(PAGE.format(runs=runs, duration=options.duration, table="\n".join(lines),
                                            date=date.today(), missing=", ".join(missing) or "none"))  # fmt: skip

    recording = record(SCENARIO, 20)
    error = abs(track(recording, observer.with_gains(gain=gains[1])).error[-1, 2])
    other = ensemble(SCENARIO, observer, {"gain": gains[1:2]}, duration=20, language="numba").final.item()
    print(f"the final error of a run: {other:.15g}, track's: {error:.15g}")

    bars = {
        f"cost a run the same from 10^4 runs on: {max(per_run[2:]) / min(per_run[2:]):.2f}": per_run[-1]
        <= 1.2 * per_run[2]
    }
    own = whole["ensemble"]
    bars[f"20 times vectorised numpy: {whole['vectorised numpy'] / own:.1f}"] = whole["vectorised numpy"] >= 20 * own
    alone = whole["one run after the other in numba"]
    bars[f"5 times one run a thread: {alone / own:.1f}"] = alone >= 5 * own
    if "C, OpenMP SIMD" in whole:
        c = whole["C, OpenMP SIMD"]
        bars[f"at most 1.3 times C with OpenMP SIMD: {own / c:.2f}"] = own <= 1.3 * c
        bars[f"one run at most 1.0 times C: {alone / whole['C, one lane']:.2f}"] = alone <= whole["C, one lane"]
    assert np.isfinite(found.final).all()
    return exit_code(bars)


if __name__ == "__main__":
    sys.exit(main())
