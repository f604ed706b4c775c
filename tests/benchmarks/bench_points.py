"""What many points cost: 60 s at 100 Hz with constant P, from 1 to 64 points of a rigid body, n = 3 p.

    python tests/benchmarks/bench_points.py

Prints each figure with the bound that it is to keep, and exits with 1 if one is not kept.  The cost of a step is
compared between numbers of points, so that it does not depend on the machine.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
import timeit

import numpy as np
from measured import exit_code

from percept_obs import linear, luenberger, record, track
from percept_obs.points import PointsForm, PointsScenario
from percept_obs.points.kernel import advance, arrays
from percept_obs.points.scenarios import moving_body

COUNTS = (1, 2, 4, 8, 16, 32, 64)
STEPS = 6000


def full(states):
    """A symmetric positive definite P without zeros."""
    return 2 * np.eye(states) + 0.5 / states


def loop(recording, observer):
    """The compiled loop alone, for all steps."""
    form = recording.view
    n = form.states
    known = form.numbers(np.linspace(0, 60, 2 * STEPS + 1))
    images = np.repeat(recording.outputs[:-1, None], 3, axis=1)
    tables = (np.full(STEPS, 0.01), known, np.linalg.inv(observer.P.at(0.0)), images)
    law = (False, 0.0, 0.0, np.zeros((n, n)))
    form_arrays = arrays(form, np.arange(n), np.arange(form.points))

    def run():
        return advance(form_arrays, law, np.zeros(n), np.eye(n), *tables, "numba")

    path, _, diverged = run()
    assert diverged is None
    assert np.linalg.norm(path[-1] - recording.truth[-1]) < np.linalg.norm(path[0] - recording.truth[0])
    return min(timeit.repeat(run, number=1, repeat=5))


def main() -> int:
    small = PointsScenario("one point", PointsForm(linear(np.zeros((3, 3)), np.ones(3)), np.eye(3)), [0, 0, 2], 1)
    begin = time.perf_counter()
    track(record(small), luenberger(small.form), language="numba")
    compiling = time.perf_counter() - begin
    print(f"the loop compiled with the first run in {compiling:.2f} s")
    print("points  states   first run   later runs   the loop alone, a step")
    first, later, alone = {}, {}, {}
    for points in COUNTS:
        recording = record(moving_body(points))
        observer = luenberger(recording.view, full(3 * points))

        def follow(recording=recording, observer=observer):
            return track(recording, observer, language="numba")

        first[points] = min(timeit.repeat(follow, number=1, repeat=1))
        later[points] = min(timeit.repeat(follow, number=1, repeat=3))
        alone[points] = loop(recording, observer) / STEPS
        print(
            f"{points:6d}  {3 * points:6d}   {first[points]:7.3f} s    {later[points]:7.3f} s   "
            f"{alone[points] * 1e6:10.1f} us"
        )
    bars = {f"64 points follow 60 s in under 2 s: {later[64]:.2f} s": later[64] < 2}
    for fewer, more in ((16, 32), (16, 64)):
        ratio, square = alone[more] / alone[fewer], (more / fewer) ** 2
        bars[f"a step of {more} points costs at most {square:.0f} times one of {fewer}: {ratio:.1f}"] = ratio <= square
    extra = first[64] - later[64]
    bars[f"64 points compile nothing of their own: {extra:.2f} s more in the first run"] = extra < compiling / 4
    return exit_code(bars)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as os.environ["NUMBA_CACHE_DIR"]:  # so that the loops are compiled here
        sys.exit(main())
