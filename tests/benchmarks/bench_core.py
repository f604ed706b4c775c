"""What the core costs: derivation, and 80 s of (35) at 100 Hz with y1 alone, point and observer together.

    python tests/benchmarks/bench_core.py

Prints each figure with the bound that it is to keep, and exits with 1 if one is not kept.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time

import numpy as np
from scipy.integrate import solve_ivp

from percept_obs import PerspectiveSystem, affine, ibo, pinhole, record, scenarios, with_point
from percept_obs.compile import Table, solve, source

DERIVATION = """
import time
from percept_obs import PerspectiveSystem, affine, pinhole
begin = time.perf_counter()
PerspectiveSystem(affine(), pinhole()).rate
print(time.perf_counter() - begin)
"""


def best_of(function, repeats):
    """Least time of several calls, in seconds."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        function()
        times.append(time.perf_counter() - begin)
    return min(times)


def main() -> int:
    derivation = float(subprocess.run([sys.executable, "-c", DERIVATION], capture_output=True, check=True).stdout)
    scenario = scenarios.ma2005_eq35()
    together = with_point(ibo(PerspectiveSystem(affine(), pinhole()).measure("y1")))
    start = [*record(scenario, 1).truth[0], 0.0, 0.0, 0.0]
    times = 0.01 * np.arange(8001)
    table = Table(np.diff(times), np.zeros((8000, 3, 0)), scenario.motion.known(0.0), np.zeros((8001, 0)))
    gains = [gain.value for gain in together.gains]
    right_hand_side = together.lambdify(scenario.motion)

    begin = time.perf_counter()
    solve(together.equations, start, table, gains, "numba")
    compiling = time.perf_counter() - begin
    scipy = best_of(lambda: solve_ivp(right_hand_side, (0, 80), start, "RK45", times), 15)
    python = best_of(lambda: solve(together.equations, start, table, gains, "python"), 15)
    numba = best_of(lambda: solve(together.equations, start, table, gains, "numba"), 50)

    print(f"pinhole, symbolic A and b, derived in a fresh process   {derivation * 1e3:8.1f} ms")
    print(f"scipy RK45 on the lambdified right-hand side            {scipy * 1e3:8.2f} ms")
    print(f"Python kernel                                           {python * 1e3:8.2f} ms")
    print(
        f"numba kernel                                            {numba * 1e3:8.3f} ms (compiled in {compiling:.2f} s)"
    )
    print(f"lines of the kernel's text                              {source(together.equations).count(chr(10)):8d}")
    bars = {
        "derivation under 0.3 s": derivation < 0.3,
        f"numba at least 30 times faster than RK45: {scipy / numba:.0f} times": scipy / numba >= 30,
        f"Python at most 2 times slower than RK45: {python / scipy:.2f} times": python / scipy <= 2,
    }
    for bar, kept in bars.items():
        print(f"{'kept' if kept else 'NOT KEPT':9} {bar}")
    return 0 if all(bars.values()) else 1


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as os.environ["NUMBA_CACHE_DIR"]:  # so that the loops are compiled here
        sys.exit(main())
