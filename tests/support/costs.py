"""The CPU and wall seconds that the tests of each room take, with the programs that they start, against a budget."""

import json
import os
import sys
import time
import tomllib
from collections import Counter
from pathlib import Path

import pytest

KEPT = "PERCEPT_OBS_COSTS"
"""Environment variable: a file that gets a line for each room and process, `[room, tests, CPU, wall]`."""
FAILS_AT = 1.5
"""A run that takes so many times the budget fails."""


def spent():
    """CPU seconds of this process and all that it started: those that run, and those that ended."""
    import psutil  # only here, for the table is also written without it

    own, total = psutil.Process(), 0.0
    for process in (own, *own.children(recursive=True)):
        try:
            total += sum(process.cpu_times()[:4])
        except psutil.Error:  # it ended meanwhile, and its parent has its seconds
            continue
    return total


class Costs:
    """Counts what the tests of one process cost, a room at a time."""

    def __init__(self, file):
        self.file, self.tests, self.cpu, self.wall = file, 0, 0.0, time.monotonic()

    def enter(self, room):
        """Write down what was spent since the last call, for a room."""
        cpu, wall = spent(), time.monotonic()
        row = [room, self.tests, cpu - self.cpu, wall - self.wall]
        with self.file.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")
        self.tests, self.cpu, self.wall = 0, cpu, wall

    @pytest.hookimpl(wrapper=True)
    def pytest_collection(self):
        yield
        self.enter("(collecting)")

    def pytest_sessionfinish(self, session):
        if hasattr(session.config, "workerinput") or not session.config.getoption("numprocesses", None):
            self.enter("(closing)")
            return
        own = sum(os.times()[:2])  # what runs in other processes, they write themselves
        self.cpu = spent() - own
        self.enter("(giving out tests)")

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item, nextitem):
        result = yield
        self.tests += 1
        room = item.path.parent.name
        if nextitem is None or nextitem.path.parent.name != room:
            self.enter(room)
        return result


def table(rows):
    """Lines of a table of rooms, from rows of several processes; the dearest room first."""
    tests, cpu, wall = Counter(), Counter(), Counter()
    for room, count, seconds, passed in rows:
        tests[room] += count
        cpu[room] += seconds
        wall[room] += passed
    lines = [f"{'room':<28}{'tests':>7}{'CPU s':>9}{'wall s':>9}"]
    for room, seconds in [*cpu.most_common(), ("all", cpu.total())]:
        number, passed = (tests.total(), wall.total()) if room == "all" else (tests[room], wall[room])
        lines.append(f"{room:<28}{number or '':>7}{seconds:>9.1f}{passed:>9.1f}")
    return lines


def judged(cpu, budget):
    """A sentence on CPU seconds and their budget, and whether they are so many that a run fails."""
    much = cpu > FAILS_AT * budget
    kept = "keeps" if cpu <= budget else "breaks"
    return f"{cpu:.0f} CPU seconds: the run {kept} its budget of {budget} (pyproject.toml)", much


def main(file):
    """Print the table of a file and the verdict; the exit code is 1 where the run fails for its cost."""
    rows = [json.loads(line) for line in Path(file).read_text("utf-8").splitlines()]
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text("utf-8"))
    said, much = judged(sum(row[2] for row in rows), project["tool"]["percept_obs"]["cpu_seconds"])
    print(*table(rows), said, sep="\n")
    return int(much)


def plugin():
    """The plugin of this process, where costs are kept."""
    return Costs(Path(os.environ[KEPT])) if KEPT in os.environ else None


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
