"""What the observers achieve on Ma's example (35), by the figures that they are to keep.

    python tests/benchmarks/bench_observers.py [--seeds 50]

Prints settling times without noise, errors with noise, y1 alone, and what a sign costs; exits with 1 if a bar is not
kept.
"""

from __future__ import annotations

import argparse
import sys

from percept_obs import Camera, PerspectiveSystem, Uniform, affine, pinhole, record, scenarios, track
from percept_obs.observers import (
    OBSERVERS,
    de_luca,
    extended_kalman,
    identifier_based,
    immersion_and_invariance,
    linear_approximation,
    range_identification,
    sliding_mode,
    spica,
)
from percept_obs.studies.chatter import METHODS, chatter, effort
from percept_obs.studies.comparison import compare, described, summary

EQ35 = scenarios.ma2005_eq35()
SYSTEM = PerspectiveSystem(affine(), pinhole())
BOTH, ONE = SYSTEM.measure("y1", "y2"), SYSTEM.measure("y1")
ZERO = (0.0, 0.0, 0.0)
SETTLES = {
    identifier_based: 2.0,
    sliding_mode: 2.5,
    immersion_and_invariance: 2.5,
    de_luca: 4.5,
    spica: 3.0,
    range_identification: 2.0,
    linear_approximation: 3.0,
}
ACCURATE = (identifier_based, sliding_mode, de_luca, extended_kalman)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=50)
    seeds = range(parser.parse_args().seeds)
    bars = {}

    clean = record(EQ35)
    print("Both outputs, no noise, exact signal, zero start: |e3| stays below 0.05 from")
    for make in OBSERVERS:
        time = track(clean, make(BOTH), ZERO, "exact").settling_time(0.05, "y3")
        print(f"  {make(BOTH).name:26} {time:5.2f} s")
        if make in SETTLES:
            bars[f"{make(BOTH).name} within {SETTLES[make]} s"] = time <= SETTLES[make]

    noisy = [record(EQ35, camera=Camera(noise=Uniform(0.01)), seed=seed) for seed in seeds]
    both = summary(compare(noisy, [make(BOTH) for make in OBSERVERS], ZERO, after=20))
    print(f"\nBoth outputs, uniform noise of +-0.01, held, {len(seeds)} seeds; errors from 20 to 80 s")
    print(described(both))
    bars |= {
        f"{make(BOTH).name}: rms at most 0.005": both.loc[make(BOTH).name, "rms_high"] <= 0.005 for make in ACCURATE
    }

    alone = [make(ONE) for make in OBSERVERS if make is not range_identification and not make.refusal(ONE)]
    print("\ny1 alone, the same noise; range identification needs both outputs")
    print(described(summary(compare(noisy, alone, ZERO, after=20))))

    print("\nWhat the sign costs: rms e3 over 5 to 10 s with the exact signal, at steps of 10, 1 and 0.1 ms")
    switches = {
        "range identification, gamma 20, sign": range_identification(BOTH, switch="sign", switching_gain=20),
        "range identification, gamma 20, hyperbolic tangent (default)": range_identification(BOTH),
        "sliding mode, sign": sliding_mode(BOTH, switch="sign"),
        "sliding mode, fraction (default)": sliding_mode(BOTH),
    }
    for name, observer in switches.items():
        found = chatter(record(EQ35, 10), observer, [1e-2, 1e-3, 1e-4], ZERO, 5)["y3"]
        print(f"  {name:62} " + ", ".join(f"{error:.2g}" for error in found))
    print("\nAdaptive solvers on 5 s, tolerance 1e-6, at most 20000 evaluations")
    for name, observer in switches.items():
        for method in METHODS:
            one = effort(EQ35, observer, 5, method, dict(zip(("y1", "y2", "y3"), ZERO, strict=True)))
            end = "arrived" if one.finished else f"gave up at {one.time[-1]:.2f} s"
            told = f"{one.evaluations[-1]:6d} evaluations, least step {one.steps.min():.1g} s, {end}"
            print(f"  {name:62} {method:6} {told}")

    print()
    for bar, kept in bars.items():
        print(f"{'kept' if kept else 'NOT KEPT':9} {bar}")
    return 0 if all(bars.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
