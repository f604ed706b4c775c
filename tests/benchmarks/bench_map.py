"""Time to the first map over two settings, and maps a second while a hand drags beside it.

    python tests/benchmarks/bench_map.py [rounds]

The first map is counted from the choice that asks for it to the moment in which a picture of it has been handed to the
screen, in a page that is opened anew each time: once its topic is open, as it is where a hand chooses, and where
nothing of the lab was touched before.  Beside it stands for how long the page's main thread computed until then, which
depends less on what else the machine does.
"""

import statistics
import sys
from typing import Any

from bench_lab import SECONDS, drag, launched, open_alone, rested, spent

from percept_obs.labs import observer_lab

FIRST = """() => new Promise((resolve) => {
    const [lab] = window.perceptObsLabs;
    const map = lab.planes.find(({ sweep }) => sweep);
    const began = performance.now();
    const draw = map.draw.bind(map);
    map.draw = (...given) => {
        const drawn = draw(...given);
        if (map.sweep.present) {
            delete map.draw;
            requestAnimationFrame(() => {
                const { port1, port2 } = new MessageChannel();
                const [{ cells }] = map.sweep.found.levels;
                port1.onmessage = () => resolve({ took: performance.now() - began, cells });
                port2.postMessage(0);
            });
        }
        return drawn;
    };
    lab.change({ over: { ...lab.settings.over, shows: "settling" } }, true);
})"""

COUNT = """() => {
    const { sweep } = window.perceptObsLabs.values().next().value.planes.find(({ sweep }) => sweep);
    const take = sweep.take.bind(sweep);
    window.maps = new Set();
    sweep.take = (part) => {
        take(part);
        if (sweep.found) window.maps.add(sweep.found.key);
    };
}"""


def first_map(page: Any) -> dict[str, float]:
    """Milliseconds to the first picture of a map, and those of the main thread."""
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    before = spent(session)["TaskDuration"]
    found = page.evaluate(FIRST)
    return found | {"main": 1000 * (spent(session)["TaskDuration"] - before)}


def main(rounds: int = 5) -> None:
    """Open a lab so many times, and tell medians."""
    untouched, firsts, drags = [], [], []
    with launched() as context:
        for _ in range(rounds):
            page = open_alone(context, observer_lab("ma2005_eq35"))
            untouched.append(first_map(page))
            page.close()
            page = open_alone(context, observer_lab("ma2005_eq35"))
            page.click("summary:has-text('Map over two settings')")
            page.wait_for_timeout(1000)
            rested(page, 60)
            firsts.append(first_map(page))
            rested(page, 60)
            page.evaluate(COUNT)
            drags.append(drag(page, "foe", SECONDS) | {"maps": page.evaluate("window.maps.size") / SECONDS})
            page.close()
    for what, found in (("its topic open", firsts), ("nothing touched before", untouched)):
        took, main_thread, cells = (statistics.median(one[name] for one in found) for name in ("took", "main", "cells"))
        print(f"first map, {what}: {took:.0f} ms, main thread {main_thread:.0f} ms, {cells:.0f} places a side")
    maps, pictures = (statistics.median(one[name] for one in drags) for name in ("maps", "rate"))
    print(f"while a hand drags: {maps:.1f} maps a second, the lab {pictures:.1f} pictures a second")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
