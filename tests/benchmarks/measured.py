"""The harness of all benchmarks: contenders in turns, the ratios of their times, and bars that are kept or not."""

import time

import numpy as np


def interleaved(rounds, contenders):
    """CPU seconds of each, shape (rounds,), every round running all of them in turn, so that load slows all alike."""
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


def exit_code(bars):
    """Say which bars, by what they claim, are kept; 1 if one is not."""
    for bar, kept in bars.items():
        print(f"{'kept' if kept else 'NOT KEPT':9} {bar}")
    return 0 if all(bars.values()) else 1
