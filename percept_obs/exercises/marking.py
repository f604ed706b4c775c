"""Marks by the shipped checks, in processes of their own: an answer comes in as a literal, and nothing else of it runs."""

from __future__ import annotations

import ast
import contextlib
import json
import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from percept_obs.exercises.copies import CHECK
from percept_obs.exercises.individual import individual
from percept_obs.exercises.models import notebooks
from percept_obs.validation import bar, workers

ANSWER_SECONDS, LESSON_SECONDS = 60, 600
"""Longest time for a check, and for the cells of a notebook before it."""

FAULT = "why a lesson cannot run"

Verdict = tuple[bool | None, str]


@dataclass(frozen=True)
class Job:
    """Answers of a student to the tasks of a notebook, in order; no name if the tasks are everybody's."""

    student: str
    notebook: str
    answers: Mapping[str, Any]


def programs(notebook: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield the programs of a notebook that solve no exercise: task or "", what comes first, and the check itself."""
    for cell in (each for each in notebook["cells"] if each["cell_type"] == "code"):
        tags, text = cell["metadata"].get("tags", ()), "".join(cell["source"])
        if "exercise" in tags and cell.get("id", "").endswith(CHECK):
            lines = text.splitlines(keepends=True)
            begin = ast.parse(text).body[-1].lineno - 1
            yield cell["id"].removesuffix(CHECK), "".join(lines[:begin]), "".join(lines[begin:])
        elif "solution" not in tags:
            yield "", text, ""


def marks(jobs: Sequence[Job]) -> list[dict[str, Verdict]]:
    """Return for each job whether its answers are right, by their tasks, and what the check replied."""
    order = sorted(range(len(jobs)), key=lambda k: jobs[k].notebook)
    count = max(1, min(workers(), len(jobs)))
    with tempfile.TemporaryDirectory() as place, contextlib.ExitStack() as stack, ThreadPoolExecutor(count) as pool:
        free = [stack.enter_context(contextlib.closing(_Marker(place))) for _ in range(count)]

        def mark(k: int) -> tuple[int, dict[str, Verdict]]:
            marker = free.pop()
            try:
                return k, marker.mark(jobs[k])
            finally:
                free.append(marker)

        found = dict(bar(pool.map(mark, order), "marking", len(jobs)))
    return [found[k] for k in range(len(jobs))]


class _Marker:
    """A process that marks one job after another, and is begun anew if a check does not come to an end."""

    def __init__(self, place: str) -> None:
        self.place = place
        self.process: Any = None

    def mark(self, job: Job) -> dict[str, Verdict]:
        left, found = dict(job.answers), {}
        while left:
            if self.process is None:
                context = multiprocessing.get_context("spawn")
                self.here, there = context.Pipe()
                self.process = context.Process(target=serve, args=(there, self.place), daemon=True)
                self.process.start()
                there.close()
            try:
                self.here.send((job.notebook, job.student, left))
                if fault := self._received(LESSON_SECONDS):
                    return found | dict.fromkeys(left, (None, fault))
                while left:
                    task, *verdict = self._received(ANSWER_SECONDS)
                    found[task] = (verdict[0], verdict[1])
                    del left[task]
            except (TimeoutError, EOFError, OSError):
                self.close()
                found[task := next(iter(left))] = (None, f"the check gave no result in {ANSWER_SECONDS} s")
                del left[task]
        return found

    def _received(self, seconds: float) -> Any:
        if not self.here.poll(seconds):
            raise TimeoutError
        return self.here.recv()

    def close(self) -> None:
        if self.process is not None:
            self.process.kill()
            self.process.join()
            self.here.close()
            self.process = None


def serve(connection: Any, place: str) -> None:
    """Mark jobs from a connection until it is closed."""
    os.environ["MPLBACKEND"] = "agg"
    os.chdir(place)
    warnings.simplefilter("ignore")
    shipped, lessons = notebooks(), dict[str, dict[str, Any]]()
    with contextlib.suppress(EOFError), open(os.devnull, "w") as nowhere:  # noqa: SIM117
        with contextlib.redirect_stdout(nowhere), contextlib.redirect_stderr(nowhere):
            while True:
                name, student, answers = connection.recv()
                notebook = individual(shipped[name], student) if student else shipped[name]
                parts = list(programs(notebook))
                if name not in lessons:
                    lessons[name] = _lesson(first for task, first, _ in parts if not task)
                connection.send(lessons[name].get(FAULT, ""))
                own = dict(lessons[name])
                for task, first, check in (part for part in parts if part[0] and FAULT not in own):
                    own[named(check)] = answers.get(task, ...)
                    exec(compile(first, task, "exec"), own)
                    if task in answers:
                        connection.send((task, *_verdict(check, own)))


def _lesson(programs: Iterable[str]) -> dict[str, Any]:
    """Return the names after the programs of a notebook, or a fault."""
    names = {"__name__": "lesson"}
    try:
        for program in programs:
            exec(compile(program, "lesson", "exec"), names)
    except Exception as error:
        return {FAULT: f"the notebook itself cannot run here: {error}"}
    return names


def named(check: str) -> str:
    """Return the name of the answer that a check is about."""
    call = ast.parse(check).body[-1]
    assert isinstance(call, ast.Expr) and isinstance(call.value, ast.Call)
    return ast.unparse(call.value.args[0])


def _verdict(check: str, names: dict[str, Any]) -> Verdict:
    try:
        reply = eval(compile(check.strip(), "check", "eval"), names)
    except Exception as error:
        return None, f"the check cannot run with it: {error}"
    return reply.right, str(reply)


# In a process of its own, if a teacher asks for it: an answer that is no literal.

CHILD = """
import contextlib, ctypes, json, os, resource, sys
given = json.load(sys.stdin)
for limit, most in given["limits"].items():
    resource.setrlimit(getattr(resource, limit), (most, most))
with contextlib.suppress(OSError, AttributeError):
    ctypes.CDLL(None).unshare(0x50000000)  # a user and a network namespace of its own, without a network
names = {"__name__": "lesson"}
for program in given["programs"]:
    exec(compile(program, "answer", "exec"), names)
with open("answer", "w") as file:
    file.write(repr(names[given["name"]]))
"""
LIMITS = {"RLIMIT_CPU": 120, "RLIMIT_AS": 8 << 30, "RLIMIT_FSIZE": 1 << 24, "RLIMIT_NOFILE": 256}
"""Seconds of processor, bytes of memory and of a file, and open files."""


def run(source: str, name: str, notebook: Mapping[str, Any], task: str) -> str:
    """Run a student's cell after the shipped ones, with limits, and return the answer's text; it is not evaluated.

    A ValueError says if there is none.
    """
    if sys.platform == "win32":
        raise ValueError("--run needs limits that Windows does not have; run it on Linux or macOS")
    before = []
    for other, first, _ in programs(notebook):
        before.append(first)
        if other == task:
            break
    given = json.dumps({"limits": LIMITS, "programs": [*before, source], "name": name})
    kept = {key: os.environ[key] for key in ("PATH", "PYTHONPATH", "LANG") if key in os.environ}
    with tempfile.TemporaryDirectory() as place, open(os.devnull, "w") as nowhere:
        child = subprocess.Popen(
            [sys.executable, "-c", CHILD],
            cwd=place,
            env={**kept, "HOME": place, "MPLBACKEND": "agg"},
            stdin=subprocess.PIPE,
            stdout=nowhere,
            stderr=nowhere,
            start_new_session=True,
            text=True,
        )
        try:
            child.communicate(given, timeout=LESSON_SECONDS)
        except (subprocess.TimeoutExpired, BrokenPipeError):
            pass
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(child.pid, signal.SIGKILL)  # and what it has started
            child.wait()
        answer = Path(place, "answer")
        if child.returncode or answer.is_symlink() or not answer.is_file():
            raise ValueError("its cell did not come to an end")
        with open(answer, encoding="utf-8", errors="replace") as file:
            return file.read(LONGEST)


LONGEST = 4000
"""Characters of an answer."""
